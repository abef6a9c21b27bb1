//! Headless Chromium.

use super::facts::Facts;
use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Options of the browser: no window, no GPU and no background requests. No host names are resolved, so that other requests
/// stay on this machine.
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
    // Time in the page advances until there is nothing left to do.
    "--virtual-time-budget=10000",
    "--disable-dev-shm-usage",
];

/// Width of the window in pixels.
const WIDTH: u32 = 1280;

/// Largest height of a page in pixels. The screenshot ends there.
const TALLEST: u32 = 16_000;

/// Interval and number of the checks whether the browser has ended: two minutes in all.
const LOOKS: (Duration, u32) = (Duration::from_millis(50), 2400);

/// A browser without stored data.
pub(crate) struct Browser {
    profile: PathBuf,
}

impl Browser {
    /// A browser with its files in `profile`, which is emptied for each page.
    pub(crate) fn new(profile: PathBuf) -> Self {
        Self { profile }
    }

    /// Loads a page, runs its script and returns the result.
    pub(crate) fn open(&self, page: &Path) -> anyhow::Result<Facts> {
        let [dom, log] = ["dom.html", "network.json"].map(|name| self.profile.with_extension(name));
        let mut chromium = self.command(800)?;
        chromium.arg(format!("--log-net-log={}", log.display())).arg("--dump-dom").arg(page);
        self.finish(chromium.stdout(File::create(&dom)?))?;
        Facts::read(&fs::read_to_string(&dom)?, &fs::read(&log)?)
    }

    /// Saves a screenshot of a whole page of `height` CSS pixels as a PNG file.
    pub(crate) fn screenshot(&self, page: &Path, picture: &Path, height: u32) -> anyhow::Result<()> {
        let mut chromium = self.command(height.clamp(1, TALLEST))?;
        chromium.arg(format!("--screenshot={}", picture.display())).arg(page);
        self.finish(chromium.stdout(Stdio::null()))?;
        ensure!(picture.is_file(), "the browser saved no screenshot of the page");
        Ok(())
    }

    /// The command of the browser, with an empty profile and a window of `height` pixels.
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

    /// Waits for the browser to end, and kills it after two minutes.
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
