//! Which suite runs: the short one of every day, or the long one before a release.

/// Whether this is the long suite: `cargo xtask test --long`, which sets `LOVELOCK_SUITE` to `long`.
pub fn is_long() -> bool {
    std::env::var("LOVELOCK_SUITE").is_ok_and(|suite| suite == "long")
}

/// How long a test simulates, in seconds: `short` every day, `long` in the long suite.
pub fn seconds(short: f64, long: f64) -> f64 {
    if is_long() { long } else { short }
}

/// The cases that a test runs through: `short` every day, `long` in the long suite.
pub fn cases<'a, T>(short: &'a [T], long: &'a [T]) -> &'a [T] {
    if is_long() { long } else { short }
}

/// Every `every`-th of many like cases in the short suite, from the first on; all of them in the long suite.
pub fn sample<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if is_long() { 1 } else { every })
}

#[cfg(test)]
mod tests {
    use super::{cases, is_long, sample, seconds};

    #[test]
    fn the_short_suite_runs_less() {
        let expected = if is_long() { (600.0, 3) } else { (20.0, 1) };
        assert_eq!((seconds(20.0, 600.0), cases(&[1], &[1, 2, 3]).len()), expected);
        assert_eq!(sample(0..10, 4).count(), if is_long() { 10 } else { 3 });
    }
}
