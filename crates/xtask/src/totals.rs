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
    /// The numbers of a line of `cargo test` or `cargo nextest run` without colours, if it is a summary.
    pub(crate) fn of_line(line: &str) -> Option<Self> {
        // nextest repeats the output of failed tests with indentation; it has been counted already.
        if let Some(counts) = line.strip_prefix("test result: ") {
            // test result: ok. 39 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.69s
            return Some(Self::of_counts(counts.split_once(". ")?.1.split(';')));
        }
        if line.trim_start().starts_with("Summary [") {
            // Summary [   0.005s] 4 tests run: 2 passed (1 slow), 1 failed, 1 timed out, 3 skipped
            return Some(Self::of_counts(line.split_once("run:")?.1.split(',')));
        }
        None
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
            } else if what.starts_with("failed")
                || what.starts_with("timed out")
                || what.starts_with("exec failed")
            {
                totals.failed += count;
            } else if what.starts_with("skipped") || what.starts_with("ignored") {
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
    fn lines_of_nextest() {
        let line = "     Summary [   0.005s] 3 tests run: 2 passed (1 slow), 1 failed, 4 skipped\n";
        assert_eq!(Totals::of_line(line), totals(2, 1, 4));
        let line = "\u{1b}[32;1m     Summary\u{1b}[0m [   1.2s] \u{1b}[1m5\u{1b}[0m tests run: \u{1b}[1m5\u{1b}[0m \
                    \u{1b}[32mpassed\u{1b}[0m, \u{1b}[1m0\u{1b}[0m skipped";
        assert_eq!(Totals::of_line(&without_colours(line)), totals(5, 0, 0));
        let line = "Summary [ 9s] 3/9 tests run: 1 passed, 1 timed out, 1 exec failed, 0 skipped";
        assert_eq!(Totals::of_line(line), totals(1, 2, 0));
    }

    #[test]
    fn other_lines_count_nothing() {
        let repeated = "    test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 93 filtered out; finished in 6.41s";
        assert_eq!(Totals::of_line(repeated), None);
        for line in
            ["", "test a::b ... ok", "    PASS [ 0.1s] a b", "3 passed; 0 failed", "Summary of it: 3 passed"]
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
