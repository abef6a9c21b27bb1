//! The times of samples.

/// The value of the cycle that means that every time is listed.
const ACYCLIC: f64 = f64::MAX / 32.0;

/// The times of a property's samples, in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    /// Length of a cycle, after which the listed times repeat.
    per_cycle: f64,
    /// The times of a cycle; all times if they do not repeat. At least one.
    listed: Vec<f64>,
}

impl Times {
    /// Samples at equal distances.
    pub fn uniform(start_secs: f64, step_secs: f64) -> Self {
        Self { per_cycle: step_secs, listed: vec![start_secs] }
    }

    /// Times as they stand in a file; `None` if they are not finite, not ascending or empty.
    pub(crate) fn new(per_cycle: f64, listed: Vec<f64>) -> Option<Self> {
        let ascending = listed.array_windows().all(|[a, b]| a <= b) && listed.iter().all(|t| t.is_finite());
        let span = listed.last()? - listed.first()?;
        let fits = per_cycle == ACYCLIC || per_cycle.is_finite() && per_cycle >= span;
        (ascending && fits).then_some(Self { per_cycle, listed })
    }

    /// Length of a cycle and the times of a cycle, as a file states them.
    pub(crate) fn parts(&self) -> (f64, &[f64]) {
        (self.per_cycle, &self.listed)
    }

    /// The time of a sample. Beyond a list without a cycle it is the last time.
    pub fn secs(&self, sample: u64) -> f64 {
        let count = self.listed.len() as u64;
        if self.per_cycle == ACYCLIC {
            return self.listed[sample.min(count - 1) as usize];
        }
        self.listed[(sample % count) as usize] + self.per_cycle * (sample / count) as f64
    }

    /// The sample at or before a time, the next one, and the fraction from the first to the second, 0 to 1; clamped to `samples`,
    /// which is at least 1.
    pub fn around(&self, secs: f64, samples: u64) -> (u64, u64, f64) {
        let secs = if secs.is_nan() { f64::NEG_INFINITY } else { secs };
        let last = samples.saturating_sub(1);
        let (mut low, mut high) = (0, last);
        // The last sample whose time is not after `secs`.
        while low < high {
            let middle = high - (high - low) / 2;
            if self.secs(middle) <= secs {
                low = middle;
            } else {
                high = middle - 1;
            }
        }
        let next = (low + 1).min(last);
        let (from, to) = (self.secs(low), self.secs(next));
        let fraction = if to > from { ((secs - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        (low, next, fraction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_uniform_cyclic_or_listed() {
        let uniform = Times::uniform(0.5, 0.25);
        assert_eq!((uniform.secs(0), uniform.secs(3)), (0.5, 1.25));
        let cyclic = Times::new(1.0, vec![0.0, 0.1]).expect("times");
        assert_eq!([0, 1, 2, 3].map(|i| cyclic.secs(i)), [0.0, 0.1, 1.0, 1.1]);
        let listed = Times::new(ACYCLIC, vec![0.0, 3.0, 4.0]).expect("times");
        assert_eq!([0, 1, 2, 9].map(|i| listed.secs(i)), [0.0, 3.0, 4.0, 4.0]);
        assert_eq!(Times::new(1.0, vec![]), None);
        assert_eq!(Times::new(1.0, vec![0.0, f64::NAN]), None);
        assert_eq!(Times::new(0.5, vec![0.0, 1.0]), None);
        assert_eq!(Times::new(-1.0, vec![0.0]), None);
    }

    #[test]
    fn a_time_lies_between_two_samples() {
        let times = Times::new(ACYCLIC, vec![0.0, 3.0, 4.0]).expect("times");
        assert_eq!(times.around(-1.0, 3), (0, 1, 0.0));
        assert_eq!(times.around(1.5, 3), (0, 1, 0.5));
        assert_eq!(times.around(3.0, 3), (1, 2, 0.0));
        assert_eq!(times.around(9.0, 3), (2, 2, 0.0));
        assert_eq!(times.around(9.0, 1), (0, 0, 0.0));
        assert_eq!(times.around(f64::NAN, 3), (0, 1, 0.0));
    }
}
