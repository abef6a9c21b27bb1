//! The names of the shadow methods.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A way to find the light that reaches a point inside hair.
///
/// Menus, the command line, comparisons and tests go through [`ShadowMethod::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ShadowMethod {
    /// No shadow inside hair: every point receives all light.
    None,
    /// Light-oriented map of density and transmittance (Bertails, Ménier, Cani 2005).
    #[default]
    VoxelMap,
    /// Optical depth at uniform slices along the light (Kim, Neumann 2001).
    OpacityMaps,
    /// A few layers that begin at the first hair (Yuksel, Keyser 2008).
    DeepOpacityMaps,
    /// A few bins of even density where the hair is (Mertens, Kautz, Bekaert, Van Reeth 2004).
    DensityClustering,
    /// Bits for slices with hair and counts for slabs of them (Sintorn, Assarsson 2009).
    OccupancyMaps,
    /// Every fragment, sorted: what the other methods are judged by.
    Exact,
}

impl ShadowMethod {
    /// Every method, in the order of menus and reports.
    pub const ALL: &'static [Self] = &[
        Self::None,
        Self::VoxelMap,
        Self::OpacityMaps,
        Self::DeepOpacityMaps,
        Self::DensityClustering,
        Self::OccupancyMaps,
        Self::Exact,
    ];

    /// The stable name of the command line, of projects and of reports.
    pub const fn id(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::VoxelMap => "voxel-map",
            Self::OpacityMaps => "opacity-maps",
            Self::DeepOpacityMaps => "deep-opacity-maps",
            Self::DensityClustering => "density-clustering",
            Self::OccupancyMaps => "occupancy-maps",
            Self::Exact => "exact",
        }
    }

    /// What the interface calls it.
    pub const fn label(self) -> &'static str {
        match self {
            Self::None => "None",
            Self::VoxelMap => "Voxel map",
            Self::OpacityMaps => "Opacity maps",
            Self::DeepOpacityMaps => "Deep opacity maps",
            Self::DensityClustering => "Density clustering",
            Self::OccupancyMaps => "Occupancy maps",
            Self::Exact => "Exact",
        }
    }

    /// One sentence: what it does and whose it is.
    pub const fn description(self) -> &'static str {
        match self {
            Self::None => "No shadow inside hair: every strand receives all light.",
            Self::VoxelMap => {
                "Density of hair in a grid along the light, summed slice by slice (Bertails, Ménier, Cani 2005)."
            }
            Self::OpacityMaps => {
                "Optical depth at equal slices along the light, for each light texel (Kim, Neumann 2001)."
            }
            Self::DeepOpacityMaps => {
                "A few layers for each light texel that begin at its first hair (Yuksel, Keyser 2008)."
            }
            Self::DensityClustering => {
                "A few bins of even density for each light texel, placed where its hair is (Mertens and others 2004)."
            }
            Self::OccupancyMaps => {
                "Bits for slices with hair and counts for slabs of them, for each light texel (Sintorn, Assarsson 2009)."
            }
            Self::Exact => {
                "Every fragment of each light texel, sorted by depth: what the others are judged by."
            }
        }
    }

    /// The publication that the method comes from; `None` where there is none.
    pub const fn source(self) -> Option<&'static str> {
        match self {
            Self::None | Self::Exact => None,
            Self::VoxelMap => Some(
                "Bertails, Ménier, Cani 2005, A Practical Self-Shadowing Algorithm for Interactive Hair Animation",
            ),
            Self::OpacityMaps => Some("Kim, Neumann 2001, Opacity Shadow Maps"),
            Self::DeepOpacityMaps => Some("Yuksel, Keyser 2008, Deep Opacity Maps"),
            Self::DensityClustering => Some(
                "Mertens, Kautz, Bekaert, Van Reeth 2004, A Self-Shadow Algorithm for Dynamic Hair using Density \
                 Clustering",
            ),
            Self::OccupancyMaps => Some(
                "Sintorn, Assarsson 2009, Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps",
            ),
        }
    }
}

impl fmt::Display for ShadowMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

/// A name that is no shadow method's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no shadow method is called \"{found}\"; use one of: {}", ids())]
pub struct UnknownShadowMethod {
    /// The name that was asked for.
    pub found: String,
}

fn ids() -> String {
    let ids: Vec<_> = ShadowMethod::ALL.iter().map(|method| method.id()).collect();
    ids.join(", ")
}

impl FromStr for ShadowMethod {
    type Err = UnknownShadowMethod;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.iter().find(|method| method.id() == name);
        found.copied().ok_or_else(|| UnknownShadowMethod { found: name.to_owned() })
    }
}

impl TryFrom<String> for ShadowMethod {
    type Error = UnknownShadowMethod;

    fn try_from(name: String) -> Result<Self, Self::Error> {
        name.parse()
    }
}

impl From<ShadowMethod> for String {
    fn from(method: ShadowMethod) -> Self {
        method.id().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_distinct_and_read_back() {
        for (i, &method) in ShadowMethod::ALL.iter().enumerate() {
            assert_eq!(method.id().parse(), Ok(method));
            assert_eq!(String::from(method), method.to_string());
            assert!(ShadowMethod::ALL[..i].iter().all(|other| other.id() != method.id()));
        }
    }

    #[test]
    fn projects_hold_the_id() {
        use serde::de::value::{Error, StrDeserializer};
        use serde::de::{Deserialize, IntoDeserializer};
        for &method in ShadowMethod::ALL {
            let text: StrDeserializer<'_, Error> = method.id().into_deserializer();
            assert_eq!(ShadowMethod::deserialize(text), Ok(method));
        }
        let text: StrDeserializer<'_, Error> = "fog".into_deserializer();
        let error = ShadowMethod::deserialize(text).unwrap_err().to_string();
        assert!(error.contains("fog") && error.contains("voxel-map"), "{error}");
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = "Voxel map".parse::<ShadowMethod>().unwrap_err().to_string();
        assert_eq!(
            error,
            "no shadow method is called \"Voxel map\"; use one of: none, voxel-map, opacity-maps, deep-opacity-maps, \
             density-clustering, occupancy-maps, exact"
        );
    }
}
