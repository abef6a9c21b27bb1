//! Writes the measured part of `docs/shadow_methods.md`: the registry, and error, time and memory of every method on five hairstyles, on
//! the CPU and on the GPU.
//!
//! `LOVELOCK_SUITE=long cargo run --release -p lovelock-shadow --example measure_methods -- docs/shadow_methods.md` replaces the text
//! between the markers in the file; without an argument it prints it.

#[path = "../../tests/common/mod.rs"]
mod common;
#[path = "../../tests/common/gpu.rs"]
mod gpu;
#[path = "../../tests/common/grooms.rs"]
mod grooms;
mod machine;
mod measure;
mod on_gpu;
mod splice;
mod tables;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use grooms::Groom;

/// The hairstyle that is a file, which may be absent.
const FILE: &str = "straight.hair";

fn text() -> String {
    let mut text = tables::registry();
    text.push_str(&tables::how_measured());
    let grooms = Groom::all();
    for groom in &grooms {
        eprintln!("measuring {}", groom.name);
        let measured = measure::all_methods(groom);
        text.push_str(&tables::hairstyle(groom, &measured));
        text.push_str(&tables::both_backends(&measured));
    }
    if grooms.iter().all(|groom| groom.name != FILE) {
        let _ = writeln!(text, "\nThe folder of real files was not there: {FILE} is left out.");
    }
    text
}

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let (path, more) = (arguments.next().map(PathBuf::from), arguments.next());
    if more.is_some() {
        eprintln!("usage: measure_methods [FILE WITH MARKERS]");
        return ExitCode::FAILURE;
    }
    let Some(path) = path else {
        print!("{}", text());
        return ExitCode::SUCCESS;
    };
    // The file is checked before minutes of measuring, and read again after, because it may have changed.
    let result = splice::check(&path).and_then(|()| splice::replace(&path, &text()));
    if let Err(error) = result {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
