//! `cargo xtask test`: every test, and the totals.

use crate::times::{Times, cpu_secs_of_children};
use crate::totals::{Totals, without_colours};
use anyhow::ensure;
use lovelock_xtask::system;
use lovelock_xtask::tool::{Stream, cargo, run as run_tool, timed, watch};

/// Tells tests which suite runs: `testkit::suite` reads it.
const SUITE: &str = "LOVELOCK_SUITE";

/// The word in the name of tests that only the long suite runs.
const LONG_ONLY: &str = "long_suite";

/// Which tests run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Suite<'a> {
    /// Only tests whose name contains this.
    pub(crate) filter: Option<&'a str>,
    /// Only tests with these names; all if there are none.
    pub(crate) names: &'a [String],
    /// Only the tests of this package.
    pub(crate) package: Option<&'a str>,
    /// Dances of minutes in place of seconds, and the tests whose name contains [`LONG_ONLY`].
    pub(crate) long: bool,
}

/// What the tests gave.
pub(crate) struct Ran {
    pub(crate) totals: Totals,
    pub(crate) times: Times,
    /// An error unless all passed.
    pub(crate) outcome: anyhow::Result<()>,
}

/// Installs missing system packages and runs the tests. The totals are the last line on standard output.
pub(crate) fn run(suite: &Suite) -> anyhow::Result<()> {
    system::prepare()?;
    build(suite)?;
    if suite.long {
        // Nothing else builds the benchmarks: their libraries are not among those of the tests.
        run_tool(&mut cargo(&[
            "build",
            "--release",
            "-p",
            "lovelock-benchmarks",
            "--benches",
            "--all-features",
        ]))?;
    }
    let Ran { totals, times, outcome } = tests(suite)?;
    println!("{}{totals}", times.report());
    outcome
}

/// What builds the tests of all packages and the programs that they start. The programs of one package alone would have other features of
/// the same libraries, and nearly everything would be built twice.
pub(crate) const BUILD: &[&str] = &["build", "--release", "--workspace", "--bins", "--tests"];

/// Builds the tests.
pub(crate) fn build(suite: &Suite) -> anyhow::Result<()> {
    match suite.package {
        None => run_tool(&mut cargo(BUILD)),
        Some(package) => run_tool(&mut cargo(&["test", "--release", "--tests", "--no-run", "-p", package])),
    }
}

fn scope<'a>(suite: &Suite<'a>) -> Vec<&'a str> {
    match suite.package {
        Some(package) => vec!["--package", package],
        None => vec!["--workspace"],
    }
}

/// Runs the tests and the examples in the documentation.
pub(crate) fn tests(suite: &Suite) -> anyhow::Result<Ran> {
    let Suite { filter, names, package, long } = *suite;
    let scope = scope(suite);
    let suite = if long { "long" } else { "short" };
    let (mut totals, mut times) = (Totals::default(), Times::default());
    let mut good = true;
    let mut see = |line: &str| {
        let line = without_colours(line);
        if let Some(found) = Totals::of_line(&line) {
            totals += found;
        }
        times.see(&line);
    };
    let cpu_before = cpu_secs_of_children();
    let (ran, wall) = timed(|| {
        // One process for all tests of a program: each of its own would look for graphics drivers and read the same files again.
        let mut tests = cargo(&["test", "--release", "--bins", "--tests", "--no-fail-fast"]);
        // Mesa's choice of devices by display prints an error for each device that is opened without a display.
        tests.env(SUITE, suite).env("NODEVICE_SELECT", "1").args(&scope);
        if cfg!(unix) {
            // The harness of a stable toolchain reports times only with this variable.
            tests.args(["--config", r#"target.'cfg(unix)'.runner=["env", "RUSTC_BOOTSTRAP=1"]"#]);
        }
        tests.args(filter).arg("--");
        if cfg!(unix) {
            tests.args(["-Zunstable-options", "--report-time"]);
        }
        if !long {
            tests.args(["--skip", LONG_ONLY]);
        }
        if !names.is_empty() {
            tests.arg("--exact").args(names);
        }
        watch(&mut tests, Stream::Out, &mut see)
    });
    good &= ran?;
    let cpu = cpu_before.zip(cpu_secs_of_children()).map(|(before, after)| after - before);
    // Without a library there are no examples in the documentation, and cargo objects.
    if names.is_empty() && package.is_none_or(|package| !["lovelock", "lovelock-chores"].contains(&package)) {
        let mut examples = cargo(&["test", "--release", "--doc", "--no-fail-fast"]);
        good &= watch(examples.args(&scope).args(filter), Stream::Out, &mut see)?;
    }
    let cores = std::thread::available_parallelism().map_or(1.0, |cores| cores.get() as f64);
    times.crowding = cpu.map_or(1.0, |cpu| (wall.as_secs_f64() * cores / cpu.max(1.0)).max(1.0));
    let outcome = (|| {
        ensure!(totals.failed == 0, "{} of the tests failed", totals.failed);
        ensure!(good, "the tests did not run to their end; the reason stands above");
        Ok(())
    })();
    Ok(Ran { totals, times, outcome })
}
