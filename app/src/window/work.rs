//! When the work of the simulation's threads shows its progress.

use std::time::Duration;

/// Work that takes longer shows its progress.
pub(super) const SHOW_WORK: Duration = Duration::from_millis(150);
/// The same for hair that is loaded again and again while a control is dragged.
const SHOW_DRAGGED: Duration = Duration::from_millis(500);
/// How often shown progress is drawn again. The threads that work do not repaint the window while an image is drawn, which may take
/// seconds.
const DRAW_WORK: Duration = Duration::from_millis(100);

/// What the threads of the simulation do for a change.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Work {
    /// For how long they load, if they do.
    pub(super) loading: Option<Duration>,
    /// For how long they settle the hair, if they do.
    pub(super) settling: Option<Duration>,
    /// Whether it is not known yet what a change needs.
    pub(super) unknown: bool,
    /// Whether a load is shown from its beginning.
    pub(super) at_once: bool,
    /// Whether a control is being dragged.
    pub(super) dragged: bool,
    /// How long ago the change was made.
    pub(super) asked: Duration,
}

impl Work {
    /// Whether nothing is done or waits.
    pub(super) fn is_done(&self) -> bool {
        self.loading.is_none() && self.settling.is_none() && !self.unknown
    }

    /// Whether the progress of loading and of settling is shown, and after which time to look again. `seen` is whether one of the two was
    /// shown just before.
    pub(super) fn shown(&self, seen: bool) -> ([bool; 2], Option<Duration>) {
        // While a control is dragged, one change follows the other: each counts from its own beginning.
        let asked = if self.dragged { Duration::ZERO } else { self.asked };
        let patience = match (self.at_once, self.dragged) {
            (true, _) => Duration::ZERO,
            (false, true) => SHOW_DRAGGED,
            (false, false) => SHOW_WORK,
        };
        let left = |taken: Duration, patience: Duration| {
            if seen { Duration::ZERO } else { patience.saturating_sub(taken.max(asked)) }
        };
        let loading = self.loading.map(|taken| left(taken, patience));
        // What is loaded settles later.
        let settling = self.settling.filter(|_| loading.is_none()).map(|taken| left(taken, SHOW_WORK));
        let is_due = |left: Option<Duration>| left.is_some_and(|left| left.is_zero());
        // A bar that is shown is drawn again, and one that is due soon is not missed.
        let again = |left: Duration| if left.is_zero() { DRAW_WORK } else { left.min(DRAW_WORK) };
        let looks = [loading, settling].into_iter().flatten().map(again);
        ([is_due(loading), is_due(settling)], looks.chain(self.unknown.then_some(DRAW_WORK)).min())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    #[test]
    fn a_change_shows_its_progress_soon_whichever_thread_works() {
        let idle = Work::default();
        assert!(idle.is_done());
        assert_eq!(idle.shown(false), ([false; 2], None));
        // A change that waits for the simulation is looked at again, and has nothing to show yet.
        let unknown = Work { unknown: true, asked: ms(400), ..idle };
        assert_eq!(unknown.shown(false), ([false; 2], Some(DRAW_WORK)));
        // Load and settling together need no longer than one of them.
        let load = |taken, asked| Work { loading: Some(ms(taken)), asked: ms(asked), ..idle };
        let settle = |taken, asked| Work { settling: Some(ms(taken)), asked: ms(asked), ..idle };
        assert_eq!(load(60, 60).shown(false), ([false; 2], Some(ms(90))));
        assert_eq!(load(60, 160).shown(false), ([true, false], Some(DRAW_WORK)));
        assert_eq!(settle(10, 90).shown(false), ([false; 2], Some(ms(60))));
        assert_eq!(settle(10, 150).shown(false), ([false, true], Some(DRAW_WORK)));
        // What was shown goes over from one to the other without a gap; the settling to come is not shown before.
        assert_eq!(settle(0, 0).shown(true), ([false, true], Some(DRAW_WORK)));
        let both = Work { settling: Some(ms(0)), ..load(300, 300) };
        assert_eq!(both.shown(true), ([true, false], Some(DRAW_WORK)));
    }

    #[test]
    fn a_dragged_control_shows_only_loads_that_take_long_and_a_take_shows_at_once() {
        let dragged = Work { asked: ms(5000), dragged: true, ..Work::default() };
        let load = |taken| Work { loading: Some(ms(taken)), ..dragged };
        assert_eq!(load(300).shown(false), ([false; 2], Some(DRAW_WORK)));
        assert_eq!(load(500).shown(false), ([true, false], Some(DRAW_WORK)));
        let take = Work { loading: Some(ms(0)), at_once: true, ..Work::default() };
        assert_eq!(take.shown(false), ([true, false], Some(DRAW_WORK)));
    }
}
