//! Tick marks of an axis.

/// Round numbers for the ticks of an axis, and their labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// The numbers in increasing order, all inside the range.
    pub values: Vec<f64>,
    /// Distance between two ticks.
    pub step: f64,
}

/// About `wanted` round numbers (steps of 1, 2 or 5 times a power of ten) in `low..=high`. Empty if the range is empty
/// or not finite.
pub fn ticks(low: f64, high: f64, wanted: usize) -> Ticks {
    let span = high - low;
    let wanted = wanted.clamp(1, 50) as f64;
    if !(span.is_finite() && span > 0.0) {
        return Ticks { values: Vec::new(), step: 0.0 };
    }
    let rough = span / wanted;
    let power = 10.0_f64.powf(rough.log10().floor());
    let multiple = [1.0, 2.0, 5.0, 10.0].into_iter().find(|multiple| multiple * power >= rough * 0.999);
    let step = multiple.unwrap_or(10.0) * power;
    // Multiples of the step, so that errors do not add up; slightly beyond the range, so that rounding loses no end.
    let [first, last] = [(low / step - 1e-6).ceil(), (high / step + 1e-6).floor()];
    let count = if (last - first).is_finite() { (last - first).clamp(-1.0, 200.0) as i64 } else { -1 };
    Ticks { values: (0..=count).map(|i| (first + i as f64) * step).collect(), step }
}

impl Ticks {
    /// The label of a value, with as many decimals as the step needs.
    pub fn label(&self, value: f64) -> String {
        // Avoids -0.
        let value = if value.abs() < self.step * 1e-6 { 0.0 } else { value };
        let largest = self.values.iter().fold(self.step, |largest, value| largest.max(value.abs()));
        if !(1e-3..1e6).contains(&largest) {
            return if value == 0.0 { "0".into() } else { scientific(value) };
        }
        let places = (-self.step.log10() - 1e-6).ceil().clamp(0.0, 9.0) as usize;
        format!("{value:.places$}")
    }
}

/// A number in scientific notation, with no more decimals than needed.
fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    match text.split_once('e') {
        Some((digits, power)) => format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.')),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::ticks;

    fn labels(low: f64, high: f64, wanted: usize) -> Vec<String> {
        let ticks = ticks(low, high, wanted);
        ticks.values.iter().map(|&value| ticks.label(value)).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(labels(0.0, 1.0, 5), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(0.0, 0.13, 5), ["0.00", "0.05", "0.10"]);
        assert_eq!(labels(-0.25, 0.25, 5), ["-0.2", "-0.1", "0.0", "0.1", "0.2"]);
        assert_eq!(labels(0.0, 47.0, 5), ["0", "10", "20", "30", "40"]);
        assert_eq!(labels(0.0, 0.0004, 4), ["0", "1e-4", "2e-4", "3e-4", "4e-4"]);
        assert_eq!(labels(0.0, 3e9, 3), ["0", "1e9", "2e9", "3e9"]);
    }

    #[test]
    fn empty_and_infinite_ranges_have_no_ticks() {
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert_eq!(labels(low, high, 5), Vec::<String>::new());
        }
        // A range far from zero and narrower than its rounding terminates too.
        assert!(labels(1e18, 1e18 + 256.0, 5).len() < 300);
        assert!(labels(0.0, f64::MIN_POSITIVE, 5).len() < 300);
        assert!(labels(f64::MIN, f64::MAX, 5).len() < 300);
    }
}
