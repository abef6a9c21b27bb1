//! `cargo xtask fuzz`: damaged files for every reader of files, as long as wanted.

use anyhow::ensure;
use lovelock_xtask::tool::{Stream, cargo, watch};

/// The packages that read files.
const READERS: [&str; 5] =
    ["lovelock-alembic", "lovelock-usd", "lovelock-groom", "lovelock-motion", "lovelock-sound"];

/// The start of the names of their tests.
const TESTS: &str = "damaged_";

/// What is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted<'a> {
    /// Seconds for each reader.
    pub(crate) secs: u64,
    /// Chooses other damage.
    pub(crate) seed: u64,
    /// Only readers whose test has this in its name.
    pub(crate) reader: Option<&'a str>,
}

/// Runs the tests of damaged files one after another, each for some seconds. The totals are the last line on standard output.
pub(crate) fn run(wanted: &Wanted) -> anyhow::Result<()> {
    let mut tests = cargo(&["test", "--no-fail-fast", "--lib", "--tests"]);
    tests.args(READERS.iter().flat_map(|package| ["--package", package]));
    tests.args([wanted.reader.unwrap_or(TESTS), "--", "--nocapture", "--test-threads", "1"]);
    tests.env("LOVELOCK_SUITE", "long");
    tests
        .env("LOVELOCK_FUZZ_SECS", wanted.secs.to_string())
        .env("LOVELOCK_FUZZ_SEED", wanted.seed.to_string());
    let (mut readers, mut inputs) = (0_u64, 0_u64);
    let good = watch(&mut tests, Stream::Out, |line| {
        if let Some(count) = inputs_of(line) {
            (readers, inputs) = (readers + 1, inputs + count);
        }
    })?;
    println!("{readers} readers, {inputs} inputs, seed {}", wanted.seed);
    ensure!(
        good,
        "a reader failed; the lines above name the input, which is in the folder for temporary files"
    );
    ensure!(readers > 0, "no reader has a test with `{}` in its name", wanted.reader.unwrap_or(TESTS));
    Ok(())
}

/// The number of inputs in a reader's line of counts.
fn inputs_of(line: &str) -> Option<u64> {
    let (before, _) = line.split_once(" inputs in ")?;
    before.rsplit(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::inputs_of;

    #[test]
    fn counts_are_found_in_their_lines() {
        let line = "stage text: 1200 inputs in 30.0 s, 90 accepted, 1110 refused, the slowest in 3.1 ms";
        assert_eq!(inputs_of(line), Some(1200));
        assert_eq!(inputs_of("test damaged_stage_text ... ok"), None);
        assert_eq!(inputs_of("some inputs in a row"), None);
    }
}
