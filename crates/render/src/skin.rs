//! What is averaged over the body's vertices: the shadow of hair, and the colour of roots on the scalp.
//!
//! A light with a size has no shadow as fine as a strand, and vertices are too far apart to show one: each would see a strand or a gap, and
//! the skin would be mottled.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec3;
use lovelock_motion::{Body, Mesh};
use rayon::prelude::*;

/// How often the shadow is averaged; even, because two buffers alternate. The deviation of what is averaged is 1.7 edges of a regular mesh.
pub(crate) const ROUNDS: usize = 12;

/// Neighbours of a vertex that count, so that sums fit 16 bits.
const MAX_NEIGHBOURS: usize = 32;

/// Vertices per task.
const PIECE: usize = 2048;

/// The neighbours of the vertices of a body. Vertices at the same place, such as those along a seam of a texture, have the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbours {
    of: Option<Arc<Body>>,
    /// Where the neighbours of each vertex begin in the list, and the length of the list.
    pub first: Vec<u32>,
    /// Neighbours, vertex after vertex.
    pub list: Vec<u32>,
}

impl Neighbours {
    /// Makes these the neighbours in `body`. Returns whether that changed anything.
    pub fn follow(&mut self, body: &Arc<Body>) -> bool {
        if self.of.as_ref().is_some_and(|old| Arc::ptr_eq(old, body)) {
            return false;
        }
        (self.first, self.list) = neighbours(&body.mesh);
        self.of = Some(Arc::clone(body));
        true
    }

    /// Averages packed transmittances of vertices over their neighbours, [`ROUNDS`] times. `other` is memory.
    pub fn soften(&self, packed: &mut Vec<u32>, other: &mut Vec<u32>) {
        if packed.len() + 1 != self.first.len() {
            return;
        }
        other.resize(packed.len(), 0);
        for _ in 0..ROUNDS {
            other.par_chunks_mut(PIECE).enumerate().for_each(|(piece, out)| {
                for (k, out) in out.iter_mut().enumerate() {
                    let i = piece * PIECE + k;
                    let around = &self.list[self.first[i] as usize..self.first[i + 1] as usize];
                    *out = average(packed[i], around.iter().map(|&j| packed[j as usize]));
                }
            });
            std::mem::swap(packed, other);
        }
    }
}

/// How strongly the scalp has the colour of the roots.
#[derive(Clone, Debug, Default)]
pub(crate) struct ScalpPaint {
    of: Option<Arc<Body>>,
    /// 0 outside the hairline, rising to 1 inside, per vertex.
    pub values: Vec<f32>,
}

impl ScalpPaint {
    /// Makes this the paint of `body`.
    pub fn follow(&mut self, body: &Arc<Body>) {
        if !self.of.as_ref().is_some_and(|old| Arc::ptr_eq(old, body)) {
            self.values = scalp_paint(&body.mesh);
            self.of = Some(Arc::clone(body));
        }
    }
}

/// How often the mask of the scalp is averaged for its paint.
const PAINT_ROUNDS: usize = 5;

/// The mask of the scalp, softened over some edges and moved inside its border, so that the paint has no line of teeth.
fn scalp_paint(mesh: &Mesh) -> Vec<f32> {
    let mut mask: Vec<f32> = (0..mesh.positions.len())
        .map(|i| mesh.scalp.get(i).map_or(0.0, |mask| mask.clamp(0.0, 1.0)))
        .collect();
    if mask.iter().all(|mask| *mask == 0.0) {
        return mask;
    }
    let (first, list) = neighbours(mesh);
    for _ in 0..PAINT_ROUNDS {
        let mean = |i: usize| {
            let around = &list[first[i] as usize..first[i + 1] as usize];
            let sum: f32 = around.iter().map(|&j| mask[j as usize]).sum();
            if around.is_empty() { mask[i] } else { 0.5 * (mask[i] + sum / around.len() as f32) }
        };
        mask = (0..mask.len()).map(mean).collect();
    }
    for mask in &mut mask {
        *mask = (2.0 * *mask - 1.0).clamp(0.0, 1.0);
    }
    mask
}

/// Half a word and half the mean of those around it, for each byte, rounded: twin of `soften` in `skin_shadow.wgsl`.
fn average(own: u32, around: impl ExactSizeIterator<Item = u32>) -> u32 {
    const EVEN: u32 = 0x00ff_00ff;
    let n = around.len() as u32;
    if n == 0 {
        return own;
    }
    let (mut even, mut odd) = (n * (own & EVEN), n * (own >> 8 & EVEN));
    for word in around {
        even += word & EVEN;
        odd += word >> 8 & EVEN;
    }
    let half = |sum: u32| (sum + n) / (2 * n);
    half(even & 0xffff) | half(even >> 16) << 16 | half(odd & 0xffff) << 8 | half(odd >> 16) << 24
}

fn neighbours(mesh: &Mesh) -> (Vec<u32>, Vec<u32>) {
    let count = mesh.positions.len();
    // The first vertex at each place stands for all of them.
    let mut at: HashMap<[u32; 3], u32> = HashMap::with_capacity(count);
    let bits = |p: &Vec3| p.to_array().map(f32::to_bits);
    let same: Vec<u32> =
        (0..count).map(|i| *at.entry(bits(&mesh.positions[i])).or_insert(i as u32)).collect();
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(mesh.triangles.len() * 6);
    for triangle in &mesh.triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(|i| same.get(i as usize).copied()) else { continue };
        edges.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]].into_iter().filter(|[a, b]| a != b));
    }
    edges.sort_unstable();
    edges.dedup();
    let mut first = Vec::with_capacity(count + 1);
    let mut list = Vec::with_capacity(edges.len());
    for &of in &same {
        first.push(list.len() as u32);
        let start = edges.partition_point(|edge| edge[0] < of);
        let own = edges[start..].iter().take_while(|edge| edge[0] == of).take(MAX_NEIGHBOURS);
        list.extend(own.map(|edge| edge[1]));
    }
    first.push(list.len() as u32);
    (first, list)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of two rows of vertices, cut at its third column.
    fn strip() -> Mesh {
        let mut mesh = Mesh::default();
        for x in [0, 1, 2, 2, 3] {
            mesh.positions.extend([0.0, 1.0].map(|y| Vec3::new(x as f32, y, 0.0)));
        }
        for a in [0, 2, 6] {
            mesh.triangles.extend([[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
        }
        mesh
    }

    #[test]
    fn vertices_of_a_seam_share_neighbours() {
        let (first, list) = neighbours(&strip());
        let of = |i: usize| &list[first[i] as usize..first[i + 1] as usize];
        assert_eq!(of(0), [1, 2]);
        assert_eq!(of(4), [2, 3, 5, 8]);
        assert_eq!(of(6), of(4), "the other side of the cut");
        assert_eq!(first.len(), 11);
    }

    #[test]
    fn the_paint_begins_inside_the_hairline() {
        let mut mesh = Mesh::default();
        let (columns, rows) = (20, 4);
        for i in 0..columns * rows {
            mesh.positions.push(Vec3::new((i % columns) as f32, (i / columns) as f32, 0.0));
            mesh.scalp.push(if i % columns < 10 { 0.0 } else { 1.0 });
        }
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let a = (row * columns + column) as u32;
                let b = a + columns as u32;
                mesh.triangles.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
            }
        }
        let paint = scalp_paint(&mesh);
        let row = &paint[columns..2 * columns];
        assert!(row.is_sorted(), "{row:?}");
        assert_eq!((row[9], row[19]), (0.0, 1.0));
        assert!(row[10] < 0.4 && row[11] < 1.0 && row[13] > 0.8, "{row:?}");
        mesh.scalp.clear();
        assert_eq!(scalp_paint(&mesh), vec![0.0; columns * rows]);
    }

    #[test]
    fn each_byte_is_averaged_by_itself() {
        assert_eq!(average(0xff00_80ff, [0xff00_80ff; 32].into_iter()), 0xff00_80ff);
        assert_eq!(average(0xffff_ffff, [0; 32].into_iter()), 0x8080_8080);
        // 100 and the mean of 0 and 100.
        assert_eq!(average(0x0064_0000, [0, 0x0064_0000].into_iter()), 0x004b_0000);
        assert_eq!(average(7, [].into_iter()), 7);
    }

    #[test]
    fn a_shadow_is_spread_and_even_light_stays() {
        let (first, list) = neighbours(&strip());
        let of = Neighbours { of: None, first, list };
        let mut other = Vec::new();
        let mut even = vec![0x4040_4040; 10];
        of.soften(&mut even, &mut other);
        assert_eq!(even, [0x4040_4040; 10]);
        let mut spot = vec![u32::MAX; 10];
        spot[0] = 0;
        of.soften(&mut spot, &mut other);
        assert!(spot[0] > 0x6000_0000 && spot[9] < u32::MAX, "{spot:x?}");
        assert_eq!(spot[4], spot[6]);
        // Another body's list is not used.
        let mut odd = vec![5, 6];
        of.soften(&mut odd, &mut other);
        assert_eq!(odd, [5, 6]);
    }
}
