//! The newest image of each pane as a texture of the window.

use std::sync::Arc;

use egui::{Color32, ColorImage, Painter, Rect, TextureHandle, TextureOptions, Vec2};
use lovelock_panes::request::LivePane;
use lovelock_project::project::CompareSection;

/// Screen pixels per image pixel from which on images are shown without interpolation.
const SHARP: f32 = 3.0;

/// The textures of the panes.
#[derive(Default)]
pub(super) struct PaneTextures {
    held: [Option<Held>; CompareSection::MOST_PANES],
}

struct Held {
    texture: TextureHandle,
    /// The image that was uploaded last.
    of: Arc<LivePane>,
    options: TextureOptions,
}

impl PaneTextures {
    /// Uploads the newest image of a pane; a pane without an image keeps its texture.
    pub(super) fn take(&mut self, ctx: &egui::Context, index: usize, pane: &Arc<LivePane>, magnified: f32) {
        let Some(slot) = self.held.get_mut(index) else { return };
        let options = if magnified >= SHARP { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
        if slot.as_ref().is_some_and(|held| Arc::ptr_eq(&held.of, pane) && held.options == options) {
            return;
        }
        let picture = &pane.picture;
        if picture.rgba.is_empty() {
            return;
        }
        // Images are opaque, so premultiplication leaves the bytes unchanged.
        let size = [picture.width as usize, picture.height as usize];
        let image = ColorImage::from_rgba_premultiplied(size, &picture.rgba);
        let of = Arc::clone(pane);
        match slot {
            Some(held) => {
                held.texture.set(image, options);
                (held.of, held.options) = (of, options);
            }
            none => {
                let texture = ctx.load_texture(format!("pane {index}"), image, options);
                *none = Some(Held { texture, of, options });
            }
        }
    }

    /// Size of a pane's image, pixels.
    pub(super) fn size(&self, index: usize) -> Option<Vec2> {
        self.held.get(index)?.as_ref().map(|held| held.texture.size_vec2())
    }

    /// Paints a pane's image. Returns false if there is none.
    pub(super) fn paint(&self, painter: &Painter, index: usize, place: Rect, shown: Rect) -> bool {
        let Some(held) = self.held.get(index).and_then(Option::as_ref) else { return false };
        painter.image(held.texture.id(), place, shown, Color32::WHITE);
        true
    }

    /// Drops the textures of removed panes.
    pub(super) fn keep(&mut self, panes: usize) {
        for slot in self.held.iter_mut().skip(panes) {
            *slot = None;
        }
    }
}
