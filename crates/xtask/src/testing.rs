//! `cargo xtask test`: every test, and the totals.

use crate::system;
use crate::tool::{Stream, cargo, output_of, watch};
use crate::totals::Totals;
use anyhow::ensure;
use std::io::IsTerminal as _;

/// Runs the tests, after a look at the system. The totals are the last line on standard output.
pub(crate) fn run(filter: Option<&str>, package: Option<&str>) -> anyhow::Result<()> {
    let (totals, outcome) = totals(filter, package)?;
    println!("{totals}");
    outcome
}

/// Runs the tests, after a look at the system; returns the totals, and an error unless all passed.
pub(crate) fn totals(
    filter: Option<&str>,
    package: Option<&str>,
) -> anyhow::Result<(Totals, anyhow::Result<()>)> {
    system::prepare()?;
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
        good &= watch(nextest.args(&scope).args(filter), Stream::Err, &mut see)?;
        // nextest leaves the examples in the documentation out. Without a library there are none, and cargo objects.
        if package.is_none_or(|package| !["lovelock", "lovelock-xtask"].contains(&package)) {
            let mut examples = cargo(&["test", "--doc", "--no-fail-fast"]);
            good &= watch(examples.args(&scope).args(filter), Stream::Out, &mut see)?;
        }
    } else {
        let mut tests = cargo(&["test", "--no-fail-fast"]);
        good &= watch(tests.args(&scope).args(filter), Stream::Out, &mut see)?;
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
