//! `cargo xtask layers`: which crate may use which, held against what cargo says.

mod graph;
mod rules;

use crate::tool;
use anyhow::{Context as _, ensure};
use graph::Graph;

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
    let faults = rules::faults(&graph);
    for fault in &faults {
        println!("{fault}");
    }
    ensure!(faults.is_empty(), "{} arrows that docs/architecture.md does not have", faults.len());
    println!("layers: {} crates, every arrow as docs/architecture.md has it", graph.members.len());
    Ok(())
}
