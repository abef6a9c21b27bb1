//! What a figure of a paper is.

use lovelock_project::error::ProjectError;

use super::studio::Studio;

/// A paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Paper {
    /// *A Practical Self-Shadowing Algorithm for Interactive Hair Animation*, Graphics Interface 2005 and INRIA report RR-5465.
    Bertails,
    /// *A Self-Shadow Algorithm for Dynamic Hair using Density Clustering*, EGSR 2004.
    Mertens,
    /// *Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps*, I3D 2009.
    Sintorn,
    /// The semantics-aware texture function.
    Xu,
}

impl Paper {
    /// Authors, year and title.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Bertails => {
                "Bertails, Ménier, Cani 2005: A Practical Self-Shadowing Algorithm for Interactive Hair Animation \
                 (Graphics Interface, and INRIA report RR-5465)"
            }
            Self::Mertens => {
                "Mertens, Kautz, Bekaert, Van Reeth 2004: A Self-Shadow Algorithm for Dynamic Hair using Density Clustering"
            }
            Self::Sintorn => {
                "Sintorn, Assarsson 2009: Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps"
            }
            Self::Xu => "Xu et al.: rendering of hair by a semantics-aware texture function",
        }
    }
}

/// A figure or table: what the paper shows, and what makes ours.
pub(super) struct Figure {
    /// The name on the command line.
    pub id: &'static str,
    pub paper: Paper,
    /// The figures or tables of the paper.
    pub title: &'static str,
    /// One sentence about what the paper shows.
    pub shows: &'static str,
    /// What differs here; empty if nothing does.
    pub differs: &'static str,
    pub make: fn(&mut Studio<'_>) -> Result<(), ProjectError>,
}
