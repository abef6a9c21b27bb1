//! Where the body is, once a step: cells of a grid that turns with the head say which points need to be
//! measured.
//!
//! Every place near the skin or inside is deposited into the cells around it, where it is at the start of the
//! step and at its end, or at its end alone where that covers the way; a point in a cell without any is further
//! from the skin than hair can touch, all step long.

use glam::{IVec3, UVec3, Vec3};
use lovelock_groom::simd::whole_part;
use lovelock_motion::BodyField;

use super::deposit::{End, Probes};
use crate::lanes::{LANES, Lane, Lane3, ZERO, at, greater, lesser};

/// A cell in spacings of the field's nodes.
const CELL: f32 = 2.5;
/// How far beyond the resting field the grid goes on, as a part of the field's longest side.
const BEYOND: f32 = 0.35;
/// Most cells to each side that a place is deposited into.
pub(super) const WIDEST: i32 = 4;
/// Where nothing is tested for sparing's sake, so many cells more to each side are tested.
pub(super) const UNSPARING: i32 = 3;
/// No skin but the head's.
pub(super) const NONE: u32 = u32::MAX;

/// What may be near the points of a row.
#[derive(Clone, Debug)]
pub(super) struct Near {
    /// Skin that only the head moves.
    pub(super) head: [bool; LANES],
    /// The weighting of the nearest other skin; 0 where there is none.
    pub(super) slot: [u16; LANES],
    /// Whether there is nothing, and the point is to be measured all the same.
    pub(super) besides: [bool; LANES],
}

/// The cells of a row of points.
pub(super) struct Cells {
    /// Their places; [`OUTSIDE`] where the grid ends.
    pub(super) index: [u32; LANES],
    /// How far the next cell is at least, metres.
    pub(super) to_next: Lane,
}

/// Stands for a cell that is not there.
const OUTSIDE: u32 = u32::MAX;

/// A grid of cells in head space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) low: Vec3,
    pub(super) cell: f32,
    pub(super) inv_cell: f32,
    pub(super) size: UVec3,
}

impl Grid {
    pub(super) fn count(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// The cells within `width` of one, as far as there are any: the first and the last.
    pub(super) fn around(&self, middle: IVec3, width: i32) -> (IVec3, IVec3) {
        ((middle - width).max(IVec3::ZERO), (middle + width).min(self.size.as_ivec3() - 1))
    }

    /// Index of the first cell of a row along x.
    pub(super) fn row(&self, y: i32, z: i32) -> usize {
        ((z * self.size.y as i32 + y) * self.size.x as i32) as usize
    }
}

#[derive(Clone, Debug)]
pub(super) struct Occupancy {
    pub(super) grid: Grid,
    pub(super) probes: Probes,
    head_probes: Vec<Vec3>,
    /// So many cells to each side the head was deposited into.
    pub(super) head_width: i32,
    pub(super) head: Vec<bool>,
    /// Cells in which the head is tried for nothing, where nothing is spared; otherwise empty.
    extra: Vec<bool>,
    /// For each cell the probe that is nearest to its middle, to within 1 % of the square of the distance:
    /// the upper half of the square of its distance, square metres, and its slot. Of two numbers the lesser
    /// is the nearer. [`NONE`] where there is none.
    pub(super) nearest: Vec<u32>,
    /// The cells that may have any: the first and the last.
    pub(super) touched: (IVec3, IVec3),
    /// The start and the end of the step.
    pub(super) ends: [End; 2],
    /// How far a point may be from the nearest probe and still be at the skin, metres.
    cover: f32,
}

impl Occupancy {
    pub(super) fn new(field: &BodyField, reach: f32) -> Self {
        let (nodes, lattice) = (field.node_lattice(), field.distance_lattice());
        let side = (nodes.high() - nodes.low).max_element();
        let centre = nodes.low.midpoint(nodes.high());
        let cell = CELL * nodes.spacing;
        let half = (0.5 + BEYOND) * side;
        let size = UVec3::splat(((2.0 * half / cell).ceil() as u32).clamp(1, 96));
        let grid = Grid { low: centre - half, cell, inv_cell: 1.0 / cell, size };
        let (mut probes, mut head_probes) = (Vec::new(), Vec::new());
        for i in 0..nodes.count() {
            let rest = nodes.place(i);
            let at = ((rest - nodes.low) / nodes.spacing).round().as_uvec3();
            let depth = field.distances()[lattice.index(at * 2)] / nodes.spacing;
            // All near the skin, and every second one deep inside.
            let kept = depth < 0.9 && (depth > -0.9 || at % 2 == UVec3::ZERO);
            if kept {
                match field.slot_of_node()[i] {
                    0 => head_probes.push(rest),
                    slot => probes.push((rest, slot, field.slots()[usize::from(slot)])),
                }
            }
        }
        let mut occupancy = Self {
            probes: Probes::new(&probes),
            head_probes,
            head_width: 0,
            head: vec![false; grid.count()],
            extra: Vec::new(),
            // Beyond the last a whole row of lanes may be written, without effect.
            nearest: vec![NONE; grid.count() + LANES],
            touched: (IVec3::ONE, IVec3::ZERO),
            ends: [End::new(grid.count()), End::new(grid.count())],
            cover: nodes.spacing,
            grid,
        };
        occupancy.place_head(occupancy.width(reach));
        occupancy
    }

    /// So many cells to each side hold all that is within `reach` of a probe.
    pub(super) fn width(&self, reach: f32) -> i32 {
        (((reach + self.cover) * self.grid.inv_cell).ceil() as i32).clamp(1, WIDEST)
    }

    pub(super) fn place_head(&mut self, width: i32) {
        if self.head_width != width {
            self.head_width = width;
            self.head.fill(false);
            mark(&mut self.head, &self.grid, &self.head_probes, width);
        }
    }

    /// Finds the cells in which the head is tried for nothing; where `spare`, there are none.
    pub(super) fn place_extra(&mut self, spare: bool, known: &[bool]) {
        self.extra.clear();
        if !spare {
            self.extra.resize(self.head.len(), false);
            mark(&mut self.extra, &self.grid, &self.head_probes, self.head_width + UNSPARING);
            self.extra.iter_mut().zip(known).for_each(|(extra, known)| *extra &= !known);
        }
    }

    /// Forgets where the last step ended: the next one begins elsewhere.
    pub(super) fn forget(&mut self) {
        self.ends[1].forget();
    }

    /// The cells that a row of points of head space is in.
    #[inline(always)]
    pub(super) fn cells(&self, row: &Lane3) -> Cells {
        let mut out = Cells { index: [OUTSIDE; LANES], to_next: ZERO };
        let Grid { low, cell: side_m, inv_cell, size: cells } = self.grid;
        let (size, last) = (cells.as_vec3(), (cells - 1).as_vec3());
        for k in 0..LANES {
            let q = (at(row, k) - low) * inv_cell;
            // Written so that what is not a number is outside.
            let within = |q: f32, size: f32| (q >= 0.0) & (q < size);
            let inside = within(q.x, size.x) & within(q.y, size.y) & within(q.z, size.z);
            let whole = |q: f32, last: f32| whole_part(lesser(q, last)) as u32;
            let (x, y, z) = (whole(q.x, last.x), whole(q.y, last.y), whole(q.z, last.z));
            let cell = (z * cells.y + y) * cells.x + x;
            out.index[k] = if inside { cell } else { OUTSIDE };
            let side = |q: f32, whole: u32| {
                let f = q - whole as f32;
                lesser(f, 1.0 - f)
            };
            let in_cell = lesser(lesser(side(q.x, x), side(q.y, y)), side(q.z, z));
            let beyond = |q: f32, size: f32| greater(-q, q - size);
            let off = greater(greater(beyond(q.x, size.x), beyond(q.y, size.y)), beyond(q.z, size.z));
            out.to_next[k] = if inside { in_cell } else { greater(0.0, off) } * side_m;
        }
        out
    }

    /// What may be near the points of a row in these `cells`; nothing where it is not `asked` for.
    #[inline(always)]
    pub(super) fn near(&self, cells: &Cells, asked: &[bool; LANES]) -> Near {
        let mut out = Near { head: [false; LANES], slot: [0; LANES], besides: [false; LANES] };
        for k in 0..LANES {
            let index = cells.index[k] as usize;
            if asked[k] && index < self.head.len() {
                let nearest = self.nearest[index];
                out.besides[k] = !self.extra.is_empty() && self.extra[index];
                out.head[k] = self.head[index] || out.besides[k];
                out.slot[k] = if nearest == NONE { 0 } else { nearest as u16 };
            }
        }
        out
    }
}

/// Marks the cells within `width` of those that the places are in.
fn mark(cells: &mut [bool], grid: &Grid, places: &[Vec3], width: i32) {
    for place in places {
        let middle = ((*place - grid.low) * grid.inv_cell).floor().as_ivec3();
        let (from, to) = grid.around(middle, width);
        if from.cmpgt(to).any() {
            continue;
        }
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                let row = grid.row(y, z);
                cells[row + from.x as usize..=row + to.x as usize].fill(true);
            }
        }
    }
}
