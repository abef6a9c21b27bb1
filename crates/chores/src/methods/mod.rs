//! `cargo xtask methods`: every shadow method on standard hair, fur and grass, as a page of the documents.

mod growth;
mod page;
mod report;
mod verdicts;

use anyhow::{Context as _, ensure};
use clap::Args;
use lovelock_xtask::tool;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use report::Report;

/// What is measured.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenes, by the start of their names; all if none is given. The page is written only if all were measured
    scenes: Vec<String>,
    /// Folder for the reports; target/methods if none is given. Complete reports that are there already are kept
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Hair on which methods are measured: its name, which is that of the folder of its report too, and options of `lovelock compare`. Fur and
/// grass have a tenth of the strands of their projects, which are wider instead; they stand still, so they have one frame.
const SCENES: [(&str, &str); 7] = [
    ("smooth", "--preset smooth --frames 45..47"),
    ("long", "--preset long --frames 45..47"),
    ("curly", "--preset curly --frames 45..47"),
    ("ponytail", "--preset ponytail --frames 45..47"),
    ("afro", "--preset afro --frames 45..47"),
    ("fur", "docs/examples/fur.lovelock --set hair.groom.strands_per_wisp=40 --frame 0"),
    ("grass", "docs/examples/lawn.lovelock --set hair.groom.strands_per_wisp=10 --frame 0"),
];
/// Options of all scenes. Errors are those of the first frame.
const OPTIONS: &str = "--fps 30 --size 480x360 --quick --no-film --draws 5 --backend cpu --methods all";

/// The name of the scene that shows how cost grows.
const GROWTH: &str = "growth";
/// Hair of a hundred thousand and of a million segments. The rays of `ray-traced` take minutes there, so it is left out.
const BENCH: &str = "smooth smooth-1m --backend cpu --size 320x240 --frames 7";

/// Measures scene by scene, and writes `docs/measured_methods.md`.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let out = arguments.out.clone().unwrap_or_else(|| tool::target().join("methods"));
    let is_chosen = |name: &str| {
        arguments.scenes.is_empty() || arguments.scenes.iter().any(|start| name.starts_with(start))
    };
    let chosen: Vec<_> = SCENES.iter().filter(|(name, _)| is_chosen(name)).collect();
    ensure!(
        !chosen.is_empty() || is_chosen(GROWTH),
        "SCENES: found {}; must be the start of one of {}, {GROWTH}",
        arguments.scenes.join(", "),
        SCENES.map(|(name, _)| name).join(", ")
    );
    let mut reports = Vec::new();
    for (name, options) in &chosen {
        let folder = out.join(name);
        let file = folder.join("report.json");
        if !Report::read(&file).is_ok_and(|report| report.complete) {
            compare(options, &folder)?;
        }
        reports.push((*name, Report::read(&file)?));
    }
    let growth = if is_chosen(GROWTH) { growth::measure(&out.join(GROWTH))? } else { Vec::new() };
    if chosen.len() < SCENES.len() || growth.is_empty() {
        println!("Not all scenes were measured: the page stays as it is. Reports: {}", out.display());
        return Ok(());
    }
    let page = tool::root().join("docs/measured_methods.md");
    fs::write(&page, page::page(&reports, &growth))
        .with_context(|| format!("could not write {}", page.display()))
}

/// Compares all methods on one scene.
fn compare(options: &str, folder: &Path) -> anyhow::Result<()> {
    let mut lovelock = Command::new(tool::program());
    lovelock.arg("compare").args(options.split_whitespace()).args(OPTIONS.split_whitespace());
    lovelock.arg("--force").arg("-o").arg(folder).current_dir(tool::root());
    tool::run(lovelock.stdin(Stdio::null()).stdout(Stdio::null()))
}
