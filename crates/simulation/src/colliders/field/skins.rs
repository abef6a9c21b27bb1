//! Rows of points against skin that is moved by other joints than the head: mapped to the rest pose and
//! measured there.

use glam::{Mat3, Mat4, Vec3, Vec4};

use super::affine::{Affine, trilinear};
use super::planes::{NONE, NOWHERE};
use super::rows::{Places, normal_of};
use super::{
    CONVERGED, FURTHEST_FROM_GUESS, GUESSED_DEPTH, IMPLAUSIBLE_DEPTH, LEAST_DETERMINANT, MovingField, ROUNDS,
};
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, choose, greater, lesser, put, splat3, transposed};
use crate::trilinear::weights;

/// Skin around a row of points, in head space. Lanes without skin hold no meaningful values.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkinRow {
    pub(super) found: [bool; LANES],
    /// Lower bound of the distance, metres; [`NONE`] if nothing is known.
    pub(super) nearest: Lane,
    pub(super) distance: Lane,
    pub(super) normal: Lane3,
    /// The head's weight at the skin.
    pub(super) share: Lane,
    /// Velocity of the skin relative to the head, metres per second.
    pub(super) drift: Lane3,
    /// Whether the skin is measured; otherwise it is a guess that may push only a little.
    pub(super) sure: [bool; LANES],
    /// Rest position of the point, the starting point of the next search; [`NOWHERE`] if the head alone moves
    /// it or it is a guess.
    pub(super) rest: Lane3,
}

impl SkinRow {
    pub(super) const NONE: Self = Self {
        found: [false; LANES],
        nearest: Lane::splat(NONE),
        distance: Lane::splat(NONE),
        normal: ZERO3,
        share: ZERO,
        drift: ZERO3,
        sure: [true; LANES],
        rest: splat3(NOWHERE),
    };
}

/// Starting points for the rest positions of a row.
pub(super) struct Starts {
    /// The lanes to be computed.
    pub(super) asked: [bool; LANES],
    /// First guesses of the rest positions.
    pub(super) guess: Lane3,
    /// The weightings that the guesses come from; 0 if the guess may not replace a missing solution.
    pub(super) slot: [u16; LANES],
}

/// Rest positions of a row, and their certainty.
struct Rest {
    /// Whether there is a rest position at all.
    there: [bool; LANES],
    place: Lane3,
    sure: [bool; LANES],
    /// The weightings of the surrounding nodes, and the position between them.
    slots: [[u16; 8]; LANES],
    fraction: Lane3,
    /// Whether the head alone moves the point, so that it is at its rest position already.
    heads: [bool; LANES],
    /// Rows of the derivative of the rest position, apart from the effect of the weightings.
    stretch: [Lane3; 3],
}

impl MovingField {
    /// Measures a row `p` at the fraction `t` of the step. Skin further away than `reach` is ignored. `alone`
    /// marks points whose place is moved by the head alone: a trial that ends there finds skin that is known
    /// already.
    #[inline(always)]
    pub(super) fn measure_skins(
        &self,
        p: &Lane3,
        starts: &Starts,
        alone: &[bool; LANES],
        t: f32,
        reach: f32,
    ) -> SkinRow {
        let rest = self.rest_positions(p, starts, t);
        let mut wanted = rest.there;
        for k in 0..LANES {
            // The head's own weighting gives no guess: it would mean that the point has not moved. Skin that
            // is already known is not measured again.
            wanted[k] &= rest.sure[k] | (starts.slot[k] != 0);
            wanted[k] &= !(alone[k] & rest.heads[k]);
        }
        let at_rest = self.at_rest(&rest.place, &wanted);
        let (mut back, mut moved) = ([ZERO; LANES], ZERO3);
        for k in 0..LANES {
            if !at_rest.there[k] || at_rest.value[k] - self.lift > 2.0 * reach {
                continue;
            }
            let (mut before, mut now) = (Affine::ZERO, Affine::ZERO);
            if rest.heads[k] {
                (before, now) = (Affine::IDENTITY, Affine::IDENTITY);
            } else {
                for (&slot, weight) in rest.slots[k].iter().zip(weights(at(&rest.fraction, k))) {
                    before = before.plus(&self.before[usize::from(slot)], weight);
                    now = now.plus(&self.now[usize::from(slot)], weight);
                }
            }
            back[k] = Lane(before.toward(&now, t).numbers());
            put(&mut moved, k, (before.apply(at(p, k)) - now.apply(at(p, k))).truncate());
        }
        let back = transposed(&back);
        let mut out = SkinRow::NONE;
        let inv_dt = 1.0 / self.dt_secs;
        for k in 0..LANES {
            let (value, gradient) = (at_rest.value[k], at(&at_rest.slope, k));
            // The chain rule: dX = (1 - V')^-1 B dx.
            let bent = at(&rest.stretch[0], k) * gradient.x
                + at(&rest.stretch[1], k) * gradient.y
                + at(&rest.stretch[2], k) * gradient.z;
            let (normal, steepness) = normal_of(times_transposed(&back, k, bent));
            put(&mut out.normal, k, normal);
            let distance = value / lesser(greater(steepness, 0.5), 2.0) - self.lift;
            // Guessed skin may push only a little. The same holds for skin that is stretched or compressed
            // beyond what is possible, and for penetrations deeper than hair ever gets.
            let valid = rest.sure[k] & (0.5..2.0).contains(&steepness) & (distance > -IMPLAUSIBLE_DEPTH);
            let distance = if valid { distance } else { greater(distance, -GUESSED_DEPTH) };
            // Stretched skin is further away than at rest, by at most half.
            let far = value - self.lift > 2.0 * reach;
            let there = at_rest.there[k];
            out.found[k] = there & !far;
            out.distance[k] = distance;
            let least = if far { 0.5 * value - self.lift } else { distance };
            out.nearest[k] = if there { least } else { NONE };
            out.sure[k] = valid;
            out.share[k] = back[15][k];
            put(&mut out.drift, k, times_transposed(&back, k, at(&moved, k)) * inv_dt);
            let (goes_on, place) = (valid & !rest.heads[k], at(&rest.place, k));
            let place = choose(goes_on, place, NOWHERE);
            put(&mut out.rest, k, place);
        }
        out
    }

    /// The image of `p` under the weighting `slot` at the fraction `t` of the step.
    #[inline(always)]
    pub(super) fn mapped(&self, p: Vec3, slot: u16, t: f32) -> Vec4 {
        let (a, b) = (self.before[usize::from(slot)].apply(p), self.now[usize::from(slot)].apply(p));
        a + (b - a) * t
    }

    /// Computes the rest positions of a row from first guesses.
    ///
    /// Solves `X = V(X)`, where `V` interpolates the images of `p` under the weightings of the eight nodes
    /// around `X`. Newton's iteration, `(1 - V') dX = V - X`, converges where a fixed-point iteration would
    /// oscillate, such as around a raised arm. Where the skin is folded so much that no solution is found
    /// nearby, the weighting of the guess alone determines the rest position.
    #[inline(always)]
    fn rest_positions(&self, p: &Lane3, starts: &Starts, t: f32) -> Rest {
        let (nodes, all) = (self.field.node_lattice(), self.field.slot_of_node());
        let (up, behind) = (nodes.size.x as usize, (nodes.size.x * nodes.size.y) as usize);
        let mut rest = Rest {
            there: starts.asked,
            place: starts.guess,
            sure: [false; LANES],
            slots: [[0; 8]; LANES],
            fraction: ZERO3,
            heads: [false; LANES],
            stretch: [splat3(Vec3::X), splat3(Vec3::Y), splat3(Vec3::Z)],
        };
        let mut going = starts.asked;
        for _ in 0..ROUNDS {
            let places = Places::new(nodes, self.inv_node, &rest.place);
            // The image of each lane, and its derivatives along the axes.
            let (mut mapped_to, mut mixed) = ([ZERO; LANES], [false; LANES]);
            for k in 0..LANES {
                if !going[k] {
                    continue;
                }
                let first = places.first[k] as usize;
                let Some(&head_alone) = self.head_alone.get(first) else {
                    (going[k], rest.there[k]) = (false, false);
                    continue;
                };
                let here = at(p, k);
                if head_alone {
                    // Valid only if the point itself lies there.
                    (going[k], rest.heads[k]) = (false, true);
                    (rest.sure[k], rest.there[k]) = self.is_moved_by_head_alone(here);
                    put(&mut rest.place, k, here);
                    continue;
                }
                let mut slots = [0; 8];
                for (pair, offset) in
                    slots.as_chunks_mut::<2>().0.iter_mut().zip([0, up, behind, behind + up])
                {
                    pair.copy_from_slice(&all[first + offset..first + offset + 2]);
                }
                rest.slots[k] = slots;
                put(&mut rest.fraction, k, at(&places.fraction, k));
                let mapped = |slot: u16| self.mapped(here, slot, t);
                mixed[k] = slots != [slots[0]; 8];
                let (mean, along) = if mixed[k] {
                    trilinear(&slots.map(mapped), at(&places.fraction, k))
                } else {
                    (mapped(slots[0]), [Vec4::ZERO; 3])
                };
                mapped_to[k] = Lane(Mat4::from_cols(mean, along[0], along[1], along[2]).to_cols_array());
            }
            let mapped_to = transposed(&mapped_to);
            let column = |i: usize, k: usize| {
                Vec3::new(mapped_to[4 * i][k], mapped_to[4 * i + 1][k], mapped_to[4 * i + 2][k])
            };
            let mut any = false;
            for k in 0..LANES {
                let (value, place) = (column(0, k), at(&rest.place, k));
                let left = |i: usize, unit: Vec3| unit - column(1 + i, k) * self.inv_node;
                let left = Mat3::from_cols(left(0, Vec3::X), left(1, Vec3::Y), left(2, Vec3::Z));
                let cross = [
                    left.y_axis.cross(left.z_axis),
                    left.z_axis.cross(left.x_axis),
                    left.x_axis.cross(left.y_axis),
                ];
                let determinant = left.z_axis.dot(cross[2]);
                // Where the skin is folded over itself, no inverse keeps its sides apart.
                let newton = mixed[k] & (determinant >= LEAST_DETERMINANT);
                let inv = 1.0 / determinant;
                let row = |c: Vec3, unit: Vec3| choose(newton, c * inv, unit);
                let stretch = [row(cross[0], Vec3::X), row(cross[1], Vec3::Y), row(cross[2], Vec3::Z)];
                let off = value - place;
                let step = Vec3::new(stretch[0].dot(off), stretch[1].dot(off), stretch[2].dot(off));
                let (squared, most) = (step.length_squared(), nodes.spacing);
                let shorter = if newton & (squared > most * most) { most / squared.sqrt() } else { 1.0 };
                let step = step * shorter;
                let next = place + step;
                put(&mut rest.place, k, choose(going[k], next, place));
                for (rows, row) in rest.stretch.iter_mut().zip(stretch) {
                    let was = at(rows, k);
                    put(rows, k, choose(going[k], row, was));
                }
                let settled = going[k] & (step.length_squared() < CONVERGED * CONVERGED);
                rest.sure[k] |= settled;
                going[k] &= !settled;
                any |= going[k];
            }
            if !any {
                break;
            }
        }
        let furthest = (FURTHEST_FROM_GUESS * nodes.spacing).powi(2);
        for k in 0..LANES {
            let guess = at(&starts.guess, k);
            rest.sure[k] &= (at(&rest.place, k) - guess).length_squared() <= furthest;
        }
        for k in (0..LANES).filter(|&k| rest.there[k] && !rest.sure[k]) {
            put(&mut rest.place, k, at(&starts.guess, k));
            (rest.slots[k], rest.heads[k]) = ([starts.slot[k]; 8], false);
            put(&mut rest.fraction, k, Vec3::ZERO);
        }
        for k in 0..LANES {
            let plain = rest.heads[k] | !rest.sure[k];
            for (row, unit) in rest.stretch.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
                let own = at(row, k);
                put(row, k, choose(plain, unit, own));
            }
        }
        rest
    }
}

/// The transpose of the matrix in lane `k`, whose columns have four numbers each, times `v`.
#[inline(always)]
fn times_transposed(matrix: &[Lane; LANES], k: usize, v: Vec3) -> Vec3 {
    let column = |i: usize| Vec3::new(matrix[4 * i][k], matrix[4 * i + 1][k], matrix[4 * i + 2][k]);
    Vec3::new(column(0).dot(v), column(1).dot(v), column(2).dot(v))
}
