//! The strands of a wisp: their offsets from the guides, and their ends.

use glam::{Vec2, Vec3};

use super::GUIDE_POINTS;
use super::cells::Cell;
use super::comb::Comb;
use crate::{GroomSettings, Guides, Obstacle, ScalpPoint, StrandSet, Wisp, WispCurve};
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// Distance over which a strand's root, which lies on the scalp, blends into the curve of its guides; metres.
const ROOT_JOIN: f32 = 0.03;
/// Estimated distance from the body below which the exact distance is computed, metres: a wisp is one or two
/// centimetres wide, and over that width a head's surface deviates from its tangent plane by 2 mm.
const NEAR: f32 = 0.008;
/// Approximate number of strands in each of the smaller locks of a wisp.
const STRANDS_PER_LOCK: usize = 6;

/// The strands of one wisp, as in [`StrandSet`].
pub(super) struct WispStrands {
    points_per_strand: usize,
    weights: Vec<[f32; 3]>,
    guide_param: Vec<f32>,
    offset: Vec<Vec3>,
    taper: Vec<f32>,
    shade: Vec<f32>,
}

impl WispStrands {
    /// Appends the strands to a set as those of wisp `wisp`.
    pub(super) fn append_to(self, set: &mut StrandSet, wisp: u32) {
        for _ in 0..self.weights.len() {
            set.wisp.push(wisp);
            let end = set.first_point.last().copied().unwrap_or(0) + self.points_per_strand as u32;
            set.first_point.push(end);
        }
        set.weights.extend(self.weights);
        set.guide_param.extend(self.guide_param);
        set.offset_normal.extend(self.offset.iter().map(|o| o.x));
        set.offset_binormal.extend(self.offset.iter().map(|o| o.y));
        set.offset_tangent.extend(self.offset.iter().map(|o| o.z));
        set.taper.extend(self.taper);
        set.shade.extend(self.shade);
    }
}

/// What the strands of a wisp have in common.
struct Lock {
    /// Phase of curls at the root, and of their variation.
    phase: [f32; 3],
    /// Whether curls turn left or right.
    hand: f32,
    /// Phase of waves at the root.
    wave_phase: f32,
    /// Length of the wisp, metres.
    length: f32,
    skin: Skin,
}

/// The distance to the body along a wisp's centre, from which the distance of its strands is estimated: a query of a
/// mesh is slow, and there are many strands.
struct Skin([(Vec3, f32, Vec3); GUIDE_POINTS]);

impl Skin {
    fn new(obstacle: &dyn Obstacle, guides: &[[Vec3; GUIDE_POINTS]; 3]) -> Self {
        Self(std::array::from_fn(|k| {
            let middle = (guides[0][k] + guides[1][k] + guides[2][k]) / 3.0;
            let (distance, n) = obstacle.distance(middle);
            (middle, distance, n)
        }))
    }

    /// Distance and normal at `point` beside the guides' parameter `u`, to first order.
    fn estimate(&self, u: f32, point: Vec3) -> (f32, Vec3) {
        let k = (u as usize).min(GUIDE_POINTS - 2);
        let ((m0, d0, n0), (m1, d1, n1)) = (self.0[k], self.0[k + 1]);
        let t = u - k as f32;
        let n = n0.lerp(n1, t).normalize_or(n0);
        (d0 + (d1 - d0) * t + n.dot(point - m0.lerp(m1, t)), n)
    }
}

/// Makes the strands of the wisp of `cell` along its `guides`.
pub(super) fn of_wisp(
    settings: &GroomSettings,
    comb: &Comb,
    obstacle: &dyn Obstacle,
    cell: &Cell,
    guides: &[[Vec3; GUIDE_POINTS]; 3],
) -> WispStrands {
    let mut rng = SplitMix64::of_stream(settings.seed, 0x57a_0000 + cell.stream);
    let mut of_guides = Guides { points_per_guide: GUIDE_POINTS, ..Guides::default() };
    for guide in guides {
        of_guides.push(guide);
    }
    let curve = WispCurve::at_rest(&of_guides, &Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: 0 });
    let root = cell.centre.position;
    // Waves of neighbours are nearly in phase, as if set by a hand or an iron.
    let around = (root.x - comb.centre.x).atan2(root.z - comb.centre.z);
    let lock = Lock {
        phase: [rng.angle(), rng.angle(), rng.angle()],
        hand: if rng.unit() < 0.5 { -1.0 } else { 1.0 },
        wave_phase: 2.0 * around + 25.0 * root.y + settings.curl_wander * 1.5 * rng.signed(),
        length: guides[0][0].distance(guides[0][1]) * (GUIDE_POINTS - 1) as f32,
        skin: Skin::new(obstacle, guides),
    };
    let wisp_shade = rng.unit();
    let flat = Flat::new(cell, guides);
    let weights: Vec<[f32; 3]> = cell.roots.iter().map(|r| flat.weights(r.position)).collect();
    let centres: Vec<([f32; 3], f32)> =
        weights.iter().step_by(STRANDS_PER_LOCK).map(|&w| (w, settings.locks * rng.bell())).collect();

    let points = settings.segments_per_strand as usize + 1;
    let total = points * cell.roots.len();
    let mut strands = WispStrands {
        points_per_strand: points,
        weights: Vec::with_capacity(cell.roots.len()),
        guide_param: Vec::with_capacity(total),
        offset: Vec::with_capacity(total),
        taper: Vec::with_capacity(total),
        shade: Vec::with_capacity(cell.roots.len()),
    };
    for (strand_root, &w) in cell.roots.iter().zip(&weights) {
        let nearest = centres.iter().min_by(|a, b| apart(a.0, w).total_cmp(&apart(b.0, w)));
        let own =
            Strand::new(settings, cell, &curve, strand_root, w, *nearest.unwrap_or(&(w, 0.0)), &mut rng);
        for k in 0..points {
            let t = k as f32 / (points - 1) as f32;
            let u = (GUIDE_POINTS - 1) as f32 * own.reach * t;
            strands.guide_param.push(u);
            strands.offset.push(own.offset(settings, comb, obstacle, &curve, &lock, u));
            strands.taper.push(thickness(settings.taper, t));
        }
        strands.weights.push(w);
        strands.shade.push((0.45 * wisp_shade + 0.55 * rng.unit()).clamp(0.0, 1.0));
    }
    strands
}

fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|g| (a[g] - b[g]) * (a[g] - b[g])).sum()
}

/// Width of a strand at the fraction `t` of its length.
fn thickness(taper: f32, t: f32) -> f32 {
    let into = if taper > 0.0 { ((t - 1.0 + taper) / taper).max(0.0) } else { 0.0 };
    1.0 - 0.9 * into * into.sqrt()
}

/// The random properties of one strand.
struct Strand {
    weights: [f32; 3],
    /// From the guides' curve to the strand's own root on the scalp.
    from_guides: Vec3,
    /// Weights of the smaller lock toward which it gathers.
    gathers_to: [f32; 3],
    /// Its length as a fraction of the guides' length.
    reach: f32,
    /// Direction and distance by which it leaves the wisp, in the frame; zero for most strands.
    stray: Vec3,
    /// How much closer to the skin than its guides it lies, as a fraction.
    depth: f32,
    frizz: f32,
    phases: [f32; 6],
    curl_phase: f32,
    curl_size: f32,
}

impl Strand {
    fn new(
        settings: &GroomSettings,
        cell: &Cell,
        curve: &WispCurve,
        root: &ScalpPoint,
        weights: [f32; 3],
        (gathers_to, lock_phase): ([f32; 3], f32),
        rng: &mut SplitMix64,
    ) -> Self {
        let from_middle = root.position.distance(cell.centre.position) / (2.0 * cell.spread);
        let shorter = 0.6 * rng.unit() + 0.4 * (from_middle * from_middle).min(1.0);
        let strays = rng.unit() < settings.strays;
        let angle = rng.angle();
        let out = settings.stray_reach * (0.4 + 0.6 * rng.unit());
        let wander = settings.curl_wander;
        Self {
            weights,
            from_guides: root.position - curve.blend(weights, 0.0),
            gathers_to,
            reach: 1.0 - settings.length_variation * shorter - if strays { 0.15 * rng.unit() } else { 0.0 },
            stray: if strays { Vec3::new(angle.cos(), angle.sin(), 0.0) * out } else { Vec3::ZERO },
            frizz: settings.frizz * (0.6 + 0.8 * rng.unit()) * if strays { 2.0 } else { 1.0 },
            depth: 0.5 * rng.unit().powi(2),
            phases: std::array::from_fn(|_| rng.angle()),
            curl_phase: lock_phase + (0.3 + if strays { 2.0 } else { 0.0 }) * wander * rng.bell(),
            curl_size: 1.0 + 0.3 * wander * rng.bell(),
        }
    }

    /// The offset in the frame at `u` that gives the strand its rest shape and keeps it out of the body.
    fn offset(
        &self,
        settings: &GroomSettings,
        comb: &Comb,
        obstacle: &dyn Obstacle,
        curve: &WispCurve,
        lock: &Lock,
        u: f32,
    ) -> Vec3 {
        let frame = curve.frame(u);
        let blended = curve.blend(self.weights, u);
        if u <= 0.0 {
            return frame.transpose() * self.from_guides;
        }
        let t = u / (GUIDE_POINTS - 1) as f32;
        let arc = t * lock.length;
        let tau = std::f32::consts::TAU;

        let join = (1.0 - arc / ROOT_JOIN.min(lock.length)).max(0.0).powi(2);
        let mut displaced = self.from_guides * join;
        displaced +=
            (curve.blend(self.gathers_to, u) - blended) * (settings.locks * smoothstep(0.05, 0.6, t));

        // Curl: a helix around the wisp whose radius and pitch vary in the same way within the wisp.
        if settings.curl_radius > 0.0 {
            let onset = smoothstep(0.0, settings.curl_onset.max(0.005), arc);
            let wander = settings.curl_wander;
            let turns = arc / settings.curl_pitch;
            let phase = lock.hand
                * (tau * turns
                    + wander * (tau * turns / 4.3 + lock.phase[1]).sin()
                    + self.curl_phase * t.sqrt())
                + lock.phase[0];
            let radius = settings.curl_radius
                * onset
                * self.curl_size
                * (1.0 + 0.3 * wander * (tau * turns / 3.1 + lock.phase[2]).sin())
                * (1.0 - 0.25 * t * t);
            displaced += (frame.x_axis * phase.cos() + frame.y_axis * phase.sin()) * radius.max(0.0);
        }
        // Waves move the wisp sideways, and slightly in and out.
        if settings.wave > 0.0 {
            let onset = smoothstep(0.2, 1.0, arc / (settings.curl_onset + 0.5 * settings.wave_length));
            let out = Vec3::new(blended.x - comb.centre.x, 0.0, blended.z - comb.centre.z);
            let sideways = frame.z_axis.cross(out).normalize_or(frame.x_axis);
            let outward = sideways.cross(frame.z_axis);
            let phase = tau * arc / settings.wave_length + lock.wave_phase + 0.5 * self.curl_phase * t;
            let swing = settings.wave * onset * (0.8 + 0.2 * self.curl_size);
            displaced += (sideways * phase.sin() + outward * (0.6 * (phase + 0.9).sin())) * swing;
        }
        // Frizz: two waves of different lengths on each axis.
        let bends = tau * arc / settings.frizz_scale;
        let size = self.frizz * (0.3 + 0.7 * t) * smoothstep(0.0, 0.03, arc);
        if size > 0.0 {
            let wobble = |a: f32, b: f32| 0.6 * (bends * 0.73 + a).sin() + 0.4 * (bends * 1.57 + b).sin();
            displaced += frame.x_axis * (size * wobble(self.phases[0], self.phases[1]));
            displaced += frame.y_axis * (size * wobble(self.phases[2], self.phases[3]));
        }
        if self.stray != Vec3::ZERO {
            displaced += frame * (self.stray * t * t.sqrt());
        }

        let mut point = blended + displaced;
        // Some strands lie deeper than others, so that hair fills a volume instead of a shell; none enters the skin.
        let (mut distance, mut n) = lock.skin.estimate(u, point);
        if distance < NEAR {
            (distance, n) = obstacle.distance(point);
        }
        let near = smoothstep(0.06, 0.02, distance) * smoothstep(0.0, 0.02, arc);
        let sunk = distance - self.depth * near * distance.max(0.0);
        let margin = (0.4 * arc).min(0.0015);
        point += n * (sunk.max(margin) - distance);
        if sunk < margin {
            let (distance, n) = obstacle.distance(point);
            point += n * (margin - distance).max(0.0);
        }
        frame.transpose() * (point - blended)
    }
}

/// The triangle of the guides' roots, laid flat.
struct Flat {
    origin: Vec3,
    axes: [Vec3; 2],
    edges: [Vec2; 2],
}

impl Flat {
    fn new(cell: &Cell, guides: &[[Vec3; GUIDE_POINTS]; 3]) -> Self {
        let roots = guides.map(|g| g[0]);
        let normal = (roots[1] - roots[0]).cross(roots[2] - roots[0]).normalize_or(cell.centre.normal);
        let x = (roots[1] - roots[0]).normalize_or(normal.any_orthonormal_vector());
        let axes = [x, normal.cross(x)];
        let flat = |p: Vec3| Vec2::new((p - roots[0]).dot(axes[0]), (p - roots[0]).dot(axes[1]));
        Self { origin: roots[0], axes, edges: [flat(roots[1]), flat(roots[2])] }
    }

    /// Weights of the guides for a strand rooted at `p`: barycentric, and limited so that an irregular cell cannot
    /// throw a strand far from its wisp.
    fn weights(&self, p: Vec3) -> [f32; 3] {
        let q = Vec2::new((p - self.origin).dot(self.axes[0]), (p - self.origin).dot(self.axes[1]));
        let [a, b] = self.edges;
        let area = a.perp_dot(b);
        if area.abs() < 1e-9 {
            return [1.0 / 3.0; 3];
        }
        let from_middle = |w: f32| (w - 1.0 / 3.0).clamp(-1.2, 1.2);
        let (v, w) = (from_middle(q.perp_dot(b) / area), from_middle(a.perp_dot(q) / area));
        [1.0 / 3.0 - v - w, 1.0 / 3.0 + v, 1.0 / 3.0 + w]
    }
}
