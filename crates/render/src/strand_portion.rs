//! Which strands an image draws, by their size on the screen.

use lovelock_groom::fine::Portion;

use crate::{FrameInput, HairPose, StrandCount};

/// The fewest and the most strands that are drawn by their size.
const FEWEST: f32 = 3_000.0;
/// See [`FEWEST`].
pub(crate) const MAX: f32 = 120_000.0;
/// The head's centre above its joint, metres.
const HEAD_HEIGHT: f32 = 0.1;
/// A camera inside the hair sees it from this far, metres.
const NEAREST: f32 = 0.1;

/// The size of a metre at the head in an image `height` pixels high.
pub(crate) fn pixels_per_metre(input: &FrameInput, height: u32) -> f32 {
    let head = input.world_from_head.transform_point3(glam::Vec3::Y * HEAD_HEIGHT);
    let distance = input.camera.eye.distance(head).max(NEAREST);
    input.camera.pixels_per_metre_at_one_metre(height) / distance
}

/// The strands of an image `height` pixels high: `None` for those that are stored.
///
/// As many strands are drawn as make each about `target` pixels wide at the distance of the head, and at most `most` points.
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
    // Fine strands lie between segments of the stored ones.
    if set.first_point.windows(2).any(|ends| ends[1] < ends[0].saturating_add(2)) {
        return None;
    }
    let look = input.look;
    let most = ((most / points_per_strand.max(2) as u64) as f32).min(MAX);
    if picture.strands == StrandCount::Fixed {
        return Some(Portion::of_all(picture.strand_number.clamp(1.0, most.max(1.0)) as usize));
    }
    let scale = pixels_per_metre(input, height);
    let covered = look.diameter * look.real_hairs;
    let wanted = covered * scale / target * picture.strand_detail.clamp(0.1, 10.0);
    let wanted = if wanted.is_finite() { wanted } else { MAX };
    // No strand stands for less than a hair.
    let wanted = wanted.clamp(FEWEST, MAX).min(look.real_hairs.max(1.0)).min(most);
    Some(Portion::fading(wanted, most as usize))
}
