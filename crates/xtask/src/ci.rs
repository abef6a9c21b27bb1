//! `cargo xtask ci`: every check, in the order in which they find faults.

use crate::lints;
use crate::testing::{self, Ran, Suite};
use anyhow::ensure;
use lovelock_xtask::system;
use lovelock_xtask::tool::{self, cargo, run as run_tool, timed};
use std::process::Command;
use std::time::Duration;

/// Builds everything once, with Clippy's lints, and runs the tests and all other checks, even after a fault.
/// What each step took and the slowest tests come before the totals of the tests, which are the last line on standard output.
pub(crate) fn run() -> anyhow::Result<()> {
    if lints::run_checked(&["ci"])? {
        return Ok(());
    }
    system::prepare()?;
    let mut steps = Vec::new();
    let (outcome, time) = timed(|| lints::build(cargo(testing::BUILD).args(["--examples", "--keep-going"])));
    steps.push(("build and lint", outcome, time));
    let (tests, time) = timed(|| testing::tests(&Suite::default()));
    let ran = match tests {
        Ok(Ran { totals, times, outcome }) => {
            steps.push(("test", outcome, time));
            let alone = |names: &[String]| Ok(testing::tests(&Suite { names, ..Suite::default() })?.times);
            let (outcome, time) = timed(|| times.check(alone));
            steps.push(("slow tests", outcome, time));
            Some((totals, times))
        }
        Err(error) => {
            steps.push(("test", Err(error), time));
            None
        }
    };
    for (name, check) in [
        (
            "interchange",
            (|| built_chore(&["interchange", "--blender", "if-installed"])) as fn() -> anyhow::Result<()>,
        ),
        ("browser", || built_chore(&["browser"])),
        ("layers", || built_chore(&["layers"])),
        ("format", || run_tool(&mut cargo(&["fmt", "--all", "--check"]))),
    ] {
        println!("== {name}");
        let (outcome, time) = timed(check);
        steps.push((name, outcome, time));
    }
    println!();
    print!("{}", report(&steps));
    if let Some((totals, times)) = &ran {
        print!("{}", times.report());
        println!("{totals}");
    }
    let failed: Vec<_> =
        steps.iter().filter(|(_, outcome, _)| outcome.is_err()).map(|(name, ..)| *name).collect();
    ensure!(failed.is_empty(), "failed: {}", failed.join(", "));
    Ok(())
}

/// Runs one of the chores that the first step has built.
fn built_chore(arguments: &[&str]) -> anyhow::Result<()> {
    run_tool(Command::new(tool::built("lovelock-chores")).args(arguments).current_dir(tool::root()))
}

/// A line a step: its name, its time, and how it went.
fn report(steps: &[(&str, anyhow::Result<()>, Duration)]) -> String {
    let line = |(name, outcome, time): &(&str, anyhow::Result<()>, Duration)| {
        let outcome = match outcome {
            Ok(()) => "good".to_owned(),
            Err(error) => format!("FAILED: {error:#}"),
        };
        format!("{name:<15}{:>8.1} s  {outcome}\n", time.as_secs_f64())
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
            ("layers", Err(anyhow::anyhow!("`layers` failed")), Duration::ZERO),
        ];
        let lines = "test               61.2 s  good\nlayers              0.0 s  FAILED: `layers` failed\n";
        assert_eq!(report(&steps), lines);
    }
}
