//! The files of a package, as `app/Cargo.toml` lists them for cargo-deb.

use anyhow::Context as _;
use lovelock_xtask::tool;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A file of a package.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Packaged {
    /// Where it is now.
    pub(super) source: PathBuf,
    /// Where it is installed, below the root of the system.
    pub(super) place: PathBuf,
    /// Whether it is a program.
    pub(super) is_program: bool,
}

/// All files of a package.
pub(super) fn files() -> anyhow::Result<Vec<Packaged>> {
    let output = tool::cargo(&["metadata", "--no-deps", "--format-version", "1"]).output()?;
    let metadata: Value = serde_json::from_slice(&output.stdout).context("`cargo metadata`")?;
    let packages = metadata["packages"].as_array().map_or(&[][..], Vec::as_slice);
    let assets = packages
        .iter()
        .find(|package| package["name"] == "lovelock")
        .and_then(|package| package["metadata"]["deb"]["assets"].as_array())
        .context("app/Cargo.toml: found no package.metadata.deb.assets; must list the files of packages")?;
    let mut files = Vec::new();
    for asset in assets {
        let row: Option<Vec<&str>> =
            asset.as_array().map(|row| row.iter().filter_map(Value::as_str).collect());
        let Some([source, place, mode]) = row.as_deref().and_then(|row| <[&str; 3]>::try_from(row).ok())
        else {
            anyhow::bail!("app/Cargo.toml: found the asset {asset}; must be [source, place, mode]");
        };
        for source in sources(source)? {
            let name = source.file_name().unwrap_or_default();
            let place = if place.ends_with('/') { Path::new(place).join(name) } else { PathBuf::from(place) };
            files.push(Packaged { source, place, is_program: mode == "755" });
        }
    }
    Ok(files)
}

/// The files that a source names: one, or those of a folder that end as `folder/*.end` says.
fn sources(source: &str) -> anyhow::Result<Vec<PathBuf>> {
    // Cargo's packagers write the folder of builds in this way, wherever it is.
    let path = source.strip_prefix("target/release/").map_or_else(
        || tool::root().join("app").join(source),
        |built| tool::target().join("release").join(built),
    );
    let Some(end) = path.file_name().and_then(|name| name.to_str()?.strip_prefix('*')) else {
        anyhow::ensure!(path.exists(), "app/Cargo.toml: {source} is a file of packages and does not exist");
        return Ok(vec![path]);
    };
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("app/Cargo.toml: {source}"))? {
        let entry = entry?.path();
        if entry.is_file() && entry.to_string_lossy().ends_with(end) {
            found.push(entry);
        }
    }
    anyhow::ensure!(!found.is_empty(), "app/Cargo.toml: {source} names no file");
    found.sort();
    Ok(found)
}
