//! Where the body is during a step: cells of a grid that turns with the head tell which points need to be
//! measured.
//!
//! Every probe near the skin or inside is deposited into the cells around its position at the start and at
//! the end of the step, or at the end alone where that covers the whole path. A point in an empty cell is
//! further from the skin than hair can touch, for the whole step.

use glam::{IVec3, UVec3, Vec3};
use lovelock_base::simd::{Width, whole_part};
use lovelock_motion::BodyField;

use super::cells::{CellGrid, NONE, UNCULLED_WIDTH, WIDEST, mark};
use super::deposit::{Probes, StepEnd, longest_path_squared, place_probes, spread_all};
use super::weightings::Joints;
use crate::lanes::{LANES, Lane, Lane3, ZERO, at, greater, lesser};

/// Cell size in spacings of the field's nodes.
const CELL: f32 = 2.5;
/// How far the grid extends beyond the field at rest, as a fraction of the field's longest side.
const MARGIN: f32 = 0.35;

/// What may be near the points of a row.
#[derive(Clone, Debug)]
pub(super) struct Near {
    /// Skin that only the head moves.
    pub(super) head: [bool; LANES],
    /// The weighting of the nearest other skin; 0 if there is none.
    pub(super) slot: [u16; LANES],
    /// Whether nothing is near, but the point is measured anyway because culling is off.
    pub(super) forced: [bool; LANES],
}

/// The cells that contain a row of points.
pub(super) struct Cells {
    /// Cell indices; [`OUTSIDE`] outside the grid.
    pub(super) index: [u32; LANES],
    /// Lower bound of the distance to the next cell, metres.
    pub(super) to_next: Lane,
}

/// Marks a point outside the grid.
const OUTSIDE: u32 = u32::MAX;

#[derive(Clone, Debug)]
pub(super) struct Occupancy {
    pub(super) grid: CellGrid,
    pub(super) probes: Probes,
    head_probes: Vec<Vec3>,
    /// Number of cells to each side over which the head was spread.
    pub(super) head_width: i32,
    pub(super) head: Vec<bool>,
    /// Cells in which the head is tested only because culling is off; otherwise empty.
    extra: Vec<bool>,
    /// For each cell the probe nearest to its centre, to within 1 % of the squared distance: the upper half
    /// holds the squared distance in square metres, the lower half the slot. The smaller of two numbers is
    /// the nearer probe. [`NONE`] if there is none.
    pub(super) nearest: Vec<u32>,
    /// The first and the last cell that may hold a probe.
    pub(super) touched: (IVec3, IVec3),
    /// The start and the end of the step.
    pub(super) ends: [StepEnd; 2],
    /// Largest distance between a point at the skin and the nearest probe, metres.
    cover: f32,
}

impl Occupancy {
    pub(super) fn new(field: &BodyField, reach: f32) -> Self {
        let (nodes, lattice) = (field.node_lattice(), field.distance_lattice());
        let side = (nodes.high() - nodes.low).max_element();
        let centre = nodes.low.midpoint(nodes.high());
        let cell = CELL * nodes.spacing;
        let half = (0.5 + MARGIN) * side;
        let size = UVec3::splat(((2.0 * half / cell).ceil() as u32).clamp(1, 96));
        let grid = CellGrid { low: centre - half, cell, inv_cell: 1.0 / cell, size };
        let (mut probes, mut head_probes) = (Vec::new(), Vec::new());
        for i in 0..nodes.count() {
            let rest = nodes.place(i);
            let at = ((rest - nodes.low) / nodes.spacing).round().as_uvec3();
            let depth = field.distances()[lattice.index(at * 2)] / nodes.spacing;
            // All probes near the skin, and every second one deep inside.
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
            // Padding: a whole row of lanes may be written beyond the last cell, without effect.
            nearest: vec![NONE; grid.count() + LANES],
            touched: (IVec3::ONE, IVec3::ZERO),
            ends: [StepEnd::new(grid.count()), StepEnd::new(grid.count())],
            cover: nodes.spacing,
            grid,
        };
        occupancy.place_head(occupancy.width(reach));
        occupancy
    }

    /// Number of cells to each side that contains everything within `reach` of a probe.
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

    /// Finds the cells in which the head is tested only because `culling` is off.
    pub(super) fn mark_extra(&mut self, culling: bool, known: &[bool]) {
        self.extra.clear();
        if !culling {
            self.extra.resize(self.head.len(), false);
            mark(&mut self.extra, &self.grid, &self.head_probes, self.head_width + UNCULLED_WIDTH);
            self.extra.iter_mut().zip(known).for_each(|(extra, known)| *extra &= !known);
        }
    }

    /// Deposits the body at both `ends` of the step. With `culling` off, the cells around are to be tested
    /// too.
    pub(super) fn update(&mut self, wide: Width, reach: f32, ends: [&Joints; 2], culling: bool) {
        self.clear();
        self.place_head(self.width(reach));
        let moved = self.collect(wide, ends);
        // A probe on its way is at most half the path from the nearer end. A slightly larger width makes one
        // end sufficient.
        let one = self.width(reach + moved);
        let (width, skip) =
            if one <= self.width(reach) { (one, 1) } else { (self.width(reach + 0.5 * moved), 0) };
        self.spread(wide, width, skip);
        let mut known = Vec::new();
        if !culling {
            known
                .extend(self.head.iter().zip(&self.nearest).map(|(&head, &nearest)| head || nearest != NONE));
            // The second pass fills only cells that the first has left empty.
            let first = self.nearest.clone();
            self.spread(wide, width + UNCULLED_WIDTH, skip);
            for ((own, &first), _) in
                self.nearest.iter_mut().zip(&first).zip(&known).filter(|(_, known)| **known)
            {
                *own = first;
            }
        }
        self.mark_extra(culling, &known);
    }

    /// Spreads the occupied cells to their neighbours; `skip` leaves out the start of the step.
    fn spread(&mut self, wide: Width, width: i32, skip: usize) {
        spread_all(wide, &self.grid, &self.ends[skip..], &mut self.nearest, &mut self.touched, width);
    }

    /// Clears the cells that may hold a probe.
    fn clear(&mut self) {
        let (from, to) = std::mem::replace(&mut self.touched, (self.grid.size.as_ivec3(), IVec3::NEG_ONE));
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                let row = self.grid.row(y, z);
                self.nearest[row + from.x as usize..=row + to.x as usize].fill(NONE);
            }
        }
    }

    /// Finds the probe nearest to the centre of each occupied cell, at both ends, and returns the longest
    /// path of a probe. A step starts where the last one ended.
    fn collect(&mut self, wide: Width, joints: [&Joints; 2]) -> f32 {
        self.ends.swap(0, 1);
        for (n, joints) in joints.into_iter().enumerate() {
            if n == 1 || self.ends[0].places.len() != self.probes.rows() {
                place_probes(wide, &self.probes, &self.grid, joints, &mut self.ends[n]);
            }
        }
        longest_path_squared(wide, &self.ends).sqrt()
    }

    /// Whether the head is tested in a cell only because culling is off.
    pub(super) fn is_forced(&self, cell: usize) -> bool {
        self.extra.get(cell) == Some(&true)
    }

    /// Discards the end of the last step, because the next one starts elsewhere.
    pub(super) fn discard_end(&mut self) {
        self.ends[1].discard();
    }

    /// The cells that contain a row of points in head space.
    #[inline(always)]
    pub(super) fn cells(&self, row: &Lane3) -> Cells {
        let mut out = Cells { index: [OUTSIDE; LANES], to_next: ZERO };
        let CellGrid { low, cell: side_m, inv_cell, size: cells } = self.grid;
        let (size, last) = (cells.as_vec3(), (cells - 1).as_vec3());
        for k in 0..LANES {
            let q = (at(row, k) - low) * inv_cell;
            // Written so that NaN is outside.
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

    /// What may be near the points in these `cells`; nothing for lanes that are not `asked`.
    #[inline(always)]
    pub(super) fn near(&self, cells: &Cells, asked: &[bool; LANES]) -> Near {
        let mut out = Near { head: [false; LANES], slot: [0; LANES], forced: [false; LANES] };
        for k in 0..LANES {
            let index = cells.index[k] as usize;
            if asked[k] && index < self.head.len() {
                let nearest = self.nearest[index];
                out.forced[k] = !self.extra.is_empty() && self.extra[index];
                out.head[k] = self.head[index] || out.forced[k];
                out.slot[k] = if nearest == NONE { 0 } else { nearest as u16 };
            }
        }
        out
    }
}
