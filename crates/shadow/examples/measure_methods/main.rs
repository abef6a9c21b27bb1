//! Writes the measured part of `docs/shadow_methods.md`: the registry, and error, time and memory of every method on five hairstyles, on
//! the CPU and on the GPU.
//!
//! `LOVELOCK_SUITE=long cargo run --release -p lovelock-shadow --example measure_methods -- docs/shadow_methods.md` replaces the text
//! between the markers in the file; without an argument it prints it. With the ids of methods as a second argument,
//! `… docs/shadow_methods.md voxel-march,exact`, only their rows are measured and written.

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
use lovelock_shadow::ShadowMethod;

/// The hairstyle that is a file, which may be absent.
const FILE: &str = "straight.hair";

/// Hairstyles with their measured methods, as tables.
fn rows(methods: &[ShadowMethod]) -> Vec<(&'static str, [String; 2])> {
    let tables = |groom: &Groom| {
        eprintln!("measuring {}", groom.name);
        let measured = measure::methods(groom, methods);
        (groom.name, [tables::hairstyle(groom, &measured), tables::both_backends(&measured)])
    };
    Groom::all().iter().map(tables).collect()
}

fn text() -> String {
    let mut text = tables::registry();
    text.push_str(&tables::how_measured());
    let grooms = Groom::all();
    for groom in &grooms {
        eprintln!("measuring {}", groom.name);
        let measured = measure::methods(groom, ShadowMethod::ALL);
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
    let (path, methods) = (arguments.next().map(PathBuf::from), arguments.next());
    let methods = methods.map(|ids| {
        ids.to_string_lossy().split(',').map(str::parse::<ShadowMethod>).collect::<Result<Vec<_>, _>>()
    });
    let methods = match methods.transpose() {
        Ok(methods) if arguments.next().is_none() => methods,
        Ok(_) => {
            eprintln!("usage: measure_methods [FILE WITH MARKERS [METHOD,METHOD…]]");
            return ExitCode::FAILURE;
        }
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let Some(path) = path else {
        print!("{}", text());
        return ExitCode::SUCCESS;
    };
    // The file is checked before minutes of measuring, and read again after, because it may have changed.
    let result = splice::check(&path).and_then(|()| match methods {
        None => splice::replace(&path, &text()),
        Some(methods) => splice::insert(&path, &rows(&methods)),
    });
    if let Err(error) = result {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
