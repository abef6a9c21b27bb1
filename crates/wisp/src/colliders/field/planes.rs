//! What the points of a block have learnt of the field: each a plane near by, taken for the skin until the point has
//! moved too far from where it was measured.
//!
//! A step asks for the skin in every substep and in every round of a push-out. The way back to rest is measured where
//! a point is for the first time in a step and anew wherever it has left the place by [`NEAR`], or by half its distance
//! from contact; in between the skin is its tangent plane, which moves with the drift. A plane is off by
//! `NEAR^2 / 2 R` at most over a surface of radius `R`: 0.01 mm over the skull, 0.1 mm at the rim of an ear.

use glam::Vec3;

use super::query::{Found, Start, Touch};
use super::{DEEP, MovingField, UNSURE, occupancy};
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, greater, lesser, put, splat3};
use crate::solver::Substep;

/// So far from where it was measured a plane near contact serves, metres.
pub(crate) const NEAR: f32 = 0.0015;

/// The distance of a skin that is not there.
pub(super) const NONE: f32 = 1e9;

/// The planes of one row of points, in head space.
#[derive(Clone, Debug)]
pub(crate) struct PlaneRow {
    /// Where the points were measured, and the square of how far from there that serves; negative where none was.
    place: Lane3,
    serves: Lane,
    /// How much of the step had passed.
    passed: Lane,
    /// Skin that goes with the head: distance at `place`, and normal.
    head_distance: Lane,
    head_normal: Lane3,
    /// Skin that other joints move too: the same, the head's share of it, and its velocity against the head.
    skin_distance: Lane,
    skin_normal: Lane3,
    share: Lane,
    drift: Lane3,
    /// 1 where that skin is a guess, else 0.
    guess: Lane,
    /// Whether any lane has skin near by.
    any: bool,
    /// Where the points were at rest when skin that other joints move too was last found near them; [`NOWHERE`] where it
    /// was not. Unlike the rest this is kept from step to step: where skin is folded there are several ways back, and
    /// what is near one side of the fold stays there.
    pub(crate) rest: Lane3,
}

/// No place at rest.
const NOWHERE: Vec3 = Vec3::splat(f32::MAX);

impl PlaneRow {
    pub(crate) const UNKNOWN: Self = Self {
        place: ZERO3,
        serves: Lane::splat(-1.0),
        passed: ZERO,
        head_distance: Lane::splat(NONE),
        head_normal: ZERO3,
        skin_distance: Lane::splat(NONE),
        skin_normal: ZERO3,
        share: ZERO,
        drift: ZERO3,
        guess: ZERO,
        any: false,
        rest: splat3(NOWHERE),
    };

    /// Forgets what was measured in the last step.
    pub(crate) fn forget(&mut self) {
        self.serves = Lane::splat(-1.0);
    }
}

/// What a row of points learns of the field, in working space; lanes far from it have a huge distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub(crate) distance: Lane,
    pub(crate) normal: Lane3,
    /// The head's share of the skin.
    pub(crate) head: Lane,
    /// Velocity of the skin against the head, metres per second.
    drift: Lane3,
    /// 1 where the skin is a guess, else 0: it may push, and nobody knows how deep hair is in it.
    pub(crate) guess: Lane,
}

impl FieldRow {
    /// Velocity of the skin near lane `k`, a point of which is at `p`.
    #[inline(always)]
    pub(crate) fn velocity(&self, k: usize, p: Vec3, substep: &Substep) -> Vec3 {
        substep.rigid_velocity(p) + at(&self.drift, k)
    }
}

impl MovingField {
    /// What a row of points in working space learns at the end of a substep, when `passed` of the step has passed;
    /// nothing further away than `reach` is of interest. `None` where all lanes are far.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        row: &Lane3,
        substep: &Substep,
        passed: f32,
        reach: f32,
        planes: &mut PlaneRow,
    ) -> Option<FieldRow> {
        let Map { turn, shift } = substep.head;
        let (mut local, mut gone) = (ZERO3, ZERO);
        for k in 0..LANES {
            let p = at(row, k) - shift;
            let p = Vec3::new(turn.x_axis.dot(p), turn.y_axis.dot(p), turn.z_axis.dot(p));
            put(&mut local, k, p);
            gone[k] = (p - at(&planes.place, k)).length_squared() - planes.serves[k];
        }
        let mut stays = true;
        for k in 0..LANES {
            stays &= gone[k] <= 0.0;
        }
        // What is not a number is measured too, and found nowhere.
        if !stays {
            self.measure(&local, &gone, passed, reach, planes);
        }
        if !planes.any {
            return None;
        }
        let mut out = FieldRow { distance: ZERO, normal: ZERO3, head: ZERO, drift: ZERO3, guess: ZERO };
        let step = passed * self.dt_secs;
        for k in 0..LANES {
            let moved = at(&local, k) - at(&planes.place, k);
            let drift = at(&planes.drift, k);
            let against = moved - drift * (step - planes.passed[k] * self.dt_secs);
            let (n, m) = (at(&planes.head_normal, k), at(&planes.skin_normal, k));
            let head = planes.head_distance[k] + n.dot(moved);
            let skin = planes.skin_distance[k] + m.dot(against);
            // Skin that comes on too quickly to be measured on its way is a guess.
            let lost = skin < -DEEP;
            let (skin, guess) = if lost { (-UNSURE, 1.0) } else { (skin, planes.guess[k]) };
            let nearer = skin < head;
            let pick = |a: f32, b: f32| if nearer { a } else { b };
            out.distance[k] = pick(skin, head);
            out.head[k] = pick(planes.share[k], 1.0);
            out.guess[k] = pick(guess, 0.0);
            let normal = Vec3::new(pick(m.x, n.x), pick(m.y, n.y), pick(m.z, n.z));
            put(&mut out.normal, k, substep.head.rotate(normal));
            let drift = Vec3::new(pick(drift.x, 0.0), pick(drift.y, 0.0), pick(drift.z, 0.0));
            put(&mut out.drift, k, substep.head.rotate(drift));
        }
        Some(out)
    }

    /// Measures the lanes that have gone too far from where they were measured.
    #[inline(always)]
    fn measure(&self, local: &Lane3, gone: &Lane, passed: f32, reach: f32, planes: &mut PlaneRow) {
        let cells = self.occupancy.cells(local);
        let (mut near, mut asked) = ([occupancy::Near::NOTHING; LANES], [false; LANES]);
        for k in 0..LANES {
            // Written so that what is not a number is measured.
            if !(gone[k] <= 0.0) {
                near[k] = self.occupancy.near(cells.index[k]);
                asked[k] = near[k].head;
            }
        }
        let heads = self.heads(local, &asked, reach);
        for k in 0..LANES {
            if gone[k] <= 0.0 {
                continue;
            }
            let (p, cell, alone) = (at(local, k), near[k], heads.alone[k]);
            let (mut head, mut nearest) =
                if alone { (heads.distance[k], heads.nearest[k]) } else { (NONE, NONE) };
            let mut skin = None;
            if cell.slot.is_some() || (cell.head && !alone) {
                let least;
                (skin, least) = self.ways_back(p, cell, alone, k, passed, reach, planes);
                nearest = lesser(nearest, least);
            }
            // What is measured besides, to show that it need not be, leaves no trace unless there is something.
            if cell.besides && nearest > reach {
                (head, skin, nearest) = (NONE, None, NONE);
            }
            // In another cell there may be other skin; within a few millimetres this cell knows of it.
            let to_next = cells.to_next[k] + NEAR;
            let free = lesser(0.5 * (nearest - reach), to_next);
            // Where there is no way back from here, or to skin that is far, there may be another from near by.
            let lost = (cell.head || cell.slot.is_some()) && !cell.besides;
            let only_head = alone && cell.slot.is_none();
            let serves = if nearest < NONE && only_head {
                greater(free, NEAR)
            } else if nearest < NONE || lost {
                NEAR
            } else {
                to_next
            };
            planes.serves[k] = if p.is_finite() { serves * serves } else { -1.0 };
            put(&mut planes.place, k, p);
            planes.passed[k] = passed;
            planes.head_distance[k] = head;
            put(&mut planes.head_normal, k, at(&heads.normal, k));
            // Of skin that is not there the rest says nothing.
            planes.skin_distance[k] = skin.map_or(NONE, |touch: Touch| touch.distance);
            put(&mut planes.rest, k, skin.and_then(|touch| touch.rest).unwrap_or(NOWHERE));
            if let Some(skin) = skin {
                put(&mut planes.skin_normal, k, skin.normal);
                planes.share[k] = skin.head;
                planes.guess[k] = f32::from(u8::from(!skin.sure));
                put(&mut planes.drift, k, skin.drift);
            }
        }
        planes.any = false;
        for k in 0..LANES {
            planes.any |= lesser(planes.head_distance[k], planes.skin_distance[k]) < NONE;
        }
    }

    /// What lane `k`, at `p`, finds of skin that other joints than the head move, and how far that is at least; `alone` says
    /// whether the head alone moves what is at `p`.
    #[inline(always)]
    fn ways_back(
        &self,
        p: Vec3,
        cell: occupancy::Near,
        alone: bool,
        k: usize,
        passed: f32,
        reach: f32,
        planes: &PlaneRow,
    ) -> (Option<Touch>, f32) {
        let found = |touch: Found| match touch {
            Found::Skin(touch) => (Some(touch), touch.distance),
            Found::Beyond(distance) => (None, distance),
            Found::Nothing => (None, NONE),
        };
        let (mut skin, mut nearest) = (None::<Touch>, NONE);
        let was = at(&planes.rest, k);
        if cell.slot.is_some()
            && was.x < NOWHERE.x
            && let Found::Skin(touch) = self.skin(p, Start::Place(was), alone, passed, reach)
            && touch.sure
        {
            (skin, nearest) = (Some(touch), touch.distance);
        }
        // Where skin is folded there are several ways back: from where the head has the point, and from where the
        // nearest other joints have it. From close to a place that is known they would lead there.
        let known = skin.and_then(|touch| touch.rest);
        // Within a step it stays on the side of a fold that it was found on.
        if known.is_some() && planes.serves[k] >= 0.0 {
            return (skin, nearest);
        }
        let of_slot = cell.slot.map(|slot| (Start::Slot(slot), self.guess(p, slot, passed)));
        let of_head = (cell.head && !alone).then_some((Start::Slot(0), p));
        let between = of_slot.map(|(_, guess)| (Start::Place(0.5 * (guess + p)), 0.5 * (guess + p)));
        let mut tried = known;
        for (start, guess) in [of_slot, of_head, between].into_iter().flatten() {
            if tried.is_some_and(|rest| self.is_close(guess, rest)) {
                continue;
            }
            tried = tried.or(Some(guess));
            let (touch, distance) = found(self.skin(p, start, alone, passed, reach));
            nearest = lesser(nearest, distance);
            skin = match (skin, touch) {
                (Some(a), Some(b)) => Some(if b.distance < a.distance { b } else { a }),
                (a, b) => a.or(b),
            };
        }
        (skin, nearest)
    }
}
