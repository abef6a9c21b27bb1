//! Errors of hair files.

use thiserror::Error;

/// Why a hair file was refused. Each message is one line that names the file.
#[derive(Debug, Error)]
pub enum HairFileError {
    /// The file could not be opened or read.
    #[error("{name}: cannot be read: {source}")]
    Io {
        /// The file.
        name: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file contradicts itself, its format or its own size.
    #[error("{name}: byte {offset}: found {}; must be {wanted}", in_one_line(found))]
    Malformed {
        /// The file.
        name: String,
        /// The position in the file, in bytes from its start.
        offset: u64,
        /// What was found there.
        found: String,
        /// What would be valid.
        wanted: String,
    },
    /// A line of a text contradicts the format or the other lines.
    #[error("{name}: line {line}: found {}; must be {wanted}", in_one_line(found))]
    MalformedLine {
        /// The file.
        name: String,
        /// The line, from 1.
        line: u64,
        /// What was found there.
        found: String,
        /// What would be valid.
        wanted: String,
    },
    /// The file is valid, but none of its strands can be drawn.
    #[error("{name}: no strand left to draw ({reason}); must have a strand of two points or more")]
    NothingToDraw {
        /// The file.
        name: String,
        /// Why no strands are left.
        reason: String,
    },
}

/// Text of a file as a part of one line: control characters become blanks, and long text is cut.
fn in_one_line(text: &str) -> String {
    const LONGEST: usize = 300;
    let cut = text.chars().nth(LONGEST).is_some();
    let line = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c });
    line.chain(cut.then_some('…')).collect()
}

#[cfg(test)]
mod tests {
    use super::HairFileError;

    #[test]
    fn messages_are_one_line_whatever_a_file_contains() {
        let found = format!("a\r\nb\u{7}{}", "c".repeat(1000));
        let error = HairFileError::Malformed { name: "a.usda".into(), offset: 3, found, wanted: "d".into() };
        let line = error.to_string();
        assert!(
            line.starts_with("a.usda: byte 3: found a  b ccc") && line.ends_with("c…; must be d"),
            "{line}"
        );
        assert!(line.len() < 400 && !line.contains(['\n', '\r', '\u{7}']));
    }
}
