//! `cargo xtask count`: counts the instructions of the inner loops by valgrind, and compares them with the counts in the tree.

mod counts;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use lovelock_xtask::{system, tool};

use counts::{Counts, changes, of_output};

/// The counts in the tree, from the root of the workspace.
const FILE: &str = "crates/benchmarks/counts.json";

/// The package of the program that runs the benchmarks under valgrind. Its version must be that of the library.
const RUNNER: &str = "gungraun-runner";

/// Counts and compares; `write` replaces the counts in the tree instead.
pub(crate) fn run(write: bool) -> anyhow::Result<()> {
    ensure!(
        cfg!(all(target_os = "linux", target_arch = "x86_64")),
        "counts: found {} on {}; must be Linux on x86-64, whose counts are in {FILE}",
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    system::prepare_count()?;
    let runner = runner()?;
    // An empty folder: the runner would compare with its results from before, in another form of output.
    let home = tool::root().join("target/count/results");
    if home.exists() {
        fs::remove_dir_all(&home).with_context(|| format!("could not empty {}", home.display()))?;
    }
    let mut bench = tool::cargo(&[
        "bench",
        "--package",
        "lovelock-benchmarks",
        "--features",
        "gungraun",
        "--bench",
        "counts",
    ]);
    bench.args(["--", "--output-format=json"]).env("GUNGRAUN_RUNNER", &runner).env("GUNGRAUN_HOME", &home);
    bench.stderr(std::process::Stdio::inherit());
    let output = bench.output().context("could not start cargo bench")?;
    ensure!(output.status.success(), "the benchmarks failed ({}); the reason stands above", output.status);
    let now = Counts {
        compiler: version_of("rustc", &["--version"])?,
        valgrind: version_of("valgrind", &["--version"])?,
        vectors: "256 bits".to_owned(),
        instructions: of_output(&String::from_utf8_lossy(&output.stdout))?,
    };
    let file = tool::root().join(FILE);
    if write {
        fs::write(&file, serde_json::to_string_pretty(&now)? + "\n").with_context(|| FILE.to_owned())?;
        print(&now.instructions, &BTreeMap::new());
        println!("Written to {FILE}.");
        return Ok(());
    }
    let text = fs::read_to_string(&file).with_context(|| format!("{FILE}; `--write` creates it"))?;
    let before: Counts = serde_json::from_str(&text)
        .with_context(|| format!("{FILE}: must be what `cargo xtask count --write` writes"))?;
    print(&now.instructions, &before.instructions);
    for (what, before, now) in
        [("compiler", &before.compiler, &now.compiler), ("valgrind", &before.valgrind, &now.valgrind)]
    {
        if before != now {
            println!("The {what} differs: {before} in {FILE}, {now} here. This alone changes counts.");
        }
    }
    let changes = changes(&before.instructions, &now.instructions);
    if changes.is_empty() {
        println!("No count differs by more than {:.0} %.", 100.0 * counts::NAMED);
        return Ok(());
    }
    bail!("{}. `cargo xtask count --write` keeps the new counts", changes.join("; "))
}

/// The table of counts, with the difference from those in the tree.
fn print(now: &BTreeMap<String, u64>, before: &BTreeMap<String, u64>) {
    println!(
        "{:<30}{:>18}{:>10}",
        "benchmark",
        "instructions",
        if before.is_empty() { "" } else { "change" }
    );
    for (name, count) in now {
        let change = before.get(name).map(|before| counts::percent(*before, *count)).unwrap_or_default();
        println!("{name:<30}{count:>18}{change:>10}");
    }
}

/// The first line that a program prints.
fn version_of(program: &str, arguments: &[&str]) -> anyhow::Result<String> {
    let text = tool::output_of(program, arguments).with_context(|| format!("could not start {program}"))?;
    Ok(text.lines().next().unwrap_or_default().trim().to_owned())
}

/// The path of the runner, which is installed below `target` if it is not there in the right version.
fn runner() -> anyhow::Result<PathBuf> {
    let lock = fs::read_to_string(tool::root().join("Cargo.lock")).context("Cargo.lock")?;
    let version = version_in(&lock).with_context(|| format!("Cargo.lock contains no {RUNNER}"))?;
    let folder = tool::root().join("target/count");
    let program = folder.join("bin").join(RUNNER);
    if !is_version(&program, version) {
        println!("Installing {RUNNER} {version} below {}.", folder.display());
        let mut install =
            tool::cargo(&["install", RUNNER, "--locked", "--force", "--version", version, "--root"]);
        // Its objects are of no further use.
        let build = folder.join("build");
        tool::run(install.arg(&folder).env("CARGO_TARGET_DIR", &build))?;
        fs::remove_dir_all(&build).with_context(|| format!("could not remove {}", build.display()))?;
    }
    Ok(program)
}

fn is_version(program: &Path, version: &str) -> bool {
    let said = program.to_str().and_then(|program| tool::output_of(program, &["--version"]));
    said.is_some_and(|said| said.split_whitespace().last() == Some(version))
}

/// The version of the runner in the lock file.
fn version_in(lock: &str) -> Option<&str> {
    let after = lock.split_once(&format!("name = \"{RUNNER}\"\nversion = \""))?.1;
    after.split_once('"').map(|(version, _)| version)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runner_has_the_version_of_the_lock_file() {
        let lock = "[[package]]\nname = \"gungraun\"\nversion = \"1.2.3\"\n\n[[package]]\nname = \"gungraun-runner\"\nversion = \"4.5.6\"\n";
        assert_eq!(version_in(lock), Some("4.5.6"));
        assert_eq!(version_in("name = \"gungraun\"\nversion = \"1.2.3\""), None);
        let own = fs::read_to_string(tool::root().join("Cargo.lock")).expect("the lock file");
        assert!(version_in(&own).is_some());
    }

    #[test]
    fn the_counts_in_the_tree_can_be_read() {
        let text = fs::read_to_string(tool::root().join(FILE)).expect("the file");
        let counts: Counts = serde_json::from_str(&text).expect("counts");
        assert!(counts.instructions.values().all(|count| *count > 0) && counts.instructions.len() >= 5);
    }
}
