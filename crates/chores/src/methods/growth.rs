//! How time and memory of a method grow with the number of segments.

use super::BENCH;
use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use serde::Deserialize;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The methods that are measured.
const METHODS: [&str; 13] = [
    "none",
    "voxel-map",
    "opacity-maps",
    "deep-opacity-maps",
    "density-clustering",
    "occupancy-maps",
    "deep-shadow-maps",
    "approximate-deep",
    "fourier",
    "adaptive",
    "moments",
    "voxel-march",
    "exact",
];

/// The part of `lovelock bench --json` that is shown.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Bench {
    pub(super) scenes: Vec<Scene>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Scene {
    pub(super) segments: u64,
    pub(super) shadow_bytes: u64,
    stages: Vec<Stage>,
}

#[derive(Clone, Debug, Deserialize)]
struct Stage {
    name: String,
    median_ms: f64,
}

impl Scene {
    /// Milliseconds to build and look up.
    pub(super) fn ms(&self) -> f64 {
        let is_map = |stage: &&Stage| ["shadow/build", "shadow/ask"].contains(&stage.name.as_str());
        self.stages.iter().filter(is_map).map(|stage| stage.median_ms).sum()
    }
}

/// Measures each method with few and many segments; those in `folder` already are kept.
pub(super) fn measure(folder: &Path) -> anyhow::Result<Vec<(&'static str, Bench)>> {
    fs::create_dir_all(folder).with_context(|| format!("could not create {}", folder.display()))?;
    METHODS.into_iter().map(|method| Ok((method, one(folder, method)?))).collect()
}

fn one(folder: &Path, method: &str) -> anyhow::Result<Bench> {
    let file = folder.join(format!("{method}.json"));
    if let Some(known) = fs::read(&file).ok().and_then(|text| serde_json::from_slice(&text).ok()) {
        return Ok(known);
    }
    let mut lovelock = Command::new(tool::program());
    lovelock.arg("bench").args(BENCH.split_whitespace()).args(["--shadow", method, "--json"]);
    let output = lovelock.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("could not start {}", tool::shown(&lovelock)))?;
    ensure!(output.status.success(), "`{}` failed ({})", tool::shown(&lovelock), output.status);
    fs::write(&file, &output.stdout).with_context(|| format!("could not write {}", file.display()))?;
    serde_json::from_slice(&output.stdout).with_context(|| file.display().to_string())
}
