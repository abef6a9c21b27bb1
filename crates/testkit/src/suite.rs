//! Which suite runs: the short one of every day, or the long one before a release.

/// Whether this is the long suite: `cargo xtask test --long`, which sets `LOVELOCK_SUITE` to `long`.
pub fn is_long() -> bool {
    std::env::var("LOVELOCK_SUITE").is_ok_and(|suite| suite == "long")
}

/// How long a test simulates, in seconds: `short` every day, `long` in the long suite.
pub fn seconds(short: f64, long: f64) -> f64 {
    if is_long() { long } else { short }
}
