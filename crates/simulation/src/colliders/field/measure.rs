//! Distances of rows of points from the skin, by means of the planes that the rows keep.

use glam::Vec3;

use super::planes::{FieldRow, NEAR, NONE, NOWHERE, PlaneRow};
use super::search::Search;
use super::{GUESSED_DEPTH, IMPLAUSIBLE_DEPTH, MovingField};
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, greater, lesser, put};
use crate::motion::Substep;

impl MovingField {
    /// The field around a row of points in working space at the end of a substep, when the fraction `passed`
    /// of the step has passed. Skin further away than `reach` is ignored. `None` if all lanes are far from
    /// it.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        row: &Lane3,
        substep: &Substep,
        passed: f32,
        reach: f32,
        planes: &mut PlaneRow,
    ) -> Option<FieldRow> {
        let (local, asked, stays) = left_planes(row, substep, planes);
        if !stays {
            let mut search = [self.search(0, &local, asked, reach, planes)];
            if search[0].any {
                self.find_skins(&mut search, passed, reach);
            }
            store_search(&search[0], passed, reach, planes);
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
            // Skin that approaches too fast to be measured on the way is a guess.
            let lost = skin < -IMPLAUSIBLE_DEPTH;
            let (skin, guess) = if lost { (-GUESSED_DEPTH, 1.0) } else { (skin, planes.guess[k]) };
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

    /// Measures in advance, all rows together, what [`MovingField::row`] will need if the points end up at
    /// `rows`. `planes` belong to these rows; `searches` is working memory.
    #[inline(always)]
    pub(crate) fn prefetch_planes(
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
            let (local, asked, stays) = left_planes(row, substep, planes);
            if stays {
                continue;
            }
            let search = self.search(n, &local, asked, reach, planes);
            if search.any {
                searches.push(search);
            } else {
                store_search(&search, passed, reach, planes);
            }
        }
        self.find_skins(searches, passed, reach);
        for search in &*searches {
            store_search(search, passed, reach, &mut planes[search.row]);
        }
    }
}

/// Stores the results of a search in the planes of the lanes that were measured.
#[inline(always)]
fn store_search(search: &Search, passed: f32, reach: f32, planes: &mut PlaneRow) {
    let Search { p: local, asked, near, to_next, heads, skins, .. } = search;
    for k in 0..LANES {
        let (p, alone, forced) = (at(local, k), heads.alone[k], near.forced[k]);
        let other_skin = near.slot[k] != 0;
        let of_head = lesser(heads.nearest[k], skins.nearest[k]);
        let nearest = if alone { of_head } else { skins.nearest[k] };
        // Points that are measured only to verify the culling leave no trace unless skin is found.
        let nothing = forced & (nearest > reach);
        let nearest = if nothing { NONE } else { nearest };
        let found = skins.found[k] & !nothing;
        // Another cell may contain other skin, which this cell takes into account within a few millimetres.
        let to_next = to_next[k] + NEAR;
        let free = greater(lesser(0.5 * (nearest - reach), to_next), NEAR);
        // Where no rest position is found from here, or only one at skin that is far, another may be found
        // nearby.
        let lost = (near.head[k] | other_skin) & !forced;
        let (known, only_head) = (nearest < NONE, alone & !other_skin);
        let valid_squared = if known & only_head { free } else { to_next };
        let valid_squared = if (known & !only_head) | (!known & lost) { NEAR } else { valid_squared };
        let finite = p.length_squared() < f32::MAX;
        let valid_squared = if finite { valid_squared * valid_squared } else { -1.0 };
        let stale = asked[k];
        replace(&mut planes.valid_squared, k, stale, valid_squared);
        replace3(&mut planes.place, k, stale, p);
        replace(&mut planes.passed, k, stale, passed);
        let head_distance = if alone & !nothing { heads.distance[k] } else { NONE };
        replace(&mut planes.head_distance, k, stale, head_distance);
        replace3(&mut planes.head_normal, k, stale, at(&heads.normal, k));
        let skin_distance = if found { skins.distance[k] } else { NONE };
        replace(&mut planes.skin_distance, k, stale, skin_distance);
        replace3(&mut planes.rest, k, stale, choose(found, at(&skins.rest, k), NOWHERE));
        // Without skin the remaining values have no meaning.
        replace3(&mut planes.skin_normal, k, stale, at(&skins.normal, k));
        replace(&mut planes.share, k, stale, skins.share[k]);
        let guess = if skins.sure[k] { 0.0 } else { 1.0 };
        replace(&mut planes.guess, k, stale, guess);
        replace3(&mut planes.drift, k, stale, at(&skins.drift, k));
    }
    planes.any = false;
    for k in 0..LANES {
        planes.any |= lesser(planes.head_distance[k], planes.skin_distance[k]) < NONE;
    }
}

/// Takes a row of points from working space to head space. Returns the points, the lanes that are too far
/// from where they were measured, and whether there are none of those.
#[inline(always)]
fn left_planes(row: &Lane3, substep: &Substep, planes: &PlaneRow) -> (Lane3, [bool; LANES], bool) {
    let Map { turn, shift } = substep.head;
    let (mut local, mut left_planes, mut stays) = (ZERO3, [false; LANES], true);
    for k in 0..LANES {
        let p = at(row, k) - shift;
        let p = Vec3::new(turn.x_axis.dot(p), turn.y_axis.dot(p), turn.z_axis.dot(p));
        put(&mut local, k, p);
        let off = (p - at(&planes.place, k)).length_squared() - planes.valid_squared[k];
        // NaN is measured too, and found nowhere.
        left_planes[k] = (off > 0.0) | off.is_nan();
        stays &= !left_planes[k];
    }
    (local, left_planes, stays)
}

/// Writes lane `k` if `stale` is true.
#[inline(always)]
fn replace(row: &mut Lane, k: usize, stale: bool, new: f32) {
    row[k] = if stale { new } else { row[k] };
}

/// The same for a vector.
#[inline(always)]
fn replace3(row: &mut Lane3, k: usize, stale: bool, new: Vec3) {
    let was = at(row, k);
    put(row, k, choose(stale, new, was));
}
