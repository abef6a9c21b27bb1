//! Distances of rows of points from the skin, by the planes that the rows keep.

use glam::Vec3;

use super::planes::{FieldRow, NEAR, NONE, NOWHERE, PlaneRow};
use super::search::Search;
use super::{DEEP, MovingField, UNSURE};
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, greater, lesser, put};
use crate::motion::Substep;

impl MovingField {
    /// What a row of points in working space learns at the end of a substep, when `passed` of the step has
    /// passed; nothing further away than `reach` is of interest. `None` where all lanes are far.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        row: &Lane3,
        substep: &Substep,
        passed: f32,
        reach: f32,
        planes: &mut PlaneRow,
    ) -> Option<FieldRow> {
        let (local, asked, stays) = gone(row, substep, planes);
        if !stays {
            let mut search = [self.search(0, &local, asked, reach, planes)];
            if search[0].any {
                self.find_skins(&mut search, passed, reach);
            }
            settle(&search[0], passed, reach, planes);
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

    /// Measures beforehand, all together, what [`MovingField::row`] will be asked for if points come to be
    /// where `rows` have them. `planes` are those of these rows, `searches` is working memory.
    #[inline(always)]
    pub(crate) fn foresee(
        &self,
        rows: &[Lane3],
        substep: &Substep,
        passed: f32,
        reach: f32,
        planes: &mut [PlaneRow],
        searches: &mut Vec<Search>,
    ) {
        searches.clear();
        for (n, (row, planes)) in rows.iter().zip(planes.iter_mut()).enumerate() {
            let (local, asked, stays) = gone(row, substep, planes);
            if stays {
                continue;
            }
            let search = self.search(n, &local, asked, reach, planes);
            if search.any {
                searches.push(search);
            } else {
                settle(&search, passed, reach, planes);
            }
        }
        self.find_skins(searches, passed, reach);
        for search in &*searches {
            settle(search, passed, reach, &mut planes[search.row]);
        }
    }
}

/// Writes down what a search has found of the lanes that it was asked for.
#[inline(always)]
fn settle(search: &Search, passed: f32, reach: f32, planes: &mut PlaneRow) {
    let Search { p: local, asked, near, to_next, heads, skins, .. } = search;
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
        let to_next = to_next[k] + NEAR;
        let free = greater(lesser(0.5 * (nearest - reach), to_next), NEAR);
        // Where there is no way back from here, or to skin that is far, there may be another from near by.
        let lost = (near.head[k] | other_skin) & !besides;
        let (known, only_head) = (nearest < NONE, alone & !other_skin);
        let serves = if known & only_head { free } else { to_next };
        let serves = if (known & !only_head) | (!known & lost) { NEAR } else { serves };
        let finite = p.length_squared() < f32::MAX;
        let serves = if finite { serves * serves } else { -1.0 };
        let anew = asked[k];
        renew(&mut planes.serves, k, anew, serves);
        renew3(&mut planes.place, k, anew, p);
        renew(&mut planes.passed, k, anew, passed);
        let head_distance = if alone & !nothing { heads.distance[k] } else { NONE };
        renew(&mut planes.head_distance, k, anew, head_distance);
        renew3(&mut planes.head_normal, k, anew, at(&heads.normal, k));
        let skin_distance = if found { skins.distance[k] } else { NONE };
        renew(&mut planes.skin_distance, k, anew, skin_distance);
        renew3(&mut planes.rest, k, anew, choose(found, at(&skins.rest, k), NOWHERE));
        // Of skin that is not there the rest says nothing.
        renew3(&mut planes.skin_normal, k, anew, at(&skins.normal, k));
        renew(&mut planes.share, k, anew, skins.share[k]);
        let guess = if skins.sure[k] { 0.0 } else { 1.0 };
        renew(&mut planes.guess, k, anew, guess);
        renew3(&mut planes.drift, k, anew, at(&skins.drift, k));
    }
    planes.any = false;
    for k in 0..LANES {
        planes.any |= lesser(planes.head_distance[k], planes.skin_distance[k]) < NONE;
    }
}

/// A row of points in working space taken to head space; the lanes that have gone too far from where they
/// were measured; and whether none has.
#[inline(always)]
fn gone(row: &Lane3, substep: &Substep, planes: &PlaneRow) -> (Lane3, [bool; LANES], bool) {
    let Map { turn, shift } = substep.head;
    let (mut local, mut gone, mut stays) = (ZERO3, [false; LANES], true);
    for k in 0..LANES {
        let p = at(row, k) - shift;
        let p = Vec3::new(turn.x_axis.dot(p), turn.y_axis.dot(p), turn.z_axis.dot(p));
        put(&mut local, k, p);
        let off = (p - at(&planes.place, k)).length_squared() - planes.serves[k];
        // What is not a number is measured too, and found nowhere.
        gone[k] = (off > 0.0) | off.is_nan();
        stays &= !gone[k];
    }
    (local, gone, stays)
}

/// Writes lane `k` where it is `anew`.
#[inline(always)]
fn renew(row: &mut Lane, k: usize, anew: bool, new: f32) {
    row[k] = if anew { new } else { row[k] };
}

/// The same for a vector.
#[inline(always)]
fn renew3(row: &mut Lane3, k: usize, anew: bool, new: Vec3) {
    let was = at(row, k);
    put(row, k, choose(anew, new, was));
}
