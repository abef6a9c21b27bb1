//! Running other programs, and measuring time.

use anyhow::{Context as _, ensure};
use std::io::{BufRead as _, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// The root folder of the workspace.
pub fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().and_then(Path::parent).unwrap_or(here)
}

/// The folder with what cargo builds.
pub fn target() -> PathBuf {
    root().join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// A program of own code that has been built: Lovelock itself by [`program`], or another by its name.
pub fn built(name: &str) -> PathBuf {
    target().join("release").join(name)
}

/// Lovelock. It is built before a chore starts.
pub fn program() -> PathBuf {
    built("lovelock")
}

/// Builds Lovelock and the chores, optimised. Both at once, because their libraries have the same features as those of the tests.
///
/// # Errors
/// If cargo fails.
pub fn build_programs() -> anyhow::Result<()> {
    run(&mut cargo(&["build", "--release", "--package", "lovelock", "--package", "lovelock-chores"]))
}

/// The cargo that runs this program, in the folder of the workspace.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// Runs a program. Fails if it cannot be started or does not succeed.
///
/// # Errors
/// If it cannot be started or its exit status is not 0.
pub fn run(command: &mut Command) -> anyhow::Result<()> {
    let shown = shown(command);
    let status = command.status().with_context(|| format!("could not start `{shown}`"))?;
    ensure!(status.success(), "`{shown}` failed ({status})");
    Ok(())
}

/// The output of a program that is read line by line.
#[derive(Clone, Copy)]
pub enum Stream {
    /// Standard output.
    Out,
    /// Standard error.
    Err,
}

/// Runs a program to its end, shows all that it prints, and hands every line of one stream to `see`.
/// Returns whether it succeeded.
///
/// # Errors
/// Where it cannot be started or its output cannot be read.
pub fn watch(command: &mut Command, stream: Stream, mut see: impl FnMut(&str)) -> anyhow::Result<bool> {
    let shown = shown(command);
    match stream {
        Stream::Out => command.stdout(Stdio::piped()),
        Stream::Err => command.stderr(Stdio::piped()),
    };
    let mut child = command.spawn().with_context(|| format!("could not start `{shown}`"))?;
    if let Some(out) = child.stdout.take() {
        copy_lines(out, &mut std::io::stdout(), &mut see)?;
    }
    if let Some(errors) = child.stderr.take() {
        copy_lines(errors, &mut std::io::stderr(), &mut see)?;
    }
    Ok(child.wait()?.success())
}

fn copy_lines(from: impl Read, to: &mut impl Write, see: &mut impl FnMut(&str)) -> anyhow::Result<()> {
    let mut from = BufReader::new(from);
    let mut line = Vec::new();
    while from.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        see(&String::from_utf8_lossy(&line));
        line.clear();
    }
    Ok(())
}

/// The standard output of a program, if it can be started and succeeds.
pub fn output_of(program: &str, arguments: &[&str]) -> Option<String> {
    let output =
        Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A command as it would be typed in a shell.
pub fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words.map(std::ffi::OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
}

/// Measures the time that something takes. The stopwatch of `lovelock-base` would make this crate wait for that crate's libraries.
#[expect(clippy::disallowed_methods, reason = "tasks report how long they took; no result depends on it")]
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = std::time::Instant::now();
    let result = work();
    (result, start.elapsed())
}
