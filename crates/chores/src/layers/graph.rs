//! What uses what, from `cargo metadata`.

use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The packages of a build and the arrows between them. Packages are known by their name.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    /// The workspace's own packages.
    pub(crate) members: BTreeSet<String>,
    /// What a package needs to be built.
    pub(crate) uses: BTreeMap<String, BTreeSet<String>>,
    /// What its tests, benchmarks and examples need beyond that.
    pub(crate) tests_use: BTreeMap<String, BTreeSet<String>>,
    /// The `src` folder of each of the workspace's own packages.
    pub(crate) sources: BTreeMap<String, PathBuf>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    workspace_members: Vec<String>,
    resolve: Resolve,
}

#[derive(Deserialize)]
struct Package {
    id: String,
    name: String,
    manifest_path: PathBuf,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<Kind>,
}

#[derive(Deserialize)]
struct Kind {
    kind: Option<String>,
}

impl Graph {
    /// Reads the output of `cargo metadata --format-version 1`.
    pub(crate) fn parse(json: &[u8]) -> serde_json::Result<Self> {
        let metadata: Metadata = serde_json::from_slice(json)?;
        let names: BTreeMap<_, _> =
            metadata.packages.iter().map(|package| (&package.id, &package.name)).collect();
        let name = |id: &String| names.get(id).map_or_else(|| id.clone(), |name| (*name).clone());
        let mut graph =
            Self { members: metadata.workspace_members.iter().map(name).collect(), ..Self::default() };
        for package in metadata.packages.iter().filter(|package| graph.members.contains(&package.name)) {
            let folder = package.manifest_path.parent().unwrap_or(Path::new(""));
            graph.sources.insert(package.name.clone(), folder.join("src"));
        }
        for node in &metadata.resolve.nodes {
            for dependency in &node.deps {
                for kind in &dependency.dep_kinds {
                    let tests_only = kind.kind.as_deref() == Some("dev");
                    let arrows = if tests_only { &mut graph.tests_use } else { &mut graph.uses };
                    arrows.entry(name(&node.id)).or_default().insert(name(&dependency.pkg));
                }
            }
        }
        Ok(graph)
    }

    /// What a package needs to be built, one step.
    pub(crate) fn used_by(&self, package: &str) -> impl Iterator<Item = &str> {
        self.uses.get(package).into_iter().flatten().map(String::as_str)
    }

    /// What its tests need beyond that, one step.
    pub(crate) fn used_by_tests_of(&self, package: &str) -> impl Iterator<Item = &str> {
        self.tests_use.get(package).into_iter().flatten().map(String::as_str)
    }

    /// A way from `package`, its tests included, to a package that `wanted` picks: the names along it.
    pub(crate) fn way(&self, package: &str, wanted: impl Fn(&str) -> bool) -> Option<Vec<String>> {
        let mut seen = BTreeSet::new();
        let first = self.used_by(package).chain(self.used_by_tests_of(package));
        let mut open: Vec<Vec<&str>> = first.map(|next| vec![package, next]).collect();
        while let Some(way) = open.pop() {
            let last = way[way.len() - 1];
            if wanted(last) {
                return Some(way.into_iter().map(str::to_owned).collect());
            }
            if seen.insert(last) {
                open.extend(self.used_by(last).map(|next| [&way[..], &[next]].concat()));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::Graph;
    use std::path::PathBuf;

    #[test]
    fn metadata_becomes_names_and_arrows() {
        let json = br#"{
            "packages": [
                {"id": "a 1", "name": "a", "manifest_path": "crates/a/Cargo.toml"},
                {"id": "b 1", "name": "b", "manifest_path": "elsewhere/b/Cargo.toml"},
                {"id": "c 1", "name": "c", "manifest_path": "elsewhere/c/Cargo.toml"}
            ],
            "workspace_members": ["a 1"],
            "resolve": {"nodes": [
                {"id": "a 1", "deps": [
                    {"pkg": "b 1", "dep_kinds": [{"kind": null, "target": null}]},
                    {"pkg": "c 1", "dep_kinds": [{"kind": "dev"}, {"kind": "build"}]}
                ]},
                {"id": "b 1", "deps": []}
            ]}
        }"#;
        let graph = Graph::parse(json).unwrap();
        assert!(graph.members.iter().eq(["a"]));
        assert!(graph.sources.iter().eq([(&"a".to_owned(), &PathBuf::from("crates/a/src"))]));
        assert!(graph.used_by("a").eq(["b", "c"]));
        assert!(graph.used_by_tests_of("a").eq(["c"]));
        assert_eq!(graph.used_by("b").count(), 0);
        assert!(Graph::parse(b"{}").is_err());
    }
}
