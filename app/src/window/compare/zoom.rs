//! The magnified part of the images, which is the same for every pane.

use egui::{PointerButton, Pos2, Rect, Response, Vec2, pos2};

/// The part of the images that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zoom {
    /// The magnification.
    factor: f32,
    /// The middle of the visible part, as fractions of the image.
    middle: Pos2,
}

impl Default for Zoom {
    fn default() -> Self {
        Self { factor: 1.0, middle: pos2(0.5, 0.5) }
    }
}

impl Zoom {
    /// The largest magnification, at which a pixel is as large as a button.
    const MAX: f32 = 24.0;

    /// Whether only a part is visible.
    pub(crate) fn is_on(&self) -> bool {
        self.factor > 1.001
    }

    /// The magnification.
    pub(crate) fn factor(&self) -> f32 {
        self.factor
    }

    /// The visible part, as fractions of the image.
    pub(crate) fn shown(&self) -> Rect {
        Rect::from_center_size(self.middle, Vec2::splat(1.0 / self.factor))
    }

    /// The position on the screen of a point of the image, which fills `place` at magnification 1.
    pub(crate) fn to_screen(self, place: Rect, at: Pos2) -> Pos2 {
        place.lerp_inside(((at - self.shown().min) * self.factor).to_pos2().to_vec2())
    }

    /// The point of the image at a position on the screen.
    pub(crate) fn at(self, place: Rect, at: Pos2) -> Pos2 {
        self.shown().min + (at - place.min) / place.size().max(Vec2::splat(1.0)) / self.factor
    }

    /// Multiplies the magnification; the point under `at` stays in place.
    pub(crate) fn magnify(&mut self, place: Rect, at: Pos2, by: f32) {
        if !by.is_finite() {
            return;
        }
        let fixed = self.at(place, at);
        self.factor = (self.factor * by).clamp(1.0, Self::MAX);
        self.shift(fixed - self.at(place, at));
    }

    /// Moves the visible part by fractions of the image.
    fn shift(&mut self, by: Vec2) {
        let half = 0.5 / self.factor;
        let (low, high) = (half, (1.0 - half).max(half));
        self.middle = (self.middle + by).clamp(pos2(low, low), pos2(high, high));
    }

    /// Applies the pointer's input over a pane. Returns whether a drag moved the visible part, so that it does not also move the
    /// camera.
    pub(crate) fn apply(&mut self, response: &Response, place: Rect) -> bool {
        if response.hovered()
            && let Some(at) = response.hover_pos()
        {
            let by = response.ctx.input(egui::InputState::zoom_delta);
            if by != 1.0 {
                self.magnify(place, at, by);
            }
        }
        let shift = response.ctx.input(|input| input.modifiers.shift);
        let aside = response.dragged_by(PointerButton::Middle)
            || response.dragged_by(PointerButton::Secondary)
            || (shift && response.dragged_by(PointerButton::Primary));
        if !(aside && self.is_on()) {
            return false;
        }
        self.shift(-response.drag_delta() / place.size().max(Vec2::splat(1.0)) / self.factor);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_under_the_pointer_stays_and_nothing_leaves_the_picture() {
        let place = Rect::from_min_size(pos2(100.0, 50.0), Vec2::new(400.0, 200.0));
        let mut zoom = Zoom::default();
        assert_eq!(zoom.shown(), Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)));
        let at = pos2(180.0, 100.0);
        let before = zoom.at(place, at);
        zoom.magnify(place, at, 4.0);
        assert!((zoom.at(place, at) - before).length() < 1e-5);
        assert!((zoom.to_screen(place, before) - at).length() < 1e-3);
        for by in [7.0, f32::NAN, 1e9, -3.0, 0.0] {
            zoom.magnify(place, pos2(1e4, -1e4), by);
            let shown = zoom.shown();
            assert!(
                shown.min.x >= -1e-6 && shown.max.x <= 1.0 + 1e-6 && shown.is_finite(),
                "{by}: {shown:?}"
            );
        }
        assert_eq!(zoom, Zoom::default(), "back at the whole");
    }
}
