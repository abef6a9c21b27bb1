//! What an error says about its cause beside its text.

use std::fmt::Display;
use std::path::Path;

/// An error that the front ends report: as one line, with an exit status and the file that it is about.
pub trait Failure: Display {
    /// Whether the request or an input file is wrong. Otherwise valid work failed, for example because the disk is full.
    fn is_request(&self) -> bool;

    /// The file that caused the error, if it is a file.
    fn file(&self) -> Option<&Path> {
        None
    }
}
