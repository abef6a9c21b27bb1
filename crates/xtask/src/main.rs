//! Chores of the workspace: run, test, ci, layers, latency and assets. `cargo xtask` lists them.

mod assets;
mod browser;
mod ci;
mod docs;
mod interchange;
mod latency;
mod launch;
mod layers;
mod system;
mod testing;
mod tool;
mod totals;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

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
        arguments: Vec<std::ffi::OsString>,
    },
    /// Runs every test and prints the totals
    Test {
        /// Only tests whose name holds this
        #[arg(long)]
        filter: Option<String>,
        /// Only the tests of this package
        #[arg(short, long)]
        package: Option<String>,
        /// Instead, holds FLIP, USD and farm jobs against other people's programs in Python, which it installs below target
        #[arg(long, conflicts_with_all = ["filter", "package"])]
        interchange: bool,
        /// Instead, opens the page of a comparison in Chromium, which it installs where it may
        #[arg(long, conflicts_with_all = ["filter", "package"])]
        browser: bool,
    },
    /// Runs every check: tests, interchange, browser, format, clippy, layers, documentation
    Ci,
    /// Writes the tables of settings in the documents, as the program prints them
    Docs,
    /// Checks which crate may use which
    Layers,
    /// Measures how long the window takes from an input to the screen, on a screen of its own (Linux, Xvfb)
    Latency {
        /// Inputs that are timed for each of three windows
        #[arg(long, default_value_t = 50)]
        inputs: usize,
    },
    /// Makes the shipped assets anew
    Assets {
        /// Also write pictures of the dancer into this folder
        #[arg(long, value_name = "DIR")]
        preview: Option<std::path::PathBuf>,
    },
}

fn main() -> ExitCode {
    let done = match Arguments::parse().chore {
        Chore::Run { arguments } => launch::run(&arguments),
        Chore::Test { interchange, browser, .. } if interchange || browser => {
            let first = if interchange { interchange::run() } else { Ok(()) };
            first.and_then(|()| if browser { browser::run() } else { Ok(()) })
        }
        Chore::Test { filter, package, .. } => testing::run(filter.as_deref(), package.as_deref()),
        Chore::Ci => ci::run(),
        Chore::Docs => docs::run(),
        Chore::Layers => layers::run(),
        Chore::Latency { inputs } => latency::run(inputs),
        Chore::Assets { preview } => assets::run(preview.as_deref()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}
