//! Numbers of passed, failed and skipped tests, parsed from the output of the test programs.

use std::fmt;
use std::ops::AddAssign;

/// Numbers of tests. Displayed as the last line of every run: `12 passed, 0 failed, 1 skipped`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Totals {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) skipped: u64,
}

impl Totals {
    /// The numbers of a line of `cargo test` without colours, if it is a summary.
    pub(crate) fn of_line(line: &str) -> Option<Self> {
        // test result: ok. 39 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.69s
        let counts = line.strip_prefix("test result: ")?;
        Some(Self::of_counts(counts.split_once(". ")?.1.split(';')))
    }

    fn of_counts<'a>(parts: impl Iterator<Item = &'a str>) -> Self {
        let mut totals = Self::default();
        for part in parts {
            let Some((count, what)) = part.trim().split_once(' ') else {
                continue;
            };
            let Ok(count) = count.parse::<u64>() else { continue };
            if what.starts_with("passed") {
                totals.passed += count;
            } else if what.starts_with("failed") {
                totals.failed += count;
            } else if what.starts_with("ignored") {
                totals.skipped += count;
            }
        }
        totals
    }
}

impl AddAssign for Totals {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

/// Removes the escape sequences for colours from a line.
pub(crate) fn without_colours(line: &str) -> String {
    let mut plain = String::with_capacity(line.len());
    let mut letters = line.chars();
    while let Some(letter) = letters.next() {
        if letter == '\u{1b}' {
            letters.by_ref().find(char::is_ascii_alphabetic);
        } else {
            plain.push(letter);
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::{Totals, without_colours};

    #[expect(clippy::unnecessary_wraps, reason = "what it is compared with is an option")]
    fn totals(passed: u64, failed: u64, skipped: u64) -> Option<Totals> {
        Some(Totals { passed, failed, skipped })
    }

    #[test]
    fn lines_of_cargo_test() {
        let line = "test result: ok. 39 passed; 0 failed; 2 ignored; 0 measured; 5 filtered out; finished in 0.69s\n";
        assert_eq!(Totals::of_line(line), totals(39, 0, 2));
        let line = "test result: \u{1b}[31mFAILED\u{1b}[m. 1 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out";
        assert_eq!(Totals::of_line(&without_colours(line)), totals(1, 3, 0));
    }

    #[test]
    fn other_lines_count_nothing() {
        for line in ["", "test a::b ... ok", "3 passed; 0 failed", "    test result: ok. 1 passed; 0 failed"]
        {
            assert_eq!(Totals::of_line(line), None, "{line}");
        }
    }

    #[test]
    fn the_sum_prints_as_promised() {
        let mut sum = Totals { passed: 1, failed: 0, skipped: 2 };
        sum += Totals { passed: 10, failed: 1, skipped: 0 };
        assert_eq!(sum.to_string(), "11 passed, 1 failed, 2 skipped");
    }
}
