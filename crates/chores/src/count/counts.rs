//! Counts of instructions: reading them from the runner's output, and comparing them.

use std::collections::BTreeMap;

use anyhow::{Context as _, ensure};
use serde::{Deserialize, Serialize};

/// A difference larger than this is named.
pub(super) const NAMED: f64 = 0.05;

/// The counts that are kept in the tree, and what they depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Counts {
    /// What `rustc --version` prints.
    pub(super) compiler: String,
    /// What `valgrind --version` prints.
    pub(super) valgrind: String,
    /// The vectors that the program chooses under valgrind.
    pub(super) vectors: String,
    /// Instructions by benchmark.
    pub(super) instructions: BTreeMap<String, u64>,
}

/// The part of a line of the runner's output that is used.
#[derive(Deserialize)]
struct Line {
    function_name: String,
    id: Option<String>,
    profiles: Vec<serde_json::Value>,
}

/// The counts in the output of the runner: one line of JSON per benchmark.
pub(super) fn of_output(output: &str) -> anyhow::Result<BTreeMap<String, u64>> {
    let mut counts = BTreeMap::new();
    for line in output.lines().filter(|line| line.starts_with('{')) {
        let line: Line = serde_json::from_str(line).context("a line of the runner")?;
        // `of` is the only case of its function.
        let name = match line.id.as_deref() {
            None | Some("of") => line.function_name,
            Some(id) => format!("{}, {id}", line.function_name),
        };
        let count = line
            .profiles
            .iter()
            .find_map(|profile| profile.pointer("/data/total/metrics/Ir/values/new")?.as_u64())
            .with_context(|| format!("{name}: the runner counted no instructions"))?;
        counts.insert(name, count);
    }
    ensure!(!counts.is_empty(), "the runner printed no counts");
    Ok(counts)
}

/// A phrase for every count that differs by more than [`NAMED`], is new, or is gone.
pub(super) fn changes(before: &BTreeMap<String, u64>, now: &BTreeMap<String, u64>) -> Vec<String> {
    let gone = before.keys().filter(|name| !now.contains_key(*name)).map(|name| format!("{name} is gone"));
    let changed = now.iter().filter_map(|(name, count)| match before.get(name) {
        None => Some(format!("{name} is new")),
        Some(before) if before.abs_diff(*count) as f64 > NAMED * *before as f64 => {
            Some(format!("{name}: {before} to {count} ({})", percent(*before, *count)))
        }
        Some(_) => None,
    });
    changed.chain(gone).collect()
}

/// The change from one count to another.
pub(super) fn percent(before: u64, now: u64) -> String {
    format!("{:+.1} %", 100.0 * (now as f64 / before as f64 - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(function: &str, id: &str, count: u64) -> String {
        serde_json::json!({
            "function_name": function,
            "id": id,
            "profiles": [{"data": {"total": {"metrics": {"Ir": {"values": {"new": count}}}}}}],
            "version": "7",
        })
        .to_string()
    }

    #[test]
    fn counts_are_read_from_the_lines_of_the_runner() {
        let output = format!("{}\nsomething else\n{}\n", line("a", "of", 7), line("b", "exact", 9));
        let counts = of_output(&output).expect("two counts");
        assert_eq!(counts, BTreeMap::from([("a".to_owned(), 7), ("b, exact".to_owned(), 9)]));
        assert!(of_output("").is_err());
        assert!(of_output("{\"function_name\": \"a\"").is_err());
        let without = "{\"function_name\": \"a\", \"id\": null, \"profiles\": []}";
        assert!(of_output(without).expect_err("no count").to_string().starts_with("a: "));
    }

    #[test]
    fn differences_over_a_twentieth_are_named_in_both_directions() {
        let of = |counts: &[(&str, u64)]| -> BTreeMap<String, u64> {
            counts.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
        };
        let before = of(&[("a", 1000), ("b", 1000), ("c", 1000), ("d", 1000)]);
        let now = of(&[("a", 1050), ("b", 1051), ("c", 940), ("e", 1)]);
        assert_eq!(
            changes(&before, &now),
            ["b: 1000 to 1051 (+5.1 %)", "c: 1000 to 940 (-6.0 %)", "e is new", "d is gone"]
        );
        assert!(changes(&before, &before).is_empty());
    }
}
