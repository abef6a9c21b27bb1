//! Lays three guides around a wisp's path.

use glam::Vec3;

use super::GUIDE_POINTS;
use super::cells::Cell;
use super::comb::Comb;
use super::path::Path;
use crate::frame::{reference_normal, transport};
use crate::polyline::{Reach, next_at, sample};
use crate::{GroomSettings, Obstacle, ScalpIndex};
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// The search for the next point of a guide along its path, in segments.
const REACH: Reach = Reach { beyond: 8.0, step: 0.25 };
/// Distance from the tips over which hair bends under or out, metres.
const ENDS: f32 = 0.09;
/// The turn between two links above which a guide is laid again over what it meets, radians.
const SHARP: f32 = 0.7;
/// The turn between two links above which a guide counts as folded and is cut, radians.
const FOLD: f32 = 1.2;
/// The sharpest turn of a guide that needs no further smoothing, radians.
const EASY_TURN: f32 = 0.45;
/// How often a folded guide is laid again before it is cut by a tenth, and how often it is cut.
const SMOOTHINGS: usize = 6;
const CUTS: usize = 3;
/// Clearance between the body and the path of such a guide, metres: far enough that its links need no push.
const CLEAR: f32 = 0.005;
/// Hair lies over what stands out from the head by less than this, such as an ear, metres.
const STANDS_OUT: f32 = 0.05;

/// Three guides of equal links around `path`, `length` metres long, rooted on the scalp and outside `obstacle`.
pub(super) fn around(
    settings: &GroomSettings,
    index: &ScalpIndex<'_>,
    comb: &Comb,
    obstacle: &dyn Obstacle,
    cell: &Cell,
    path: &Path,
    length: f32,
) -> [[Vec3; GUIDE_POINTS]; 3] {
    let mut rng = SplitMix64::of_stream(settings.seed, 0x901d_0000 + cell.stream);
    let start = rng.angle();
    let root = cell.centre;
    let along =
        (path.directions[0] - root.normal * path.directions[0].dot(root.normal)).normalize_or(Vec3::X);
    let across = root.normal.cross(along);
    let mut tangents = Vec::with_capacity(GUIDE_POINTS);
    let mut normals = Vec::with_capacity(GUIDE_POINTS);
    let mut middle = Vec::with_capacity(GUIDE_POINTS);
    for k in 0..GUIDE_POINTS {
        let (mut p, t) = path.at(length * fraction(k));
        // The ends turn under or out over the last centimetres.
        let near_end = 1.0 - (length * (1.0 - fraction(k)) / ENDS.min(0.5 * length)).min(1.0);
        let inward = Vec3::new(comb.centre.x - p.x, 0.0, comb.centre.z - p.z).normalize_or_zero();
        if near_end > 0.0 && settings.ends != 0.0 {
            // Hair that lies on the neck has no room to turn.
            let room = smoothstep(0.01, 0.05, obstacle.distance(p).0);
            p += inward * (settings.ends * room * 0.5 * ENDS.min(0.5 * length) * near_end * near_end);
        }
        let normal = match k {
            0 => reference_normal(t.into()),
            _ => transport(normals[k - 1], tangents[k - 1], t.into()),
        };
        middle.push(p);
        tangents.push(t.into());
        normals.push(normal);
    }
    std::array::from_fn(|g| {
        // The triangle of the guides is as wide as a disc with the cell's area.
        let angle = start + g as f32 * std::f32::consts::TAU / 3.0;
        let reach = 1.41 * cell.spread;
        let aim = root.position + (along * angle.cos() + across * angle.sin()) * reach;
        let own_root = index.closest(aim).unwrap_or(root);
        let from_middle = own_root.position - root.position;
        let local = [
            from_middle.dot(normals[0].into()),
            from_middle.dot(tangents[0].cross(normals[0]).into()),
            from_middle.dot(tangents[0].into()),
        ];
        let own_length = length * (1.0 + 0.15 * settings.length_variation * rng.bell());
        let target: [Vec3; GUIDE_POINTS] = std::array::from_fn(|k| {
            let t = fraction(k);
            // Hair fans out slightly above the roots, where it overlaps its neighbours, then gathers.
            let fan = 1.0 + 0.12 * smoothstep(0.0, 0.25, t);
            let gather = 1.0 - settings.clump * smoothstep(0.05, 0.95 - 0.3 * settings.clump, t);
            let binormal: Vec3 = tangents[k].cross(normals[k]).into();
            let (normal, tangent): (Vec3, Vec3) = (normals[k].into(), tangents[k].into());
            middle[k] + (normal * local[0] + binormal * local[1] + tangent * local[2]) * (fan * gather)
        });
        let mut target = target;
        target[0] = own_root.position;
        lay_smoothly(&target, own_length, own_root.normal, comb.centre, obstacle)
    })
}

/// As [`lay`], without folds.
///
/// Where the target passes through something thin, such as an ear, a chain that is pushed out of it link by link comes to lie behind it
/// and folds back on itself. Such a guide is laid over it instead, along a path that is smoothed until no turn is sharp. A guide that
/// meets a shoulder head-on and still folds is cut shorter.
fn lay_smoothly(
    target: &[Vec3; GUIDE_POINTS],
    length: f32,
    root_normal: Vec3,
    centre: Vec3,
    obstacle: &dyn Obstacle,
) -> [Vec3; GUIDE_POINTS] {
    let mut best = lay(target, length, root_normal, obstacle);
    let mut sharpest = sharpest_turn(&best);
    if sharpest < SHARP {
        return best;
    }
    let mut length = length;
    for _ in 0..CUTS {
        for over in [false, true] {
            let mut target = *target;
            for round in 0..SMOOTHINGS {
                if sharpest < EASY_TURN {
                    return best;
                }
                if over {
                    lift_over(&mut target, centre, obstacle);
                }
                smooth(&mut target, round, length, obstacle);
                let laid = lay(&target, length, root_normal, obstacle);
                let turn = sharpest_turn(&laid);
                if turn < sharpest {
                    (best, sharpest) = (laid, turn);
                }
            }
            if sharpest < SHARP {
                break;
            }
        }
        if sharpest < FOLD {
            break;
        }
        length *= 0.9;
    }
    best
}

/// Moves the points of a path that lie in or behind something thin to its outer side, away from the axis of the head.
fn lift_over(target: &mut [Vec3; GUIDE_POINTS], centre: Vec3, obstacle: &dyn Obstacle) {
    for p in &mut target[1..] {
        let Some(out) = Vec3::new(p.x - centre.x, 0.0, p.z - centre.z).try_normalize() else { continue };
        // From outside inward to the first surface.
        let mut ahead = STANDS_OUT;
        while ahead > 0.0 {
            let free = obstacle.distance(*p + out * ahead).0 - CLEAR;
            if free < 1e-4 {
                break;
            }
            ahead -= free.max(0.0005);
        }
        // What is deeper is the body itself, whose surface is not out there.
        if ahead > 0.0 && ahead < STANDS_OUT {
            *p += out * ahead;
        }
    }
}

/// Smooths the path of a guide, more strongly in later rounds, and keeps it clear of the body.
fn smooth(target: &mut [Vec3; GUIDE_POINTS], round: usize, length: f32, obstacle: &dyn Obstacle) {
    for _ in 0..4 + 2 * round {
        let before = *target;
        for k in 1..GUIDE_POINTS - 1 {
            target[k] = 0.25 * (before[k - 1] + before[k + 1]) + 0.5 * before[k];
        }
        let [.., a, b, end] = &mut *target;
        *end = 0.5 * (*end + *b + (*b - *a));
        for (k, p) in target.iter_mut().enumerate().skip(1) {
            let clear = (CLEAR * (1.0 + 0.5 * round as f32)).min(0.2 * length * fraction(k));
            let (distance, n) = obstacle.distance(*p);
            *p += n * (clear - distance).max(0.0);
        }
    }
}

/// The sharpest turn from one link to the next, radians.
fn sharpest_turn(guide: &[Vec3; GUIDE_POINTS]) -> f32 {
    guide.windows(3).map(|p| (p[1] - p[0]).angle_between(p[2] - p[1])).fold(0.0, f32::max)
}

fn fraction(k: usize) -> f32 {
    k as f32 / (GUIDE_POINTS - 1) as f32
}

/// Lays a chain of equal links along `target`, `length` metres long, outside `obstacle`.
fn lay(
    target: &[Vec3; GUIDE_POINTS],
    length: f32,
    root_normal: Vec3,
    obstacle: &dyn Obstacle,
) -> [Vec3; GUIDE_POINTS] {
    let link = length / (GUIDE_POINTS - 1) as f32;
    let mut guide = [target[0]; GUIDE_POINTS];
    // The position of the chain along the target, in segments.
    let mut at = 0.0_f32;
    let mut direction = root_normal;
    for k in 1..GUIDE_POINTS {
        let from = guide[k - 1];
        at = next_at(target, at, from, link, REACH);
        direction = (sample(target, at) - from).normalize_or(direction);
        let margin = 0.003_f32.min(0.35 * link * k as f32);
        let mut p = from + direction * link;
        for _ in 0..12 {
            let (distance, n) = obstacle.distance(p);
            if distance >= margin {
                break;
            }
            // Pushes out slightly more than needed, because placing the link again brings it back partly.
            direction = (p + n * (1.3 * (margin - distance) + 1e-5) - from).normalize_or(direction);
            p = from + direction * link;
        }
        guide[k] = p;
    }
    guide
}
