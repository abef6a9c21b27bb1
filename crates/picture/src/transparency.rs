//! How strands that overlap in a pixel are put together.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// How strands that overlap in a pixel are put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transparency {
    /// Every strand hides what is behind it; its coverage of a pixel is rounded to the samples of the pixel.
    Opaque,
    /// Fragments averaged by their opacity, without any order (Bavoil, Meyers 2008).
    WeightedAverage,
    /// Fragments weighted by the order that occupancy maps estimate (Sintorn, Assarsson 2009).
    OccupancyOrder,
    /// Segments are blended from far to near, sorted by the depth of their middle.
    #[default]
    Sorted,
    /// Every fragment of a pixel sorted and blended: what depth peeling gives.
    Exact,
}

impl Transparency {
    /// All modes, in the order of menus.
    pub const ALL: [Self; 5] =
        [Self::Opaque, Self::WeightedAverage, Self::OccupancyOrder, Self::Sorted, Self::Exact];

    /// The stable name that the command line, project files and reports use.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Opaque => "opaque",
            Self::WeightedAverage => "weighted-average",
            Self::OccupancyOrder => "occupancy-order",
            Self::Sorted => "sorted",
            Self::Exact => "exact",
        }
    }

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Opaque => "Opaque",
            Self::WeightedAverage => "Weighted average",
            Self::OccupancyOrder => "Occupancy order",
            Self::Sorted => "Sorted segments",
            Self::Exact => "Exact",
        }
    }

    /// One sentence: what it does and whose it is.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Opaque => "Every strand hides what is behind it.",
            Self::WeightedAverage => {
                "Strands averaged by their opacity, without any order (Bavoil, Meyers 2008)."
            }
            Self::OccupancyOrder => {
                "Strands weighted by the order that occupancy maps estimate (Sintorn, Assarsson 2009)."
            }
            Self::Sorted => "Segments blended from far to near, by the depth of their middle.",
            Self::Exact => "Every fragment of a pixel sorted and blended: the reference for the others.",
        }
    }
}

impl Choices for Transparency {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl fmt::Display for Transparency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

impl FromStr for Transparency {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|mode| mode.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|mode| mode.id()).collect();
            format!("unknown transparency `{id}`: must be one of {}", known.join(", "))
        })
    }
}
