//! What is measured about locks, over the instants of a dance.

use std::collections::HashMap;
use std::fmt;

use glam::{IVec3, Vec3};
use lovelock_base::statistics::percentile;
use lovelock_groom::{Hairstyle, Wisp};
use serde::Serialize;

/// The first point of a guide that counts: those before stand in the scalp.
const FIRST_POINT: usize = 3;

/// A lock with a larger radius than this at a point is wide there, metres.
const WIDE: f32 = 0.025;

/// Links of different locks that are closer than this are neighbours, metres.
const NEIGHBOUR: f32 = 0.015;

/// The first link that is compared with its neighbours.
const FIRST_LINK: usize = 5;

/// Neighbours are compared in one of this many instants.
const CROSSING_EVERY: u64 = 12;

/// Speeds below which the hair is at rest, metres per second: of the median tip, and of the tip at the 95th percentile.
const AT_REST: [f32; 2] = [0.05, 0.15];

/// The guides of all locks at an instant, three guides per lock, one after the other.
pub(super) struct Instant {
    /// World space, metres.
    pub(super) world: Vec<Vec3>,
    /// Head space, metres.
    pub(super) head: Vec<Vec3>,
}

/// Percentiles of a quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// The median.
    pub p50: f32,
    /// The 95th percentile.
    pub p95: f32,
    /// The 99th percentile.
    pub p99: f32,
}

impl Spread {
    fn of(values: &[f32]) -> Self {
        let [p50, p95, p99] = [0.5, 0.95, 0.99].map(|q| percentile(values, q).unwrap_or(0.0));
        Self { p50, p95, p99 }
    }

    fn times(self, factor: f32) -> Self {
        Self { p50: self.p50 * factor, p95: self.p95 * factor, p99: self.p99 * factor }
    }
}

impl fmt::Display for Spread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} / {:.1} / {:.1}", self.p50, self.p95, self.p99)
    }
}

/// Figures over a dance and after a stop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LockFigures {
    /// Radius of a lock in its outer half, millimetres: the root mean square distance of its guides from their mean.
    pub radius_mm: Spread,
    /// The same at rest.
    pub rest_radius_mm: Spread,
    /// Share of all points at which a lock is wider than 25 mm.
    pub wide_share: f32,
    /// Share of the guides that have a point in front of the face, at rest.
    pub rest_face_share: f32,
    /// The same at the first frame.
    pub first_face_share: f32,
    /// The same over the dance: percentiles over its instants.
    pub face_share: Spread,
    /// Angle between the outer half of a guide and straight down, degrees.
    pub plumb_deg: Spread,
    /// Median of the same angle at the first frame, degrees.
    pub first_plumb_deg: f32,
    /// Angle between links of different locks within 15 mm of each other, degrees.
    pub crossing_deg: Spread,
    /// Time after a stop of the body until the median speed of the tips stays below 5 cm/s, seconds.
    pub settle_secs: f64,
    /// The same until the 95th percentile of the speeds stays below 15 cm/s, seconds.
    pub settle_most_secs: f64,
    /// Radius of a lock five seconds after the stop, millimetres.
    pub still_radius_mm: Spread,
}

/// Collects figures instant by instant.
pub(super) struct Figures {
    points: usize,
    /// The guides at rest, head space.
    rest: Vec<Vec3>,
    outer_radius: Vec<f32>,
    wide: [u64; 2],
    face: Vec<f32>,
    plumb: Vec<f32>,
    first_plumb: f32,
    crossing: Vec<f32>,
    still_tips: Vec<Vec<Vec3>>,
    still_radius: Vec<f32>,
}

/// The guides of the wisps that have three, in order.
pub(super) fn guides_of_locks(style: &Hairstyle) -> impl Iterator<Item = usize> {
    let lock = |wisp: &&Wisp| {
        let [a, b, c] = wisp.guides;
        a != b && b != c && c != a
    };
    style.wisps.iter().filter(lock).flat_map(|wisp| wisp.guides).map(|g| g as usize)
}

impl Figures {
    pub(super) fn new(style: &Hairstyle) -> Self {
        let points = style.guides.points_per_guide;
        let rest: Vec<Vec3> =
            guides_of_locks(style).flat_map(|g| (0..points).map(move |i| style.guides.point(g, i))).collect();
        Self {
            points,
            rest,
            outer_radius: Vec::new(),
            wide: [0; 2],
            face: Vec::new(),
            plumb: Vec::new(),
            first_plumb: 0.0,
            crossing: Vec::new(),
            still_tips: Vec::new(),
            still_radius: Vec::new(),
        }
    }

    pub(super) fn locks(&self) -> usize {
        self.rest.len() / (3 * self.points.max(1))
    }

    /// Adds an instant of the dance, the `frame`-th.
    pub(super) fn add(&mut self, now: &Instant, frame: u64) {
        let n = self.points;
        for (i, radius) in radii(&now.world, n) {
            if i >= n / 2 {
                self.outer_radius.push(radius);
            }
            if i >= FIRST_POINT {
                self.wide[1] += 1;
                self.wide[0] += u64::from(radius > WIDE);
            }
        }
        self.face.push(self.face_share(&now.head));
        let angles: Vec<f32> = now.world.chunks(n).map(off_plumb_deg).collect();
        if frame == 0 {
            self.first_plumb = percentile(&angles, 0.5).unwrap_or(0.0);
        }
        self.plumb.extend(angles);
        if frame.is_multiple_of(CROSSING_EVERY) {
            crossing_deg(&now.head, n, &mut self.crossing);
        }
    }

    /// Adds an instant after the stop of the body.
    pub(super) fn add_still(&mut self, now: &Instant) {
        let n = self.points;
        self.still_tips.push(now.head.chunks(n).map(|guide| guide[n - 1]).collect());
        self.still_radius.clear();
        self.still_radius.extend(radii(&now.world, n).filter(|(i, _)| *i >= FIRST_POINT).map(|(_, r)| r));
    }

    /// The share of guides with a point in front of the face: a column as wide as the face, from the brow to the chin.
    fn face_share(&self, head: &[Vec3]) -> f32 {
        let roots = self.rest.iter().step_by(self.points);
        let (mut high, mut sum, mut count) = (Vec3::NEG_INFINITY, 0.0, 0.0);
        for root in roots {
            (high, sum, count) = (high.max(*root), sum + root.x, count + 1.0);
        }
        let middle = sum / f32::max(count, 1.0);
        let before = |p: &Vec3| {
            (p.x - middle).abs() < 0.055 && p.y < high.y - 0.06 && p.y > high.y - 0.24 && p.z > high.z - 0.015
        };
        let guides = head.chunks(self.points);
        guides.filter(|guide| guide.iter().any(before)).count() as f32 / f32::max(count, 1.0)
    }

    /// The figures; instants are `secs` apart.
    pub(super) fn finish(&self, secs: f64) -> LockFigures {
        let n = self.points;
        let rest: Vec<f32> = radii(&self.rest, n).filter(|(i, _)| *i >= n / 2).map(|(_, r)| r).collect();
        let speeds: Vec<Vec<f32>> = self
            .still_tips
            .windows(2)
            .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b) / secs as f32).collect())
            .collect();
        let rest_after = |q: f64, limit: f32| {
            let moving = |tips: &Vec<f32>| percentile(tips, q).is_some_and(|speed| speed > limit);
            speeds.iter().rposition(moving).map_or(0, |last| last + 1) as f64 * secs
        };
        LockFigures {
            radius_mm: Spread::of(&self.outer_radius).times(1e3),
            rest_radius_mm: Spread::of(&rest).times(1e3),
            wide_share: self.wide[0] as f32 / self.wide[1].max(1) as f32,
            rest_face_share: self.face_share(&self.rest),
            first_face_share: self.face.first().copied().unwrap_or(0.0),
            face_share: Spread::of(&self.face),
            plumb_deg: Spread::of(&self.plumb),
            first_plumb_deg: self.first_plumb,
            crossing_deg: Spread::of(&self.crossing),
            settle_secs: rest_after(0.5, AT_REST[0]),
            settle_most_secs: rest_after(0.95, AT_REST[1]),
            still_radius_mm: Spread::of(&self.still_radius).times(1e3),
        }
    }
}

/// The radius of every lock at every point: the point's index, and the root mean square distance of its three guides from their
/// mean.
fn radii(guides: &[Vec3], points: usize) -> impl Iterator<Item = (usize, f32)> {
    guides.chunks_exact(3 * points).flat_map(move |lock| {
        (0..points).map(move |i| {
            let of = [lock[i], lock[points + i], lock[2 * points + i]];
            let mean = (of[0] + of[1] + of[2]) / 3.0;
            (i, (of.iter().map(|p| p.distance_squared(mean)).sum::<f32>() / 3.0).sqrt())
        })
    })
}

/// Angle between the outer half of a guide and straight down, degrees.
fn off_plumb_deg(guide: &[Vec3]) -> f32 {
    let outer = guide[guide.len() - 1] - guide[guide.len() / 2];
    (-outer.y / outer.length().max(1e-9)).clamp(-1.0, 1.0).acos().to_degrees()
}

/// Adds the angles between neighbouring links of different locks to `out`, degrees.
fn crossing_deg(guides: &[Vec3], points: usize, out: &mut Vec<f32>) {
    let links: Vec<(usize, Vec3, Vec3)> = guides
        .chunks_exact(points)
        .enumerate()
        .flat_map(|(g, guide)| {
            guide
                .windows(2)
                .skip(FIRST_LINK)
                .map(move |link| (g / 3, 0.5 * (link[0] + link[1]), (link[1] - link[0]).normalize_or_zero()))
        })
        .collect();
    let cell = |p: Vec3| (p / NEIGHBOUR).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<usize>> = HashMap::new();
    for (n, (_, p, _)) in links.iter().enumerate() {
        cells.entry(cell(*p)).or_default().push(n);
    }
    for (n, (lock, p, d)) in links.iter().enumerate() {
        let here = cell(*p);
        for offset in (0..27).map(|i| IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) {
            let near = cells.get(&(here + offset)).into_iter().flatten().filter(|&&m| m > n);
            for (other, q, e) in near.map(|&m| &links[m]) {
                if other != lock && p.distance_squared(*q) < NEIGHBOUR * NEIGHBOUR {
                    out.push(d.dot(*e).clamp(-1.0, 1.0).acos().to_degrees());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::Guides;

    use super::*;

    const POINTS: usize = 13;

    /// Three guides of 12 cm that hang from `root`, 10 mm from the middle of their lock, or run along X.
    fn lock(root: Vec3, along: Vec3) -> Vec<Vec3> {
        let out = [Vec3::X, Vec3::new(-0.5, 0.0, 0.866_025_4), Vec3::new(-0.5, 0.0, -0.866_025_4)];
        out.iter()
            .flat_map(|out| (0..POINTS).map(move |i| root + *out * 0.01 + along * (0.01 * i as f32)))
            .collect()
    }

    fn style(points: &[Vec3]) -> Hairstyle {
        let mut guides = Guides { points_per_guide: POINTS, ..Guides::default() };
        points.chunks(POINTS).for_each(|guide| guides.push(guide));
        let wisp = |w: u32| Wisp { guides: [3 * w, 3 * w + 1, 3 * w + 2], first_strand: 0, strand_count: 0 };
        let wisps = (0..guides.count() as u32 / 3).map(wisp).collect();
        Hairstyle { guides, wisps, ..Hairstyle::default() }
    }

    fn still(points: &[Vec3]) -> Instant {
        Instant { world: points.to_vec(), head: points.to_vec() }
    }

    #[test]
    fn a_hanging_lock_is_plumb_and_as_wide_as_drawn() {
        let rest = lock(Vec3::ZERO, Vec3::NEG_Y);
        let mut figures = Figures::new(&style(&rest));
        assert_eq!(figures.locks(), 1);
        figures.add(&still(&rest), 0);
        // Opened five times as wide, and level.
        let wide: Vec<Vec3> =
            lock(Vec3::ZERO, Vec3::X).iter().map(|p| Vec3::new(p.x, p.y, 5.0 * p.z)).collect();
        figures.add(&still(&wide), 1);
        let found = figures.finish(1.0 / 30.0);
        assert!((found.rest_radius_mm.p50 - 10.0).abs() < 1e-3, "{found:?}");
        // Half of the instants: the larger one is the 95th percentile.
        assert!((found.radius_mm.p50 - 10.0).abs() < 1e-3 && found.radius_mm.p95 > 30.0, "{found:?}");
        assert!((found.wide_share - 0.5).abs() < 1e-6);
        assert!(found.first_plumb_deg < 0.1 && (found.plumb_deg.p99 - 90.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn only_near_links_of_other_locks_cross() {
        let level = lock(Vec3::new(-0.06, 0.0, 0.0), Vec3::X);
        let crossing = |height: f32| {
            let mut both = level.clone();
            both.extend(lock(Vec3::new(0.0, height, -0.06), Vec3::Z));
            let mut angles = Vec::new();
            crossing_deg(&both, POINTS, &mut angles);
            angles
        };
        let near = crossing(0.004);
        assert!(!near.is_empty() && near.iter().all(|angle| (angle - 90.0).abs() < 0.1), "{near:?}");
        assert!(crossing(0.05).is_empty(), "control: locks that pass at 5 cm");
    }

    #[test]
    fn hair_in_front_of_the_face_is_counted() {
        // A lock at the crown, and one that is rooted at the brow and hangs before the face, where one of its guides is behind
        // the others.
        let mut rest = lock(Vec3::new(0.0, 0.2, -0.05), Vec3::NEG_Z);
        rest.extend(lock(Vec3::new(0.0, 0.15, 0.1), Vec3::NEG_Y));
        let figures = Figures::new(&style(&rest));
        assert_eq!(figures.face_share(&rest), 2.0 / 6.0);
    }

    #[test]
    fn hair_is_at_rest_after_its_last_quick_instant() {
        let rest = lock(Vec3::ZERO, Vec3::NEG_Y);
        let mut figures = Figures::new(&style(&rest));
        for frame in 0..10 {
            // 0.3 m/s for four instants, then 1 cm/s.
            let moved = 0.01 * f32::min(frame as f32, 4.0) + 3e-4 * (frame as f32 - 4.0).max(0.0);
            let now: Vec<Vec3> = rest.iter().map(|p| *p + Vec3::X * moved).collect();
            figures.add_still(&still(&now));
        }
        let found = figures.finish(1.0 / 30.0);
        assert!((found.settle_secs - 4.0 / 30.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found.settle_most_secs, found.settle_secs);
    }
}
