//! How many strands of the list one image draws, and how wide each is.

/// The last part of the strands, as a fraction of all, that fades toward width 0.
const FADING: f32 = 0.1;

/// A number of strands at the beginning of the list. The last ones fade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portion {
    /// The number of strands that have any width.
    pub drawn: usize,
    /// The index at which the width would reach 0; infinite if none fade.
    end: f32,
    /// The number of strands over which the width falls.
    ramp: f32,
    /// The sum of the shares of all strands.
    sum: f64,
}

impl Portion {
    /// Exactly `count` strands of full width.
    pub fn of_all(count: usize) -> Self {
        Self { drawn: count, end: f32::INFINITY, ramp: 1.0, sum: count as f64 }
    }

    /// The strands that together are as wide as `wanted` strands, of a list of `most`; at least one of a list that has any.
    pub fn fading(wanted: f32, most: usize) -> Self {
        // The shares fall linearly over the last part, so their sum is the number less half of that part.
        let end = wanted.max(1.0) / (1.0 - 0.5 * FADING);
        if !end.is_finite() || end * (1.0 - FADING) >= most as f32 {
            return Self::of_all(most);
        }
        let ramp = FADING * end;
        let drawn = (end.ceil() as usize).min(most);
        let mut portion = Self { drawn, end, ramp, sum: 0.0 };
        let full = portion.first_fading();
        portion.sum = full as f64 + (full..drawn).map(|i| f64::from(portion.share(i))).sum::<f64>();
        portion
    }

    /// The index of the first strand that is narrower than the others.
    fn first_fading(&self) -> usize {
        if self.end.is_finite() {
            ((self.end - self.ramp).max(0.0) as usize).min(self.drawn)
        } else {
            self.drawn
        }
    }

    /// The width of strand `i` as a share of the full width, 0 to 1.
    pub fn share(&self, i: usize) -> f32 {
        if self.end.is_finite() { ((self.end - i as f32) / self.ramp).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// The sum of the shares of all strands: the number of strands of full width that they stand for.
    pub fn sum(&self) -> f32 {
        self.sum as f32
    }

    /// `(end, 1 / ramp)` for a shader: the share of strand `i` is `clamp((end - i) * inverse, 0, 1)`.
    pub fn ramp(&self) -> [f32; 2] {
        if self.end.is_finite() { [self.end, 1.0 / self.ramp] } else { [f32::MAX, 1.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_what_is_wanted_and_change_without_a_jump() {
        for wanted in [1.0, 7.3, 400.0, 3350.0, 24_990.5] {
            let portion = Portion::fading(wanted, 100_000);
            let sum: f64 = (0..portion.drawn).map(|i| f64::from(portion.share(i))).sum();
            assert!((sum / f64::from(portion.sum()) - 1.0).abs() < 1e-6);
            assert!((sum - f64::from(wanted)).abs() < 1.0 + 0.001 * f64::from(wanted), "{wanted}: {sum}");
            assert_eq!(portion.share(portion.drawn), 0.0, "the next one has no width");
            assert!((0..portion.first_fading()).all(|i| portion.share(i) == 1.0));
        }
        // A hundredth more changes no share by more than it must: a tenth of the strands fades over a tenth.
        let (a, b) = (Portion::fading(5000.0, 100_000), Portion::fading(5050.0, 100_000));
        let jump = (0..b.drawn).map(|i| (a.share(i) - b.share(i)).abs()).fold(0.0, f32::max);
        assert!(jump < 0.12 && jump > 0.08, "{jump}");
    }

    #[test]
    fn a_list_that_is_too_short_is_drawn_whole() {
        for wanted in [1000.0, f32::INFINITY] {
            let portion = Portion::fading(wanted, 900);
            assert_eq!((portion.drawn, portion.sum(), portion.share(899)), (900, 900.0, 1.0));
        }
        assert_eq!(Portion::fading(f32::NAN, 900).drawn, 2, "NaN draws the least");
        assert_eq!(Portion::fading(5.0, 0).drawn, 0);
    }
}
