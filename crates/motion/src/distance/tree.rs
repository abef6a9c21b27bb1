//! A bounding volume tree over triangles.

use glam::Vec3;

use super::closest::{Feature, closest_on_triangle};

/// Most triangles of a leaf.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// A leaf's first triangle in `order`, or an inner node's second child; the first child follows the node.
    at: u32,
    /// Triangles of a leaf; 0 for an inner node.
    count: u32,
}

impl Node {
    fn distance_squared(&self, p: Vec3) -> f32 {
        (p - p.clamp(self.low, self.high)).length_squared()
    }
}

/// Nodes in depth-first order.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Tree {
    pub(super) fn new(corners: &[[Vec3; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..corners.len() as u32).collect() };
        if !corners.is_empty() {
            let centres: Vec<Vec3> = corners.iter().map(|[a, b, c]| (a + b + c) / 3.0).collect();
            tree.split(corners, &centres, 0, corners.len());
        }
        tree
    }

    /// Halves a run of triangles at the median of the longest axis; the depth is logarithmic.
    fn split(&mut self, corners: &[[Vec3; 3]], centres: &[Vec3], from: usize, to: usize) {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (mut centre_low, mut centre_high) = (low, high);
        for &t in &self.order[from..to] {
            for p in corners[t as usize] {
                (low, high) = (low.min(p), high.max(p));
            }
            let c = centres[t as usize];
            (centre_low, centre_high) = (centre_low.min(c), centre_high.max(c));
        }
        let node = self.nodes.len();
        self.nodes.push(Node { low, high, at: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF {
            return;
        }
        let axis = (centre_high - centre_low).max_position();
        let middle = usize::midpoint(from, to);
        self.order[from..to].select_nth_unstable_by(middle - from, |&a, &b| {
            centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
        });
        self.split(corners, centres, from, middle);
        (self.nodes[node].at, self.nodes[node].count) = (self.nodes.len() as u32, 0);
        self.split(corners, centres, middle, to);
    }

    /// The triangle closest to a point, its closest point, and the part of it on which that lies.
    pub(super) fn closest(&self, corners: &[[Vec3; 3]], p: Vec3) -> Option<(usize, Vec3, Feature)> {
        let mut best = None;
        let mut nearest = f32::INFINITY;
        // The depth of a median tree over 2^32 triangles is 32; each level leaves one node waiting.
        let mut waiting = [(0.0_f32, 0_u32); 64];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let (bound, index) = waiting[count];
            if bound >= nearest {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for &t in &self.order[node.at as usize..(node.at + node.count) as usize] {
                    let (at, feature) = closest_on_triangle(corners[t as usize], p);
                    let distance = (p - at).length_squared();
                    if distance < nearest {
                        nearest = distance;
                        best = Some((t as usize, at, feature));
                    }
                }
                continue;
            }
            let children = [index + 1, node.at].map(|c| (self.nodes[c as usize].distance_squared(p), c));
            let (near, far) = if children[0].0 <= children[1].0 { (0, 1) } else { (1, 0) };
            waiting[count] = children[far];
            waiting[count + 1] = children[near];
            count += 2;
        }
        best
    }
}
