//! Transmittance: optical depth summed along the light, in place.
//!
//! A cell becomes two numbers of 16 bits in steps of 1/4096: optical depth at its front face below, at its back
//! face above. One load then holds all that interpolation along the light needs.

use rayon::prelude::*;

use super::grid::{Grid, Span};
use super::layout::{Layout, TILE_CELLS};

/// Where sums stop: above 16 in fixed point, the largest depth that a cell can hold, and far from overflow.
const MOST: u32 = 1 << 25;
/// From the fixed point of density (2^20) to that of faces (2^12).
const FACE_SHIFT: u32 = 8;

/// The touched slices of each tile, of all grids together.
pub(super) fn touched_spans(layout: &Layout, grids: &[Grid], spans: &mut Vec<Span>) {
    spans.clear();
    spans.extend((0..layout.tiles()).map(|tile| {
        grids
            .iter()
            .map(|grid| grid.span(layout, tile))
            .fold(Span::EMPTY, Span::join)
    }));
}

/// Spans widened to those of the tiles around: a point reads columns up to one beyond its tile on either side,
/// so these must be filled as deep as the point lies.
pub(super) fn dilate(layout: &Layout, touched: &[Span], filled: &mut Vec<Span>) {
    let edge = layout.tiles_per_edge as usize;
    filled.clear();
    filled.extend((0..touched.len()).map(|tile| {
        let (j, k) = (tile / edge, tile % edge);
        let mut span = Span::EMPTY;
        for row in j.saturating_sub(1)..=(j + 1).min(edge - 1) {
            for tile in row * edge + k.saturating_sub(1)..=row * edge + (k + 1).min(edge - 1) {
                span = span.join(touched[tile]);
            }
        }
        span
    }));
}

/// Sums every tile within its span, over all grids, into the first.
pub(super) fn sum_along_light(layout: &Layout, grids: &mut [Grid], filled: &[Span]) {
    let Some((target, others)) = grids.split_first_mut() else {
        return;
    };
    let groups = layout.groups();
    let group_cells = 1 << layout.group_len_shift();
    target
        .cells
        .par_chunks_exact_mut(layout.tile_len())
        .zip(filled)
        .with_min_len(16)
        .enumerate()
        .for_each(|(tile, (cells, span))| {
            let mut faces = Faces::default();
            let mut cells_at = span.cells();
            while !cells_at.is_empty() {
                let group = cells_at.start / group_cells;
                let within = cells_at.start..((group + 1) * group_cells).min(cells_at.end);
                for other in others.iter() {
                    if other.touched[tile * groups + group] != 0 {
                        let from = tile * layout.tile_len();
                        merge(
                            &mut cells[within.clone()],
                            &other.cells[from + within.start..from + within.end],
                        );
                    }
                }
                for slice in cells[within.clone()].as_chunks_mut::<TILE_CELLS>().0 {
                    faces.pass(slice);
                }
                cells_at.start = within.end;
            }
        });
}

fn merge(into: &mut [u32], from: &[u32]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = into.saturating_add(*from);
    }
}

/// The state of 64 columns on the way from the light.
struct Faces {
    sum: [u32; TILE_CELLS],
    front: [u32; TILE_CELLS],
}

impl Default for Faces {
    fn default() -> Self {
        Self {
            sum: [0; TILE_CELLS],
            front: [0; TILE_CELLS],
        }
    }
}

impl Faces {
    /// Takes up one slice of density and leaves its faces there.
    fn pass(&mut self, slice: &mut [u32; TILE_CELLS]) {
        for ((cell, sum), front) in slice.iter_mut().zip(&mut self.sum).zip(&mut self.front) {
            *sum = (*sum + (*cell).min(MOST)).min(MOST);
            let back = ((*sum + (1 << (FACE_SHIFT - 1))) >> FACE_SHIFT).min(0xffff);
            *cell = *front | back << 16;
            *front = back;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_holds_the_depth_before_and_behind_it() {
        let mut faces = Faces::default();
        let mut slices = [[0_u32; TILE_CELLS]; 4];
        slices[1][5] = 3 << 20;
        slices[2][5] = 1 << 19;
        for slice in &mut slices {
            faces.pass(slice);
        }
        let at = |slice: usize| (slices[slice][5] & 0xffff, slices[slice][5] >> 16);
        assert_eq!(
            [at(0), at(1), at(2)],
            [(0, 0), (0, 3 * 4096), (3 * 4096, 3 * 4096 + 2048)]
        );
        assert_eq!(
            at(3),
            (3 * 4096 + 2048, 3 * 4096 + 2048),
            "an empty cell keeps the running value"
        );
        assert!(slices.iter().all(|slice| slice[6] == 0));
    }

    #[test]
    fn full_cells_saturate() {
        let mut faces = Faces::default();
        for _ in 0..600 {
            let mut slice = [u32::MAX; TILE_CELLS];
            faces.pass(&mut slice);
            assert_eq!(slice[0] >> 16, 0xffff);
        }
    }

    #[test]
    fn dilation_reaches_all_eight_neighbours() {
        let layout = Layout::new(64);
        let mut touched = vec![Span::EMPTY; layout.tiles()];
        touched[3 * 8 + 4] = Span { first: 8, last: 11 };
        touched[3 * 8 + 6] = Span { first: 20, last: 31 };
        let mut filled = Vec::new();
        dilate(&layout, &touched, &mut filled);
        for j in 0..8_usize {
            for k in 0..8_usize {
                let span = filled[j * 8 + k];
                let near = |tile: usize| j.abs_diff(3) <= 1 && k.abs_diff(tile) <= 1;
                let expected = match (near(4), near(6)) {
                    (true, true) => Span { first: 8, last: 31 },
                    (true, false) => Span { first: 8, last: 11 },
                    (false, true) => Span { first: 20, last: 31 },
                    (false, false) => Span::EMPTY,
                };
                assert_eq!(span, expected, "tile {j}, {k}");
            }
        }
    }
}
