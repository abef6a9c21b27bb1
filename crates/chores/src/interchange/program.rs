//! Building and running Lovelock.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Builds Lovelock, unless the environment names its program, and returns the path.
pub(super) fn build() -> anyhow::Result<PathBuf> {
    if let Some(program) = std::env::var_os(tool::PROGRAM) {
        return Ok(program.into());
    }
    let mut cargo = tool::cargo(&["build", "--quiet", "--package", "lovelock", "--message-format", "json"]);
    let output = cargo.stderr(Stdio::inherit()).output().context("could not start cargo")?;
    ensure!(output.status.success(), "Lovelock could not be built");
    let messages = String::from_utf8_lossy(&output.stdout);
    let mut programs = messages.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        let is_program = message["target"]["name"] == "lovelock";
        message["executable"].as_str().filter(|_| is_program).map(PathBuf::from)
    });
    programs.next_back().context("cargo named no program")
}

/// A command of Lovelock that prints JSON.
pub(super) fn lovelock(program: &Path, command: &str) -> Command {
    let mut lovelock = Command::new(program);
    lovelock.args([command, "--json"]).stdin(Stdio::null());
    lovelock
}

/// Runs it and returns its JSON.
pub(super) fn run_json(command: &mut Command) -> anyhow::Result<Value> {
    let shown = tool::shown(command);
    let output = command.output().with_context(|| format!("could not start `{shown}`"))?;
    let told = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "`{shown}` failed ({}): {}", output.status, told.trim());
    serde_json::from_slice(&output.stdout).with_context(|| format!("`{shown}` printed no JSON"))
}
