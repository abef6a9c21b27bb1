//! `cargo xtask test --interchange`: compares results with those of other programs, which are installed from the Python
//! Package Index into a virtual environment in `target`.

mod blender;
mod exr;
mod farm;
mod pictures;
mod program;
mod stage;

use crate::python::environment;
use anyhow::{Context as _, ensure};
use lovelock_metrics::{Image, flip};
use lovelock_xtask::{system, tool};
use pictures::Picture;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The program of FLIP's authors in the Python Package Index.
const PACKAGE: &str = "flip-evaluator==1.7";
/// An undeclared dependency of FLIP, Pixar's USD library with its validators, and the command line of the Open Job
/// Description. The release depends on the version of Python.
const BESIDE: [&str; 3] = ["numpy<3", "usd-core>=25.5", "openjd-cli>=0.7"];

/// The largest accepted difference between two means of FLIP. Measured: 8e-5, because theirs uses 67.02 pixels per degree.
const LIMIT: f64 = 1e-3;

/// The versions of Blender that open files. Each is some hundreds of megabytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Blender {
    /// The first, if an earlier run has installed it.
    IfInstalled,
    /// The first, which is installed if need be.
    One,
    /// All that are known to read and write such files.
    Every,
}

/// Compares FLIP, USD and the job for many machines with other programs, and fails if one differs.
pub(crate) fn run(blender: Blender) -> anyhow::Result<()> {
    system::prepare_interchange()?;
    let folder = tool::root().join("target/interchange");
    let python = environment(&folder.join("python"), &[&[PACKAGE][..], &BESIDE].concat())?;
    check_flip(&python, &folder)?;
    exr::run(&folder)?;
    let lovelock = tool::program();
    stage::check(&python, &folder, &lovelock)?;
    blender::check(&folder, &lovelock, blender)?;
    farm::check(&python, &folder, &lovelock)
}

/// Creates an empty folder.
fn empty(folder: &Path) -> anyhow::Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("could not remove {}", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("could not create {}", folder.display()))
}

/// Compares the means of FLIP for pairs of images.
fn check_flip(python: &Path, folder: &Path) -> anyhow::Result<()> {
    let pictures = Picture::all();
    for picture in &pictures {
        picture.save(folder)?;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/interchange/flip_means.py");
    let mut program = Command::new(python);
    program.arg(&script).args(pictures.iter().map(|picture| folder.join(picture.file())));
    let output = program.output().with_context(|| format!("could not start {}", python.display()))?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    let theirs: Vec<f64> = serde_json::from_slice(&output.stdout).context("the script printed no numbers")?;
    let means =
        pairs(&pictures).map(|(reference, test)| mean(reference, test)).collect::<Result<Vec<_>, _>>()?;
    compare(&means, &theirs)?;
    println!("interchange: {} means of FLIP agree with {PACKAGE} to {LIMIT}", means.len());
    Ok(())
}

/// Every pair of images in both orders, in the order of the script.
fn pairs(pictures: &[Picture]) -> impl Iterator<Item = (&Picture, &Picture)> {
    let size = |picture: &Picture| (picture.width, picture.height);
    pictures.iter().flat_map(move |reference| {
        let same = pictures.iter().filter(move |test| size(test) == size(reference));
        same.map(move |test| (reference, test))
    })
}

fn mean(reference: &Picture, test: &Picture) -> anyhow::Result<f64> {
    let reference = Image::new(reference.width, reference.height, &reference.rgba)?;
    let test = Image::new(test.width, test.height, &test.rgba)?;
    Ok(flip(&reference, &test)?.mean())
}

/// Fails if two means differ by more than the limit.
fn compare(ours: &[f64], theirs: &[f64]) -> anyhow::Result<()> {
    ensure!(ours.len() == theirs.len(), "{} means, and {} of theirs", ours.len(), theirs.len());
    for (index, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
        println!("  pair {index}: {ours:.6}, theirs {theirs:.6}");
        let difference = (ours - theirs).abs();
        ensure!(difference <= LIMIT, "the mean of pair {index} is off by {difference:.6}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Picture, compare, mean, pairs};

    #[test]
    fn means_that_differ_are_found() {
        assert!(compare(&[0.1, 0.2], &[0.1005, 0.1995]).is_ok());
        let error = compare(&[0.1, 0.2], &[0.1, 0.202]).unwrap_err().to_string();
        assert_eq!(error, "the mean of pair 1 is off by 0.002000");
        assert!(compare(&[0.1], &[]).is_err());
        assert!(compare(&[0.1], &[f64::NAN]).is_err());
    }

    #[test]
    fn pairs_are_of_one_size_and_most_of_them_differ() {
        let pictures = Picture::all();
        let means: Vec<f64> = pairs(&pictures).map(|(a, b)| mean(a, b).unwrap()).collect();
        let differ = means.iter().filter(|&&mean| mean > 0.01).count();
        assert!(differ * 2 > means.len() && differ < means.len(), "{means:?}");
    }
}
