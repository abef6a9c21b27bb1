//! Files of Blender, in both directions: it opens what Lovelock wrote, and Lovelock opens what Blender wrote.

use super::Blender;
use super::program::{lovelock, run_json};
use crate::python::{environment_of, is_made};
use anyhow::{Context as _, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Versions of Blender as a Python package: the one with long support, and the newest. They want exactly this version of Python.
const PACKAGES: [&str; 2] = ["bpy==4.5.4", "bpy==5.0.1"];
const PYTHON: &str = "python3.11";

/// Frames that are written, and frames per second.
const FRAMES: [u64; 2] = [3, 9];
const FPS: f64 = 24.0;
/// The most that a length of a file of Blender may be off, metres.
const LIMIT: f64 = 0.01;

/// Writes the small scene in the formats that Blender reads, and reads those that it writes. Says why it does not, where this Python or a version
/// that may not be installed is missing.
pub(super) fn check(folder: &Path, program: &Path, versions: Blender) -> anyhow::Result<()> {
    if Command::new(PYTHON).arg("--version").output().is_err() {
        println!("interchange: left out Blender: {} wants {PYTHON}, which is not installed", PACKAGES[0]);
        return Ok(());
    }
    if versions == Blender::IfInstalled && !is_made(&place(folder, PACKAGES[0])) {
        println!("interchange: left out Blender: `cargo xtask test --interchange` installs {}", PACKAGES[0]);
        return Ok(());
    }
    let count = if versions == Blender::Every { PACKAGES.len() } else { 1 };
    PACKAGES[..count].iter().try_for_each(|package| check_version(folder, program, package))
}

/// The folder of a version's Python.
fn place(folder: &Path, package: &str) -> PathBuf {
    folder.join(format!("{}-python", package.replace("bpy==", "blender-")))
}

fn check_version(folder: &Path, program: &Path, package: &str) -> anyhow::Result<()> {
    let name = package.replace("bpy==", "blender-");
    let python = environment_of(PYTHON, &place(folder, package), &[package])?;
    let loads = Command::new(&python).args(["-c", "import bpy"]).output();
    if let Err(why) = loads.context("it does not start").and_then(|output| {
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
        Ok(())
    }) {
        println!("interchange: left out Blender, which cannot be loaded on this system: {why:#}");
        return Ok(());
    }
    let folder = folder.join(name);
    super::empty(&folder)?;
    let project = folder.join("small.lovelock");
    fs::write(&project, include_str!("../browser/small.lovelock"))?;
    let [first, end] = FRAMES;
    let fps = FPS.to_string();
    let files = ["strands.abc", "strands.usdc", "strands.glb"];
    // A film of glTF is a mesh of its own per frame.
    for (name, end) in files.into_iter().zip([end, end, first + 1]) {
        let frames = format!("{first}..{end}");
        let mut record = lovelock(program, "record");
        record.arg(&project).arg("-o").arg(folder.join(name));
        run_json(record.args(["--curves", "strands", "--frames", &frames, "--fps", &fps]))?;
    }
    let info = run_json(lovelock(program, "info").arg(folder.join("strands.usdc")))?;
    let bounds = &info["bounds_m"];
    let request = json!({
        "files": files, "frames": FRAMES, "fps": FPS, "body": true,
        "curves": info["strands"], "points": info["points"], "bounds": [bounds["min"], bounds["max"]],
    });
    fs::write(folder.join("request.json"), request.to_string())?;

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/interchange/blender_scene.py");
    let output = Command::new(&python).arg(&script).arg(&folder).output();
    let output = output.with_context(|| format!("could not start {}", python.display()))?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    let told: Value = serde_json::from_str(&fs::read_to_string(folder.join("told.json"))?)?;
    let mut faults: Vec<String> = strings(&told["faults"]);
    let written = told["written"].as_array().context("the script named no files")?;
    for file in written {
        let name = file["file"].as_str().context("a file has no name")?;
        match run_json(lovelock(program, "info").arg(folder.join(name))) {
            Ok(info) => {
                faults.extend(differences(file, &info).into_iter().map(|fault| format!("{name}: {fault}")));
            }
            Err(error) => faults.push(format!("{name}: {error:#}")),
        }
    }
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    let version = told["version"].as_str().unwrap_or_default();
    println!(
        "interchange: Blender {version} opens {}; opened {} files of its own",
        files.join(", "),
        written.len()
    );
    Ok(())
}

fn strings(value: &Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// How `info` differs from what Blender wrote.
fn differences(written: &Value, info: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    for key in ["kind", "strands", "points", "joints"] {
        let (wanted, found) = (&written[key], &info[key]);
        // USD exporters add the root of the armature as a joint of its own.
        let more = key == "joints" && found.as_u64() > wanted.as_u64();
        if !wanted.is_null() && wanted != found && !more {
            faults.push(format!("{key} is {found}; must be {wanted}"));
        }
    }
    let mut near = |what: &str, found: Option<f64>, wanted: &Value| {
        if let Some(wanted) = wanted.as_f64()
            && found.is_none_or(|found| (found - wanted).abs() > LIMIT)
        {
            faults.push(format!("{what} is {found:?}; must be {wanted}"));
        }
    };
    if written["kind"] == "hair" {
        let y = |end: &str| info["bounds_m"][end][1].as_f64();
        near("the height", y("max").zip(y("min")).map(|(max, min)| max - min), &written["height"]);
    } else {
        near("the height", info["height_m"].as_f64(), &written["height"]);
        near("the clip", info["clips"][0]["duration_secs"].as_f64(), &written["secs"]);
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_counts_and_sizes_are_told() {
        let wrote = json!({ "kind": "hair", "strands": 20, "points": null, "height": 0.4 });
        let bounds = json!({ "min": [0.0, 1.0, 0.0], "max": [0.2, 1.4, 0.0] });
        let info = |strands: u64, bounds: &Value| json!({ "kind": "hair", "strands": strands, "points": 7, "bounds_m": bounds });
        assert_eq!(differences(&wrote, &info(20, &bounds)), Vec::<String>::new());
        assert_eq!(differences(&wrote, &info(19, &bounds)), ["strands is 19; must be 20"]);
        let tall = json!({ "min": [0.0, 1.0, 0.0], "max": [0.2, 41.0, 0.0] });
        assert!(differences(&wrote, &info(20, &tall))[0].contains("the height is"));
        let figure = json!({ "kind": "character", "joints": 19, "height": 1.8, "secs": 1.0 });
        let found = json!({ "kind": "character", "joints": 20, "height_m": 1.8, "clips": [] });
        assert_eq!(differences(&figure, &found), ["the clip is None; must be 1"]);
    }
}
