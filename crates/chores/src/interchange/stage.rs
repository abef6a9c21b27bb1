//! USD stages, read by Pixar's library and its validators.

use super::program::{lovelock, run_json};
use anyhow::{Context as _, ensure};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Frames that are written, and frames per second.
const FRAMES: [u64; 2] = [3, 7];
const FPS: f64 = 24.0;

/// Writes stages of the small scene and reads them with Pixar's library.
pub(super) fn check(python: &Path, folder: &Path, program: &Path) -> anyhow::Result<()> {
    let folder = folder.join("stage");
    super::empty(&folder)?;
    let project = folder.join("small.lovelock");
    fs::write(&project, include_str!("../browser/small.lovelock"))?;
    let [first, end] = FRAMES;
    let (frames, fps) = (format!("{first}..{end}"), FPS.to_string());
    for (name, curves) in
        [("strands.usdc", "strands"), ("strands.usda", "strands"), ("guides.usdc", "guides")]
    {
        let mut record = lovelock(program, "record");
        record.arg(&project).arg("-o").arg(folder.join(name));
        run_json(record.args(["--curves", curves, "--frames", &frames, "--fps", &fps]))?;
    }
    let info = run_json(lovelock(program, "info").arg(folder.join("strands.usdc")))?;
    fs::write(folder.join("info.json"), info.to_string())?;
    let request = serde_json::json!({ "frames": FRAMES, "fps": FPS });
    fs::write(folder.join("request.json"), request.to_string())?;

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/interchange/usd_stage.py");
    let output = Command::new(python).arg(&script).arg(&folder).output();
    let output = output.with_context(|| format!("could not start {}", python.display()))?;
    let told = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{}", told.trim());
    let faults = String::from_utf8_lossy(&output.stdout);
    ensure!(faults.trim().is_empty(), "{}", faults.trim());
    println!("interchange: usd-core reads the stages: {}", told.lines().last().unwrap_or_default());
    Ok(())
}
