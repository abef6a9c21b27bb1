//! Tells the program its version with the commit and its date, where the source is a checkout.

use std::process::Command;

fn main() {
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    // Packagers that build from an archive state the commit themselves.
    println!("cargo::rerun-if-env-changed=LOVELOCK_COMMIT");
    let stated = std::env::var("LOVELOCK_COMMIT").ok();
    let commit = stated.or_else(|| git(&["show", "--no-patch", "--abbrev=8", "--format=%h, %cs", "HEAD"]));
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    let version = commit.map_or_else(|| version.clone(), |commit| format!("{version} ({commit})"));
    println!("cargo::rustc-env=LOVELOCK_VERSION={version}");
}

/// What git prints, or nothing outside a checkout of this program.
fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (!text.is_empty()).then_some(text)
}
