//! Chromium without a window.

use super::facts::Facts;
use crate::tool;
use anyhow::{Context as _, ensure};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// How the browser runs: without a window, a graphics card or anything of its own to ask the network for. Names lead
/// nowhere, so what it asks for all the same stays on this machine.
const FLAGS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    // Time in the page runs ahead until nothing is left to do.
    "--virtual-time-budget=10000",
    "--disable-dev-shm-usage",
];

/// Pixels across the window that a page is laid out for.
const WIDTH: u32 = 1280;

/// No page that is looked at is taller: beyond it the picture ends.
const TALLEST: u32 = 16_000;

/// How often and how many times to look whether the browser has ended: two minutes.
const LOOKS: (Duration, u32) = (Duration::from_millis(50), 2400);

/// A browser that forgets.
pub(crate) struct Browser {
    profile: PathBuf,
}

impl Browser {
    /// One that keeps its files in `profile`, which is emptied for each page.
    pub(crate) fn new(profile: PathBuf) -> Self {
        Self { profile }
    }

    /// Loads a page, runs its script and reads what became of it.
    pub(crate) fn open(&self, page: &Path) -> anyhow::Result<Facts> {
        let [dom, log] = ["dom.html", "network.json"].map(|name| self.profile.with_extension(name));
        let mut chromium = self.command(800)?;
        chromium.arg(format!("--log-net-log={}", log.display())).arg("--dump-dom").arg(page);
        self.finish(chromium.stdout(File::create(&dom)?))?;
        Facts::read(&fs::read_to_string(&dom)?, &fs::read(&log)?)
    }

    /// Draws a whole page of `height` CSS pixels into a PNG file.
    pub(crate) fn screenshot(&self, page: &Path, picture: &Path, height: u32) -> anyhow::Result<()> {
        let mut chromium = self.command(height.clamp(1, TALLEST))?;
        chromium.arg(format!("--screenshot={}", picture.display())).arg(page);
        self.finish(chromium.stdout(Stdio::null()))?;
        ensure!(picture.is_file(), "the browser left no picture of the page");
        Ok(())
    }

    /// The browser with an empty profile and a window of `height` pixels.
    fn command(&self, height: u32) -> anyhow::Result<Command> {
        if self.profile.exists() {
            fs::remove_dir_all(&self.profile)?;
        }
        fs::create_dir_all(&self.profile)?;
        let mut chromium = Command::new("chromium");
        chromium.args(FLAGS).arg(format!("--user-data-dir={}", self.profile.display()));
        chromium.arg(format!("--window-size={WIDTH},{height}"));
        Ok(chromium)
    }

    /// Waits for the end of the browser, and ends it where it does not end by itself.
    fn finish(&self, chromium: &mut Command) -> anyhow::Result<()> {
        let words = self.profile.with_extension("log");
        chromium.stdin(Stdio::null()).stderr(File::create(&words)?);
        let mut child = chromium.spawn().context("could not start `chromium`")?;
        for _ in 0..LOOKS.1 {
            if let Some(status) = child.try_wait()? {
                let said = || fs::read_to_string(&words).unwrap_or_default();
                ensure!(status.success(), "`{}` failed ({status}): {}", tool::shown(chromium), said().trim());
                return Ok(());
            }
            std::thread::sleep(LOOKS.0);
        }
        child.kill()?;
        child.wait()?;
        anyhow::bail!("`{}` did not end within two minutes", tool::shown(chromium));
    }
}
