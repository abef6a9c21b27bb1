//! `cargo xtask test`: every test, and the totals.

use crate::totals::Totals;
use anyhow::ensure;
use lovelock_xtask::system;
use lovelock_xtask::tool::{Stream, cargo, output_of, watch};
use std::io::IsTerminal as _;

/// Tells tests which suite runs: `testkit::suite` reads it.
const SUITE: &str = "LOVELOCK_SUITE";

/// The word in the name of tests that only the long suite runs.
const LONG_ONLY: &str = "long_suite";

/// Which tests run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Suite<'a> {
    /// Only tests whose name contains this.
    pub(crate) filter: Option<&'a str>,
    /// Only the tests of this package.
    pub(crate) package: Option<&'a str>,
    /// Dances of minutes in place of seconds, and the tests whose name contains [`LONG_ONLY`].
    pub(crate) long: bool,
}

/// Installs missing system packages and runs the tests. The totals are the last line on standard output.
pub(crate) fn run(suite: &Suite) -> anyhow::Result<()> {
    let (totals, outcome) = totals(suite)?;
    println!("{totals}");
    outcome
}

/// Installs missing system packages and runs the tests; returns the totals, and an error unless all passed.
pub(crate) fn totals(suite: &Suite) -> anyhow::Result<(Totals, anyhow::Result<()>)> {
    system::prepare()?;
    let Suite { filter, package, long } = *suite;
    let suite = if long { "long" } else { "short" };
    let scope = match package {
        Some(package) => vec!["--package", package],
        None => vec!["--workspace"],
    };
    let mut totals = Totals::default();
    let mut good = true;
    let mut see = |line: &str| {
        if let Some(found) = Totals::of_line(line) {
            totals += found;
        }
    };
    if has_nextest() {
        let colour = if std::io::stderr().is_terminal() { "always" } else { "never" };
        let mut nextest = cargo(&["nextest", "run", "--no-fail-fast", "--color", colour]);
        nextest.env(SUITE, suite).args(&scope).args(filter);
        if !long {
            nextest.args(["--filterset", &format!("not test(/{LONG_ONLY}/)")]);
        }
        good &= watch(&mut nextest, Stream::Err, &mut see)?;
        // nextest leaves the examples in the documentation out. Without a library there are none, and cargo objects.
        if package.is_none_or(|package| !["lovelock", "lovelock-chores"].contains(&package)) {
            let mut examples = cargo(&["test", "--doc", "--no-fail-fast"]);
            good &= watch(examples.args(&scope).args(filter), Stream::Out, &mut see)?;
        }
    } else {
        let mut tests = cargo(&["test", "--no-fail-fast"]);
        tests.env(SUITE, suite).args(&scope).args(filter);
        if !long {
            tests.args(["--", "--skip", LONG_ONLY]);
        }
        good &= watch(&mut tests, Stream::Out, &mut see)?;
    }
    let outcome = (|| {
        ensure!(totals.failed == 0, "{} of the tests failed", totals.failed);
        ensure!(good, "the tests did not run to their end; the reason stands above");
        Ok(())
    })();
    Ok((totals, outcome))
}

fn has_nextest() -> bool {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    output_of(&cargo, &["nextest", "--version"]).is_some()
}
