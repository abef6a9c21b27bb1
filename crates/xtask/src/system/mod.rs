//! Installs missing system packages.

mod needs;
mod plan;
mod probe;

use anyhow::bail;
use needs::{BROWSER, COUNT, FILM, INTERCHANGE, NEEDS, Need, SCREEN, TRIAL};
use plan::{Plan, Rights, Step, plan};
use probe::ThisMachine;
use std::process::Command;

/// Installs the system packages for building, testing and the window.
///
/// On Debian and related distributions missing packages are installed; elsewhere the command for installing them is printed.
/// Only a missing compiler is an error. Without the other packages the window or GPU rendering does not work, and a warning
/// says so. macOS and Windows need no packages.
///
/// # Errors
/// If a compiler is missing and cannot be installed.
pub fn prepare() -> anyhow::Result<()> {
    get(&NEEDS)
}

/// Installs the system packages for `cargo xtask test --interchange`.
///
/// # Errors
/// If a compiler is missing and cannot be installed.
pub fn prepare_interchange() -> anyhow::Result<()> {
    get(&INTERCHANGE)
}

/// Installs the system packages for `cargo xtask test --browser`.
///
/// # Errors
/// If a compiler is missing and cannot be installed.
pub fn prepare_browser() -> anyhow::Result<()> {
    get(&BROWSER)
}

/// Installs the system packages for windows on a virtual screen, as `cargo xtask latency` opens them.
///
/// # Errors
/// If a compiler is missing and cannot be installed.
pub fn prepare_screen() -> anyhow::Result<()> {
    get(&SCREEN)
}

/// Installs the system packages for the images that `cargo xtask pictures` takes out of films.
///
/// # Errors
/// If ffmpeg is missing and cannot be installed.
pub fn prepare_film() -> anyhow::Result<()> {
    get(&FILM)
}

/// Installs the system packages for `cargo xtask package --try`.
///
/// # Errors
/// If debootstrap is missing and cannot be installed.
pub fn prepare_trial() -> anyhow::Result<()> {
    get(&TRIAL)
}

/// Installs the system packages for `cargo xtask count`.
///
/// # Errors
/// If valgrind is missing and cannot be installed.
pub fn prepare_count() -> anyhow::Result<()> {
    get(&COUNT)
}

fn get(needs: &[Need]) -> anyhow::Result<()> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let Some(first) = plan(&ThisMachine::new(), needs) else {
        return Ok(());
    };
    name(&first);
    if let Step::Install { rights, update_first, packages } = &first.step {
        println!("Installing with apt-get: {}", packages.join(" "));
        install(*rights, *update_first, packages);
    }
    let Some(left) = plan(&ThisMachine::new(), needs) else {
        return Ok(());
    };
    let what: Vec<_> = left.missing.iter().map(|need| need.what).collect();
    let advice = advice(&left);
    if left.stops_the_build() {
        bail!("missing: {}. {advice}", what.join(", "));
    }
    eprintln!("Still missing: {}. {advice} Continuing without.", what.join(", "));
    Ok(())
}

fn name(plan: &Plan) {
    println!("Missing on this system:");
    for need in &plan.missing {
        match need.test {
            needs::Test::Library(library) => println!("  {} ({library})", need.what),
            _ => println!("  {}", need.what),
        }
    }
}

/// Advice for the user.
fn advice(plan: &Plan) -> String {
    match &plan.step {
        Step::Install { packages, .. } => {
            format!("Installing {} with apt-get did not help.", packages.join(" "))
        }
        Step::Say { command } => format!("Install with: {command}"),
        Step::Name => "Install these with this system's package manager.".into(),
    }
}

/// Installs packages. If this fails, updates the package lists and tries again, because old lists may contain removed packages.
fn install(rights: Rights, update_first: bool, packages: &[&str]) {
    let update = || apt_get(rights, &["update"]);
    let install = || apt_get(rights, &[&["install", "-y", "--no-install-recommends"], packages].concat());
    if update_first {
        update();
    }
    if !install() && !update_first {
        update();
        install();
    }
}

/// Runs apt-get without questions. Returns whether it succeeded.
fn apt_get(rights: Rights, arguments: &[&str]) -> bool {
    let before: &[&str] = match rights {
        Rights::Root => &["env"],
        Rights::FreeSudo => &["sudo", "-n", "env"],
        Rights::AskingSudo => &["sudo", "env"],
    };
    let words = [before, &["DEBIAN_FRONTEND=noninteractive", "apt-get", "-q"], arguments].concat();
    Command::new(words[0]).args(&words[1..]).status().is_ok_and(|status| status.success())
}
