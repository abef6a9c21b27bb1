//! Lints and documentation from the same build as the tests: a pass of their own would read every library again.
//!
//! Cargo compiles own crates by the program in `RUSTC_WORKSPACE_WRAPPER`, here Clippy's compiler, which lints what it compiles. It writes the
//! documentation by the program in `RUSTDOC`, here this one, which also documents each crate whose examples cargo tests.

use crate::totals::without_colours;
use anyhow::{Context as _, bail, ensure};
use lovelock_xtask::tool::{self, Stream, watch};
use std::ffi::OsString;
use std::process::Command;

const COMPILER: (&str, &str) = ("RUSTC_WORKSPACE_WRAPPER", "clippy-driver");

/// Runs this program again with the compiler and the rustdoc that check, unless it runs with them. Returns whether it did.
pub(crate) fn run_checked(arguments: &[&str]) -> anyhow::Result<bool> {
    if std::env::var_os(COMPILER.0).is_some_and(|program| program == COMPILER.1) {
        return Ok(false);
    }
    let own = std::env::current_exe().context("could not find this program")?;
    tool::run(Command::new(&own).args(arguments).env(COMPILER.0, COMPILER.1).env("RUSTDOC", &own))?;
    Ok(true)
}

/// Runs a build, and fails if it fails or a lint of an own crate objects.
pub(crate) fn build(command: &mut Command) -> anyhow::Result<()> {
    let mut found = Vec::new();
    let good = watch(command, Stream::Err, |line| found.extend(warned(&without_colours(line))))?;
    ensure!(good, "`{}` failed", tool::shown(command));
    ensure!(found.is_empty(), "found warnings in {}; must be none", found.join(", "));
    Ok(())
}

/// The crate and the target of a line in which cargo sums up warnings.
fn warned(line: &str) -> Option<String> {
    let (target, rest) = line.strip_prefix("warning: `")?.split_once(" generated ")?;
    rest.contains("warning").then(|| target.replace('`', ""))
}

/// Whether cargo runs this program as its rustdoc.
pub(crate) fn is_rustdoc(arguments: &[OsString]) -> bool {
    let own = || std::env::current_exe().ok();
    arguments.first().is_some_and(|first| first.to_string_lossy().starts_with('-'))
        && std::env::var_os("RUSTDOC").is_some_and(|program| own().is_some_and(|own| own == program))
}

/// Does what rustdoc does with these arguments. Where they test examples, it also writes the documentation, in which a warning is an error.
pub(crate) fn rustdoc(arguments: &[OsString]) -> anyhow::Result<()> {
    if let Some(document) = without_tests(arguments) {
        let mut rustdoc = Command::new("rustdoc");
        rustdoc.args(document).args(["--deny", "warnings", "--out-dir"]).arg(tool::target().join("doc"));
        // The arguments are hundreds of libraries.
        let status = rustdoc.status().context("could not start rustdoc")?;
        ensure!(status.success(), "the documentation has the faults above");
    }
    if !Command::new("rustdoc").args(arguments).status().context("could not start rustdoc")?.success() {
        bail!("rustdoc failed; the reason stands above");
    }
    Ok(())
}

/// The arguments without those that only testing has; `None` if they do not test.
fn without_tests(arguments: &[OsString]) -> Option<Vec<OsString>> {
    const WITH_VALUE: [&str; 4] =
        ["--test-run-directory", "--test-args", "--test-runtool", "--doctest-build-arg"];
    let mut kept = Vec::new();
    let mut tests = false;
    let mut all = arguments.iter();
    while let Some(argument) = all.next() {
        match argument.to_string_lossy().as_ref() {
            "--test" => tests = true,
            "--no-run" => {}
            option if WITH_VALUE.contains(&option) => {
                all.next();
            }
            _ => kept.push(argument.clone()),
        }
    }
    tests.then_some(kept)
}

#[cfg(test)]
mod tests {
    use super::{warned, without_tests};
    use std::ffi::OsString;

    #[test]
    fn sums_of_warnings_are_found() {
        let found = |line| warned(line);
        assert_eq!(
            found("warning: `lovelock-usd` (lib test) generated 2 warnings").as_deref(),
            Some("lovelock-usd (lib test)")
        );
        for other in ["warning: unused variable: `generated`", "   Compiling lovelock-usd", "error: no"] {
            assert_eq!(found(other), None, "{other}");
        }
    }

    #[test]
    fn arguments_of_tests_are_left_out_of_the_documentation() {
        let of = |words: &str| words.split(' ').map(OsString::from).collect::<Vec<_>>();
        let given = of("--crate-name a --test src/lib.rs --test-run-directory /a/b -L dependency=c");
        assert_eq!(without_tests(&given), Some(of("--crate-name a src/lib.rs -L dependency=c")));
        assert_eq!(without_tests(&of("--version --verbose")), None);
    }
}
