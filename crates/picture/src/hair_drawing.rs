//! What hair is drawn as.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// What hair is drawn as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HairDrawing {
    /// Strand by strand.
    #[default]
    Strands,
    /// Lock by lock, as layered shells whose appearance comes from a database (Xu et al., "SATF").
    Clusters,
    /// Strands where hair is large in the image, clusters where it is small.
    Auto,
}

impl Choices for HairDrawing {
    const ALL: &'static [Self] = &[Self::Strands, Self::Clusters, Self::Auto];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Strands => ("strands", "Strands"),
            Self::Clusters => ("clusters", "Clusters"),
            Self::Auto => ("auto", "Strands near, clusters far"),
        }
    }
}

impl fmt::Display for HairDrawing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.names().0)
    }
}

impl FromStr for HairDrawing {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.iter().copied().find(|drawing| drawing.names().0 == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|drawing| drawing.names().0).collect();
            format!("hair cannot be drawn as `{id}`: must be one of {}", known.join(", "))
        })
    }
}
