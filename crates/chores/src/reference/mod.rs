//! `cargo xtask reference`: hair beside a path tracer.
//!
//! Lovelock writes scenes (`lovelock bench reference`), Mitsuba 3 renders the same fibres, camera and light, and both images are
//! compared after the same tone curve. Mitsuba is installed from the Python Package Index into a virtual environment in `target`.

mod figures;
mod images;
mod report;
mod scenes;
mod sheet;
mod variant;

use crate::python;
use anyhow::{Context as _, ensure};
use clap::Args;
use lovelock_xtask::{system, tool};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use images::LinearImage;
use report::Report;
use scenes::Scenes;
use variant::Variant;

/// The path tracer.
const PACKAGES: [&str; 2] = ["mitsuba==3.9.1", "numpy<3"];

/// What is rendered, and how.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenes: reference for all, reference-HAIR, reference-HAIR-COLOUR or reference-HAIR-COLOUR-LIGHT
    #[arg(default_value = "reference")]
    scenes: Vec<String>,
    /// Paths per pixel of the path tracer, an even number; 64, or 16 with --quick
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=65536))]
    samples: Option<u32>,
    /// Fewer pixels and samples: 256x256 and 16
    #[arg(long)]
    quick: bool,
    /// Size in pixels; 384x384, or 256x256 with --quick
    #[arg(long, value_name = "WxH")]
    size: Option<String>,
    /// Strands of a hairstyle, 100 to 120000, the wider the fewer; 60000 if none is given
    #[arg(long, value_name = "N")]
    strands: Option<u32>,
    /// Stops by which both images are brightened before they are compared: a single light leaves hair dark
    #[arg(long, value_name = "STOPS", default_value_t = 2.0, allow_negative_numbers = true)]
    exposure: f32,
    /// A setting of all our images, such as shadow.method=exact; may be given several times
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// A way of shading to compare: a name and its settings, such as "dull: look.roughness=0.6"; may be given several times. Without
    /// any, the shipped settings
    #[arg(long, value_name = "NAME: SETTING=VALUE …")]
    variant: Vec<Variant>,
    /// Folder for images, table, figures and contact sheet; target/reference if none is given
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Renders all scenes by both programs, compares them, and writes `report.md`, `report.json` and `sheet.png`.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let samples = arguments.samples.unwrap_or(if arguments.quick { 16 } else { 64 });
    ensure!(
        samples.is_multiple_of(2),
        "--samples: found {samples}; must be even, because noise is measured by two halves"
    );
    ensure!(
        arguments.exposure.abs() <= 20.0,
        "--exposure: found {}; must be between -20 and 20",
        arguments.exposure
    );
    let variants = Variant::checked(&arguments.variant)?;
    system::prepare_interchange()?;
    let below = tool::root().join("target/reference");
    let python = python::environment(&below.join("python"), &PACKAGES)?;
    let out = arguments.out.clone().unwrap_or(below);
    let mut ours = Vec::new();
    for variant in &variants {
        let folder = out.join("ours").join(&variant.name);
        render_ours(arguments, variant, &folder)?;
        ours.push((variant.name.clone(), folder));
    }
    let Some((_, first)) = ours.first() else { return Ok(()) };
    let scenes = Scenes::read(first)?;
    for (name, folder) in &ours[1..] {
        scenes
            .ensure_same(first, &Scenes::read(folder)?, folder)
            .with_context(|| format!("--variant {name}"))?;
    }
    let theirs = out.join("theirs");
    let told = render_theirs(&python, first, &theirs, samples)?;
    let mut report = Report::new(arguments, samples, &variants, &scenes, told);
    let mut sheet = sheet::Sheet::new(ours.iter().map(|(name, _)| name.as_str()));
    for scene in &scenes.list {
        let read = |path: &Path| {
            let image = LinearImage::read(path, [scenes.width, scenes.height])?;
            anyhow::Ok(image.scaled(arguments.exposure.exp2()))
        };
        let half = |half: &str| read(&theirs.join(format!("{}.{half}.f32", scene.name)));
        let (a, b) = (half("a")?, half("b")?);
        let reference = LinearImage::mean(&a, &b);
        let mut images = Vec::new();
        for (_, folder) in &ours {
            images.push(read(&folder.join(&scene.image_file))?);
        }
        report.add(scene, &images, &reference, [&a, &b])?;
        sheet.add(&scene.name, &images, &reference);
    }
    write(&out.join("report.md"), report.markdown().as_bytes())?;
    write(&out.join("report.json"), serde_json::to_string_pretty(&report)?.as_bytes())?;
    sheet.save(&out.join("sheet.png"))?;
    println!("{}", report.markdown());
    println!("Written: report.md, report.json and sheet.png in {}", out.display());
    Ok(())
}

/// Runs our side.
fn render_ours(arguments: &Arguments, variant: &Variant, folder: &Path) -> anyhow::Result<()> {
    let quick = if arguments.quick { "256x256" } else { "384x384" };
    let mut lovelock = Command::new(tool::program());
    lovelock.arg("bench").args(&arguments.scenes).arg("-o").arg(folder);
    lovelock.args(["--size", arguments.size.as_deref().unwrap_or(quick)]);
    if let Some(strands) = arguments.strands {
        lovelock.args(["--strands", &strands.to_string()]);
    }
    for setting in arguments.set.iter().chain(&variant.settings) {
        lovelock.args(["--set", setting]);
    }
    tool::run(lovelock.stdin(Stdio::null()).stdout(Stdio::null()))
}

/// Runs the path tracer. Returns what it told.
fn render_theirs(python: &Path, scenes: &Path, out: &Path, samples: u32) -> anyhow::Result<Value> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/reference/render.py");
    let mut program = Command::new(python);
    program.arg(&script).args([scenes, out]).arg(samples.to_string());
    // Progress goes to the terminal.
    let output = program.stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("could not start {}", python.display()))?;
    ensure!(output.status.success(), "the path tracer failed ({})", output.status);
    serde_json::from_slice(&output.stdout).context("the path tracer printed no JSON")
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    fs::write(path, bytes).with_context(|| format!("could not write {}", path.display()))
}
