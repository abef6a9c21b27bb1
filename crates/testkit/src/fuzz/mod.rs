//! Damaged input for readers of files: seeded mutations of sound files, a few every day and many in the long suite.
//!
//! A reader must answer any bytes with a value or an error, within some seconds of CPU time. A panic fails the test and leaves the bytes in the
//! folder for temporary files.

mod mutate;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use lovelock_base::clock::Stopwatch;
use lovelock_base::random::SplitMix64;

use crate::clock::thread_time;
use crate::suite;
pub use mutate::Mutator;

/// The most CPU time for one input, seconds: a reader that needs more has stopped answering. Other work on the machine does not count.
const SLOWEST_SECS: f64 = 10.0;
/// Seconds for each reader in the long suite unless `LOVELOCK_FUZZ_SECS` says otherwise.
const LONG_SECS: f64 = 30.0;

/// What happened to the inputs of one reader.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Inputs.
    pub inputs: u64,
    /// Inputs that the reader accepted.
    pub accepted: u64,
    /// CPU time of the slowest input, seconds.
    pub slowest_secs: f64,
    /// Time of all inputs, seconds.
    pub secs: f64,
}

impl Counts {
    /// Checks that the reader accepted more than the share `least` of the inputs, and refused most: a reader that refuses everything
    /// keeps all its promises.
    ///
    /// # Panics
    /// If it did not.
    pub fn assert_mixed(&self, least: f64) {
        let share = self.accepted as f64 / self.inputs as f64;
        assert!(share > least && share < 0.5, "accepted {share}, not {least} to 0.5 of them: {self:?}");
    }
}

/// A number from the environment.
fn named(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().and_then(|value| value.parse().ok())
}

/// Calls `reads` with damaged copies of `sound` files: `short` of them every day; in the long suite as many as fit into the
/// seconds of the environment variable `LOVELOCK_FUZZ_SECS`, 30 if it is not set. `LOVELOCK_FUZZ_SEED` chooses other damage. `reads` returns
/// whether the reader accepted the bytes, and panics if it broke a promise. Prints the counts.
///
/// # Panics
/// If `reads` panics, takes more than 10 seconds of CPU time, or refuses a sound file.
pub fn damaged(name: &str, sound: &[Vec<u8>], short: u64, reads: impl Fn(&[u8]) -> bool) -> Counts {
    for (index, file) in sound.iter().enumerate() {
        assert!(reads(file), "{name}: the sound file {index} was refused");
    }
    let budget_secs =
        suite::is_long().then(|| named("LOVELOCK_FUZZ_SECS").map_or(LONG_SECS, |secs| secs as f64));
    let seed = named("LOVELOCK_FUZZ_SEED").unwrap_or(1) as u32;
    let watch = Stopwatch::start();
    let mut mutator = Mutator::new(SplitMix64::of_stream(seed, name.bytes().map(u64::from).sum()));
    let mut counts = Counts::default();
    let goes_on = |counts: &Counts| match budget_secs {
        Some(secs) => watch.secs() < secs,
        None => counts.inputs < short,
    };
    while goes_on(&counts) {
        let input = mutator.damaged(sound);
        let start = thread_time();
        match catch_unwind(AssertUnwindSafe(|| reads(&input))) {
            Ok(accepted) => counts.accepted += u64::from(accepted),
            Err(panic) => {
                keep(name, counts.inputs, &input);
                resume_unwind(panic);
            }
        }
        let secs = thread_time().saturating_sub(start).as_secs_f64();
        if secs > SLOWEST_SECS {
            keep(name, counts.inputs, &input);
            panic!("{name}: input {} took {secs:.1} s", counts.inputs);
        }
        counts.slowest_secs = counts.slowest_secs.max(secs);
        counts.inputs += 1;
    }
    counts.secs = watch.secs();
    println!(
        "{name}: {} inputs in {:.1} s, {} accepted, {} refused, the slowest in {:.1} ms",
        counts.inputs,
        counts.secs,
        counts.accepted,
        counts.inputs - counts.accepted,
        1e3 * counts.slowest_secs,
    );
    counts
}

fn keep(name: &str, number: u64, input: &[u8]) {
    let path = std::env::temp_dir().join(format!("lovelock-damaged-{name}-{number}"));
    match std::fs::write(&path, input) {
        Ok(()) => eprintln!("the input is {}", path.display()),
        Err(error) => eprintln!("the input could not be kept: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::damaged;
    use crate::suite;

    #[test]
    fn inputs_are_the_same_in_every_run_and_mostly_damaged() {
        if suite::is_long() {
            return;
        }
        let sound = [b"Frames: 12 and a text of some length".to_vec()];
        let hash = |seen: &std::cell::RefCell<u64>, bytes: &[u8]| {
            let mut seen = seen.borrow_mut();
            for &byte in bytes {
                *seen = seen.wrapping_mul(31).wrapping_add(u64::from(byte));
            }
            bytes == sound[0]
        };
        let (first, second) = (std::cell::RefCell::new(0), std::cell::RefCell::new(0));
        let counts = damaged("a", &sound, 1000, |bytes| hash(&first, bytes));
        damaged("a", &sound, 1000, |bytes| hash(&second, bytes));
        assert_eq!(first, second);
        assert!(counts.inputs == 1000 && counts.accepted < 100, "{counts:?}");
    }

    #[test]
    #[should_panic(expected = "the reader fell")]
    fn a_panic_is_passed_on() {
        damaged("falls", &[b"sound".to_vec()], 100, |bytes| {
            assert!(bytes == b"sound", "the reader fell");
            true
        });
    }
}
