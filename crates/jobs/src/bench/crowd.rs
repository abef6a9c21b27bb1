//! Many heads of the same hair in one image.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Guides, Hairstyle, StrandColours, Wisp};

/// Heads side by side and behind each other.
const COLUMNS: usize = 5;
const ROWS: usize = 4;
/// Heads of a crowd.
const HEADS: usize = COLUMNS * ROWS;
/// The distance between heads, metres.
const APART: f32 = 1.1;

/// A hairstyle that is the copies of another one, one per head, and their guides. The body is not copied.
pub(super) struct Crowd {
    pub style: Arc<Hairstyle>,
    guides: GuideFrame,
}

impl Crowd {
    pub fn new(one: &Hairstyle) -> Self {
        let guides = one.guides.count() as u32;
        let strands = &one.strands;
        let mut style = one.clone();
        style.guides = copies(&one.guides);
        let floats = [
            &mut style.held,
            &mut style.widest,
            &mut style.strands.guide_param,
            &mut style.strands.offset_normal,
            &mut style.strands.offset_binormal,
            &mut style.strands.offset_tangent,
            &mut style.strands.taper,
            &mut style.strands.shade,
        ];
        for values in floats.into_iter().chain(style.motion.lists_mut()) {
            *values = values.repeat(HEADS);
        }
        style.strands.weights = strands.weights.repeat(HEADS);
        let colours = strands.colours.strands().repeat(HEADS);
        if !colours.is_empty() {
            style.strands.colours = StrandColours::new(colours);
        }
        for head in 1..HEADS as u32 {
            style.wisps.extend(one.wisps.iter().map(|wisp| Wisp {
                guides: wisp.guides.map(|guide| guide + head * guides),
                first_strand: wisp.first_strand + head * strands.count() as u32,
                strand_count: wisp.strand_count,
            }));
            style.strands.wisp.extend(strands.wisp.iter().map(|wisp| wisp + head * one.wisps.len() as u32));
            let ends = strands.first_point.iter().skip(1);
            style.strands.first_point.extend(ends.map(|point| point + head * strands.points() as u32));
            style.ropes.extend(one.ropes.iter().cloned().map(|mut rope| {
                rope.guides.iter_mut().for_each(|(guide, _)| *guide += head * guides);
                rope
            }));
        }
        let frame =
            GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides: Guides::default() };
        Self { style: Arc::new(style), guides: frame }
    }

    /// The guides of all heads, each in the pose `one`.
    pub fn follow(&mut self, one: &GuideFrame) -> &GuideFrame {
        self.guides = GuideFrame { guides: copies(&one.guides), ..*one };
        &self.guides
    }
}

/// The middles of the heads around that of the first pose, metres.
fn places() -> impl Iterator<Item = Vec3> {
    (0..HEADS).map(|head| {
        let middle = |count: usize| 0.5 * (count - 1) as f32;
        let (x, z) = ((head % COLUMNS) as f32, (head / COLUMNS) as f32);
        APART * Vec3::new(x - middle(COLUMNS), 0.0, z - middle(ROWS))
    })
}

fn copies(one: &Guides) -> Guides {
    let moved = |values: &[f32], axis: usize| {
        places().flat_map(|by| values.iter().map(move |value| value + by[axis])).collect::<Vec<_>>()
    };
    Guides {
        points_per_guide: one.points_per_guide,
        x: moved(&one.x, 0),
        y: moved(&one.y, 1),
        z: moved(&one.z, 2),
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{GroomSettings, PlainHead, Strands, grow, interpolate};

    use super::*;

    #[test]
    fn each_head_has_the_same_hair_in_its_own_place() {
        let settings = GroomSettings { wisps: 3, strands_per_wisp: 2, ..GroomSettings::default() };
        let one = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
        let mut crowd = Crowd::new(&one);
        assert_eq!(crowd.style.check(), Ok(()));
        assert_eq!(crowd.style.strands.count(), HEADS * one.strands.count());
        let pose = GuideFrame::at_rest(&one.guides, Affine3A::from_translation(Vec3::Y), 0.0);
        let [mut alone, mut all] = [Strands::default(), Strands::default()];
        interpolate(&one, &pose, &mut alone);
        let style = Arc::clone(&crowd.style);
        interpolate(&style, crowd.follow(&pose), &mut all);
        for (head, place) in places().enumerate() {
            for i in 0..alone.points() {
                let error = all.point(head * alone.points() + i) - alone.point(i) - place;
                assert!(error.length() < 1e-5, "head {head}, point {i}: {error}");
            }
        }
        // No two heads are in one place.
        let places: Vec<_> = places().collect();
        let apart = |a: usize| (0..a).map(move |b| (a, b));
        assert!((0..HEADS).flat_map(apart).all(|(a, b)| places[a].distance(places[b]) > 1.0));
    }
}
