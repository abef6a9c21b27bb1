//! The scale of the interface, beside that of the system.

use std::ops::RangeInclusive;

use egui::{Context, Vec2, vec2};

/// The scales that can be chosen, as factors.
pub(crate) const RANGE: RangeInclusive<f32> = 0.75..=3.0;

/// The scales that keys go through.
const STEPS: [f32; 11] = [0.75, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0];

/// The least room that the window needs, points: with panels at both sides of the image, and without them.
const ROOM: Vec2 = vec2(760.0, 420.0);
const ROOM_WITHOUT_PANELS: Vec2 = vec2(420.0, 280.0);

/// The next larger scale.
pub(super) fn larger(scale: f32) -> f32 {
    STEPS.into_iter().find(|step| *step > scale + 0.01).unwrap_or(*RANGE.end())
}

/// The next smaller scale.
pub(super) fn smaller(scale: f32) -> f32 {
    STEPS.into_iter().rev().find(|step| *step < scale - 0.01).unwrap_or(*RANGE.start())
}

/// A stored scale within its range.
pub(super) fn clamped(scale: f32) -> f32 {
    if scale.is_finite() { scale.clamp(*RANGE.start(), *RANGE.end()) } else { 1.0 }
}

/// The scale that a window of a size, in points at scale 1, has room for.
fn fitting(scale: f32, size: Vec2, panels_hidden: bool) -> f32 {
    let room = if panels_hidden { ROOM_WITHOUT_PANELS } else { ROOM };
    let most = (size / room).min_elem().max(*RANGE.start());
    clamped(scale).min(most)
}

/// Gives the window the chosen scale, as far as it has room for it. Returns the scale that it has.
pub(super) fn apply(ctx: &Context, scale: f32, panels_hidden: bool) -> f32 {
    let now = ctx.zoom_factor();
    let size = ctx.content_rect().size() * now;
    let wanted = fitting(scale, size, panels_hidden);
    // In steps of one percent, so that rounding of the size cannot make it change in every pass.
    let wanted = (wanted * 100.0).floor() / 100.0;
    if (wanted - now).abs() > 0.005 {
        ctx.set_zoom_factor(wanted);
    }
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_go_through_all_steps_and_stay_in_the_range() {
        let mut scale = 1.0;
        for _ in 0..20 {
            scale = larger(scale);
        }
        assert_eq!(scale, 3.0);
        let mut steps = 0;
        while scale > 0.75 {
            scale = smaller(scale);
            steps += 1;
        }
        assert_eq!((scale, steps), (0.75, STEPS.len() - 1));
        assert_eq!((clamped(f32::NAN), clamped(9.0)), (1.0, 3.0));
    }

    #[test]
    fn a_small_window_has_a_smaller_scale() {
        let (small, large) = (vec2(1024.0, 700.0), vec2(2560.0, 1440.0));
        assert_eq!(fitting(3.0, large, false), 3.0);
        assert!((fitting(3.0, small, false) - 1024.0 / 760.0).abs() < 1e-3);
        assert!(fitting(3.0, small, true) > 2.0, "without panels there is more room");
        assert_eq!(fitting(1.0, vec2(300.0, 200.0), false), 0.75);
        assert_eq!(fitting(1.0, small, false), 1.0);
    }
}
