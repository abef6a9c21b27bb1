//! Running Lovelock.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

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
