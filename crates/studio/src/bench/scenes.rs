//! The scenes that are measured, and what was published of them.

use std::fmt;
use std::str::FromStr;

use lovelock_groom::Preset;

use crate::{Project, Stage};

/// A scene that is measured: the default project with more or other hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchScene {
    /// The published smooth hairstyle: 134 wisps of 25 strands of 30 segments.
    Smooth,
    /// The published curly hairstyle: the same wisps, twice the segments.
    Curly,
    /// Half a million segments.
    Smooth500k,
    /// A million segments.
    Smooth1M,
    /// Two million segments.
    Smooth2M,
}

impl BenchScene {
    /// All of them, from small to large.
    pub const ALL: [Self; 5] = [Self::Smooth, Self::Curly, Self::Smooth500k, Self::Smooth1M, Self::Smooth2M];

    /// The stable name of the command line and of reports.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Curly => "curly",
            Self::Smooth500k => "smooth-500k",
            Self::Smooth1M => "smooth-1m",
            Self::Smooth2M => "smooth-2m",
        }
    }

    /// The project that is measured: `voxel-map`, blended.
    pub fn project(self) -> Project {
        let mut project = Project::default();
        // 134 wisps of 30 segments a strand: 4,020 segments for each strand of a wisp.
        let strands_per_wisp = match self {
            Self::Smooth | Self::Curly => None,
            Self::Smooth500k => Some(125),
            Self::Smooth1M => Some(249),
            Self::Smooth2M => Some(498),
        };
        project.set_preset(if self == Self::Curly { Preset::Curly } else { Preset::Smooth });
        if let Some(strands) = strands_per_wisp {
            project.hair.groom.strands_per_wisp = strands;
        }
        project
    }

    /// Milliseconds of a stage in Bertails, Ménier, Cani 2005, table 2 (a Pentium 4 at 3 GHz); none where they give
    /// none.
    ///
    /// Animation and collisions are our simulation with the interpolation of strands in it; density and transmittance
    /// our shadow; filtering and drawing our drawing.
    #[expect(clippy::match_same_arms, reason = "the table's figures, which are equal by chance")]
    pub const fn published_ms(self, stage: Stage) -> Option<f64> {
        match (self, stage) {
            (Self::Smooth, Stage::Simulate) => Some(67.0 + 3.0),
            (Self::Smooth, Stage::Shadow) => Some(38.0 + 15.0),
            (Self::Smooth, Stage::Draw) => Some(37.0),
            (Self::Curly, Stage::Simulate) => Some(254.0 + 3.0),
            (Self::Curly, Stage::Shadow) => Some(62.0 + 15.0),
            (Self::Curly, Stage::Draw) => Some(53.0),
            (Self::Smooth | Self::Curly, Stage::Motion | Stage::Interpolate | Stage::Encode)
            | (Self::Smooth500k | Self::Smooth1M | Self::Smooth2M, _) => None,
        }
    }
}

impl fmt::Display for BenchScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

impl FromStr for BenchScene {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|scene| scene.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|scene| scene.id()).collect();
            format!("unknown scene `{id}`: expected one of {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_others_are_refused() {
        for scene in BenchScene::ALL {
            assert_eq!(scene.id().parse(), Ok(scene));
        }
        assert!("wig".parse::<BenchScene>().unwrap_err().contains("smooth-2m"));
    }

    #[test]
    fn the_published_parts_sum_to_what_the_paper_prints() {
        let sum = |scene: BenchScene| -> f64 {
            Stage::ALL.into_iter().filter_map(|stage| scene.published_ms(stage)).sum()
        };
        assert_eq!(sum(BenchScene::Smooth), 160.0);
        // The print says 557 ms for the curly one; its parts sum to this.
        assert_eq!(sum(BenchScene::Curly), 387.0);
    }
}
