//! How many strands an image draws.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Choices;
use lovelock_groom::fine::Portion;
use serde::{Deserialize, Serialize};

use crate::{FrameInput, HairPose};

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
            format!("unknown number of strands `{id}`: expected one of {}", known.join(", "))
        })
    }
}

/// The fewest and the most strands that are drawn by their size.
const FEWEST: f32 = 3_000.0;
/// See [`FEWEST`].
pub(crate) const MOST: f32 = 120_000.0;
/// The head's centre above its joint, metres.
const HEAD_HEIGHT: f32 = 0.1;
/// A camera inside the hair sees it from this far, metres.
const NEAREST: f32 = 0.1;

/// The strands of an image `height` pixels high: `None` for those that are stored.
///
/// A strand is about `target` pixels wide if the head fills a part of the image that shows it whole. At most `most` points are drawn.
pub(crate) fn portion_of(
    input: &FrameInput,
    height: u32,
    target: f32,
    (points_per_strand, most): (usize, u64),
) -> Option<Portion> {
    let picture = input.picture;
    let set = &input.style.strands;
    if picture.strands == StrandCount::Stored || input.known.is_some() || set.count() == 0 {
        return None;
    }
    if let HairPose::Strands(strands) = input.hair {
        // Strands that do not belong to the hairstyle are drawn as they are.
        let points = set.points();
        let fits = *strands.first_point == *set.first_point
            && [&strands.x, &strands.y, &strands.z].iter().all(|axis| axis.len() == points);
        if !fits {
            return None;
        }
    }
    let look = input.look;
    let most = ((most / points_per_strand.max(2) as u64) as f32).min(MOST);
    if picture.strands == StrandCount::Fixed {
        return Some(Portion::of_all(picture.strand_number.clamp(1.0, most.max(1.0)) as usize));
    }
    let head = input.world_from_head.translation + glam::Vec3A::Y * HEAD_HEIGHT;
    let distance = glam::Vec3A::from(input.camera.eye).distance(head).max(NEAREST);
    let scale = input.camera.pixels_per_metre_at_one_metre(height) / distance;
    let covered = look.diameter * look.real_hairs;
    let wanted = covered * scale / target * picture.strand_detail.clamp(0.1, 10.0);
    let wanted = if wanted.is_finite() { wanted } else { MOST };
    // No strand stands for less than a hair.
    let wanted = wanted.clamp(FEWEST, MOST).min(look.real_hairs.max(1.0)).min(most);
    Some(Portion::fading(wanted, most as usize))
}
