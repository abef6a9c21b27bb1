//! One point against the field: taken back to rest and measured there.

use glam::{Mat3A, UVec3, Vec3, Vec3A};
use lovelock_motion::FieldLattice;

use super::back::{Around, Back};
use super::{CLOSE, DEEP, MovingField, ROUNDS, SETTLED, STRAYED, UNFOLDED, UNSURE};
use crate::trilinear::{gradient, weights};

/// What one point learns of a skin, in head space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) distance: f32,
    pub(super) normal: Vec3,
    /// The head's share of the skin there.
    pub(super) head: f32,
    /// Velocity of the skin against the head, metres per second.
    pub(super) drift: Vec3,
    /// Whether this is measured, and not a guess that may push a little.
    pub(super) sure: bool,
    /// Where the point is at rest, to go on from in the next measurement; `None` where the head alone moves it.
    pub(super) rest: Option<Vec3>,
}

/// Where the way of a point back to rest begins.
#[derive(Clone, Copy)]
pub(super) enum Start {
    /// What a weighting makes of the point.
    Slot(usize),
    /// Where the point was found before.
    Place(Vec3),
}

/// What a point finds: the skin, or how far it is from any at least.
pub(super) enum Found {
    Skin(Touch),
    Beyond(f32),
    Nothing,
}

/// Where a point is at rest, and how well that is known.
struct Rest {
    place: Vec3,
    sure: bool,
    back: Back,
    /// What a small step now makes of the place at rest, beside `back`.
    stretch: Mat3A,
    /// The nodes around it, and where it is between them; `None` where the head alone moves them.
    slots: Option<[u16; 8]>,
    fraction: Vec3,
}

impl MovingField {
    /// Against the skin that other joints move too, at the fraction `t` of the step; `alone` says that the head alone moves
    /// what is at `p`, and that this is known already.
    #[inline(always)]
    pub(super) fn skin(&self, p: Vec3, start: Start, alone: bool, t: f32, reach: f32) -> Found {
        let (guess, slot) = match start {
            Start::Slot(slot) => (self.guess(p, slot, t), slot),
            Start::Place(place) => (place, 0),
        };
        let Some(rest) = self.way_back(p, guess, slot, t) else { return Found::Nothing };
        // Of the head's own weighting there is no guess: it says that the point has not moved. Nor is where it was.
        if (slot == 0 && !rest.sure) || (alone && rest.slots.is_none()) {
            return Found::Nothing;
        }
        let Some((value, at_rest)) = self.at_rest(rest.place) else { return Found::Nothing };
        // A stretched skin is further away than it was at rest, by half at most.
        if value - self.lift > 2.0 * reach {
            return Found::Beyond(0.5 * value - self.lift);
        }
        // The chain rule: dX = (1 - V')^-1 B dx.
        let slope = rest.back.turn_forth(rest.stretch.transpose() * Vec3A::from(at_rest));
        let steepness = slope.length_squared().sqrt();
        let normal = if steepness > 1e-6 { slope * (1.0 / steepness) } else { Vec3::Y };
        let distance = value / steepness.clamp(0.5, 2.0) - self.lift;
        // A guess may push, but not far; nor may skin that is stretched or pressed beyond what skin can be, or that
        // hair has never been so deep in.
        let sound = rest.sure && (0.5..2.0).contains(&steepness) && distance > -DEEP;
        let distance = if sound { distance } else { distance.max(-UNSURE) };
        let going_on = rest.slots.filter(|_| sound).map(|_| rest.place);
        let drift = match &rest.slots {
            None => Vec3::ZERO,
            Some(slots) => {
                let mut way = Back::NOTHING;
                for (&slot, weight) in slots.iter().zip(weights(rest.fraction)) {
                    let slot = usize::from(slot);
                    way = way.plus(&self.before[slot].less(&self.now[slot]), weight);
                }
                let moved = way.apply(p);
                rest.back.turn_forth(moved) * (1.0 / self.dt_secs)
            }
        };
        Found::Skin(Touch { distance, normal, head: rest.back.head(), drift, sure: sound, rest: going_on })
    }

    /// What the weighting `slot` makes of `p`.
    #[inline(always)]
    pub(super) fn guess(&self, p: Vec3, slot: usize, t: f32) -> Vec3 {
        self.before[slot].toward(&self.now[slot], t).apply(p).into()
    }

    /// Whether a way back that begins at `guess` leads to the place `rest` that is known.
    #[inline(always)]
    pub(super) fn is_close(&self, guess: Vec3, rest: Vec3) -> bool {
        (guess - rest).length_squared() < (CLOSE * self.field.node_lattice().spacing).powi(2)
    }

    /// Takes `p` back to rest from a first guess of where that is.
    ///
    /// Wanted is `X = V(X)`, where `V` mixes what the weightings of the eight nodes around `X` make of `p`. Newton's
    /// iteration, `(1 - V') dX = V - X`, goes where a plain one would swing to and fro: around a raised arm. Where the
    /// skin is so folded that it finds nothing near by, the weighting `slot` of the guess alone says where the point is.
    #[inline(always)]
    fn way_back(&self, p: Vec3, guess: Vec3, slot: usize, t: f32) -> Option<Rest> {
        let (nodes, all) = (self.field.node_lattice(), self.field.slot_of_node());
        let of_slot = |slot: u16| self.before[usize::from(slot)].toward(&self.now[usize::from(slot)], t);
        let mut rest = Rest {
            place: guess,
            sure: false,
            back: Back::IDENTITY,
            stretch: Mat3A::IDENTITY,
            slots: None,
            fraction: Vec3::ZERO,
        };
        for _ in 0..ROUNDS {
            let (corners, fraction) = around(nodes, self.inv_node, rest.place)?;
            if self.head_alone[corners[0]] {
                // Only if that is where it is.
                let (corners, _) = around(nodes, self.inv_node, p)?;
                rest = Rest {
                    place: p,
                    sure: self.head_alone[corners[0]],
                    back: Back::IDENTITY,
                    stretch: Mat3A::IDENTITY,
                    slots: None,
                    fraction,
                };
                break;
            }
            let mut slots = [0; 8];
            for (slot, &c) in slots.iter_mut().zip(&corners) {
                *slot = all[c];
            }
            (rest.slots, rest.fraction) = (Some(slots), fraction);
            let next = if slots == [slots[0]; 8] {
                (rest.back, rest.stretch) = (of_slot(slots[0]), Mat3A::IDENTITY);
                rest.back.apply(p).into()
            } else {
                let mut backs = [Back::IDENTITY; 8];
                for (back, &slot) in backs.iter_mut().zip(&slots) {
                    *back = of_slot(slot);
                }
                let here = Around::new(&backs, fraction);
                rest.back = here.back;
                let value = Vec3::from(rest.back.apply(p));
                let left = Mat3A::IDENTITY - here.slope(p) * self.inv_node;
                // Where the skin is folded over itself there is no way back that keeps its sides apart.
                if left.determinant() < UNFOLDED {
                    rest.stretch = Mat3A::IDENTITY;
                    value
                } else {
                    rest.stretch = left.inverse();
                    let step = Vec3::from(rest.stretch * Vec3A::from(value - rest.place));
                    rest.place + step.clamp_length_max(nodes.spacing)
                }
            };
            let moved = (next - rest.place).length_squared();
            rest.place = next;
            if moved < SETTLED * SETTLED {
                rest.sure = true;
                break;
            }
        }
        let strayed = (rest.place - guess).length_squared() > (STRAYED * nodes.spacing).powi(2);
        rest.sure &= !strayed;
        if !rest.sure {
            rest.place = guess;
            rest.back = of_slot(slot as u16);
            (rest.slots, rest.stretch) = (Some([slot as u16; 8]), Mat3A::IDENTITY);
        }
        Some(rest)
    }

    /// Distance of a place at rest and its gradient.
    #[inline(always)]
    fn at_rest(&self, rest: Vec3) -> Option<(f32, Vec3)> {
        let (corners, within) = around(self.field.distance_lattice(), self.inv_spacing, rest)?;
        let (all, mut d, mut value) = (self.field.distances(), [0.0; 8], 0.0);
        for (i, weight) in weights(within).into_iter().enumerate() {
            d[i] = all[corners[i]];
            value += d[i] * weight;
        }
        Some((value, gradient(&d, within) * self.inv_spacing))
    }
}

/// The eight points of a lattice around a place, x fastest, and where between them it is.
#[inline(always)]
pub(super) fn around(lattice: &FieldLattice, inv_spacing: f32, p: Vec3) -> Option<([usize; 8], Vec3)> {
    let q = (p - lattice.low) * inv_spacing;
    let last = lattice.size - 1;
    // Written so that what is not a number is outside.
    let inside = q.x >= 0.0
        && q.y >= 0.0
        && q.z >= 0.0
        && q.x < last.x as f32
        && q.y < last.y as f32
        && q.z < last.z as f32;
    if !inside {
        return None;
    }
    let cell = UVec3::new(q.x as u32, q.y as u32, q.z as u32);
    let first = lattice.index(cell);
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let mut corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    for corner in &mut corners {
        *corner += first;
    }
    Some((corners, q - cell.as_vec3()))
}
