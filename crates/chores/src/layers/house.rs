//! The crates and their arrows as text.

use super::graph::Graph;
use super::rules::short;
use std::collections::{BTreeMap, BTreeSet};

/// The workspace's crates, one a line with the crates that it uses, each below all those that use it.
pub(crate) fn drawing(graph: &Graph) -> String {
    let used: BTreeMap<&str, BTreeSet<&str>> = graph
        .members
        .iter()
        .map(|member| {
            let own = graph.used_by(member).filter(|used| graph.members.contains(*used) && *used != member);
            (member.as_str(), own.collect())
        })
        .collect();
    let mut order: Vec<(usize, &str)> =
        used.keys().map(|member| (height(member, &used, 0), *member)).collect();
    order.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(b.1)));
    let width = order.iter().map(|(_, member)| short(member).len()).max().unwrap_or(0);
    let mut drawing = String::new();
    for (_, member) in order {
        let mut lower: Vec<_> =
            used[member].iter().map(|lower| (height(lower, &used, 0), short(lower))).collect();
        lower.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(b.1)));
        let lower: Vec<_> = lower.into_iter().map(|(_, lower)| lower).collect();
        let line = format!("{:<width$} → {}", short(member), lower.join(", "));
        drawing += line.trim_end_matches([' ', '→']);
        drawing.push('\n');
    }
    drawing
}

/// How many arrows lie on the longest way down from a crate.
fn height(member: &str, used: &BTreeMap<&str, BTreeSet<&str>>, depth: usize) -> usize {
    // Cargo refuses circles of crates; the bound holds for any graph.
    if depth > used.len() {
        return 0;
    }
    let lower = used.get(member).into_iter().flatten();
    lower.map(|lower| 1 + height(lower, used, depth + 1)).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::{Graph, drawing};

    #[test]
    fn each_crate_stands_above_those_that_it_uses() {
        let mut graph = Graph::default();
        for (user, used) in [
            ("lovelock", "lovelock-render"),
            ("lovelock", "lovelock-groom"),
            ("lovelock", "egui"),
            ("lovelock-render", "lovelock-groom"),
            ("lovelock-groom", "glam"),
        ] {
            graph.uses.entry(user.to_owned()).or_default().insert(used.to_owned());
            graph
                .members
                .extend([user, used].into_iter().filter(|n| n.starts_with("lovelock")).map(str::to_owned));
        }
        assert_eq!(drawing(&graph), "app    → render, groom\nrender → groom\ngroom\n");
    }
}
