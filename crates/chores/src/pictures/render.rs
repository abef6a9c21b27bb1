//! Images that Lovelock renders without a window, and programs of others that turn its files into images.

use super::images;
use crate::browser::chromium::Browser;
use anyhow::{Context as _, bail};
use image::RgbImage;
use lovelock_xtask::tool;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A body and hair that do not move.
const STILL: &str = "--set motion.source=Rest --set timeline.preroll_secs=0";
/// Hair that strokes are played on, and the strokes.
const STROKES: &str = "--preset long --strokes docs/examples/asymmetric.lovelockstrokes";

/// The height of the part of a page that is shown, pixels.
const PAGE_HEIGHT: u32 = 1800;

/// A frame of a project, or of a new one. The options name one frame.
pub(super) fn frame(folder: &Path, project: Option<&Path>, options: &[&str]) -> anyhow::Result<RgbImage> {
    let out = folder.join("frame");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("could not remove {}", out.display()))?;
    }
    let mut record = lovelock("record", options);
    tool::run(record.args(project).args(["--backend", "cpu", "-o"]).arg(&out))?;
    let mut files = Vec::new();
    for entry in fs::read_dir(&out).with_context(|| format!("could not list {}", out.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "png") {
            files.push(path);
        }
    }
    let [file] = files.as_slice() else {
        bail!("{}: found {} images; must be one", out.display(), files.len());
    };
    images::read(file)
}

/// The hair of a project, or of a new one, at rest.
pub(super) fn rest(folder: &Path, project: Option<&Path>, options: &[&str]) -> anyhow::Result<RgbImage> {
    frame(folder, project, &[options, &["--frames 0..1", STILL]].concat())
}

/// A contact sheet of hairstyles.
pub(super) fn sheet(folder: &Path, options: &str) -> anyhow::Result<RgbImage> {
    let out = folder.join("sheet.png");
    tool::run(lovelock("presets", &[options, "--backend cpu --sheet"]).arg(&out))?;
    images::read(&out)
}

/// The upper part of the page of a comparison in a browser.
pub(super) fn page(folder: &Path, options: &str) -> anyhow::Result<RgbImage> {
    let (report, out) = (folder.join("report"), folder.join("page.png"));
    tool::run(lovelock("compare", &[options, "-o"]).arg(&report))?;
    Browser::new(folder.join("profile")).screenshot(&report.join("report.html"), &out, PAGE_HEIGHT)?;
    images::read(&out)
}

/// Plays the first `count` strokes on hair at rest, or all of them. Returns the path of the project.
pub(super) fn brushed(folder: &Path, count: Option<u32>) -> anyhow::Result<PathBuf> {
    let out = folder.join("brushed.lovelock");
    let mut style = lovelock("style", &[STROKES, STILL, "--force"]);
    if let Some(count) = count {
        style.args(["--count", &count.to_string()]);
    }
    tool::run(style.arg("-o").arg(&out))?;
    Ok(out)
}

/// Films how the strokes are played during the dance. Returns the images at these seconds.
pub(super) fn film(folder: &Path, view: &str, secs: &[u32]) -> anyhow::Result<Vec<RgbImage>> {
    let (film, project) = (folder.join("film.mp4"), folder.join("combed.lovelock"));
    let mut style = lovelock("style", &[STROKES, "--on-dance 0.5", view]);
    tool::run(style.arg("--film").arg(&film).arg("-o").arg(&project))?;
    let mut frames = Vec::new();
    for secs in secs {
        let out = folder.join(format!("film_{secs}.png"));
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-v", "error", "-y", "-ss", &secs.to_string(), "-i"]).arg(&film);
        tool::run(ffmpeg.args(["-frames:v", "1"]).arg(&out).stdin(Stdio::null()))?;
        frames.push(images::read(&out)?);
    }
    Ok(frames)
}

/// The image `name` of the two that the example `brush` draws.
pub(super) fn plate(folder: &Path, name: &str) -> anyhow::Result<RgbImage> {
    let example = ["run", "--release", "--package", "lovelock-simulation", "--example", "brush", "--"];
    let files = ["hair_with_grid.png", "hair_without_grid.png"].map(|file| folder.join(file));
    tool::run(tool::cargo(&example).args(&files))?;
    images::read(&folder.join(format!("{name}.png")))
}

/// A command of Lovelock in the root of the workspace, because options name examples from there. Options are split at spaces.
fn lovelock(command: &str, options: &[&str]) -> Command {
    let mut lovelock = Command::new(tool::program());
    lovelock.arg(command).args(options.iter().copied().flat_map(str::split_whitespace));
    lovelock.current_dir(tool::root()).stdin(Stdio::null()).stdout(Stdio::null());
    lovelock
}
