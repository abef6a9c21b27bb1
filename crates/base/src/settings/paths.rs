//! Settings by their path through nested structs, such as `simulation.wind.speed`.

use std::fmt;

use super::{AnySettings, Info, Value};

/// A setting in a tree of structs.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The path from the root, with dots.
    pub path: String,
    /// What it is.
    pub info: &'static Info,
    /// Its value.
    pub value: Value,
}

/// Every setting below `root`: the struct's own first, then those of its parts.
pub fn entries(root: &dyn AnySettings) -> Vec<Entry> {
    let mut out = Vec::new();
    collect(root, "", &mut out);
    out
}

fn collect(part: &dyn AnySettings, prefix: &str, out: &mut Vec<Entry>) {
    for info in part.infos() {
        if let Some((info, value)) = part.value(info.name) {
            out.push(Entry { path: format!("{prefix}{}", info.name), info, value });
        }
    }
    for (name, child) in part.children() {
        collect(child, &format!("{prefix}{name}."), out);
    }
}

/// The setting at `path` below `root`.
pub fn find(root: &dyn AnySettings, path: &str) -> Option<(&'static Info, Value)> {
    root.value(path)
        .or_else(|| root.children().into_iter().find_map(|(name, child)| find(child, rest_of(path, &name)?)))
}

/// Puts a value at `path` below `root` as it is, and returns whether there is such a setting.
pub fn set_value(root: &mut dyn AnySettings, path: &str, value: Value) -> bool {
    if root.value(path).is_some() {
        root.assign(path, value);
        return true;
    }
    root.children_mut()
        .into_iter()
        .any(|(name, child)| rest_of(path, &name).is_some_and(|rest| set_value(child, rest, value)))
}

/// The path below the part called `name`, where it leads there.
fn rest_of<'a>(path: &'a str, name: &str) -> Option<&'a str> {
    path.strip_prefix(name)?.strip_prefix('.')
}

/// Reads `text` and puts it at `path` below `root`.
///
/// # Errors
/// A path without a setting, with the nearest that has one, or a value that the setting does not take.
pub fn set(root: &mut dyn AnySettings, path: &str, text: &str) -> Result<(), SettingError> {
    let Some((info, _)) = find(root, path) else {
        let known: Vec<String> = entries(root).into_iter().map(|entry| entry.path).collect();
        return Err(SettingError::Unknown { path: path.to_owned(), nearest: nearest(path, &known) });
    };
    let value = info.parse(text).map_err(|valid| SettingError::Value {
        path: path.to_owned(),
        found: text.trim().to_owned(),
        valid,
    })?;
    set_value(root, path, value);
    Ok(())
}

/// Why a setting cannot be set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingError {
    /// There is no setting at the path.
    Unknown {
        /// The path.
        path: String,
        /// The known path that differs least; none where all differ by much.
        nearest: Option<String>,
    },
    /// The setting does not take the value.
    Value {
        /// The path.
        path: String,
        /// The text that was found.
        found: String,
        /// What it takes.
        valid: String,
    },
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { path, nearest: Some(nearest) } => {
                write!(f, "{path}: there is no such setting; the nearest is {nearest}")
            }
            Self::Unknown { path, nearest: None } => {
                write!(f, "{path}: there is no such setting; `lovelock settings` lists all of them")
            }
            Self::Value { path, found, valid } => write!(f, "{path}: found {found}; must be {valid}"),
        }
    }
}

impl std::error::Error for SettingError {}

/// The name that fewest letters must be changed of to get `wanted`, if they are at most a third of it. Where the last part alone is
/// right, it is that one.
fn nearest(wanted: &str, known: &[String]) -> Option<String> {
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let same_end = known.iter().filter(|path| last(path) == last(wanted));
    let by_distance = |path: &&String| (edits(wanted, path), path.len());
    let best = known.iter().min_by_key(by_distance)?;
    if edits(wanted, best) <= wanted.chars().count() / 3 {
        return Some(best.clone());
    }
    same_end.min_by_key(by_distance).cloned()
}

/// Letters that must be inserted, removed or exchanged to make `b` of `a` (Levenshtein).
pub fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let exchanged = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
