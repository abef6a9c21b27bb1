//! Lines of descriptions.

use std::collections::BTreeMap;
use std::fmt;

pub(super) fn line(f: &mut fmt::Formatter<'_>, name: &str, value: impl fmt::Display) -> fmt::Result {
    writeln!(f, "  {name:<9} {value}")
}

pub(super) fn remarks(
    f: &mut fmt::Formatter<'_>,
    dropped: &BTreeMap<String, u64>,
    notes: &[String],
) -> fmt::Result {
    for (what, count) in dropped {
        line(f, "left out", format_args!("{count} {what}"))?;
    }
    for note in notes {
        line(f, "note", note)?;
    }
    Ok(())
}
