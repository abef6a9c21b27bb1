//! Tells the program its version with the commit and its date, where the source is a checkout, and gives it its icon on Windows.

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
    embed_icon();
}

/// Puts the icon into the program for Windows, with its name and version. Untried: nobody has built it there yet.
#[cfg(windows)]
fn embed_icon() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let icon = format!("{folder}/../packaging/windows/lovelock.ico");
    println!("cargo::rerun-if-changed={icon}");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("windows") {
        return;
    }
    let embedded = winresource::WindowsResource::new()
        .set("ProductName", "Lovelock")
        .set("FileDescription", "Lovelock")
        .set_icon(&icon)
        .compile_for("lovelock");
    if let Err(error) = embedded {
        // The program works without it.
        println!("cargo::warning={icon}: could not be put into the program: {error}");
    }
}

#[cfg(not(windows))]
fn embed_icon() {}

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
