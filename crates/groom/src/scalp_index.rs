//! Finds the closest points of a scalp with a uniform grid.

use glam::{IVec3, Vec3};
use lovelock_base::triangle::closest_barycentric;

use crate::{Scalp, ScalpPoint};

/// Cells along the longest side of the scalp's box.
const CELLS: f32 = 24.0;

/// A scalp with a grid over its triangles, for finding closest points fast.
#[derive(Clone, Debug)]
pub struct ScalpIndex<'a> {
    scalp: &'a Scalp,
    low: Vec3,
    cell: f32,
    size: IVec3,
    /// Index of each cell's first triangle in `items`, then the length of `items`.
    first: Vec<u32>,
    items: Vec<u32>,
}

impl<'a> ScalpIndex<'a> {
    /// Sorts the triangles of `scalp`, which has passed [`Scalp::check`], into cells.
    pub fn new(scalp: &'a Scalp) -> Self {
        let used = scalp.triangles.iter().flatten().map(|&v| scalp.positions[v as usize]);
        let (low, high) = used.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let (low, high) = if low.is_finite() { (low, high) } else { (Vec3::ZERO, Vec3::ZERO) };
        let cell = ((high - low).max_element() / CELLS).max(1e-4);
        let size = ((high - low) / cell).as_ivec3() + IVec3::ONE;
        let mut index = Self { scalp, low, cell, size, first: Vec::new(), items: Vec::new() };
        let cells = (size.x * size.y * size.z) as usize;
        let mut counts = vec![0_u32; cells + 1];
        for t in 0..scalp.triangles.len() as u32 {
            index.each_cell(t, |c| counts[c + 1] += 1);
        }
        for c in 0..cells {
            counts[c + 1] += counts[c];
        }
        let mut next = counts.clone();
        let mut items = vec![0; counts[cells] as usize];
        for t in 0..scalp.triangles.len() as u32 {
            index.each_cell(t, |c| {
                items[next[c] as usize] = t;
                next[c] += 1;
            });
        }
        index.first = counts;
        index.items = items;
        index
    }

    /// The scalp that is searched.
    pub fn scalp(&self) -> &'a Scalp {
        self.scalp
    }

    /// The point of the scalp closest to `p`; `None` for a scalp without triangles.
    pub fn closest(&self, p: Vec3) -> Option<ScalpPoint> {
        self.closest_within(p, f32::INFINITY)
    }

    /// The point of the scalp closest to `p`, if it is no farther than `reach` metres.
    pub fn closest_within(&self, p: Vec3, reach: f32) -> Option<ScalpPoint> {
        let home = self.cell_of(p);
        let mut best: Option<(f32, u32, [f32; 3])> = None;
        for shell in 0..=self.size.max_element() {
            // Everything in this shell and beyond is at least `shell - 1` cells away from the start.
            let nearest = (shell - 1) as f32 * self.cell;
            if nearest > reach || best.is_some_and(|(d2, ..)| d2.sqrt() <= nearest) {
                break;
            }
            self.each_of_shell(home, shell, |triangle| {
                let corners =
                    self.scalp.triangles[triangle as usize].map(|v| self.scalp.positions[v as usize]);
                let b = closest_barycentric(p, &corners);
                let d2 = (corners[0] * b[0] + corners[1] * b[1] + corners[2] * b[2]).distance_squared(p);
                // The lower index wins a tie, so that the answer does not depend on the search order.
                if best.is_none_or(|(d, t, _)| d2 < d || (d2 == d && triangle < t)) {
                    best = Some((d2, triangle, b));
                }
            });
        }
        let reached = best.filter(|(d2, ..)| d2.sqrt() <= reach);
        reached.map(|(_, triangle, b)| self.scalp.point(triangle, b))
    }

    fn cell_of(&self, p: Vec3) -> IVec3 {
        ((p - self.low) / self.cell).as_ivec3().clamp(IVec3::ZERO, self.size - IVec3::ONE)
    }

    fn number(&self, c: IVec3) -> usize {
        ((c.z * self.size.y + c.y) * self.size.x + c.x) as usize
    }

    fn each_cell(&self, triangle: u32, mut visit: impl FnMut(usize)) {
        let corners = self.scalp.triangles[triangle as usize].map(|v| self.scalp.positions[v as usize]);
        let low = self.cell_of(corners[0].min(corners[1]).min(corners[2]));
        let high = self.cell_of(corners[0].max(corners[1]).max(corners[2]));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    visit(self.number(IVec3::new(x, y, z)));
                }
            }
        }
    }

    fn each_of_shell(&self, home: IVec3, shell: i32, mut visit: impl FnMut(u32)) {
        let low = (home - shell).max(IVec3::ZERO);
        let high = (home + shell).min(self.size - 1);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                let whole_row = (z - home.z).abs() == shell || (y - home.y).abs() == shell;
                let step = if whole_row { 1 } else { (2 * shell).max(1) };
                let mut x = if whole_row { low.x } else { home.x - shell };
                while x <= high.x {
                    if x >= low.x {
                        let c = self.number(IVec3::new(x, y, z));
                        let range = self.first[c] as usize..self.first[c + 1] as usize;
                        self.items[range].iter().for_each(|&t| visit(t));
                    }
                    x += step;
                }
            }
        }
    }
}
