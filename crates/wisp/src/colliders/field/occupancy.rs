//! Where the body is, once a step: cells of a grid that turns with the head say which points need to be measured.
//!
//! Every place near the skin or inside is deposited into the cells around it, where it is at the start of the step
//! and at its end; a point in a cell without any is further from the skin than hair can touch, all step long.

use glam::{Affine3A, IVec3, UVec3, Vec3};
use lovelock_motion::BodyField;

use crate::lanes::greater;

/// A cell in spacings of the field's nodes.
const CELL: f32 = 2.5;
/// How far beyond the resting field the grid goes on, as a part of the field's longest side.
const BEYOND: f32 = 0.35;
/// Most cells to each side that a place is deposited into.
const WIDEST: i32 = 4;
/// Where nothing is tested for sparing's sake, so many cells more to each side are tested.
const UNSPARING: i32 = 3;
/// No skin but the head's.
const NONE: u16 = u16::MAX;

/// What may be near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    /// Skin that only the head moves.
    pub(super) head: bool,
    /// The weighting of the nearest other skin.
    pub(super) slot: Option<usize>,
    /// Whether there is nothing, and the point is to be measured all the same.
    pub(super) besides: bool,
    /// How far the next cell is at least, metres.
    pub(super) to_next: f32,
}

/// A place that is deposited: where it is at rest, and its weighting.
#[derive(Clone, Copy, Debug)]
struct Probe {
    rest: Vec3,
    slot: u16,
}

/// An eighth of a cell with probes in it: the one nearest to its middle.
#[derive(Clone, Copy, Debug)]
struct Occupied {
    index: u32,
    at: IVec3,
    place: Vec3,
    squared: f32,
    slot: u16,
}

#[derive(Clone, Debug)]
pub(super) struct Occupancy {
    low: Vec3,
    inv_cell: f32,
    cell: f32,
    size: UVec3,
    probes: Vec<Probe>,
    head_probes: Vec<Vec3>,
    /// So many cells to each side the head was deposited into.
    head_width: i32,
    head: Vec<bool>,
    /// Cells in which the head is tried for nothing, where nothing is spared; otherwise empty.
    extra: Vec<bool>,
    /// Slot of the nearest probe to the middle of each cell, and the square of its distance.
    slot: Vec<u16>,
    nearest: Vec<f32>,
    touched: Vec<u32>,
    /// For the start and the end of the step: the eighths of cells with probes, and for each its place among them.
    occupied: [Vec<Occupied>; 2],
    own: [Vec<u32>; 2],
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
        let count = size.as_usizevec3().element_product();
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
                    slot => probes.push(Probe { rest, slot }),
                }
            }
        }
        let mut occupancy = Self {
            low: centre - half,
            inv_cell: 1.0 / cell,
            cell,
            size,
            probes,
            head_probes,
            head_width: 0,
            head: vec![false; count],
            extra: Vec::new(),
            slot: vec![NONE; count],
            nearest: vec![f32::INFINITY; count],
            touched: Vec::new(),
            occupied: [Vec::new(), Vec::new()],
            own: [vec![u32::MAX; 8 * count], vec![u32::MAX; 8 * count]],
            cover: nodes.spacing,
        };
        occupancy.place_head(occupancy.width(reach));
        occupancy
    }

    /// So many cells to each side hold all that is within `reach` of a probe.
    fn width(&self, reach: f32) -> i32 {
        (((reach + self.cover) * self.inv_cell).ceil() as i32).clamp(1, WIDEST)
    }

    fn place_head(&mut self, width: i32) {
        if self.head_width == width {
            return;
        }
        self.head_width = width;
        self.head.fill(false);
        for i in 0..self.head_probes.len() {
            let middle = self.cell_of(self.head_probes[i]);
            self.each_cell(middle, width, |this, index, _| this.head[index] = true);
        }
    }

    /// Deposits the body at both ends of the step, to which `ends` carry the slots from rest. Where `spare` is false
    /// the cells around are to be tested too.
    pub(super) fn update(&mut self, reach: f32, ends: [&[Affine3A]; 2], spare: bool) {
        for &i in &self.touched {
            (self.slot[i as usize], self.nearest[i as usize]) = (NONE, f32::INFINITY);
        }
        self.touched.clear();
        self.extra.clear();
        self.place_head(self.width(reach));
        let moved = self.collect(ends);
        // What is on its way is nearest to one end, by half the way at most. A little more width spares one end.
        let one = self.width(reach + moved);
        let (width, skip) =
            if one <= self.width(reach) { (one, 1) } else { (self.width(reach + 0.5 * moved), 0) };
        self.spread(width, skip, &[]);
        if !spare {
            // The second round only fills what the first has left, and so changes nothing there.
            let known: Vec<bool> =
                self.slot.iter().zip(&self.head).map(|(&slot, &head)| head || slot != NONE).collect();
            self.extra.resize(self.head.len(), false);
            for i in 0..self.head_probes.len() {
                let middle = self.cell_of(self.head_probes[i]);
                self.each_cell(middle, self.head_width + UNSPARING, |this, index, _| {
                    this.extra[index] |= !known[index];
                });
            }
            self.spread(width + UNSPARING, skip, &known);
        }
    }

    /// Finds the probe nearest to the middle of each eighth of a cell that has any, at both ends; the furthest way of a
    /// probe.
    fn collect(&mut self, ends: [&[Affine3A]; 2]) -> f32 {
        let mut furthest = 0.0_f32;
        for (own, cells) in self.own.iter_mut().zip(&mut self.occupied) {
            for cell in cells.drain(..) {
                own[cell.index as usize] = u32::MAX;
            }
        }
        for n in 0..self.probes.len() {
            let Probe { rest, slot } = self.probes[n];
            let places = ends.map(|maps| maps[usize::from(slot)].transform_point3(rest));
            furthest = furthest.max((places[1] - places[0]).length_squared());
            for (end, place) in places.into_iter().enumerate() {
                let at = self.cell_of(place);
                let Some(index) = self.index_of(at) else { continue };
                let (centre, eighth) = self.eighth(at, place);
                let squared = (centre - place).length_squared();
                let index = 8 * index + eighth;
                let (own, cells) = (&mut self.own[end][index], &mut self.occupied[end]);
                let found = Occupied { index: index as u32, at, place, squared, slot };
                match cells.get_mut(*own as usize) {
                    Some(known) if squared < known.squared => *known = found,
                    Some(_) => {}
                    None => {
                        *own = cells.len() as u32;
                        cells.push(found);
                    }
                }
            }
        }
        furthest.sqrt()
    }

    /// Tells the cells around the occupied ones of the nearest of these, and none that are `known`; `skip` leaves out
    /// the start of the step.
    fn spread(&mut self, width: i32, skip: usize, known: &[bool]) {
        let occupied = std::mem::take(&mut self.occupied);
        for cell in occupied[skip..].iter().flatten() {
            self.each_cell(cell.at, width, |this, index, centre| {
                let squared = (centre - cell.place).length_squared();
                if squared < this.nearest[index] && !known.get(index).copied().unwrap_or(false) {
                    if this.slot[index] == NONE {
                        this.touched.push(index as u32);
                    }
                    (this.nearest[index], this.slot[index]) = (squared, cell.slot);
                }
            });
        }
        self.occupied = occupied;
    }

    fn index_of(&self, cell: IVec3) -> Option<usize> {
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.size.as_ivec3()).all();
        inside.then(|| ((cell.z as u32 * self.size.y + cell.y as u32) * self.size.x + cell.x as u32) as usize)
    }

    /// The eighth of a cell that a place is in: its middle and its number.
    fn eighth(&self, cell: IVec3, place: Vec3) -> (Vec3, usize) {
        let centre = self.centre(cell);
        let upper = place.cmpgt(centre);
        let middle = centre + Vec3::select(upper, Vec3::ONE, Vec3::NEG_ONE) * (0.25 * self.cell);
        (middle, upper.bitmask() as usize)
    }

    fn centre(&self, cell: IVec3) -> Vec3 {
        self.low + (cell.as_vec3() + 0.5) * self.cell
    }

    fn cell_of(&self, p: Vec3) -> IVec3 {
        // What is not a number is outside.
        let q = (p - self.low) * self.inv_cell;
        if q.is_finite() && q.abs().max_element() < 1e6 { q.floor().as_ivec3() } else { IVec3::splat(-1000) }
    }

    /// The cells within `width` of one, as far as there are any.
    #[inline(always)]
    fn each_cell(&mut self, middle: IVec3, width: i32, mut visit: impl FnMut(&mut Self, usize, Vec3)) {
        let last = self.size.as_ivec3() - 1;
        let (from, to) = ((middle - width).max(IVec3::ZERO), (middle + width).min(last));
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                let row = ((z * self.size.y as i32 + y) * self.size.x as i32) as usize;
                for x in from.x..=to.x {
                    let centre = self.centre(IVec3::new(x, y, z));
                    visit(self, row + x as usize, centre);
                }
            }
        }
    }

    /// What may be near a point of head space.
    #[inline(always)]
    pub(super) fn at(&self, p: Vec3) -> Near {
        let q = (p - self.low) * self.inv_cell;
        let size = self.size.as_vec3();
        let inside = q.x >= 0.0 && q.y >= 0.0 && q.z >= 0.0 && q.x < size.x && q.y < size.y && q.z < size.z;
        if !inside {
            let beyond = (-q).max(q - size).max_element();
            return Near {
                head: false,
                slot: None,
                besides: false,
                to_next: greater(0.0, beyond) * self.cell,
            };
        }
        let (x, y, z) = (q.x as u32, q.y as u32, q.z as u32);
        let index = ((z * self.size.y + y) * self.size.x + x) as usize;
        let f = q - Vec3::new(x as f32, y as f32, z as f32);
        let to_next = f.min(Vec3::ONE - f).min_element() * self.cell;
        let besides = !self.extra.is_empty() && self.extra[index];
        let slot = self.slot[index];
        Near {
            head: self.head[index] || besides,
            slot: (slot != NONE).then_some(usize::from(slot)),
            besides,
            to_next,
        }
    }
}
