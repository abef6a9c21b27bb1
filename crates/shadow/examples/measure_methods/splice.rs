//! The part of a file between two markers.

use std::fs;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

const BEGIN: &str = "<!-- measured:begin -->\n";
const END: &str = "<!-- measured:end -->";

/// What comes before the part, the begin marker included, and what follows, from the end marker on.
fn around(text: &str) -> Result<(&str, &str)> {
    let missing = || {
        let message = format!("wanted one line {} and after it one {END}", BEGIN.trim_end());
        Error::new(ErrorKind::InvalidData, message)
    };
    let (before, rest) = text.split_once(BEGIN).ok_or_else(missing)?;
    let (_, after) = rest.split_once(END).ok_or_else(missing)?;
    if rest.contains(BEGIN) || after.contains(END) {
        return Err(missing());
    }
    Ok((&text[..before.len() + BEGIN.len()], &text[text.len() - after.len() - END.len()..]))
}

/// Whether the file has both markers.
pub(crate) fn check(path: &Path) -> Result<()> {
    around(&fs::read_to_string(path)?).map(|_| ())
}

/// Puts `part` between the markers. The file is written beside the old one and renamed, so that it is whole at any time.
pub(crate) fn replace(path: &Path, part: &str) -> Result<()> {
    let text = fs::read_to_string(path)?;
    let (before, after) = around(&text)?;
    let beside = path.with_extension("md.new");
    fs::write(&beside, format!("{before}{part}{after}"))?;
    fs::rename(&beside, path)
}

/// Puts the rows of tables into those of the file, two for each hairstyle: in the place of rows of the same methods, or before that of
/// `exact`.
pub(crate) fn insert(path: &Path, hairstyles: &[(&str, [String; 2])]) -> Result<()> {
    let mut lines: Vec<String> = fs::read_to_string(path)?.lines().map(str::to_owned).collect();
    for (name, tables) in hairstyles {
        let heading = format!("### Measured on {name}");
        let Some(section) = lines.iter().position(|line| *line == heading) else {
            return Err(Error::other(format!("there is no heading \"{heading}\"")));
        };
        for (head, table) in ["| method |", "| both backends |"].iter().zip(tables) {
            let find = |lines: &[String], from: usize, start: &str| {
                lines[from..].iter().position(|line| line.starts_with(start)).map(|at| from + at)
            };
            let Some(first) = find(&lines, section, head) else {
                return Err(Error::other(format!("there is no table \"{head}\" of {name}")));
            };
            for row in table.lines().filter(|line| line.starts_with("| `")) {
                let id = row.split('`').nth(1).unwrap_or_default();
                let end = find(&lines, first, "| `exact` |").unwrap_or(lines.len());
                match find(&lines[..end], first, &format!("| `{id}` |")) {
                    Some(at) => row.clone_into(&mut lines[at]),
                    None if id == "exact" => row.clone_into(&mut lines[end]),
                    None => lines.insert(end, row.to_owned()),
                }
            }
        }
    }
    fs::write(path, lines.join("\n") + "\n")
}
