//! How long each test took, and which took too long.

use std::fmt::Write as _;

/// The most that a test of the short suite may take on two cores without other work, seconds.
const MAX_SECS: f64 = 5.0;

/// On slow machines a test may take this share of the time of all tests instead.
const MAX_SHARE: f64 = 0.02;

/// Tests that may take longer, by the end of their names, and why they stay in the short suite.
const MAY_BE_SLOW: [(&str, &str); 0] = [];

/// How many tests are printed.
const PRINTED: usize = 10;

/// The time of each test, seconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times {
    tests: Vec<(String, f64)>,
    /// The time of all cores while the tests ran, divided by what the tests had of it, at least 1: other work on the machine makes it larger,
    /// and so do cores that had nothing to do.
    pub(crate) crowding: f64,
}

impl Times {
    /// Adds the test of a line of `cargo test` with times.
    pub(crate) fn see(&mut self, line: &str) {
        self.tests.extend(of_line(line));
    }

    /// The slowest tests, a line each.
    pub(crate) fn report(&self) -> String {
        let mut text = String::new();
        if self.tests.is_empty() {
            return text;
        }
        let _ = writeln!(
            text,
            "The slowest of {} tests, which had {:.0} % of the time of all cores:",
            self.tests.len(),
            100.0 / self.crowding.max(1.0)
        );
        for (name, secs) in self.sorted().into_iter().take(PRINTED) {
            let _ = writeln!(text, "{secs:>8.1} s  {name}");
        }
        text
    }

    /// Fails if a test took too long, even with all cores to itself, and is not among [`MAY_BE_SLOW`].
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        let crowding = self.crowding.max(1.0);
        let all: f64 = self.tests.iter().map(|(_, secs)| secs / crowding).sum();
        let limit = MAX_SECS.max(MAX_SHARE * all);
        let is_listed = |name: &str| MAY_BE_SLOW.iter().any(|(end, _)| name.ends_with(end));
        let slow: Vec<_> = self.sorted().into_iter().map(|(name, secs)| (name, secs / crowding)).collect();
        let slow: Vec<_> = slow
            .into_iter()
            .filter(|(name, secs)| *secs > limit && !is_listed(name))
            .map(|(name, secs)| format!("{name} took {secs:.1} s"))
            .collect();
        anyhow::ensure!(
            slow.is_empty(),
            "a test of the short suite must take at most {limit:.0} s, be in the long suite or be listed in times.rs: {}",
            slow.join(", ")
        );
        Ok(())
    }

    fn sorted(&self) -> Vec<(&str, f64)> {
        let mut all: Vec<_> = self.tests.iter().map(|(name, secs)| (name.as_str(), *secs)).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }
}

/// The name and the seconds of the test in a line without colours.
fn of_line(line: &str) -> Option<(String, f64)> {
    // test scene::tests::a_name ... ok <0.123s>
    let (name, rest) = line.strip_prefix("test ")?.split_once(" ... ")?;
    let secs = rest.trim_end().strip_suffix("s>")?.rsplit_once('<')?.1;
    Some((name.split(' ').next()?.to_owned(), secs.parse().ok()?))
}

/// CPU time of the programs that this one has started and that have ended, seconds; `None` where the system does not tell.
pub(crate) fn cpu_secs_of_children() -> Option<f64> {
    // A tick is a hundredth of a second on every Linux that is known. The name may contain anything, so count from its closing bracket.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(13);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}

#[cfg(test)]
mod tests {
    use super::{Times, cpu_secs_of_children, of_line};

    #[test]
    fn times_are_found_in_lines() {
        let found = |line| of_line(line).map(|(name, secs)| format!("{name} {secs}"));
        assert_eq!(found("test a::b ... ok <0.123s>\n").as_deref(), Some("a::b 0.123"));
        assert_eq!(found("test a - should panic ... ok <61.5s>").as_deref(), Some("a 61.5"));
        for other in [
            "test a::b ... ok",
            "test a ... ignored",
            "test result: ok. 3 passed",
            "     Summary [   5.1s] 3 tests run",
        ] {
            assert_eq!(found(other), None, "{other}");
        }
    }

    #[test]
    fn slow_tests_are_those_that_are_slow_without_other_work() {
        let mut times = Times { crowding: 2.0, ..Times::default() };
        for line in
            ["test slow ... ok <12.0s>", "test kept_waiting ... ok <9.0s>", "test quick ... ok <0.1s>"]
        {
            times.see(line);
        }
        let said = times.check().expect_err("a slow test").to_string();
        assert!(said.ends_with(": slow took 6.0 s"), "{said}");
        // On a machine on which all tests take long, none of them is slow.
        (0..400).for_each(|_| times.see("test other ... ok <2.0s>"));
        assert!(times.check().is_ok());
        assert!(times.report().lines().nth(1).is_some_and(|line| line.ends_with("12.0 s  slow")));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_time_of_children_is_known() {
        assert!(cpu_secs_of_children().is_some_and(|secs| secs >= 0.0));
    }
}
