//! The grids of a build that no worker uses at the moment.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::grid::Grid;

/// Grids that workers take and give back. The first one is taken first and whatever was given back last comes next, so that as few
/// grids are used as there are workers at a time.
pub(super) struct FreeGrids<'a> {
    state: Mutex<State<'a>>,
}

struct State<'a> {
    /// Grids that were used in this build.
    warm: Vec<TakenGrid<'a>>,
    /// The others, first ones first.
    new: std::slice::IterMut<'a, Grid>,
    /// Number of grids that were taken from `new`.
    used: usize,
}

/// A grid of one worker.
pub(super) struct TakenGrid<'a> {
    pub grid: &'a mut Grid,
    /// Whether it still holds a former build.
    pub is_new: bool,
}

impl<'a> FreeGrids<'a> {
    pub(super) fn new(grids: &'a mut [Grid]) -> Self {
        let state = State { warm: Vec::with_capacity(grids.len()), new: grids.iter_mut(), used: 0 };
        Self { state: Mutex::new(state) }
    }

    /// Takes a grid.
    ///
    /// # Panics
    /// If all are taken: there must be as many grids as workers.
    pub(super) fn take(&self) -> TakenGrid<'a> {
        let mut state = self.lock();
        if let Some(taken) = state.warm.pop() {
            return taken;
        }
        let Some(grid) = state.new.next() else { panic!("more workers than grids") };
        state.used += 1;
        TakenGrid { grid, is_new: true }
    }

    /// Returns a grid for other workers.
    pub(super) fn give_back(&self, taken: TakenGrid<'a>) {
        self.lock().warm.push(taken);
    }

    /// The number of grids that were used, the first ones.
    pub(super) fn used(self) -> usize {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner).used
    }

    fn lock(&self) -> MutexGuard<'_, State<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::Layout;
    use super::*;

    #[test]
    fn one_worker_at_a_time_uses_one_grid_and_two_use_two() {
        let layout = Layout::new(16);
        let mut grids: Vec<Grid> = (0..3).map(|_| Grid::new(&layout)).collect();
        let free = FreeGrids::new(&mut grids);
        for at in 0..5 {
            let taken = free.take();
            assert_eq!(taken.is_new, at == 0);
            free.give_back(TakenGrid { is_new: false, ..taken });
        }
        assert_eq!(free.used(), 1);
        let free = FreeGrids::new(&mut grids);
        let taken = [free.take(), free.take()];
        for taken in taken {
            free.give_back(taken);
        }
        assert_eq!(free.used(), 2);
    }

    #[test]
    #[should_panic(expected = "more workers than grids")]
    fn a_worker_without_a_grid_is_an_error_and_no_endless_wait() {
        let mut grids = [Grid::new(&Layout::new(16))];
        let free = FreeGrids::new(&mut grids);
        let _taken = free.take();
        free.take();
    }
}
