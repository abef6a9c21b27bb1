//! Where the fragments of clusters go: into the list of a tile, or blended at once.

use crate::cpu::hair::list::{Fragment, Fragments};
use crate::cpu::tile::{HairPlanes, UNSEEN};

/// Receives fragments.
pub(super) trait Sink {
    /// Whether a fragment in the pixel at `at` could be seen.
    fn is_open(&self, at: usize) -> bool;
    /// Receives a fragment.
    fn take(&mut self, at: usize, fragment: Fragment);
}

impl Sink for Fragments {
    fn is_open(&self, _at: usize) -> bool {
        true
    }

    fn take(&mut self, at: usize, fragment: Fragment) {
        self.push(at, fragment);
    }
}

/// Blends fragments that come from near to far.
pub(super) struct Blend<'a>(pub &'a mut HairPlanes);

impl Sink for Blend<'_> {
    #[inline]
    fn is_open(&self, at: usize) -> bool {
        self.0.through[at] > UNSEEN
    }

    #[inline]
    fn take(&mut self, at: usize, fragment: Fragment) {
        let share = fragment.opacity() * self.0.through[at];
        for (plane, color) in self.0.color.iter_mut().zip(fragment.color) {
            plane[at] += share * color;
        }
        self.0.through[at] -= share;
    }
}
