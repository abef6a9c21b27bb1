//! What the points of a block have learnt of the field: each a plane near by, taken for the skin until the point has
//! moved too far from where it was measured.
//!
//! A step asks for the skin in every substep and in every round of a push-out. The way back to rest is measured where
//! a point is for the first time in a step and anew wherever it has left the place by [`NEAR`], or by half its distance
//! from contact; in between the skin is its tangent plane, which moves with the drift. On which side of a fold of the skin a
//! point is, is asked once a step. A plane is off by
//! `NEAR^2 / 2 R` at most over a surface of radius `R`: 0.01 mm over the skull, 0.1 mm at the rim of an ear.

use glam::Vec3;

use super::occupancy::Near;
use super::skins::{Skins, Starts};
use super::{CLOSE, DEEP, MovingField, UNSURE};
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, greater, lesser, put, splat3};
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
pub(super) const NOWHERE: Vec3 = Vec3::splat(f32::MAX);

impl PlaneRow {
    /// A row near which no skin has been found.
    pub(crate) const NO_SKIN: Lane3 = splat3(NOWHERE);

    /// Nothing has been measured yet; `rest` is what is known from the last step.
    pub(crate) const fn unknown(rest: Lane3) -> Self {
        Self {
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
            rest,
        }
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
            let normal = choose(nearer, m, n);
            put(&mut out.normal, k, substep.head.rotate(normal));
            let drift = choose(nearer, drift, Vec3::ZERO);
            put(&mut out.drift, k, substep.head.rotate(drift));
        }
        Some(out)
    }

    /// Measures the lanes that have gone too far from where they were measured.
    #[inline(always)]
    fn measure(&self, local: &Lane3, gone: &Lane, passed: f32, reach: f32, planes: &mut PlaneRow) {
        let cells = self.occupancy.cells(local);
        let mut asked = [false; LANES];
        for k in 0..LANES {
            // What is not a number is measured too, and found nowhere.
            asked[k] = (gone[k] > 0.0) | gone[k].is_nan();
        }
        let near = self.occupancy.near(&cells, &asked);
        let heads = self.heads(local, &near.head, reach);
        let skins = self.find_skins(local, &near, &heads.alone, passed, reach, planes);
        for k in 0..LANES {
            let (p, alone, besides) = (at(local, k), heads.alone[k], near.besides[k]);
            let other_skin = near.slot[k] != 0;
            let of_head = lesser(heads.nearest[k], skins.nearest[k]);
            let nearest = if alone { of_head } else { skins.nearest[k] };
            // What is measured besides, to show that it need not be, leaves no trace unless there is something.
            let nothing = besides & (nearest > reach);
            let nearest = if nothing { NONE } else { nearest };
            let found = skins.found[k] & !nothing;
            // In another cell there may be other skin; within a few millimetres this cell knows of it.
            let to_next = cells.to_next[k] + NEAR;
            let free = greater(lesser(0.5 * (nearest - reach), to_next), NEAR);
            // Where there is no way back from here, or to skin that is far, there may be another from near by.
            let lost = (near.head[k] | other_skin) & !besides;
            let (known, only_head) = (nearest < NONE, alone & !other_skin);
            let serves = if known & only_head { free } else { to_next };
            let serves = if (known & !only_head) | (!known & lost) { NEAR } else { serves };
            let finite = p.length_squared() < f32::MAX;
            let serves = if finite { serves * serves } else { -1.0 };
            let anew = asked[k];
            let set = |own: &mut f32, new: f32| *own = if anew { new } else { *own };
            let set3 = |own: &mut Lane3, new: Vec3| {
                set(&mut own[0][k], new.x);
                set(&mut own[1][k], new.y);
                set(&mut own[2][k], new.z);
            };
            set(&mut planes.serves[k], serves);
            set3(&mut planes.place, p);
            set(&mut planes.passed[k], passed);
            set(&mut planes.head_distance[k], if alone & !nothing { heads.distance[k] } else { NONE });
            set3(&mut planes.head_normal, at(&heads.normal, k));
            set(&mut planes.skin_distance[k], if found { skins.distance[k] } else { NONE });
            set3(&mut planes.rest, choose(found, at(&skins.rest, k), NOWHERE));
            // Of skin that is not there the rest says nothing.
            set3(&mut planes.skin_normal, at(&skins.normal, k));
            set(&mut planes.share[k], skins.share[k]);
            set(&mut planes.guess[k], if skins.sure[k] { 0.0 } else { 1.0 });
            set3(&mut planes.drift, at(&skins.drift, k));
        }
        planes.any = false;
        for k in 0..LANES {
            planes.any |= lesser(planes.head_distance[k], planes.skin_distance[k]) < NONE;
        }
    }

    /// What the lanes of a row find of skin that other joints than the head move, and how far that is at least; `alone` says
    /// where the head alone moves what is at a point.
    #[inline(always)]
    fn find_skins(
        &self,
        local: &Lane3,
        near: &Near,
        alone: &[bool; LANES],
        passed: f32,
        reach: f32,
        planes: &PlaneRow,
    ) -> Skins {
        let (mut skins, mut tried, mut stays) = (Skins::NONE, splat3(NOWHERE), [false; LANES]);
        let (slot, mut guess) = (near.slot, ZERO3);
        let (mut any, mut others) = (false, [false; LANES]);
        for k in 0..LANES {
            others[k] = near.head[k] & !alone[k];
            any |= others[k] | (slot[k] != 0);
        }
        if !any {
            return skins;
        }
        for way in Way::ALL {
            let mut starts = Starts { asked: [false; LANES], guess, slot };
            let mut any = false;
            for k in 0..LANES {
                let (p, was, of_slot) = (at(local, k), at(&planes.rest, k), at(&guess, k));
                let (asked, from) = match way {
                    Way::Again => ((slot[k] != 0) & (was.x < NOWHERE.x), was),
                    Way::OfSlot => ((slot[k] != 0) & !stays[k], of_slot),
                    Way::OfHead => (others[k] & !stays[k], p),
                    Way::Between => ((slot[k] != 0) & !stays[k], 0.5 * (of_slot + p)),
                };
                // From close to a place that is known it would lead there.
                let known = at(&tried, k);
                let asked = asked & !((known.x < NOWHERE.x) & self.is_close(from, known));
                starts.asked[k] = asked;
                any |= asked;
                put(&mut starts.guess, k, from);
                starts.slot[k] = if way == Way::OfSlot { slot[k] } else { 0 };
                let first = asked & (way != Way::Again) & (known.x >= NOWHERE.x);
                put(&mut tried, k, choose(first, from, known));
            }
            if any {
                let found = self.measure_skins(local, &starts, alone, passed, reach);
                let mut taken = [false; LANES];
                for k in 0..LANES {
                    let nearer = !skins.found[k] | (found.distance[k] < skins.distance[k]);
                    let good = if way == Way::Again { found.sure[k] } else { nearer };
                    taken[k] = found.found[k] & good;
                    let counts = starts.asked[k] & (way != Way::Again || taken[k]);
                    let nearer = lesser(skins.nearest[k], found.nearest[k]);
                    skins.nearest[k] = if counts { nearer } else { skins.nearest[k] };
                }
                skins.take(&found, &taken);
            }
            if way == Way::Again {
                for k in 0..LANES {
                    // Within a step it stays on the side of a fold that it was found on.
                    stays[k] = (skins.rest[0][k] < NOWHERE.x) & (planes.serves[k] >= 0.0);
                    if slot[k] != 0 && !stays[k] {
                        put(&mut guess, k, self.mapped(at(local, k), slot[k], passed).truncate());
                    }
                }
                tried = skins.rest;
            }
        }
        skins
    }

    /// Whether a way back that begins at `guess` leads to the place `rest` that is known.
    #[inline(always)]
    fn is_close(&self, guess: Vec3, rest: Vec3) -> bool {
        (guess - rest).length_squared() < (CLOSE * self.field.node_lattice().spacing).powi(2)
    }
}

/// From where a point is taken back to rest. Where skin is folded there are several ways back.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// From where it was found last, in this step or the one before.
    Again,
    /// From where the nearest other joints have it.
    OfSlot,
    /// From where the head has it.
    OfHead,
    /// From midway between these.
    Between,
}

impl Way {
    const ALL: [Self; 4] = [Self::Again, Self::OfSlot, Self::OfHead, Self::Between];
}
