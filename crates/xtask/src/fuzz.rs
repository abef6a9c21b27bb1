//! `cargo xtask fuzz`: damaged files for every reader of files, as long as wanted.

use std::process::Command;

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
    let mut tests = tests_of_readers();
    match wanted.reader {
        // The harness runs the tests that match any of its filters, so those that match both are named in full.
        Some(reader) => tests.args(["--", "--exact"]).args(names_with(reader)?),
        None => tests.args([TESTS, "--"]),
    };
    tests.args(["--nocapture", "--test-threads", "1"]);
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
    ensure!(readers > 0, "no reader has a test with `{TESTS}` in its name");
    Ok(())
}

/// `cargo test` for all readers, without a choice of tests.
fn tests_of_readers() -> Command {
    let mut tests = cargo(&["test", "--release", "--no-fail-fast", "--lib", "--tests"]);
    tests.args(READERS.iter().flat_map(|package| ["--package", package]));
    tests
}

/// The tests of damaged files with `reader` in their names, with their modules.
fn names_with(reader: &str) -> anyhow::Result<Vec<String>> {
    let mut list = tests_of_readers();
    list.args([TESTS, "--", "--list"]);
    let mut names = Vec::new();
    let good = watch(&mut list, Stream::Out, |line| names.extend(listed(line, reader)))?;
    ensure!(good, "the tests could not be listed");
    ensure!(!names.is_empty(), "no reader has a test with `{TESTS}` and `{reader}` in its name");
    Ok(names)
}

/// The test in a line of the list, if it is one of damaged files and has `reader` in its name.
fn listed(line: &str, reader: &str) -> Option<String> {
    let path = line.trim_end().strip_suffix(": test")?;
    let name = path.rsplit("::").next()?;
    (name.starts_with(TESTS) && name.contains(reader)).then(|| path.to_owned())
}

/// The number of inputs in a reader's line of counts.
fn inputs_of(line: &str) -> Option<u64> {
    let (before, _) = line.split_once(" inputs in ")?;
    before.rsplit(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::{inputs_of, listed};

    #[test]
    fn a_reader_is_chosen_among_the_tests_of_damaged_files() {
        let of_usd = |line| listed(line, "usd");
        assert_eq!(
            of_usd("usd::damaged_character_usd: test\n").as_deref(),
            Some("usd::damaged_character_usd")
        );
        assert_eq!(of_usd("damaged_hair_usd_text: test").as_deref(), Some("damaged_hair_usd_text"));
        assert_eq!(of_usd("usd::damaged_motion_bvh: test"), None, "only its module");
        assert_eq!(of_usd("io::usd::a_stage_is_read_in_usd: test"), None, "not of damaged files");
        assert_eq!(of_usd("3 tests, 0 benchmarks"), None);
    }

    #[test]
    fn counts_are_found_in_their_lines() {
        let line = "stage text: 1200 inputs in 30.0 s, 90 accepted, 1110 refused, the slowest in 3.1 ms";
        assert_eq!(inputs_of(line), Some(1200));
        assert_eq!(inputs_of("test damaged_stage_text ... ok"), None);
        assert_eq!(inputs_of("some inputs in a row"), None);
    }
}
