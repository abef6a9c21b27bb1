//! `cargo xtask ci`: every check, in the order in which they find faults.

use crate::testing::{self, Suite};
use anyhow::{bail, ensure};
use lovelock_xtask::tool::{cargo, run as run_tool, timed};
use std::time::Duration;

/// Runs the tests, then interchange, browser, format, clippy, layers and documentation, all of them even after a fault. The totals of the
/// tests are the last line on standard output.
pub(crate) fn run() -> anyhow::Result<()> {
    let mut steps = Vec::new();
    let (tests, time) = timed(|| testing::totals(&Suite::default()));
    let (totals, outcome) = match tests {
        Ok((totals, outcome)) => (Some(totals), outcome),
        Err(error) => (None, Err(error)),
    };
    steps.push(("test", outcome, time));
    // Clippy reads the dependencies anew without making code of them, and the documentation reuses what it has read.
    for (name, check) in [
        ("interchange", (|| crate::chore("interchange", [])) as fn() -> anyhow::Result<()>),
        ("browser", || crate::chore("browser", [])),
        ("format", || run_tool(&mut cargo(&["fmt", "--all", "--check"]))),
        ("clippy", || {
            run_tool(&mut cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))
        }),
        ("layers", || crate::chore("layers", [])),
        ("documentation", || {
            run_tool(cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
        }),
    ] {
        println!("== {name}");
        let (outcome, time) = timed(check);
        steps.push((name, outcome, time));
    }
    println!();
    let report = report(&steps);
    print!("{report}");
    if let Some(totals) = totals {
        println!("{totals}");
    }
    let failed: Vec<_> =
        steps.iter().filter(|(_, outcome, _)| outcome.is_err()).map(|(name, ..)| *name).collect();
    ensure!(failed.is_empty(), "failed: {}", failed.join(", "));
    if totals.is_none() {
        bail!("the tests did not run");
    }
    Ok(())
}

/// A line a step: its name, its time, and how it went.
fn report(steps: &[(&str, anyhow::Result<()>, Duration)]) -> String {
    let line = |(name, outcome, time): &(&str, anyhow::Result<()>, Duration)| {
        let outcome = match outcome {
            Ok(()) => "good".to_owned(),
            Err(error) => format!("FAILED: {error:#}"),
        };
        format!("{name:<14}{:>8.1} s  {outcome}\n", time.as_secs_f64())
    };
    steps.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::report;
    use std::time::Duration;

    #[test]
    fn every_step_has_its_line() {
        let steps = [
            ("test", Ok(()), Duration::from_millis(61_240)),
            ("clippy", Err(anyhow::anyhow!("`cargo clippy` failed")), Duration::ZERO),
        ];
        let lines =
            "test              61.2 s  good\nclippy             0.0 s  FAILED: `cargo clippy` failed\n";
        assert_eq!(report(&steps), lines);
    }
}
