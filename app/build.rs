//! Tells the program its version with the commit and its date, where the source is a checkout.

use std::path::Path;
use std::process::Command;

fn main() {
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    // Packagers that build from an archive state the commit themselves.
    println!("cargo::rerun-if-env-changed=LOVELOCK_COMMIT");
    let stated = std::env::var("LOVELOCK_COMMIT").ok();
    let commit = stated.or_else(|| {
        if is_own() { git(&["show", "--no-patch", "--abbrev=8", "--format=%h, %cs", "HEAD"]) } else { None }
    });
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    let version = commit.map_or_else(|| version.clone(), |commit| format!("{version} ({commit})"));
    println!("cargo::rustc-env=LOVELOCK_VERSION={version}");
}

/// Whether the checkout is that of this program, and not one that an archive of it was unpacked in.
fn is_own() -> bool {
    let root =
        std::env::var_os("CARGO_MANIFEST_DIR").and_then(|app| Path::new(&app).parent()?.canonicalize().ok());
    let top = git(&["rev-parse", "--show-toplevel"]).and_then(|top| Path::new(&top).canonicalize().ok());
    root.is_some() && root == top
}

/// What git prints, or nothing outside a checkout.
fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (!text.is_empty()).then_some(text)
}
