//! The pages that the window shows between its panels, one at a time.

use serde::{Deserialize, Serialize};

/// What is shown between the panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Page {
    /// The image of the project.
    #[default]
    Image,
    /// The panes of the comparison.
    Compare,
    /// The wall of variants.
    Wall,
}

impl Page {
    /// Shows `page`, or the image if it is shown already.
    pub(crate) fn toggle(&mut self, page: Self) {
        *self = if *self == page { Self::Image } else { page };
    }
}
