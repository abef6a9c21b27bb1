//! The part of the timeline that is visible.

use serde::{Deserialize, Serialize};

/// The shortest visible part, seconds: a quarter of a second is fifteen frames.
const LEAST_SECS: f64 = 0.25;

/// The visible part of the timeline, as fractions of its length, so that it is kept when the length changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Zoom {
    start: f64,
    end: f64,
}

impl Default for Zoom {
    fn default() -> Self {
        Self { start: 0.0, end: 1.0 }
    }
}

impl Zoom {
    /// The first and the last visible time of a dance of `duration` seconds.
    pub(super) fn shown(self, duration: f64) -> [f64; 2] {
        let Self { start, end } = self.inside();
        [start * duration, end * duration]
    }

    /// Scales the visible part by `factor`; the point `at` (0 to 1 of the visible part) stays in place.
    pub(super) fn by(&mut self, factor: f64, at: f64, duration: f64) {
        let Self { start, end } = self.inside();
        let least = (LEAST_SECS / duration.max(1e-9)).min(1.0);
        let span = ((end - start) * factor).clamp(least, 1.0);
        let fixed = start + (end - start) * at.clamp(0.0, 1.0);
        let start = (fixed - span * at.clamp(0.0, 1.0)).clamp(0.0, 1.0 - span);
        *self = Self { start, end: start + span };
    }

    /// Moves by a fraction of the visible part.
    pub(super) fn pan(&mut self, by: f64) {
        let Self { start, end } = self.inside();
        let span = end - start;
        let start = (start + by * span).clamp(0.0, 1.0 - span);
        *self = Self { start, end: start + span };
    }

    /// A valid part of the timeline, whatever was stored.
    fn inside(self) -> Self {
        let good = self.start.is_finite() && self.end.is_finite() && self.end - self.start > 1e-9;
        if good && self.start >= 0.0 && self.end <= 1.0 + 1e-9 { self } else { Self::default() }
    }
}

/// Numbers of the ruler that are nearer than this are frames, seconds.
pub(super) const FRAMES_BELOW_SECS: f64 = 0.09;

/// Seconds between two numbers of the ruler: the finest of frames, `fps` per second, and round times at which numbers do not overlap.
pub(super) fn tick_secs(points_per_sec: f64, room: f64, fps: f64) -> f64 {
    const FRAMES: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
    const STEPS: [f64; 14] =
        [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 1800.0, 3600.0, 36000.0];
    let frames = FRAMES.map(|frames| frames / fps.max(1e-3));
    let steps = frames.into_iter().filter(|step| *step < FRAMES_BELOW_SECS).chain(STEPS);
    let mut steps = steps.filter(|step| step * points_per_sec >= room);
    steps.next().unwrap_or(360_000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zooming_keeps_the_time_under_the_pointer_and_stays_inside() {
        let mut zoom = Zoom::default();
        let under = |zoom: Zoom, at: f64| {
            let [from, to] = zoom.shown(100.0);
            from + (to - from) * at
        };
        zoom.by(0.5, 0.25, 100.0);
        assert!((under(zoom, 0.25) - 25.0).abs() < 1e-9, "{zoom:?}");
        assert_eq!(zoom.shown(100.0), [12.5, 62.5]);
        zoom.pan(10.0);
        assert_eq!(zoom.shown(100.0), [50.0, 100.0]);
        for _ in 0..40 {
            zoom.by(0.5, 1.0, 100.0);
        }
        let [from, to] = zoom.shown(100.0);
        assert!((to - from - LEAST_SECS).abs() < 1e-6 && to <= 100.0 + 1e-6, "{from} to {to}");
        for _ in 0..40 {
            zoom.by(2.0, 0.3, 100.0);
        }
        assert_eq!(zoom.shown(100.0), [0.0, 100.0]);
    }

    #[test]
    fn a_zoom_that_makes_no_sense_shows_everything() {
        for (start, end) in [(f64::NAN, 1.0), (0.5, 0.5), (-1.0, 0.5), (0.0, 2.0), (0.9, 0.1)] {
            assert_eq!(Zoom { start, end }.shown(8.0), [0.0, 8.0]);
        }
    }

    #[test]
    fn ticks_are_frames_when_near_and_hours_when_far() {
        assert_eq!(tick_secs(6000.0, 40.0, 60.0), 1.0 / 60.0);
        assert_eq!(tick_secs(6000.0, 40.0, 24.0), 1.0 / 24.0);
        assert_eq!(tick_secs(600.0, 40.0, 24.0), 2.0 / 24.0);
        assert_eq!(tick_secs(6000.0, 40.0, 1.0), 0.1, "seconds where frames are longer");
        assert_eq!(tick_secs(100.0, 40.0, 30.0), 0.5);
        assert_eq!(tick_secs(41.0, 40.0, 30.0), 1.0);
        assert_eq!(tick_secs(0.01, 40.0, 30.0), 36_000.0);
        assert_eq!(tick_secs(0.0, 40.0, 30.0), 360_000.0);
    }
}
