//! `cargo xtask layers`: prints which crate uses which, and fails on arrows that the architecture lacks, on circles among modules,
//! and on paths in the documents that lead nowhere.

mod documents;
mod graph;
mod house;
mod modules;
mod rules;

use anyhow::{Context as _, ensure};
use graph::Graph;
use lovelock_xtask::tool;
use modules::Modules;

/// Reads the workspace's dependencies and fails on every arrow that the architecture does not have.
pub(crate) fn run() -> anyhow::Result<()> {
    let version = tool::output_of("rustc", &["-vV"]).context("could not run `rustc -vV`")?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc names no host")?;
    // Without the filter, cargo would fetch what other systems need.
    let output = tool::cargo(&["metadata", "--format-version", "1", "--filter-platform", host]).output()?;
    ensure!(
        output.status.success(),
        "`cargo metadata` failed: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    let graph = Graph::parse(&output.stdout).context("could not read what `cargo metadata` printed")?;
    let mut faults = rules::faults(&graph);
    print!("{}", house::drawing(&graph));
    let mut modules = 0;
    for (name, src) in &graph.sources {
        let found = Modules::read(src).with_context(|| format!("could not read the modules of {name}"))?;
        modules += found.len();
        faults.extend(rules::circles(name, &found.circles()));
    }
    faults.extend(documents::dead_paths(tool::root())?);
    for fault in &faults {
        println!("{fault}");
    }
    ensure!(faults.is_empty(), "{} faults of structure; docs/architecture.md has the rules", faults.len());
    println!(
        "layers: {} crates, every arrow as docs/architecture.md has it; {modules} modules, no circle but those that are named, no dead path in the documents",
        graph.members.len()
    );
    Ok(())
}
