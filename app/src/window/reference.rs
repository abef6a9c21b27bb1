//! The reference picture in the window: read on a thread, and laid over the image.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::{Color32, ColorImage, Context, Rect, TextureHandle, TextureOptions, Ui, Vec2, pos2};
use lovelock_appearance::environment::{BackdropPicture, BackdropPixels};
use lovelock_project::error::{Place, Problem};
use lovelock_project::files::{Access, FileRef};
use lovelock_project::project::ReferenceSection;

use super::theme;

/// The longest side of the texture, pixels: a larger picture is shown with every second or fewer of its pixels.
const LONGEST: usize = 2048;

/// What a thread has read.
type Answer = Result<ColorImage, String>;

/// The reference picture in the window.
#[derive(Default)]
pub(crate) struct Reference {
    /// What was asked for last.
    of: Option<(FileRef, Access)>,
    reading: Option<Receiver<Answer>>,
    texture: Option<TextureHandle>,
}

impl Reference {
    /// Reads the picture of the project if it is another one. Returns a message for the user.
    pub(crate) fn update(
        &mut self,
        section: &ReferenceSection,
        access: &Access,
        ctx: &Context,
    ) -> Option<String> {
        let wanted = section.file.clone().map(|file| (file, access.clone()));
        if self.of != wanted {
            (self.reading, self.texture) = (None, None);
            self.of.clone_from(&wanted);
            if let Some((file, access)) = wanted {
                match access.read(Place::Reference, &file) {
                    Ok(path) => self.reading = read(path, ctx),
                    Err(problem) => return Some(problem.message),
                }
            }
        }
        let answer = match self.reading.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Err("Reading the reference picture stopped.".to_owned()),
            Ok(answer) => answer,
        };
        self.reading = None;
        match answer {
            Ok(image) => {
                self.texture = Some(ctx.load_texture("reference", image, TextureOptions::LINEAR));
                None
            }
            Err(message) => Some(message),
        }
    }

    /// Lays the picture over the image at `place`.
    pub(crate) fn show(&self, ui: &Ui, section: &ReferenceSection, place: Rect) {
        let Some(texture) = self.texture.as_ref().filter(|_| section.shown && section.opacity > 0.0) else {
            return;
        };
        let size = section.fit.size(texture.size_vec2().into(), place.size().into());
        let rect = Rect::from_center_size(place.center(), Vec2::from(size));
        let [left, right] = if section.flip { [1.0, 0.0] } else { [0.0, 1.0] };
        let tint = Color32::WHITE.gamma_multiply(section.opacity.clamp(0.0, 1.0));
        let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        painter.image(texture.id(), rect, Rect::from_min_max(pos2(left, 0.0), pos2(right, 1.0)), tint);
    }

    /// Memory of the texture, bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.texture.as_ref().map_or(0, |texture| 4 * texture.size().iter().product::<usize>() as u64)
    }
}

/// Reads a picture on a thread; `None` if there can be no thread.
fn read(path: PathBuf, ctx: &Context) -> Option<Receiver<Answer>> {
    let (send, receive) = sync_channel(1);
    let ctx = ctx.clone();
    let work = move || {
        let picture = BackdropPicture::load(&path);
        let answer = picture.map(|picture| image_of(&picture)).map_err(|error| {
            Problem::not_loaded(Place::Reference, error).with_fallback("no reference is shown").message
        });
        let _ = send.send(answer);
        super::images::wake(&ctx);
    };
    std::thread::Builder::new().name("reference".to_owned()).spawn(work).ok().map(|_| receive)
}

/// The picture as egui shows it.
fn image_of(picture: &BackdropPicture) -> ColorImage {
    let [width, height] = picture.size().map(|side| side as usize);
    let step = width.max(height).div_ceil(LONGEST).max(1);
    let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
    let at = |x: usize, y: usize| y * step * width + x * step;
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let pixels = match picture.pixels() {
        BackdropPixels::Display(pixels) => places
            .map(|(x, y)| {
                let [r, g, b, a] = pixels[at(x, y)];
                theme::of_picture([r, g, b, a])
            })
            .collect(),
        BackdropPixels::Light(pixels) => places
            .map(|(x, y)| {
                let [r, g, b] = pixels[at(x, y)].map(|light| {
                    let shown = light / (1.0 + light);
                    (255.0 * shown.max(0.0).powf(1.0 / 2.2) + 0.5) as u8
                });
                theme::from_srgb([r, g, b])
            })
            .collect(),
    };
    ColorImage::new([columns, rows], pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_picture_is_thinned_out_and_keeps_its_shape() {
        let size = [5000, 100];
        let pixels = (0..5000 * 100).map(|i| [(i % 5000 / 20) as u8, 7, 9, 255]).collect();
        let picture = BackdropPicture::from_pixels(size, BackdropPixels::Display(pixels)).expect("a picture");
        let image = image_of(&picture);
        assert_eq!(image.size, [1667, 34]);
        assert_eq!((image.pixels[0].r(), image.pixels[1666].r(), image.pixels[0].g()), (0, 249, 7));
    }
}
