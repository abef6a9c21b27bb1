//! How strands that overlap in a pixel are put together.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How strands that overlap in a pixel are put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transparency {
    /// Every strand hides what is behind it; its coverage of a pixel is rounded to the samples of the pixel.
    Opaque,
    /// Segments are blended from far to near, sorted by the depth of their middle.
    #[default]
    Sorted,
}

impl Transparency {
    /// All modes, in the order of menus.
    pub const ALL: [Self; 2] = [Self::Opaque, Self::Sorted];

    /// The stable name that the command line, project files and reports use.
    pub fn id(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::Sorted => "sorted",
        }
    }

    /// The name in menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Opaque => "Opaque",
            Self::Sorted => "Sorted segments",
        }
    }
}

impl fmt::Display for Transparency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl FromStr for Transparency {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|mode| mode.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|mode| mode.id()).collect();
            format!("unknown transparency `{id}`: expected one of {}", known.join(", "))
        })
    }
}
