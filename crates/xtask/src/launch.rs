//! `cargo xtask run`: opens the window, or records the default dance if there is no display.

use lovelock_xtask::{system, tool};
use std::ffi::{OsStr, OsString};
use std::process::Command;

/// The film that is recorded if there is no display.
const FILM: &str = "out/dance.mp4";

/// Builds Lovelock optimised and starts it.
pub(crate) fn run(arguments: &[OsString]) -> anyhow::Result<()> {
    system::prepare()?;
    println!("Building Lovelock, optimised. The first time takes some minutes.");
    tool::build_programs()?;
    let mut lovelock = Command::new(tool::program());
    if arguments.is_empty() && !has_display(cfg!(target_os = "linux"), |name| std::env::var_os(name)) {
        println!(
            "There is no display (neither DISPLAY nor WAYLAND_DISPLAY is set): recording the default dance to {FILM}."
        );
        tool::run(lovelock.args(["record", "-o", FILM]).current_dir(tool::root()))?;
        println!("The dance is in {}.", tool::root().join(FILM).display());
        return Ok(());
    }
    tool::run(lovelock.args(arguments))
}

/// Whether a window can be opened. On macOS and Windows this is assumed.
fn has_display(by_environment: bool, variable: impl Fn(&str) -> Option<OsString>) -> bool {
    let set = |name| variable(name).is_some_and(|value| value.as_os_str() != OsStr::new(""));
    !by_environment || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(set)
}

#[cfg(test)]
mod tests {
    use super::has_display;

    #[test]
    fn a_display_is_one_of_three_variables_and_not_empty() {
        let only = |set: &'static str, value: &'static str| {
            has_display(true, move |name| (name == set).then(|| value.into()))
        };
        assert!(only("DISPLAY", ":0") && only("WAYLAND_DISPLAY", "wayland-0") && only("WAYLAND_SOCKET", "5"));
        assert!(!only("DISPLAY", "") && !only("TERM", "xterm"));
        assert!(has_display(false, |_| None), "other systems always have a display");
    }
}
