//! Paths in the documents that lead nowhere.

use anyhow::Context as _;
use std::collections::BTreeSet;
use std::path::Path;

/// Folders that hold no sources.
const SKIPPED: [&str; 3] = ["target", "out", "third_party"];

/// A sentence for each path in `README.md` and `docs/*.md` that names no file: source files between backticks, which may leave out the
/// folders before them and `src`, and the targets of links.
pub(crate) fn dead_paths(root: &Path) -> anyhow::Result<Vec<String>> {
    let mut files = BTreeSet::new();
    list(root, "", &mut files)?;
    let documents = files.iter().filter(|file| is_document(file));
    let mut faults = Vec::new();
    for document in documents {
        let text = std::fs::read_to_string(root.join(document))
            .with_context(|| format!("could not read {document}"))?;
        faults.extend(dead_in(document, &text, &files));
    }
    Ok(faults)
}

fn is_document(file: &str) -> bool {
    file == "README.md"
        || (file.starts_with("docs/") && Path::new(file).extension().is_some_and(|end| end == "md"))
}

/// Adds the files below a folder, by their path from the root with `/`.
fn list(folder: &Path, prefix: &str, files: &mut BTreeSet<String>) -> anyhow::Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| format!("could not list {}", folder.display()))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{prefix}{name}");
        if entry.file_type()?.is_dir() {
            if !name.starts_with('.') && !SKIPPED.contains(&path.as_str()) {
                list(&entry.path(), &format!("{path}/"), files)?;
            }
        } else {
            files.insert(path);
        }
    }
    Ok(())
}

fn dead_in(document: &str, text: &str, files: &BTreeSet<String>) -> Vec<String> {
    let mut faults = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        let mut fault = |path: &str| {
            faults.push(format!("{document}:{number}: found `{path}`; must be a path in the tree"));
        };
        // Every second part is between backticks.
        for path in line.split('`').skip(1).step_by(2).filter(|path| is_source(path)) {
            if !files.iter().any(|file| ends_with(file, path)) {
                fault(path);
            }
        }
        for link in line.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = link.split('#').next().unwrap_or_default();
            if !target.is_empty() && !target.contains("://") && !files.contains(&beside(document, target)) {
                fault(target);
            }
        }
    }
    faults
}

fn is_source(path: &str) -> bool {
    let ends = Path::new(path).extension().is_some_and(|end| end == "rs" || end == "wgsl");
    ends && path.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
}

/// Whether a file has this path at its end, with or without the folder `src` of its crate.
fn ends_with(file: &str, path: &str) -> bool {
    let ends =
        |file: &str| file == path || file.strip_suffix(path).is_some_and(|before| before.ends_with('/'));
    ends(file) || ends(&file.replacen("/src/", "/", 1))
}

/// The path from the root of a link in a document.
fn beside(document: &str, target: &str) -> String {
    let mut folders: Vec<&str> = document.split('/').collect();
    folders.pop();
    for part in target.split('/') {
        match part {
            ".." => drop(folders.pop()),
            "." => {}
            part => folders.push(part),
        }
    }
    folders.join("/")
}

#[cfg(test)]
mod tests {
    use super::dead_in;

    #[test]
    fn dead_paths_are_found_and_others_are_not() {
        let files = ["crates/usd/src/text.rs", "docs/a.md", "README.md", "docs/pictures/x.jpg"];
        let files = files.into_iter().map(str::to_owned).collect();
        let good = "`usd/text.rs` `text.rs` `usd/src/text.rs` `x.rs.y` [a](a.md#b) [r](../README.md) ![x](pictures/x.jpg) [w](https://w.org)";
        assert_eq!(dead_in("docs/a.md", good, &files), Vec::<String>::new());
        let bad = "first\n`ext.rs` [b](b.md)";
        let expected =
            ["ext.rs", "b.md"].map(|path| format!("docs/a.md:2: found `{path}`; must be a path in the tree"));
        assert_eq!(dead_in("docs/a.md", bad, &files), expected);
    }
}
