//! Where the body is, once a step: cells of a grid that turns with the head say which points need to be measured.
//!
//! Every place near the skin or inside is deposited into the cells around it, where it is at the start of the step
//! and at its end; a point in a cell without any is further from the skin than hair can touch, all step long.

use glam::{Affine3A, IVec3, UVec3, Vec3};
use lovelock_groom::simd::whole_part;
use lovelock_motion::BodyField;

use crate::lanes::{LANES, Lane, Lane3, ZERO, at, greater, lesser};

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

/// What may be near the points of a row.
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

/// A place that is deposited: where it is at rest, and its weighting.
#[derive(Clone, Copy, Debug)]
struct Probe {
    rest: Vec3,
    slot: u16,
}

/// A cell with probes in it: the one nearest to its middle.
#[derive(Clone, Copy, Debug)]
struct Occupied {
    index: u32,
    at: IVec3,
    place: Vec3,
    squared: f32,
    slot: u16,
}

/// The cells with probes at one end of a step.
#[derive(Clone, Debug)]
struct End {
    occupied: Vec<Occupied>,
    /// For each cell its place among them.
    own: Vec<u32>,
    /// Where each probe is; empty where nothing is known of this end.
    places: Vec<Vec3>,
}

impl End {
    fn new(cells: usize) -> Self {
        Self { occupied: Vec::new(), own: vec![u32::MAX; cells], places: Vec::new() }
    }
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
    /// The start and the end of the step.
    ends: [End; 2],
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
            ends: [End::new(count), End::new(count)],
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

    /// Forgets where the last step ended: the next one begins elsewhere.
    pub(super) fn forget(&mut self) {
        self.ends[1].places.clear();
    }

    /// Finds the probe nearest to the middle of each cell that has any, at both ends; the furthest way of a probe. A step
    /// begins where the last one has ended.
    fn collect(&mut self, maps: [&[Affine3A]; 2]) -> f32 {
        self.ends.swap(0, 1);
        for (n, maps) in maps.into_iter().enumerate() {
            if n == 1 || self.ends[0].places.len() != self.probes.len() {
                let mut end = std::mem::replace(&mut self.ends[n], End::new(0));
                self.place_probes(maps, &mut end);
                self.ends[n] = end;
            }
        }
        let [before, now] = &self.ends;
        let ways = before.places.iter().zip(&now.places).map(|(a, b)| (*b - *a).length_squared());
        ways.fold(0.0, greater).sqrt()
    }

    /// Puts the probes where `maps` have them.
    fn place_probes(&self, maps: &[Affine3A], end: &mut End) {
        for cell in end.occupied.drain(..) {
            end.own[cell.index as usize] = u32::MAX;
        }
        end.places.clear();
        for &Probe { rest, slot } in &self.probes {
            let place = maps[usize::from(slot)].transform_point3(rest);
            end.places.push(place);
            let at = self.cell_of(place);
            let Some(index) = self.index_of(at) else { continue };
            let squared = (self.centre(at) - place).length_squared();
            let own = &mut end.own[index];
            let found = Occupied { index: index as u32, at, place, squared, slot };
            match end.occupied.get_mut(*own as usize) {
                Some(known) if squared < known.squared => *known = found,
                Some(_) => {}
                None => {
                    *own = end.occupied.len() as u32;
                    end.occupied.push(found);
                }
            }
        }
    }

    /// Tells the cells around the occupied ones of the nearest of these, and none that are `known`; `skip` leaves out
    /// the start of the step.
    fn spread(&mut self, width: i32, skip: usize, known: &[bool]) {
        for end in skip..2 {
            let occupied = std::mem::take(&mut self.ends[end].occupied);
            for cell in &occupied {
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
            self.ends[end].occupied = occupied;
        }
    }

    fn index_of(&self, cell: IVec3) -> Option<usize> {
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.size.as_ivec3()).all();
        inside.then(|| ((cell.z as u32 * self.size.y + cell.y as u32) * self.size.x + cell.x as u32) as usize)
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

    /// The cells that a row of points of head space is in.
    #[inline(always)]
    pub(super) fn cells(&self, row: &Lane3) -> Cells {
        let mut out = Cells { index: [OUTSIDE; LANES], to_next: ZERO };
        let (size, last) = (self.size.as_vec3(), (self.size - 1).as_vec3());
        for k in 0..LANES {
            let q = (at(row, k) - self.low) * self.inv_cell;
            // Written so that what is not a number is outside.
            let within = |q: f32, size: f32| (q >= 0.0) & (q < size);
            let inside = within(q.x, size.x) & within(q.y, size.y) & within(q.z, size.z);
            let whole = |q: f32, last: f32| whole_part(lesser(q, last)) as u32;
            let (x, y, z) = (whole(q.x, last.x), whole(q.y, last.y), whole(q.z, last.z));
            let cell = (z * self.size.y + y) * self.size.x + x;
            out.index[k] = if inside { cell } else { OUTSIDE };
            let side = |q: f32, whole: u32| {
                let f = q - whole as f32;
                lesser(f, 1.0 - f)
            };
            let in_cell = lesser(lesser(side(q.x, x), side(q.y, y)), side(q.z, z));
            let beyond = |q: f32, size: f32| greater(-q, q - size);
            let off = greater(greater(beyond(q.x, size.x), beyond(q.y, size.y)), beyond(q.z, size.z));
            out.to_next[k] = if inside { in_cell } else { greater(0.0, off) } * self.cell;
        }
        out
    }

    /// What may be near the points of a row in these `cells`; nothing where it is not `asked` for.
    #[inline(always)]
    pub(super) fn near(&self, cells: &Cells, asked: &[bool; LANES]) -> Near {
        let mut out = Near { head: [false; LANES], slot: [0; LANES], besides: [false; LANES] };
        for k in 0..LANES {
            let index = cells.index[k] as usize;
            if asked[k] && index < self.slot.len() {
                let slot = self.slot[index];
                out.besides[k] = !self.extra.is_empty() && self.extra[index];
                out.head[k] = self.head[index] || out.besides[k];
                out.slot[k] = if slot == NONE { 0 } else { slot };
            }
        }
        out
    }
}
