//! How the number of strands of an image is chosen.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// How the number of strands of an image is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StrandCount {
    /// As many as make a strand a fraction of a pixel wide.
    #[default]
    BySize,
    /// A fixed number.
    Fixed,
    /// The strands that the hairstyle stores, which are also those that cast shadows.
    Stored,
}

impl Choices for StrandCount {
    const ALL: &'static [Self] = &[Self::BySize, Self::Fixed, Self::Stored];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::BySize => ("by-size", "By size on screen"),
            Self::Fixed => ("fixed", "Fixed number"),
            Self::Stored => ("stored", "As stored"),
        }
    }
}

impl fmt::Display for StrandCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.names().0)
    }
}

impl FromStr for StrandCount {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.iter().copied().find(|count| count.names().0 == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|count| count.names().0).collect();
            format!("unknown number of strands `{id}`: must be one of {}", known.join(", "))
        })
    }
}
