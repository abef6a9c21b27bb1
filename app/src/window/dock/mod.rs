//! Where the panels are: in a column beside the image, floating over it, or in a second window.

mod arrangement;
mod column;
mod floating;
mod headers;
mod held;
mod menu;
mod second;

pub(crate) use arrangement::{Arrangement, Place, Spot};
pub(crate) use column::{column, reset_widths};
pub(crate) use floating::floating;
pub(crate) use headers::Column;
pub(crate) use held::drop_held;
pub(crate) use menu::{menu, places};
pub(crate) use second::{SecondWindow, second_window};

/// A panel and where it is moved to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Move {
    pub(crate) title: &'static str,
    pub(crate) place: Place,
}

impl Move {
    /// Moves the panel.
    pub(crate) fn apply(self, arrangement: &mut Arrangement, ctx: &egui::Context) {
        if let Place::Floating(Some(corner)) = self.place {
            floating::begin_at(ctx, self.title, corner);
        }
        arrangement.set(self.title, self.place, crate::window::shelf::Panels::usual());
    }
}

impl crate::window::Window {
    /// Returns every panel to its usual place and size.
    pub(super) fn reset_layout(&mut self, ctx: &egui::Context) {
        self.layout.dock = Arrangement::default();
        self.layout.tracks_height = None;
        self.layout.panels_hidden = false;
        ctx.memory_mut(egui::Memory::reset_areas);
        reset_widths(ctx);
    }
}
