//! How much of the light from all directions gets to each vertex: rays over the hemisphere, stopped by what is near.

use glam::{Quat, Vec3};
use rayon::prelude::*;

/// Rays per vertex.
const RAYS: usize = 96;
/// What is farther away than this does not count, metres.
const REACH: f32 = 0.07;
/// Rays start this far above the surface, metres.
const ABOVE: f32 = 0.0007;

/// A box with either two children or triangles.
struct Node {
    low: Vec3,
    high: Vec3,
    /// First child, the second one follows it; or the first triangle.
    first: usize,
    /// Number of triangles; 0 for a node with children.
    count: usize,
}

/// Triangles in a tree of boxes.
struct Tree {
    nodes: Vec<Node>,
    triangles: Vec<[Vec3; 3]>,
}

impl Tree {
    fn new(mut triangles: Vec<[Vec3; 3]>) -> Self {
        let mut tree = Self { nodes: Vec::new(), triangles: Vec::new() };
        let count = triangles.len();
        tree.nodes.push(Node { low: Vec3::ZERO, high: Vec3::ZERO, first: 0, count });
        let mut open = vec![0];
        while let Some(n) = open.pop() {
            let (first, count) = (tree.nodes[n].first, tree.nodes[n].count);
            let part = &mut triangles[first..first + count];
            let low = part.iter().flatten().fold(Vec3::INFINITY, |a, b| a.min(*b));
            let high = part.iter().flatten().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
            (tree.nodes[n].low, tree.nodes[n].high) = (low, high);
            if count <= 4 {
                continue;
            }
            let size = high - low;
            let axis = if size.x >= size.y.max(size.z) {
                0
            } else if size.y >= size.z {
                1
            } else {
                2
            };
            part.sort_by(|a, b| {
                let middle = |t: &[Vec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
                middle(a).total_cmp(&middle(b))
            });
            let (half, child) = (count / 2, tree.nodes.len());
            for (first, count) in [(first, half), (first + half, count - half)] {
                tree.nodes.push(Node { low, high, first, count });
            }
            tree.nodes[n].first = child;
            tree.nodes[n].count = 0;
            open.extend([child, child + 1]);
        }
        tree.triangles = triangles;
        tree
    }

    /// Distance along a ray to the nearest triangle; `reach` if there is none before it.
    fn hit(&self, from: Vec3, along: Vec3, reach: f32) -> f32 {
        let inverse = along.recip();
        let mut best = reach;
        let mut open = vec![0];
        while let Some(n) = open.pop() {
            let node = &self.nodes[n];
            let (a, b) = ((node.low - from) * inverse, (node.high - from) * inverse);
            let enter = a.min(b).max_element().max(0.0);
            if enter > a.max(b).min_element() || enter >= best {
                continue;
            }
            if node.count == 0 {
                open.extend([node.first, node.first + 1]);
                continue;
            }
            for [p, q, r] in &self.triangles[node.first..node.first + node.count] {
                // Möller and Trumbore 1997.
                let (e, f) = (*q - *p, *r - *p);
                let h = along.cross(f);
                let d = e.dot(h);
                if d.abs() < 1e-12 {
                    continue;
                }
                let s = (from - *p) / d;
                let u = s.dot(h);
                let k = s.cross(e);
                let v = along.dot(k);
                let t = f.dot(k);
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < best {
                    best = t;
                }
            }
        }
        best
    }
}

/// The share of light at each of the points, given with their normals, among the triangles.
pub(super) fn bake(points: &[(Vec3, Vec3)], triangles: Vec<[Vec3; 3]>) -> Vec<f32> {
    let tree = Tree::new(triangles);
    // Directions weighted by the cosine: even on a disk, raised to the hemisphere.
    let directions: Vec<Vec3> = (0..RAYS)
        .map(|i| {
            let r = ((i as f32 + 0.5) / RAYS as f32).sqrt();
            let (s, c) = (i as f32 * 2.399_963_2).sin_cos();
            Vec3::new(r * c, (1.0 - r * r).sqrt(), r * s)
        })
        .collect();
    points
        .par_iter()
        .map(|(place, normal)| {
            let turn = Quat::from_rotation_arc(Vec3::Y, normal.normalize_or(Vec3::Y));
            let from = *place + *normal * ABOVE;
            let light = |d: &Vec3| {
                let t = tree.hit(from, turn * *d, REACH) / REACH;
                t * t * (3.0 - 2.0 * t)
            };
            directions.iter().map(light).sum::<f32>() / RAYS as f32
        })
        .collect()
}
