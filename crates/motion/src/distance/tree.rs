//! A bounding volume tree of triangles.

use glam::Vec3;

use super::closest::{LANES, Pack, closest_on_triangle};

/// A box around a run of triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    /// A leaf's first triangle, or an inner node's second child; the first child follows the node.
    pub(super) at: u32,
    /// Number of triangles of a leaf; 0 for an inner node.
    pub(super) count: u32,
    /// Index of a leaf's pack of triangles.
    pack: u32,
}

impl Node {
    fn distance_squared(&self, p: Vec3) -> f32 {
        (p - p.clamp(self.low, self.high)).length_squared()
    }
}

/// The surface point closest to another point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) triangle: u32,
    pub(super) at: Vec3,
    pub(super) distance_squared: f32,
}

/// Nodes in depth-first order, with the triangles in the order of the leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) corners: Vec<[Vec3; 3]>,
    packs: Vec<Pack>,
}

impl Tree {
    pub(super) fn new(corners: &[[Vec3; 3]]) -> Self {
        let centres: Vec<Vec3> = corners.iter().map(|[a, b, c]| a / 3.0 + b / 3.0 + c / 3.0).collect();
        let mut order: Vec<u32> = (0..corners.len() as u32).collect();
        let mut nodes = Vec::new();
        if !order.is_empty() {
            split(&mut nodes, corners, &centres, &mut order, 0);
        }
        let corners: Vec<[Vec3; 3]> = order.iter().map(|&t| corners[t as usize]).collect();
        let mut packs = Vec::new();
        for leaf in nodes.iter_mut().filter(|node| node.count > 0) {
            leaf.pack = packs.len() as u32;
            packs.push(Pack::new(&corners[leaf.at as usize..(leaf.at + leaf.count) as usize]));
        }
        Self { nodes, corners, packs }
    }

    /// The bounding box of everything.
    pub(super) fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.nodes.first().map(|root| (root.low, root.high))
    }

    /// The triangles of a leaf.
    pub(super) fn pack(&self, leaf: &Node) -> &Pack {
        &self.packs[leaf.pack as usize]
    }

    /// The normal of a counter-clockwise triangle.
    pub(super) fn normal(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.corners[triangle as usize];
        (b - a).cross(c - a).normalize_or(Vec3::Y)
    }

    fn hit(&self, triangle: u32, p: Vec3) -> Hit {
        let at = closest_on_triangle(&self.corners[triangle as usize], p);
        Hit { triangle, at, distance_squared: (p - at).length_squared() }
    }

    /// Updates the best hit with a leaf.
    fn approach(&self, leaf: &Node, p: Vec3, best: &mut Option<Hit>, nearest: &mut f32) {
        let (lane, square) = self.packs[leaf.pack as usize].closest(p);
        if square < *nearest {
            let hit = self.hit(leaf.at + (lane as u32).min(leaf.count - 1), p);
            if hit.distance_squared < *nearest {
                (*nearest, *best) = (hit.distance_squared, Some(hit));
            }
        }
    }

    /// The closest point of the surface; `None` if there is no surface. A `guess` of the triangle, such as
    /// that of a nearby point, shortens the search.
    pub(super) fn closest(&self, p: Vec3, guess: Option<u32>) -> Option<Hit> {
        let mut best = guess.map(|triangle| self.hit(triangle, p));
        let mut nearest = best.map_or(f32::INFINITY, |hit| hit.distance_squared);
        // The depth of a median tree over 2^32 triangles is 32; each level leaves one node on the stack.
        let mut stack = [(0.0_f32, 0_u32); 64];
        let mut count = usize::from(!self.nodes.is_empty());
        'nodes: while count > 0 {
            count -= 1;
            let (bound, mut index) = stack[count];
            if bound >= nearest {
                continue;
            }
            while self.nodes[index as usize].count == 0 {
                let children = [index + 1, self.nodes[index as usize].at];
                let [first, second] = children.map(|c| self.nodes[c as usize].distance_squared(p));
                let (near, far) = if first <= second { (0, 1) } else { (1, 0) };
                let farther = first.max(second);
                if farther < nearest {
                    stack[count] = (farther, children[far]);
                    count += 1;
                }
                if first.min(second) >= nearest {
                    continue 'nodes;
                }
                index = children[near];
            }
            self.approach(&self.nodes[index as usize], p, &mut best, &mut nearest);
        }
        best
    }

    /// Replaces `leaves` by those within `radius` of a point.
    pub(super) fn leaves_around(&self, p: Vec3, radius: f32, leaves: &mut Vec<u32>) {
        leaves.clear();
        let mut stack = [0_u32; 64];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let index = stack[count];
            let node = &self.nodes[index as usize];
            if node.distance_squared(p) > radius * radius {
                continue;
            }
            if node.count > 0 {
                leaves.push(index);
            } else {
                (stack[count], stack[count + 1]) = (node.at, index + 1);
                count += 2;
            }
        }
    }

    /// The closest point among some leaves and a guess.
    pub(super) fn closest_of(&self, leaves: &[u32], p: Vec3, guess: u32) -> Hit {
        let hit = self.hit(guess, p);
        let (mut best, mut nearest) = (Some(hit), hit.distance_squared);
        for &leaf in leaves {
            let node = &self.nodes[leaf as usize];
            if node.distance_squared(p) < nearest {
                self.approach(node, p, &mut best, &mut nearest);
            }
        }
        best.unwrap_or(hit)
    }
}

/// Splits a range of triangles, whose first index is `start`, at the median of the longest axis; the depth is
/// logarithmic.
fn split(nodes: &mut Vec<Node>, corners: &[[Vec3; 3]], centres: &[Vec3], order: &mut [u32], start: usize) {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (mut centre_low, mut centre_high) = (low, high);
    for &t in &*order {
        for p in corners[t as usize] {
            (low, high) = (low.min(p), high.max(p));
        }
        let c = centres[t as usize];
        (centre_low, centre_high) = (centre_low.min(c), centre_high.max(c));
    }
    let node = nodes.len();
    nodes.push(Node { low, high, at: start as u32, count: order.len() as u32, pack: 0 });
    if order.len() <= LANES {
        return;
    }
    let axis = (centre_high - centre_low).max_position();
    // Full packs as far as possible.
    let middle = (order.len() / 2).next_multiple_of(LANES);
    order.select_nth_unstable_by(middle, |&a, &b| {
        centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    split(nodes, corners, centres, left, start);
    (nodes[node].at, nodes[node].count) = (nodes.len() as u32, 0);
    split(nodes, corners, centres, right, start + middle);
}
