//! A job for many machines, run by the command line of the Open Job Description.

use super::program::{lovelock, run_json};
use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const FRAMES: &str = "2..9";
const SIZE: &str = "96x72";

/// Runs the job's steps and tasks, each as a scheduler would, and compares the frames with those of a single machine.
pub(super) fn check(python: &Path, folder: &Path, program: &Path) -> anyhow::Result<()> {
    let folder = folder.join("farm");
    super::empty(&folder)?;
    let project = folder.join("small.lovelock");
    fs::write(&project, include_str!("../browser/small.lovelock"))?;
    let job = folder.join("job");
    let mut farm = lovelock(program, "farm");
    farm.arg(&project).arg("-o").arg(&job);
    let report = run_json(farm.args(["--frames", FRAMES, "--size", SIZE, "--fps", "24", "--chunk", "3"]))?;
    ensure!(report["tasks"] == 3, "{} tasks", report["tasks"]);
    // In another folder, as on another machine.
    let moved = folder.join("moved job");
    fs::rename(&job, &moved)?;
    let template = moved.join("template.json");

    openjd(python, &["check"], &template, &[])?;
    let broken = folder.join("broken.json");
    fs::write(&broken, fs::read_to_string(&template)?.replace("\"Simulate\"", "\"Draw\""))?;
    ensure!(
        openjd(python, &["check"], &broken, &[]).is_err(),
        "negative control: a job with two steps of the same name passed"
    );

    let parameter = format!("Lovelock={}", program.display());
    let step = |step: &str, more: &[&str]| {
        let arguments = [&["--step", step, "--no-run-dependencies", "-p", &parameter], more].concat();
        openjd(python, &["run"], &template, &arguments)
    };
    step("Simulate", &[])?;
    // The last task first, because a scheduler may choose any order.
    for frames in ["8..9", "2..5", "5..8"] {
        step("Draw", &["--task-param", &format!("Frames={frames}")])?;
    }
    step("Assemble", &[])?;

    // A single machine that simulates and renders gives the same images. One that renders the job's take gives the same folder
    // with its manifest, which contains the checksum of the take.
    let take = folder.join("single.take");
    let mut record = lovelock(program, "record");
    record.arg(&project).arg("-o").arg(&take).arg("--force");
    run_json(record.args(["--frames", FRAMES, "--fps", "24"]))?;
    let draw = |take: &Path, out: &str| {
        let out = folder.join(out);
        let mut record = lovelock(program, "record");
        record.arg(take).arg("-o").arg(&out);
        let wanted = ["--frames", FRAMES, "--dance-time", "--fps", "24", "--size", SIZE, "--backend", "cpu"];
        run_json(record.args(wanted))?;
        files(&out)
    };
    let (own, ours) = (draw(&take, "single")?, draw(&moved.join("dance.take"), "same take")?);
    let theirs = files(&moved.join("frames"))?;
    ensure!(ours.len() == 8, "{} files of a single machine; must be 7 frames and a manifest", ours.len());
    compare(&theirs, &ours)?;
    compare(&pictures(&theirs), &pictures(&own))?;
    let mut altered = theirs.clone();
    if let Some(bytes) = altered.get_mut(Path::new("frame_000005.png")) {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
    }
    ensure!(compare(&altered, &ours).is_err(), "negative control: an altered frame passed");
    println!("interchange: openjd renders the same {} files as a single machine", ours.len());
    Ok(())
}

/// The files without the manifest.
fn pictures(files: &BTreeMap<PathBuf, Vec<u8>>) -> BTreeMap<PathBuf, Vec<u8>> {
    let is_picture = |name: &Path| name.extension().is_some_and(|ending| ending == "png");
    files
        .iter()
        .filter(|(name, _)| is_picture(name))
        .map(|(name, bytes)| (name.clone(), bytes.clone()))
        .collect()
}

fn compare(theirs: &BTreeMap<PathBuf, Vec<u8>>, ours: &BTreeMap<PathBuf, Vec<u8>>) -> anyhow::Result<()> {
    ensure!(theirs.keys().eq(ours.keys()), "different files: {:?} and {:?}", theirs.keys(), ours.keys());
    for (name, bytes) in ours {
        ensure!(theirs[name] == *bytes, "{} differs from the file of a single machine", name.display());
    }
    Ok(())
}

fn files(folder: &Path) -> anyhow::Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).with_context(|| format!("could not list {}", folder.display()))? {
        let path = entry?.path();
        files.insert(path.file_name().unwrap_or_default().into(), fs::read(&path)?);
    }
    Ok(files)
}

fn openjd(python: &Path, verb: &[&str], template: &Path, arguments: &[&str]) -> anyhow::Result<()> {
    let mut command =
        Command::new(python.with_file_name(if cfg!(windows) { "openjd.exe" } else { "openjd" }));
    command.args(verb).arg(template).args(arguments).stdin(Stdio::null());
    let output = command.output().with_context(|| format!("could not start `{}`", tool::shown(&command)))?;
    let told = [output.stdout, output.stderr].concat();
    ensure!(
        output.status.success(),
        "`{}` failed ({}): {}",
        tool::shown(&command),
        output.status,
        String::from_utf8_lossy(&told).trim()
    );
    Ok(())
}
