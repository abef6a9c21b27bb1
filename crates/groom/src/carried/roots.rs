//! Where the roots of hair are on a surface.

use std::collections::{BTreeMap, VecDeque};

use glam::Vec3;
use lovelock_base::random::SplitMix64;
use lovelock_base::triangle::closest_barycentric;

use super::{RootPlace, SkinSurface};

/// A place on a triangle of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SkinRoot {
    /// The index of the triangle.
    pub triangle: usize,
    /// The weights of its corners, which sum to 1.
    pub weights: [f32; 3],
}

/// Places among which each root is chosen, so that roots are even.
const CANDIDATES: usize = 6;
/// The least value of a mask on a rim.
const MARKED: f32 = 0.5;
/// How far aside a vertex hides those behind it, as a fraction of the length of the rim.
const BESIDE: f32 = 0.04;
/// The golden ratio: multiples of it fill the unit interval evenly, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// `count` places in a mask on the vertices of a surface. More places begin with the same ones.
pub(super) fn roots_of(
    surface: &SkinSurface,
    mask: &[f32],
    (place, count): (RootPlace, usize),
    random: &mut SplitMix64,
) -> Vec<SkinRoot> {
    if let RootPlace::Rim(toward) = place {
        let rim = Rim::of(surface, mask, toward);
        if rim.total() > 0.0 {
            return (0..count).filter_map(|i| rim.at(surface, i, random)).collect();
        }
    }
    let triangles = Triangles::of(surface, mask);
    if triangles.total() > 0.0 { triangles.evenly(surface, count, random) } else { Vec::new() }
}

/// The index of the piece that contains the place `at` along pieces of which `sums` are the running totals.
fn piece_at(sums: &[f64], at: f64) -> usize {
    sums.partition_point(|sum| *sum <= at).min(sums.len().saturating_sub(1))
}

/// Those of points in ascending order of x that no other one within `beside` of their x is farther than in a direction: a sliding
/// maximum, so that the time is linear.
fn farthest(ascending: &[Vec3], toward: Vec3, beside: f32) -> Vec<Vec3> {
    // The x and the distance of the points of the window that may still be its maximum, the largest first.
    let mut window: VecDeque<[f32; 2]> = VecDeque::new();
    let mut next = 0;
    let mut line = Vec::new();
    for p in ascending {
        while let Some(q) = ascending.get(next).filter(|q| q.x - p.x <= beside) {
            let far = q.dot(toward);
            if !far.is_nan() {
                while window.back().is_some_and(|[_, before]| *before <= far) {
                    window.pop_back();
                }
                window.push_back([q.x, far]);
            }
            next += 1;
        }
        while window.front().is_some_and(|[x, _]| p.x - x > beside) {
            window.pop_front();
        }
        if window.front().is_some_and(|[_, most]| *most <= p.dot(toward)) {
            line.push(*p);
        }
    }
    line
}

/// The line in each half of a mask that is farthest in a direction.
struct Rim {
    /// Its pieces, and the running totals of their lengths, metres.
    pieces: Vec<[Vec3; 2]>,
    sums: Vec<f64>,
    /// The triangles with a vertex of the mask.
    triangles: Vec<usize>,
}

impl Rim {
    fn of(surface: &SkinSurface, mask: &[f32], toward: Vec3) -> Self {
        let is_marked = |i: usize| mask.get(i).is_some_and(|value| *value >= MARKED);
        let finite = |i: &usize| surface.positions[*i].is_finite();
        let marked: Vec<Vec3> = (0..surface.positions.len().min(mask.len()))
            .filter(|i| is_marked(*i) && finite(i))
            .map(|i| surface.positions[i])
            .collect();
        let (low, high) = marked
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), p| (low.min(p.x), high.max(p.x)));
        let middle = 0.5 * (low + high);
        let mut rim = Self { pieces: Vec::new(), sums: Vec::new(), triangles: Vec::new() };
        let mut total = 0.0;
        for is_right in [false, true] {
            let mut half: Vec<Vec3> =
                marked.iter().copied().filter(|p| (p.x >= middle) == is_right).collect();
            half.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.dot(toward).total_cmp(&q.dot(toward))));
            let (Some(first), Some(last)) = (half.first(), half.last()) else { continue };
            // Vertices beside a farther one are behind the rim.
            let beside = BESIDE * (last.x - first.x);
            let line = farthest(&half, toward, beside);
            for ends in line.windows(2) {
                let length = f64::from(ends[0].distance(ends[1]));
                if length.is_finite() && length > 0.0 {
                    total += length;
                    rim.pieces.push([ends[0], ends[1]]);
                    rim.sums.push(total);
                }
            }
        }
        let touches = |triangle: &[u32; 3]| triangle.iter().any(|i| is_marked(*i as usize));
        let whole = |triangle: &[u32; 3]| {
            surface.corners(*triangle).is_some_and(|corners| area_of(corners).is_normal())
        };
        let triangles = surface.triangles.iter().enumerate();
        rim.triangles = triangles.filter(|(_, t)| touches(t) && whole(t)).map(|(i, _)| i).collect();
        rim
    }

    fn total(&self) -> f64 {
        if self.triangles.is_empty() { 0.0 } else { self.sums.last().copied().unwrap_or(0.0) }
    }

    /// Root `i`: the nearest place on the surface to a place on the line.
    fn at(&self, surface: &SkinSurface, i: usize, random: &mut SplitMix64) -> Option<SkinRoot> {
        let place = ((i as f64 + 0.5) * GOLDEN).fract();
        let jitter = 0.3 * (random.unit_f64() - 0.5) * self.total() / 100.0;
        let place = (place * self.total() + jitter).clamp(0.0, self.total());
        let piece = piece_at(&self.sums, place);
        let before = if piece == 0 { 0.0 } else { self.sums[piece - 1] };
        let along = ((place - before) / (self.sums[piece] - before).max(1e-12)).clamp(0.0, 1.0) as f32;
        let [from, to] = self.pieces[piece];
        let at = from.lerp(to, along);
        let nearest = self.triangles.iter().filter_map(|&triangle| {
            let corners = surface.corners(surface.triangles[triangle])?;
            let weights = closest_barycentric(at, &corners);
            let found: Vec3 = (0..3).map(|k| corners[k] * weights[k]).sum();
            Some((found.distance_squared(at), SkinRoot { triangle, weights }))
        });
        nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, root)| root)
    }
}

/// The triangles of a mask.
struct Triangles {
    of: Vec<usize>,
    /// The mask at the corners of each.
    masks: Vec<[f32; 3]>,
    sums: Vec<f64>,
}

impl Triangles {
    fn of(surface: &SkinSurface, mask: &[f32]) -> Self {
        let mut found = Self { of: Vec::new(), masks: Vec::new(), sums: Vec::new() };
        let mut total = 0.0;
        for (t, &triangle) in surface.triangles.iter().enumerate() {
            let masks = triangle.map(|i| mask.get(i as usize).map_or(0.0, |value| value.clamp(0.0, 1.0)));
            if masks.iter().all(|value| *value == 0.0) {
                continue;
            }
            let Some(corners) = surface.corners(triangle) else { continue };
            let share = f64::from(area_of(corners) * masks.iter().sum::<f32>() / 3.0);
            if share > 0.0 && share.is_finite() {
                total += share;
                found.of.push(t);
                found.masks.push(masks);
                found.sums.push(total);
            }
        }
        found
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    fn any(&self, random: &mut SplitMix64) -> SkinRoot {
        let piece = piece_at(&self.sums, random.unit_f64() * self.total());
        let masks = self.masks[piece];
        let most = masks.iter().copied().fold(0.0, f32::max);
        let mut weights = [1.0 / 3.0; 3];
        // Within a triangle by the mask, as far as a few attempts find such a place.
        for _ in 0..8 {
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            weights = [1.0 - u - v, u, v];
            let here: f32 = (0..3).map(|k| weights[k] * masks[k]).sum();
            if random.unit() * most < here {
                break;
            }
        }
        SkinRoot { triangle: self.of[piece], weights }
    }

    /// Each root is the one of some candidates that is farthest from those before it (Mitchell 1991, best candidate).
    fn evenly(&self, surface: &SkinSurface, count: usize, random: &mut SplitMix64) -> Vec<SkinRoot> {
        // About as far as the nearest of a thousand roots are apart; farther ones count as far.
        let cell = ((self.total() / 1000.0).sqrt() * 2.0).max(1e-6) as f32;
        let key = |p: Vec3| (p / cell).floor().to_array().map(|x| x as i32);
        let mut cells: BTreeMap<[i32; 3], Vec<Vec3>> = BTreeMap::new();
        let mut roots = Vec::with_capacity(count);
        for _ in 0..count {
            let mut best: Option<(f32, SkinRoot, Vec3)> = None;
            for _ in 0..CANDIDATES {
                let root = self.any(random);
                let Some(at) = point_of(surface, root) else { continue };
                let of = key(at);
                let mut nearest = cell * cell;
                for near in (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]) {
                    let key: [i32; 3] = std::array::from_fn(|axis| of[axis].saturating_add(near[axis]));
                    for other in cells.get(&key).into_iter().flatten() {
                        nearest = nearest.min(other.distance_squared(at));
                    }
                }
                if best.is_none_or(|(square, ..)| nearest > square) {
                    best = Some((nearest, root, at));
                }
            }
            let Some((_, root, at)) = best else { break };
            cells.entry(key(at)).or_default().push(at);
            roots.push(root);
        }
        roots
    }
}

/// The point of a surface at a root.
pub(super) fn point_of(surface: &SkinSurface, root: SkinRoot) -> Option<Vec3> {
    let corners = surface.corners(*surface.triangles.get(root.triangle)?)?;
    Some((0..3).map(|k| corners[k] * root.weights[k]).sum())
}

/// Twice the area of a triangle.
fn area_of([a, b, c]: [Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliding_maximum_finds_what_a_search_of_all_pairs_finds() {
        let mut random = SplitMix64::of_stream(7, 0);
        let mut points: Vec<Vec3> = (0..300)
            .map(|_| Vec3::new((random.unit() * 50.0).floor(), random.unit(), random.unit()))
            .collect();
        points.sort_by(|p, q| p.x.total_cmp(&q.x));
        let toward = Vec3::new(0.0, -1.0, 1.0);
        for beside in [0.0, 1.0, 2.5, 100.0] {
            let is_farthest = |p: &&Vec3| {
                let others = points.iter().filter(|q| (q.x - p.x).abs() <= beside);
                others.map(|q| q.dot(toward)).fold(f32::NEG_INFINITY, f32::max) <= p.dot(toward)
            };
            let wanted: Vec<Vec3> = points.iter().filter(is_farthest).copied().collect();
            assert_eq!(farthest(&points, toward, beside), wanted, "{beside}");
        }
    }

    #[test]
    fn many_marked_vertices_take_little_time() {
        let points: Vec<Vec3> = (0..120_000).map(|i| Vec3::new(i as f32 * 1e-6, 0.0, 0.0)).collect();
        // Each is as far as the others; all pairs would be 10^10.
        assert_eq!(farthest(&points, Vec3::Z, 0.01).len(), points.len());
    }
}
