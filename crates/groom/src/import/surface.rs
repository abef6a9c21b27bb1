//! Finds the closest points on a triangle mesh with a tree of boxes.

use glam::Vec3;
use lovelock_base::triangle::closest_point_with;

use crate::Scalp;

/// Triangles in a leaf of the tree.
const LEAF: usize = 4;

/// Some triangles of a scalp, prepared for closest-point queries.
pub(super) struct Surface {
    triangles: Vec<[Vec3; 3]>,
    nodes: Vec<Node>,
}

/// A box of triangles `start..end`; `right` is the index of the second child, 0 for a leaf. The first child
/// follows its parent.
struct Node {
    min: Vec3,
    max: Vec3,
    start: u32,
    end: u32,
    right: u32,
}

impl Surface {
    /// The part of `scalp` where hair grows (mean mask of a triangle's corners above one half), or all of it if none
    /// does. `None` if the scalp has no triangles with finite corners.
    pub(super) fn where_hair_grows(scalp: &Scalp) -> Option<Self> {
        let mask = |triangle: &[u32; 3]| {
            triangle.iter().filter_map(|&v| scalp.mask.get(v as usize)).sum::<f32>() > 1.5
        };
        Self::of(scalp, mask).or_else(|| Self::whole(scalp))
    }

    /// All of `scalp`, including face and neck.
    pub(super) fn whole(scalp: &Scalp) -> Option<Self> {
        Self::of(scalp, |_| true)
    }

    fn of(scalp: &Scalp, keep: impl Fn(&[u32; 3]) -> bool) -> Option<Self> {
        let corner = |v: u32| scalp.positions.get(v as usize).copied().filter(|p| p.is_finite());
        let mut triangles: Vec<[Vec3; 3]> = scalp
            .triangles
            .iter()
            .filter(|triangle| keep(triangle))
            .filter_map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]))
            .collect();
        if triangles.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(triangles.len());
        let count = triangles.len();
        build(&mut triangles, 0, count, &mut nodes);
        Some(Self { triangles, nodes })
    }

    /// Corners of the triangles; shared corners repeat for each triangle.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.triangles.iter().flatten().copied()
    }

    /// The point of the surface closest to `point`.
    pub(super) fn closest(&self, point: Vec3) -> Vec3 {
        let mut best = (f32::INFINITY, point);
        // The tree halves at every level, so this depth is enough for 2^32 triangles.
        let mut stack = [0_u32; 40];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let index = stack[top] as usize;
            let node = &self.nodes[index];
            if node.distance_squared(point) >= best.0 {
                continue;
            }
            if node.right == 0 {
                for triangle in &self.triangles[node.start as usize..node.end as usize] {
                    let on_it = closest_on_triangle(point, triangle);
                    let distance = on_it.distance_squared(point);
                    if distance < best.0 {
                        best = (distance, on_it);
                    }
                }
                continue;
            }
            let children = [index as u32 + 1, node.right];
            let [first, second] = children.map(|child| self.nodes[child as usize].distance_squared(point));
            // The nearer child is taken off the stack first.
            let ordered = if first <= second { [children[1], children[0]] } else { children };
            stack[top..top + 2].copy_from_slice(&ordered);
            top += 2;
        }
        best.1
    }
}

impl Node {
    fn distance_squared(&self, point: Vec3) -> f32 {
        point.distance_squared(point.clamp(self.min, self.max))
    }
}

/// Splits triangles `start..end` at the median of their centres along the longest side of their box.
fn build(triangles: &mut [[Vec3; 3]], start: usize, end: usize, nodes: &mut Vec<Node>) {
    let of_range = &mut triangles[start..end];
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in of_range.iter().flatten() {
        min = min.min(*p);
        max = max.max(*p);
    }
    let index = nodes.len();
    nodes.push(Node { min, max, start: start as u32, end: end as u32, right: 0 });
    if end - start <= LEAF {
        return;
    }
    let size = max - min;
    let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    let middle = of_range.len() / 2;
    let key = |t: &[Vec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
    of_range.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
    build(triangles, start, start + middle, nodes);
    nodes[index].right = nodes.len() as u32;
    build(triangles, start + middle, end, nodes);
}

/// The point of a triangle closest to `p`; finite for triangles without area.
fn closest_on_triangle(p: Vec3, triangle: &[Vec3; 3]) -> Vec3 {
    closest_point_with(p, triangle, |[va, vb, vc]| {
        let &[a, b, c] = triangle;
        let sum = va + vb + vc;
        a + ((b - a) * vb + (c - a) * vc) / if sum > 0.0 { sum } else { 1.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lovelock_base::random::SplitMix64;

    #[test]
    fn the_tree_finds_what_a_search_of_all_triangles_finds() {
        // An uneven height field of 800 triangles.
        let side = 21;
        let height = |x: usize, y: usize| ((x * 7 + y * 13) % 11) as f32 * 0.1;
        let positions: Vec<Vec3> = (0..side * side)
            .map(|i| Vec3::new((i % side) as f32, height(i % side, i / side), (i / side) as f32))
            .collect();
        let mut triangles = Vec::new();
        for y in 0..side - 1 {
            for x in 0..side - 1 {
                let i = (y * side + x) as u32;
                let s = side as u32;
                triangles.push([i, i + 1, i + s]);
                triangles.push([i + 1, i + s + 1, i + s]);
            }
        }
        let scalp = Scalp { positions, triangles, ..Scalp::default() };
        let surface = Surface::whole(&scalp).expect("triangles");
        for i in 0..500 {
            let mut rng = SplitMix64::of_stream(1, i);
            let p = Vec3::from([(); 3].map(|()| rng.unit() * 30.0 - 5.0)) * Vec3::new(1.0, 0.3, 1.0);
            let best = surface
                .triangles
                .iter()
                .map(|t| closest_on_triangle(p, t).distance(p))
                .fold(f32::INFINITY, f32::min);
            assert_eq!(surface.closest(p).distance(p), best);
        }
    }

    #[test]
    fn degenerate_and_missing_triangles_are_harmless() {
        let scalp = Scalp {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(f32::NAN, 0.0, 0.0)],
            triangles: vec![[0, 0, 0], [0, 1, 1], [0, 1, 2], [0, 1, 9]],
            ..Scalp::default()
        };
        let surface = Surface::whole(&scalp).expect("two triangles remain");
        assert_eq!(surface.closest(Vec3::new(0.25, 1.0, 0.0)), Vec3::new(0.25, 0.0, 0.0));
        assert!(Surface::whole(&Scalp::default()).is_none());
    }
}
