//! The search for skin that is moved by other joints than the head. Only some lanes of a row are near such
//! skin; those of all rows of a block are measured together, sixteen at a time.

use glam::Vec3;

use super::occupancy::Near;
use super::planes::{NOWHERE, PlaneRow};
use super::rows::{HeadSkinRow, Places};
use super::skins::{SkinRow, Starts};
use super::{MovingField, SAME_START};
use crate::lanes::{LANES, Lane, Lane3, ZERO3, at, choose, lesser, put, splat3};

/// A row of points for which skin is searched, in head space.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    /// Index of the row in the list that was passed in.
    pub(super) row: usize,
    pub(super) p: Lane3,
    /// The lanes to be searched.
    pub(super) asked: [bool; LANES],
    pub(super) near: Near,
    /// Lower bound of the distance to the next cell, metres.
    pub(super) to_next: Lane,
    pub(super) heads: HeadSkinRow,
    /// Whether any lane may find skin that other joints move.
    pub(super) any: bool,
    /// Lanes near the head whose place is not moved by the head alone.
    others: [bool; LANES],
    /// Rest positions where such skin was last found, and whether that was in this step.
    was: Lane3,
    in_this_step: [bool; LANES],
    /// Whether the points stay on their side of a fold.
    stays: [bool; LANES],
    /// Rest positions according to the nearest other joints.
    guess: Lane3,
    /// A starting point that has been tried.
    tried: Lane3,
    /// The skin found so far.
    pub(super) skins: SkinRow,
}

/// An attempt to find a rest position: for which point, and from which starting point.
#[derive(Clone, Copy)]
struct Trial {
    search: usize,
    lane: usize,
    p: Vec3,
    from: Vec3,
    slot: u16,
    alone: bool,
}

/// Where the iteration for the rest position starts. Folded skin has several rest positions.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Start {
    /// The rest position found last, in this step or the one before.
    Previous,
    /// The rest position according to the nearest other joints.
    Slot,
    /// The rest position according to the head.
    Head,
    /// Halfway between those two.
    Between,
}

impl Start {
    const ALL: [Self; 4] = [Self::Previous, Self::Slot, Self::Head, Self::Between];
}

/// Queued trials: a full row, and those that one more row of points may add.
struct TrialQueue {
    trials: [Trial; 2 * LANES],
    count: usize,
}

impl MovingField {
    /// Starts the search of the lanes `asked` of the row `p`, which has index `row`: looks up the cells and
    /// measures the skin that moves with the head.
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
        let heads = self.measure_head_skin(p, &near.head, reach);
        let (mut others, mut in_this_step, mut any) = ([false; LANES], [false; LANES], false);
        for k in 0..LANES {
            others[k] = near.head[k] & !heads.alone[k];
            in_this_step[k] = planes.valid_squared[k] >= 0.0;
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
            skins: SkinRow::NONE,
        }
    }

    /// Searches skin that is moved by other joints than the head, at the fraction `t` of the step. Skin
    /// further away than `reach` is ignored.
    #[inline(always)]
    pub(super) fn find_skins(&self, searches: &mut [Search], t: f32, reach: f32) {
        let none = Trial { search: 0, lane: 0, p: Vec3::ZERO, from: Vec3::ZERO, slot: 0, alone: false };
        let mut queue = TrialQueue { trials: [none; 2 * LANES], count: 0 };
        for start in Start::ALL {
            for next in 0..=searches.len() {
                if let Some(search) = searches.get_mut(next) {
                    if start == Start::Slot {
                        self.prepare_starts(search, t);
                    }
                    self.queue_trials(search, next, start, &mut queue);
                }
                let last = next == searches.len();
                while queue.count >= LANES || (last && queue.count > 0) {
                    self.run_trials(searches, start, &mut queue, t, reach);
                }
            }
        }
    }

    /// Prepares the remaining starting points once the previous rest positions have been tried.
    #[inline(always)]
    fn prepare_starts(&self, search: &mut Search, t: f32) {
        search.tried = search.skins.rest;
        for k in 0..LANES {
            // Within a step a point stays on its side of a fold.
            search.stays[k] = (search.skins.rest[0][k] < NOWHERE.x) & search.in_this_step[k];
            let slot = search.near.slot[k];
            if slot != 0 && !search.stays[k] {
                put(&mut search.guess, k, self.mapped(at(&search.p, k), slot, t).truncate());
            }
        }
    }

    /// Queues the trials of one kind of starting point.
    #[inline(always)]
    fn queue_trials(&self, search: &mut Search, number: usize, start: Start, queue: &mut TrialQueue) {
        let (slot, alone) = (&search.near.slot, &search.heads.alone);
        let (mut asked, mut froms) = ([false; LANES], ZERO3);
        match start {
            Start::Previous => {
                froms = search.was;
                for k in 0..LANES {
                    asked[k] = (slot[k] != 0) & (froms[0][k] < NOWHERE.x);
                }
            }
            Start::Slot => {
                froms = search.guess;
                for k in 0..LANES {
                    asked[k] = (slot[k] != 0) & !search.stays[k];
                }
            }
            Start::Head => {
                froms = search.p;
                for k in 0..LANES {
                    asked[k] = search.others[k] & !search.stays[k];
                }
            }
            Start::Between => {
                for k in 0..LANES {
                    put(&mut froms, k, 0.5 * (at(&search.guess, k) + at(&search.p, k)));
                    asked[k] = (slot[k] != 0) & !search.stays[k];
                }
            }
        }
        if start != Start::Previous {
            let close = (SAME_START * self.field.node_lattice().spacing).powi(2);
            for k in 0..LANES {
                // A starting point close to a known rest position would lead there again.
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
        if start == Start::Slot {
            let nodes = Places::new(self.field.node_lattice(), self.inv_node, &froms);
            for k in 0..LANES {
                // It would lead to the skin that moves with the head, which is known.
                let first = nodes.first[k] as usize;
                asked[k] &= !(alone[k] && self.head_alone.get(first).is_some_and(|&own| own));
            }
        }
        for k in 0..LANES {
            if asked[k] {
                queue.trials[queue.count] = Trial {
                    search: number,
                    lane: k,
                    p: at(&search.p, k),
                    from: at(&froms, k),
                    slot: if start == Start::Slot { slot[k] } else { 0 },
                    alone: alone[k],
                };
                queue.count += 1;
            }
        }
    }

    /// Runs the last row of the queued trials.
    #[inline(always)]
    fn run_trials(&self, searches: &mut [Search], start: Start, queue: &mut TrialQueue, t: f32, reach: f32) {
        let first = queue.count.saturating_sub(LANES);
        let trials = &queue.trials[first..queue.count];
        let (mut p, mut alone) = (ZERO3, [false; LANES]);
        let mut starts = Starts { asked: [false; LANES], guess: ZERO3, slot: [0; LANES] };
        for (k, trial) in trials.iter().enumerate() {
            put(&mut p, k, trial.p);
            put(&mut starts.guess, k, trial.from);
            (starts.asked[k], starts.slot[k], alone[k]) = (true, trial.slot, trial.alone);
        }
        let found = self.measure_skins(&p, &starts, &alone, t, reach);
        for (k, trial) in trials.iter().enumerate() {
            searches[trial.search].skins.merge(trial.lane, &found, k, start == Start::Previous);
        }
        queue.count = first;
    }
}

impl SkinRow {
    /// Merges lane `of` of `found` into `lane` if it is nearer than the known skin or, for a trial from the
    /// previous rest position, if it is certain.
    #[inline(always)]
    fn merge(&mut self, lane: usize, found: &Self, of: usize, from_previous: bool) {
        let nearer = !self.found[lane] | (found.distance[of] < self.distance[lane]);
        let taken = found.found[of] & if from_previous { found.sure[of] } else { nearer };
        if !from_previous || taken {
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
