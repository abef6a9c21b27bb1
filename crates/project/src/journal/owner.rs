//! The program that writes a journal.

use std::time::SystemTime;

use crate::date;
use serde::{Deserialize, Serialize};

/// The program that writes a journal.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Owner {
    /// The version of the program.
    pub version: String,
    /// The number of its process.
    pub process: u32,
    /// When it began to write, milliseconds since 1970.
    pub since_ms: u64,
}

impl Owner {
    /// This program, from now on.
    pub(super) fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            process: std::process::id(),
            since_ms: date::unix_ms(date::now()),
        }
    }

    /// When it began to write.
    pub fn since(&self) -> SystemTime {
        date::of_unix_ms(self.since_ms)
    }
}
