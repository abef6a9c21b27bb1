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
