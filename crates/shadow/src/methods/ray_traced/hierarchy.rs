//! A hierarchy of boxes over segments.
//!
//! Segments are sorted along a curve that fills space (Morton 1966), four make a leaf, and the boxes of leaves are joined in pairs. The
//! tree is complete: its nodes lie in one list, the children of `i` at `2 i` and `2 i + 1`, so that it needs neither links nor a stack
//! (Lauterbach et al. 2009 sort so; the layout is that of a heap).

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::samples::Ray;
use crate::bounds::FARTHEST;
use crate::{Bounds, ShadowInput};

/// Segments of a leaf.
pub(super) const LEAF: usize = 4;
/// The fewest segments for which room is made: a workgroup of the GPU sorts as many.
pub(super) const LEAST: usize = 128;

/// The number of places for so many segments: a power of two.
pub(super) fn places(segments: u64) -> u64 {
    segments.max(LEAST as u64).next_power_of_two()
}

/// A segment, from the anchor, metres.
type Segment = [Vec3; 2];

/// A box around segments. Empty where the first corner is above the second.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Extent {
    min: Vec3,
    max: Vec3,
}

impl Extent {
    const EMPTY: Self = Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    fn join(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// All segments in the order of their leaves, and the boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    segments: Vec<Segment>,
    /// The root at 1; nothing at 0.
    nodes: Vec<Extent>,
    half_width: f32,
}

/// The place of a point on the curve, of 2³⁰ within the extent.
fn on_curve(p: Vec3, extent: &Bounds) -> u32 {
    let size = (extent.max - extent.min).max(Vec3::splat(1e-12));
    let cell = ((p - extent.min) / size * 1024.0).clamp(Vec3::ZERO, Vec3::splat(1023.0)).as_uvec3();
    let UVec3 { x, y, z } = UVec3::from(cell.to_array().map(spread));
    x | y << 1 | z << 2
}

/// Puts two bits of 0 between all of ten bits.
fn spread(mut v: u32) -> u32 {
    v = (v | v << 16) & 0x0300_00ff;
    v = (v | v << 8) & 0x0300_f00f;
    v = (v | v << 4) & 0x030c_30c3;
    (v | v << 2) & 0x0924_9249
}

impl Hierarchy {
    /// The hierarchy of all segments of `input` that can be seen, as wide as `width`.
    pub fn new(input: &ShadowInput, extent: &Bounds, width: f32) -> Self {
        let strands = input.strands;
        let seen = |p: Vec3| p.abs().max_element() <= FARTHEST && p.is_finite();
        let mut keyed: Vec<(u32, u32, Segment)> = strands
            .first_point
            .par_windows(2)
            .flat_map_iter(|ends| {
                let points = ends[0] as usize..ends[1] as usize;
                points.clone().zip(points.skip(1)).filter_map(|(a, b)| {
                    let [from, to] = [a, b].map(|at| strands.point(at) - input.anchor);
                    let is_there = seen(from) && seen(to) && from != to;
                    is_there.then(|| (on_curve(from.midpoint(to), extent), a as u32, [from, to]))
                })
            })
            .collect();
        keyed.par_sort_unstable_by_key(|(code, at, _)| (*code, *at));
        let mut segments: Vec<Segment> = keyed.into_iter().map(|(.., segment)| segment).collect();
        segments.shrink_to_fit();
        let leaves = places(segments.len() as u64) as usize / LEAF;
        let half_width = 0.5 * width;
        let mut nodes = vec![Extent::EMPTY; 2 * leaves];
        let of_leaf = |segments: &[Segment]| {
            segments.iter().fold(Extent::EMPTY, |all, [a, b]| {
                all.join(Extent { min: a.min(*b) - half_width, max: a.max(*b) + half_width })
            })
        };
        let (inner, last) = nodes.split_at_mut(leaves);
        last.par_iter_mut()
            .zip(segments.par_chunks(LEAF))
            .for_each(|(node, segments)| *node = of_leaf(segments));
        // Level by level, from the leaves to the root.
        let mut below: &[Extent] = last;
        let mut rest = inner;
        while rest.len() > 1 {
            let (before, level) = rest.split_at_mut(rest.len() / 2);
            level.par_iter_mut().zip(below.par_chunks(2)).for_each(|(node, two)| *node = two[0].join(two[1]));
            (below, rest) = (level, before);
        }
        Self { segments, nodes, half_width }
    }

    /// Memory of the lists, bytes.
    pub fn bytes(&self) -> u64 {
        (size_of::<Segment>() * self.segments.capacity() + size_of::<Extent>() * self.nodes.capacity()) as u64
    }

    /// An upper limit of the memory for so many segments, with what sorting them needs, bytes.
    pub fn needed_bytes(segments: u64) -> u64 {
        let nodes = 2 * places(segments) / LEAF as u64;
        segments * (size_of::<Segment>() + size_of::<(u32, u32, Segment)>()) as u64
            + nodes * size_of::<Extent>() as u64
    }

    /// Segments.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Calls `put` with the distance of each ribbon that a ray crosses, in the order of the tree, until it returns `false`.
    #[inline]
    pub fn for_each_hit(&self, ray: &Ray, mut put: impl FnMut(f32) -> bool) {
        let (inverse, nearest) = (ray.along.recip(), ray.nearest());
        let leaves = self.nodes.len() / 2;
        let mut node = 1;
        while node != 0 && node < self.nodes.len() {
            if crosses(&self.nodes[node], ray, inverse) {
                if node < leaves {
                    node *= 2;
                    continue;
                }
                let first = (node - leaves) * LEAF;
                let end = (first + LEAF).min(self.segments.len());
                for segment in &self.segments[first.min(end)..end] {
                    if let Some(distance) = hit(segment, ray, self.half_width)
                        && distance > nearest
                        && !put(distance)
                    {
                        return;
                    }
                }
            }
            // To the next node that is not below this one: up from right children, then to the right.
            node >>= node.trailing_ones();
            node += usize::from(node != 0);
        }
    }

    /// The number of ribbons before the light of a ray, at most `most`.
    #[inline]
    pub fn count(&self, ray: &Ray, most: u32) -> u32 {
        let mut count = 0;
        self.for_each_hit(ray, |_| {
            count += 1;
            count < most
        });
        count
    }
}

/// Whether a ray crosses a box.
#[inline]
fn crosses(extent: &Extent, ray: &Ray, inverse: Vec3) -> bool {
    let (mut near, mut far) = (0.0_f32, ray.length);
    for axis in 0..3 {
        let a = (extent.min[axis] - ray.from[axis]) * inverse[axis];
        let b = (extent.max[axis] - ray.from[axis]) * inverse[axis];
        // NaN where the ray runs along a side: it is within.
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far && extent.min.x <= extent.max.x
}

/// The square of the least sine of the angle between a ray and a segment that it sees: below, places along it are noise.
const LEAST_SINE: f32 = 1e-8;

/// Where a ray crosses a ribbon that faces it, metres from its start; `None` if it passes beside it.
#[inline]
fn hit([a, b]: &Segment, ray: &Ray, half_width: f32) -> Option<f32> {
    let (from, to) = (*a - ray.from, *b - ray.from);
    let (near, far) = (from.dot(ray.along), to.dot(ray.along));
    // Across the ray.
    let start = from - ray.along * near;
    let side = to - ray.along * far - start;
    let length = side.dot(side);
    let part = -start.dot(side) / length;
    let closest = start + side * part;
    let distance = near + (far - near) * part;
    // False for NaN.
    let is_hit = length > LEAST_SINE * a.distance_squared(*b)
        && (0.0..1.0).contains(&part)
        && closest.dot(closest) <= half_width * half_width
        && distance > 0.0
        && distance < ray.length;
    is_hit.then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LightFrame;
    use lovelock_base::random::SplitMix64;
    use lovelock_groom::Strands;

    fn hair(count: usize, seed: u64) -> Strands {
        let mut random = SplitMix64::new(seed);
        let mut strands = Strands::default();
        let mut first = vec![0];
        for _ in 0..count {
            let mut p = 0.1 * random.signed_vec3();
            for _ in 0..5 {
                strands.x.push(p.x);
                strands.y.push(p.y);
                strands.z.push(p.z);
                p += 0.01 * random.signed_vec3();
            }
            first.push(strands.x.len() as u32);
        }
        strands.first_point = first.into();
        strands
    }

    fn built(strands: &Strands, width: f32) -> Hierarchy {
        let input = ShadowInput {
            strands,
            strand_width: width,
            extinction_scale: 1.0,
            light: LightFrame::WORLD,
            anchor: Vec3::new(0.01, 0.02, 0.03),
            maps: 1,
            projected: None,
        };
        Hierarchy::new(&input, &input.bounds(), width)
    }

    #[test]
    fn every_ribbon_that_a_ray_crosses_is_found_and_no_other() {
        let mut random = SplitMix64::new(4);
        for count in [0, 1, 3, 200, 1000] {
            let made = built(&hair(count, 1), 2e-3);
            assert_eq!(made.len(), 4 * count);
            let mut hits = 0;
            for at in 0..300 {
                let mut along = random.signed_vec3().normalize_or(Vec3::X);
                if at % 5 == 0 {
                    along = [Vec3::X, Vec3::NEG_Y, Vec3::Z][at / 5 % 3];
                }
                let length = if at % 2 == 0 { f32::INFINITY } else { 0.1 };
                let ray = Ray { from: 0.1 * random.signed_vec3(), along, length };
                let all = made.segments.iter().filter_map(|segment| hit(segment, &ray, made.half_width));
                let mut all: Vec<_> = all.filter(|distance| *distance > ray.nearest()).collect();
                let mut found = Vec::new();
                made.for_each_hit(&ray, |distance| {
                    found.push(distance);
                    true
                });
                all.sort_by(f32::total_cmp);
                found.sort_by(f32::total_cmp);
                assert_eq!(found, all, "{count} strands, ray {at}");
                assert_eq!(made.count(&ray, 2), 2.min(all.len() as u32));
                hits += all.len();
            }
            assert!(count < 200 || hits * 10 > count, "control: {hits}");
        }
    }

    #[test]
    fn a_ribbon_is_as_wide_as_it_is_and_as_long_as_its_segment() {
        let segment = [Vec3::new(-1.0, 0.5, 0.0), Vec3::new(1.0, 1.5, 0.0)];
        let at = |x: f32, z: f32| {
            let ray = Ray { from: Vec3::new(x, 0.0, z), along: Vec3::Y, length: f32::INFINITY };
            hit(&segment, &ray, 0.1)
        };
        assert_eq!(at(0.0, 0.0), Some(1.0));
        assert_eq!(at(0.5, 0.09), Some(1.25));
        for beside in [at(0.0, 0.11), at(1.01, 0.0), at(-1.01, 0.0), at(0.2, -0.11)] {
            assert_eq!(beside, None);
        }
        // Seen along its length it is nothing, and what lies behind the start or the light is not before it.
        let along = (segment[1] - segment[0]).normalize_or_zero();
        assert_eq!(hit(&segment, &Ray { from: segment[0] - along, along, length: 9.0 }, 0.1), None);
        for (from, along, length) in
            [(Vec3::Y, Vec3::Y, 9.0), (2.0 * Vec3::Y, Vec3::Y, 9.0), (Vec3::ZERO, Vec3::Y, 0.9)]
        {
            assert_eq!(hit(&segment, &Ray { from, along, length }, 0.1), None, "{from} {length}");
        }
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let mut strands = hair(10, 2);
        (strands.x[3], strands.y[17], strands.z[29]) = (f32::NAN, f32::INFINITY, 1e30);
        let made = built(&strands, 1e-3);
        // Each lies in one or two segments.
        assert!(made.len() < 40 && made.len() >= 34, "{}", made.len());
        assert!(made.nodes[1].min.is_finite() && made.nodes[1].max.is_finite());
        assert!(made.bytes() <= Hierarchy::needed_bytes(40));
    }
}
