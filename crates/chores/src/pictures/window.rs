//! Screenshots of the window.

use super::images;
use crate::latency::Closed;
use crate::latency::screen::Screen;
use anyhow::{Context as _, bail, ensure};
use image::RgbImage;
use lovelock_xtask::tool;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

/// Size of the screen: that of the window at its first start, and a margin for the pointer.
const SCREEN: (u16, u16) = (1480, 940);
/// Beside the window, so that the pointer highlights nothing in it.
const BESIDE: (i16, i16) = (1470, 930);
/// Interval and number of the checks whether the window is closed: ten minutes in all.
const LOOKS: (Duration, u32) = (Duration::from_millis(200), 3000);

/// The window on a screen of its own, opened with these options.
pub(super) fn screenshot(folder: &Path, options: &str) -> anyhow::Result<RgbImage> {
    // An empty home folder: the window has the layout of a first start, and the user's own settings are not touched.
    let home = folder.join("home");
    fs::create_dir_all(&home).with_context(|| format!("could not create {}", home.display()))?;
    let out = folder.join("window.png");
    let screen = Screen::start(SCREEN.0, SCREEN.1)?;
    screen.point(BESIDE)?;
    let mut lovelock = Command::new(tool::program());
    lovelock.args(options.split_whitespace()).arg("--screenshot").arg(&out).current_dir(tool::root());
    lovelock.env("DISPLAY", screen.name()).env_remove("WAYLAND_DISPLAY");
    lovelock.envs(["HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"].map(|name| (name, &home)));
    let shown = tool::shown(&lovelock);
    let child = lovelock.spawn().with_context(|| format!("could not start `{shown}`"))?;
    let mut window = Closed(child);
    for _ in 0..LOOKS.1 {
        if let Some(status) = window.0.try_wait()? {
            ensure!(status.success(), "`{shown}` failed ({status})");
            return images::read(&out);
        }
        sleep(LOOKS.0);
    }
    bail!("`{shown}` did not end within ten minutes")
}
