//! One axis of a plot: maps numbers to positions.

use lovelock_metrics::ticks;

/// Largest ratio between the ends of a logarithmic axis. Smaller values are drawn at its low end, so that the others can be
/// distinguished.
const WIDEST: f64 = 1e5;

/// One axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity with unit.
    pub(crate) label: String,
    /// Numbers at the two ends, in ascending order.
    low: f64,
    high: f64,
    /// Whether the axis is logarithmic.
    logarithmic: bool,
}

impl Axis {
    /// A linear axis from `low` to `high`; an empty range is extended.
    pub fn even(label: &str, low: f64, high: f64) -> Self {
        let (low, high) = if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) };
        let high = if high - low > f64::EPSILON * low.abs().max(1e-30) { high } else { low + 1.0 };
        Self { label: label.into(), low, high, logarithmic: false }
    }

    /// A logarithmic axis for the positive `values`, with a margin, down to 1/100,000 of the largest.
    pub fn logarithmic(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let positive = values.into_iter().filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = positive.fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if high > 0.0 { (low / 1.35, high * 1.35) } else { (0.1, 10.0) };
        let low = low.max(high / WIDEST);
        // At least half a decade, so that noise does not fill the plot.
        let short = (3.0 / (high / low)).max(1.0).sqrt();
        Self { label: label.into(), low: low / short, high: high * short, logarithmic: true }
    }

    /// Position of a number, 0 at the low end and 1 at the high end, clamped.
    pub(super) fn place(&self, value: f64) -> f64 {
        let place = if self.logarithmic {
            (value.max(self.low) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        // Handles non-finite numbers as well.
        if place > 0.0 { place.min(1.0) } else { 0.0 }
    }

    /// Whether a number lies between the ends.
    pub(super) fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Whether a part of the span from `start` to `end` lies between the ends.
    pub(super) fn meets(&self, start: f64, end: f64) -> bool {
        start <= self.high && end >= self.low && start <= end
    }

    /// Round numbers along the axis, with their text.
    pub(super) fn marks(&self, wanted: usize) -> Vec<(f64, String)> {
        if !self.logarithmic {
            let ticks = ticks(self.low, self.high, wanted);
            return ticks.values.iter().map(|&v| (v, ticks.label(v).replace('-', "−"))).collect();
        }
        let decades = (self.high / self.low).log10();
        let digits: &[f64] = match decades {
            decades if decades < 1.7 => &[1.0, 2.0, 3.0, 5.0],
            decades if decades < 3.5 => &[1.0, 3.0],
            _ => &[1.0],
        };
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let every = ((last - first) / 12).max(1);
        let powers = (first..=last).step_by(every as usize).map(|power| 10.0_f64.powi(power));
        let values = powers.flat_map(|power| digits.iter().map(move |digit| digit * power));
        values.filter(|value| self.holds(*value)).map(|value| (value, short(value))).collect()
    }
}

/// Short text of a round number.
fn short(value: f64) -> String {
    if (1e-4..1e6).contains(&value) {
        let places = (-value.log10().floor()).max(0.0) as usize;
        format!("{value:.places$}")
    } else {
        format!("{value:.0e}").replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    #[test]
    fn places_lie_between_the_ends() {
        let even = Axis::even("", -2.0, 2.0);
        assert_eq!([-3.0, -2.0, 0.0, 2.0, 9.0].map(|v| even.place(v)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        let log = Axis::logarithmic("", [1.0, 100.0]);
        assert!((log.place(10.0) - 0.5).abs() < 1e-9);
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(|v| log.place(v)), [0.0, 0.0, 1.0]);
        assert!(even.meets(-9.0, 9.0) && even.meets(1.0, 9.0) && even.meets(0.0, 0.0));
        assert!(!even.meets(3.0, 9.0) && !even.meets(f64::NAN, 0.0) && !even.meets(1.0, -1.0));
        assert!(log.holds(1.0) && log.holds(100.0) && !log.holds(0.0));
    }

    #[test]
    fn marks_are_round() {
        let words =
            |axis: &Axis| axis.marks(5).into_iter().map(|(_, word)| word).collect::<Vec<_>>().join(" ");
        assert_eq!(words(&Axis::even("", -0.1, 0.1)), "−0.10 −0.05 0.00 0.05 0.10");
        assert_eq!(words(&Axis::logarithmic("", [0.012, 0.2])), "0.01 0.02 0.03 0.05 0.1 0.2");
        assert_eq!(words(&Axis::logarithmic("", [1.0, 900.0])), "1 3 10 30 100 300 1000");
        // Tiny values are at the edge.
        let wide = Axis::logarithmic("", [1e-300, 1e300]);
        assert!((2..9).contains(&wide.marks(5).len()) && wide.place(1e-300) == 0.0, "{wide:?}");
    }

    #[test]
    fn what_is_no_range_becomes_one() {
        for axis in [Axis::even("", 3.0, 3.0), Axis::even("", f64::NAN, 1.0), Axis::logarithmic("", [])] {
            assert!(axis.marks(5).len() > 1, "{axis:?}");
        }
        assert!(Axis::logarithmic("", [5.0]).marks(5).len() > 1);
    }
}
