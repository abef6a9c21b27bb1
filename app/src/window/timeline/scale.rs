//! The horizontal scale that the ruler, the thumbnails and the tracks share.

use egui::Rangef;

/// The mapping of times to positions on the screen.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    left: f32,
    pub(super) width: f32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Scale {
    /// The mapping of the times in `shown`, seconds, to the positions in `over`, points.
    pub(super) fn new(over: Rangef, shown: [f64; 2]) -> Self {
        Self { left: over.min, width: over.span(), from: shown[0], to: shown[1] }
    }

    /// The position of a time, points; up to a width beside the visible part.
    pub(super) fn x(&self, secs: f64) -> f32 {
        let span = (self.to - self.from).max(1e-9);
        self.left + self.width * (((secs - self.from) / span).clamp(-1.0, 2.0)) as f32
    }

    /// The position of a time, if it is visible.
    pub(super) fn x_of(&self, secs: f64) -> Option<f32> {
        (self.from..=self.to).contains(&secs).then(|| self.x(secs))
    }

    /// The positions of the first and the last visible time, points.
    pub(super) fn x_range(&self) -> Rangef {
        Rangef::new(self.left, self.left + self.width)
    }

    /// The time that a distance is long, seconds.
    pub(super) fn secs_of(&self, dx: f32) -> f64 {
        (self.to - self.from) * f64::from(dx / self.width.max(1.0))
    }

    /// The time at a position, seconds.
    pub(super) fn secs(&self, x: f32) -> f64 {
        let part = f64::from(((x - self.left) / self.width.max(1.0)).clamp(0.0, 1.0));
        self.from + (self.to - self.from) * part
    }
}
