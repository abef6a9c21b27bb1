//! The newest image of each pane on the screen.

use egui::{Color32, Context, Painter, Rect, Vec2};
use lovelock_panes::request::LivePane;
use lovelock_project::project::CompareSection;

use crate::window::images::{ShownImage, Textures};

/// Screen pixels per image pixel from which on images are shown without interpolation.
const SHARP: f32 = 3.0;

/// The images of the panes.
#[derive(Default)]
pub(super) struct PaneTextures {
    held: [ShownImage; CompareSection::MAX_PANES],
}

impl PaneTextures {
    /// Takes the newest image of a pane; a pane without an image keeps the one before.
    pub(super) fn take(
        &mut self,
        ctx: &Context,
        textures: &Textures,
        index: usize,
        pane: &LivePane,
        magnified: f32,
    ) {
        if let Some(slot) = self.held.get_mut(index) {
            slot.set(ctx, textures, &format!("pane {index}"), &pane.image, magnified >= SHARP);
        }
    }

    /// Size of a pane's image, pixels.
    pub(super) fn size(&self, index: usize) -> Option<Vec2> {
        self.held.get(index)?.size()
    }

    /// Paints a pane's image. Returns false if there is none.
    pub(super) fn paint(&self, painter: &Painter, index: usize, place: Rect, shown: Rect) -> bool {
        let Some(texture) = self.held.get(index).and_then(ShownImage::texture) else { return false };
        painter.image(texture, place, shown, Color32::WHITE);
        true
    }

    /// Drops the images of all panes from this one on.
    pub(super) fn keep(&mut self, panes: usize) {
        self.held.iter_mut().skip(panes).for_each(ShownImage::forget);
    }
}
