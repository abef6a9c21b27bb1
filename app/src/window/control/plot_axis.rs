//! Numbers along the axes of plots.

use std::ops::RangeInclusive;

use egui::Rangef;
use egui_plot::{AxisHints, GridMark};

/// The number of a mark on an axis, with as many digits after the point as the distance of the marks needs. Rounding errors of zero
/// have no sign.
pub(crate) fn axis_number(mark: GridMark, _shown: &RangeInclusive<f64>) -> String {
    let whole = |decimals: &usize| {
        let steps = mark.step_size * 10_f64.powi(*decimals as i32);
        (steps - steps.round()).abs() < 1e-3 * steps.max(1.0)
    };
    let decimals = (0..6).find(whole).unwrap_or(6);
    let value = if mark.value.abs() < 1e-6 * mark.step_size { 0.0 } else { mark.value };
    format!("{value:.decimals$}")
}

/// A horizontal axis. Its numbers are short, so they stand nearer to each other than egui's limit of 60 points.
pub(crate) fn axis_of_short_numbers(
    label: &str,
    text: impl Fn(GridMark, &RangeInclusive<f64>) -> String + 'static,
) -> AxisHints<'static> {
    AxisHints::new_x().label(label.to_owned()).formatter(text).label_spacing(Rangef::new(20.0, 36.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        let text = |value, step_size| axis_number(GridMark { value, step_size }, &(-1.0..=1.0));
        assert_eq!(text(-0.0, 10.0), "0");
        assert_eq!(text(-1e-12, 0.1), "0.0");
        assert_eq!(text(-0.1, 0.1), "-0.1");
        assert_eq!(text(-20.0, 10.0), "-20");
        assert_eq!(text(2.5, 2.5), "2.5");
        assert_eq!(text(0.25, 0.05), "0.25");
        // Control: the plain format of the same values has a sign.
        assert_eq!(format!("{:.1}", -1e-12), "-0.0");
    }
}
