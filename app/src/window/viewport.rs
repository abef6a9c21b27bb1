//! The image in the window.

use egui::{Align2, Color32, FontId, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};
use lovelock_render::Backend;
use lovelock_session::render_thread::{Adapter, RenderedImage};

use super::images::{ShownImage, Textures};
use super::theme;

/// The most pixels that are rendered for a pane, so that the image updates often enough for styling: a graphics card renders
/// every pixel, the CPU fewer, and a software adapter fewer still.
pub(crate) fn most_pixels(adapter: Option<&Adapter>) -> f32 {
    match adapter {
        Some(adapter) if !adapter.software => f32::INFINITY,
        Some(adapter) if adapter.backend == Backend::Gpu => 640.0 * 400.0,
        _ => 1280.0 * 720.0,
    }
}

/// The most pixels that are rendered while nothing moves. Only a software adapter is too slow for every pixel even then.
pub(crate) fn most_pixels_at_rest(adapter: Option<&Adapter>) -> f32 {
    match adapter {
        Some(adapter) if adapter.software && adapter.backend == Backend::Gpu => 1280.0 * 720.0,
        _ => f32::INFINITY,
    }
}

/// The image in the window.
#[derive(Default)]
pub(crate) struct Viewport {
    shown: ShownImage,
    /// Requested size of images, pixels.
    pub(crate) wanted: [u32; 2],
    /// The size of the film whose frame is shown, pixels; no frame is shown without it.
    pub(crate) film: Option<[u32; 2]>,
}

impl Viewport {
    /// Shows the newest image over the whole of `ui`. `most_pixels` is the number of pixels that the adapter renders quickly, `scale`
    /// the number of rendered pixels per screen pixel (0 is automatic).
    pub(crate) fn show(
        &mut self,
        ui: &mut Ui,
        (painted, textures): (Option<&RenderedImage>, &Textures),
        most_pixels: f32,
        scale: f32,
    ) -> Response {
        // No control: Tab passes it by, and keys are shortcuts while nothing else has the focus.
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::CLICK | Sense::DRAG);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Viewport"));
        let pixels_per_point = ui.ctx().pixels_per_point();
        self.wanted = size_for(image_size(rect.size(), self.film), pixels_per_point, most_pixels, scale);
        if let Some(painted) = painted {
            self.shown.set(ui.ctx(), textures, "picture", &painted.image, false);
        }
        let painter = ui.painter_at(rect);
        let place = self.place(rect);
        // No background is painted if the image fills the viewport.
        if place.is_none_or(|place| !place.expand(1.0).contains_rect(rect)) {
            painter.rect_filled(rect, 0.0, theme::page());
        }
        if let (Some(texture), Some(place)) = (self.shown.texture(), place) {
            painter.image(texture, place, Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), Color32::WHITE);
        } else {
            painter.text(
                rect.center(),
                Align2::CENTER_CENTER,
                "Getting ready…",
                FontId::proportional(15.0),
                theme::quiet(),
            );
        }
        if let (Some(film), Some(place)) = (self.film, place) {
            frame(ui, rect, film_in(place, film), film);
        }
        response
    }

    /// The position of the image in `rect`; `None` before there is one.
    pub(crate) fn place(&self, rect: Rect) -> Option<Rect> {
        self.shown.size().map(|size| fit(size, rect))
    }

    /// Forgets the image, whose device is lost.
    pub(crate) fn forget_image(&mut self) {
        self.shown.forget();
    }

    /// A line of text in a corner of the image. Returns its place.
    pub(crate) fn caption(ui: &Ui, rect: Rect, align: Align2, text: &str, color: Color32) -> Rect {
        if text.is_empty() {
            return Rect::NOTHING;
        }
        let at = match align {
            Align2::LEFT_BOTTOM => rect.left_bottom() + Vec2::new(10.0, -8.0),
            Align2::RIGHT_BOTTOM => rect.right_bottom() + Vec2::new(-10.0, -8.0),
            Align2::RIGHT_TOP => rect.right_top() + Vec2::new(-10.0, 8.0),
            _ => rect.left_top() + Vec2::new(10.0, 8.0),
        };
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        let galley = painter.layout(text.to_owned(), FontId::proportional(11.5), color, rect.width() - 24.0);
        let place = align.anchor_size(at, galley.size());
        painter.rect_filled(place.expand(4.0), 4.0, theme::behind_text());
        painter.galley(place.min, galley, color);
        place
    }
}

/// The size of the image in a viewport of `size`: with the frame of a film that is wider than the viewport, that of the film, so that
/// all of it is visible. Image and film show the same height of the scene.
fn image_size(size: Vec2, film: Option<[u32; 2]>) -> Vec2 {
    let of_film = film.map(|[width, height]| vec2(width.max(1) as f32, height.max(1) as f32));
    let wider = of_film.filter(|film| film.x * size.y > size.x * film.y);
    wider.map_or(size, |film| fit(film, Rect::from_min_size(Pos2::ZERO, size)).size())
}

/// The part of an image at `place` that a film shows.
fn film_in(place: Rect, [width, height]: [u32; 2]) -> Rect {
    fit(vec2(width.max(1) as f32, height.max(1) as f32), place)
}

/// The frame of a film: its border, and what is outside of it dimmed.
fn frame(ui: &Ui, rect: Rect, film: Rect, [width, height]: [u32; 2]) {
    let painter = ui.painter_at(rect);
    let left_of = |x: f32| Rect::from_min_max(rect.min, pos2(x, rect.bottom()));
    let right_of = |x: f32| Rect::from_min_max(pos2(x, rect.top()), rect.max);
    let above = Rect::from_min_max(pos2(film.left(), rect.top()), film.right_top());
    let below = Rect::from_min_max(film.left_bottom(), pos2(film.right(), rect.bottom()));
    for outside in [left_of(film.left()), right_of(film.right()), above, below] {
        painter.rect_filled(outside, 0.0, theme::page().gamma_multiply(0.7));
    }
    painter.rect_stroke(film, 0.0, Stroke::new(1.0, theme::recording()), StrokeKind::Inside);
    let text = format!("Film {width} × {height}");
    let at = film.center_bottom() - vec2(0.0, 6.0);
    painter.text(at, Align2::CENTER_BOTTOM, text, FontId::proportional(10.5), theme::recording());
}

/// Pixels for a viewport of `size` points.
pub(crate) fn size_for(size: Vec2, pixels_per_point: f32, most_pixels: f32, scale: f32) -> [u32; 2] {
    let pixels = size * pixels_per_point;
    let scale =
        if scale > 0.0 { scale } else { (most_pixels / (pixels.x * pixels.y).max(1.0)).sqrt().min(1.0) };
    let side = |v: f32| if v.is_finite() { (v * scale).round().clamp(16.0, 8192.0) as u32 } else { 16 };
    [side(pixels.x), side(pixels.y)]
}

/// The largest centred rectangle in `rect` with the aspect ratio of `size`.
pub(crate) fn fit(size: Vec2, rect: Rect) -> Rect {
    let scale = (rect.width() / size.x.max(1.0)).min(rect.height() / size.y.max(1.0));
    Rect::from_center_size(rect.center(), size * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_of_a_film_shows_the_same_height_as_the_image() {
        let view = vec2(800.0, 600.0);
        assert_eq!(image_size(view, None), view);
        // Narrower than the viewport: the image stays, and the frame is inside it.
        let square = Some([1080, 1080]);
        assert_eq!(image_size(view, square), view);
        let frame = film_in(Rect::from_min_size(Pos2::ZERO, view), [1080, 1080]);
        assert_eq!((frame.left(), frame.right(), frame.height()), (100.0, 700.0, 600.0));
        // Wider: the image is the film's, so that its sides are visible too.
        let wide = Some([1920, 1080]);
        let image = image_size(view, wide);
        assert_eq!(image, vec2(800.0, 450.0));
        let place = fit(image, Rect::from_min_size(Pos2::ZERO, view));
        assert_eq!(film_in(place, [1920, 1080]), place);
        assert_eq!(image_size(view, Some([0, 0])), view, "a size that a file may hold");
    }

    #[test]
    fn the_processor_draws_fewer_pixels_of_the_same_shape() {
        let software = Adapter { name: String::new(), backend: Backend::Gpu, software: true };
        let [w, h] = size_for(Vec2::new(1280.0, 800.0), 1.0, most_pixels(Some(&software)), 0.0);
        assert!((w * h) as f32 <= 640.0 * 400.0 * 1.01);
        let card = most_pixels(Some(&Adapter { software: false, ..software }));
        assert!((w as f32 / h as f32 - 1.6).abs() < 0.01);
        assert_eq!(size_for(Vec2::new(1280.0, 800.0), 2.0, card, 0.0), [2560, 1600]);
        assert_eq!(size_for(Vec2::new(100.0, 50.0), 1.0, card, 0.5), [50, 25]);
        assert_eq!(size_for(Vec2::new(f32::NAN, 0.0), 1.0, card, 0.0)[1], 16);
    }

    #[test]
    fn a_picture_keeps_its_proportions() {
        let place =
            fit(Vec2::new(200.0, 100.0), Rect::from_min_size(pos2(0.0, 0.0), Vec2::new(400.0, 400.0)));
        assert_eq!(place.size(), Vec2::new(400.0, 200.0));
    }
}
