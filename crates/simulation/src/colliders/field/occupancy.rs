//! Where the body is, once a step: cells of a grid that turns with the head say which points need to be
//! measured.
//!
//! Every place near the skin or inside is deposited into the cells around it, where it is at the start of the
//! step and at its end, or at its end alone where that covers the way; a point in a cell without any is further
//! from the skin than hair can touch, all step long.

use glam::{IVec3, UVec3, Vec3};
use lovelock_groom::simd::{Width, whole_part};
use lovelock_motion::BodyField;

use super::cells::{Grid, NONE, UNSPARING, WIDEST, mark};
use super::deposit::{End, Probes, furthest, place_probes, spread_all};
use super::weightings::Joints;
use crate::lanes::{LANES, Lane, Lane3, ZERO, at, greater, lesser};

/// A cell in spacings of the field's nodes.
const CELL: f32 = 2.5;
/// How far beyond the resting field the grid goes on, as a part of the field's longest side.
const BEYOND: f32 = 0.35;

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

    /// Deposits the body at both `ends` of the step. Where `spare` is false the cells around are to be tested
    /// too.
    pub(super) fn update(&mut self, wide: Width, reach: f32, ends: [&Joints; 2], spare: bool) {
        self.clear();
        self.place_head(self.width(reach));
        let moved = self.collect(wide, ends);
        // What is on its way is nearest to one end, by half the way at most. A little more width spares one
        // end.
        let one = self.width(reach + moved);
        let (width, skip) =
            if one <= self.width(reach) { (one, 1) } else { (self.width(reach + 0.5 * moved), 0) };
        self.spread(wide, width, skip);
        let mut known = Vec::new();
        if !spare {
            known
                .extend(self.head.iter().zip(&self.nearest).map(|(&head, &nearest)| head || nearest != NONE));
            // The second round only fills what the first has left, and so changes nothing there.
            let first = self.nearest.clone();
            self.spread(wide, width + UNSPARING, skip);
            for ((own, &first), _) in
                self.nearest.iter_mut().zip(&first).zip(&known).filter(|(_, known)| **known)
            {
                *own = first;
            }
        }
        self.place_extra(spare, &known);
    }

    /// Tells the cells around the occupied ones of the nearest of these; `skip` leaves out the start of the step.
    fn spread(&mut self, wide: Width, width: i32, skip: usize) {
        spread_all(wide, &self.grid, &self.ends[skip..], &mut self.nearest, &mut self.touched, width);
    }

    /// Empties the cells that may have any probe near them.
    fn clear(&mut self) {
        let (from, to) = std::mem::replace(&mut self.touched, (self.grid.size.as_ivec3(), IVec3::NEG_ONE));
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                let row = self.grid.row(y, z);
                self.nearest[row + from.x as usize..=row + to.x as usize].fill(NONE);
            }
        }
    }

    /// Finds the probe nearest to the middle of each cell that has any, at both ends; the furthest way of a
    /// probe. A step begins where the last one has ended.
    fn collect(&mut self, wide: Width, joints: [&Joints; 2]) -> f32 {
        self.ends.swap(0, 1);
        for (n, joints) in joints.into_iter().enumerate() {
            if n == 1 || self.ends[0].places.len() != self.probes.rows() {
                place_probes(wide, &self.probes, &self.grid, joints, &mut self.ends[n]);
            }
        }
        furthest(wide, &self.ends).sqrt()
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
