//! Rows of points that look for the skin that other joints than the head move. Only some lanes of a row are
//! near any: those of all rows of a block are measured together, sixteen at a time.

use glam::Vec3;

use super::occupancy::Near;
use super::planes::{NOWHERE, PlaneRow};
use super::rows::{Heads, Places};
use super::skins::{Skins, Starts};
use super::{CLOSE, MovingField};
use crate::lanes::{LANES, Lane, Lane3, ZERO3, at, choose, lesser, put, splat3};

/// A row of points that looks for skin, in head space.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    /// Which of the rows that were given it is.
    pub(super) row: usize,
    pub(super) p: Lane3,
    /// The lanes that it is about.
    pub(super) asked: [bool; LANES],
    pub(super) near: Near,
    /// How far the next cell is at least, metres.
    pub(super) to_next: Lane,
    pub(super) heads: Heads,
    /// Whether any lane may find skin that other joints move.
    pub(super) any: bool,
    /// Near the head, where not the head alone moves what is at the point.
    others: [bool; LANES],
    /// Where the points were at rest when they last found such skin; and whether that was in this step.
    was: Lane3,
    in_this_step: [bool; LANES],
    /// Whether the points stay on the side of a fold that they were found on.
    stays: [bool; LANES],
    /// Where the nearest other joints have the points at rest.
    guess: Lane3,
    /// From where a way back has been tried.
    tried: Lane3,
    /// What has been found.
    pub(super) skins: Skins,
}

/// A way back that is to be tried: of which point, and from where.
#[derive(Clone, Copy)]
struct Trial {
    search: usize,
    lane: usize,
    p: Vec3,
    from: Vec3,
    slot: u16,
    alone: bool,
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

/// Trials that wait: a full row of them, and what one more row of points may add.
struct Waiting {
    trials: [Trial; 2 * LANES],
    count: usize,
}

impl MovingField {
    /// Begins the search of the lanes `asked` of the row `p`, the `row`-th of those that were given: what the
    /// cells know, and the skin that goes with the head.
    #[inline(always)]
    pub(super) fn search(
        &self,
        row: usize,
        p: &Lane3,
        asked: [bool; LANES],
        reach: f32,
        planes: &PlaneRow,
    ) -> Search {
        let cells = self.occupancy.cells(p);
        let near = self.occupancy.near(&cells, &asked);
        let heads = self.heads(p, &near.head, reach);
        let (mut others, mut in_this_step, mut any) = ([false; LANES], [false; LANES], false);
        for k in 0..LANES {
            others[k] = near.head[k] & !heads.alone[k];
            in_this_step[k] = planes.serves[k] >= 0.0;
            any |= others[k] | (near.slot[k] != 0);
        }
        Search {
            row,
            p: *p,
            asked,
            near,
            to_next: cells.to_next,
            heads,
            any,
            others,
            was: planes.rest,
            in_this_step,
            stays: [false; LANES],
            guess: ZERO3,
            tried: splat3(NOWHERE),
            skins: Skins::NONE,
        }
    }

    /// Looks for skin that other joints than the head move, at the fraction `t` of the step; nothing further
    /// than `reach` is of interest.
    #[inline(always)]
    pub(super) fn find_skins(&self, searches: &mut [Search], t: f32, reach: f32) {
        let none = Trial { search: 0, lane: 0, p: Vec3::ZERO, from: Vec3::ZERO, slot: 0, alone: false };
        let mut waiting = Waiting { trials: [none; 2 * LANES], count: 0 };
        for way in Way::ALL {
            for next in 0..=searches.len() {
                if let Some(search) = searches.get_mut(next) {
                    if way == Way::OfSlot {
                        self.go_on(search, t);
                    }
                    self.ask(search, next, way, &mut waiting);
                }
                let last = next == searches.len();
                while waiting.count >= LANES || (last && waiting.count > 0) {
                    self.try_all(searches, way, &mut waiting, t, reach);
                }
            }
        }
    }

    /// What a search knows after its points have gone on from where they were found last.
    #[inline(always)]
    fn go_on(&self, search: &mut Search, t: f32) {
        search.tried = search.skins.rest;
        for k in 0..LANES {
            // Within a step it stays on the side of a fold that it was found on.
            search.stays[k] = (search.skins.rest[0][k] < NOWHERE.x) & search.in_this_step[k];
            let slot = search.near.slot[k];
            if slot != 0 && !search.stays[k] {
                put(&mut search.guess, k, self.mapped(at(&search.p, k), slot, t).truncate());
            }
        }
    }

    /// Lists the trials of one way.
    #[inline(always)]
    fn ask(&self, search: &mut Search, number: usize, way: Way, waiting: &mut Waiting) {
        let (slot, alone) = (&search.near.slot, &search.heads.alone);
        let (mut asked, mut froms) = ([false; LANES], ZERO3);
        match way {
            Way::Again => {
                froms = search.was;
                for k in 0..LANES {
                    asked[k] = (slot[k] != 0) & (froms[0][k] < NOWHERE.x);
                }
            }
            Way::OfSlot => {
                froms = search.guess;
                for k in 0..LANES {
                    asked[k] = (slot[k] != 0) & !search.stays[k];
                }
            }
            Way::OfHead => {
                froms = search.p;
                for k in 0..LANES {
                    asked[k] = search.others[k] & !search.stays[k];
                }
            }
            Way::Between => {
                for k in 0..LANES {
                    put(&mut froms, k, 0.5 * (at(&search.guess, k) + at(&search.p, k)));
                    asked[k] = (slot[k] != 0) & !search.stays[k];
                }
            }
        }
        if way != Way::Again {
            let close = (CLOSE * self.field.node_lattice().spacing).powi(2);
            for k in 0..LANES {
                // From close to a place that is known it would lead there.
                let (from, known) = (at(&froms, k), at(&search.tried, k));
                let untried = known.x >= NOWHERE.x;
                asked[k] &= untried | ((from - known).length_squared() >= close);
                put(&mut search.tried, k, choose(asked[k] & untried, from, known));
            }
        }
        let mut any = false;
        for k in 0..LANES {
            any |= asked[k];
        }
        if !any {
            return;
        }
        if way == Way::OfSlot {
            let nodes = Places::new(self.field.node_lattice(), self.inv_node, &froms);
            for k in 0..LANES {
                // It would lead to the skin that goes with the head, which is known.
                let first = nodes.first[k] as usize;
                asked[k] &= !(alone[k] && self.head_alone.get(first).is_some_and(|&own| own));
            }
        }
        for k in 0..LANES {
            if asked[k] {
                waiting.trials[waiting.count] = Trial {
                    search: number,
                    lane: k,
                    p: at(&search.p, k),
                    from: at(&froms, k),
                    slot: if way == Way::OfSlot { slot[k] } else { 0 },
                    alone: alone[k],
                };
                waiting.count += 1;
            }
        }
    }

    /// Tries a row of the ways that wait, the last ones.
    #[inline(always)]
    fn try_all(&self, searches: &mut [Search], way: Way, waiting: &mut Waiting, t: f32, reach: f32) {
        let first = waiting.count.saturating_sub(LANES);
        let trials = &waiting.trials[first..waiting.count];
        let (mut p, mut alone) = (ZERO3, [false; LANES]);
        let mut starts = Starts { asked: [false; LANES], guess: ZERO3, slot: [0; LANES] };
        for (k, trial) in trials.iter().enumerate() {
            put(&mut p, k, trial.p);
            put(&mut starts.guess, k, trial.from);
            (starts.asked[k], starts.slot[k], alone[k]) = (true, trial.slot, trial.alone);
        }
        let found = self.measure_skins(&p, &starts, &alone, t, reach);
        for (k, trial) in trials.iter().enumerate() {
            searches[trial.search].skins.learn(trial.lane, &found, k, way == Way::Again);
        }
        waiting.count = first;
    }
}

impl Skins {
    /// Takes what a trial has found, lane `of` of `found`, into `lane`: if it is nearer than what is known;
    /// where it only went on from the last place, if it is sure.
    #[inline(always)]
    fn learn(&mut self, lane: usize, found: &Self, of: usize, again: bool) {
        let nearer = !self.found[lane] | (found.distance[of] < self.distance[lane]);
        let taken = found.found[of] & if again { found.sure[of] } else { nearer };
        if !again || taken {
            self.nearest[lane] = lesser(self.nearest[lane], found.nearest[of]);
        }
        if taken {
            (self.found[lane], self.sure[lane]) = (true, found.sure[of]);
            (self.distance[lane], self.share[lane]) = (found.distance[of], found.share[of]);
            put(&mut self.normal, lane, at(&found.normal, of));
            put(&mut self.drift, lane, at(&found.drift, of));
            put(&mut self.rest, lane, at(&found.rest, of));
        }
    }
}
