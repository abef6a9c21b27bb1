//! Hair that the skin carries: shaded as strands of its own look, and drawn with those of the hairstyle.

use std::sync::Arc;

use lovelock_base::memory::list_bytes;

use super::placed::PlacedScene;
use super::shadow::ShadowStage;
use super::strand_points::{PointsIn, ShadedPoint, ShadedPoints, shade_all};
use super::view::View;
use crate::strand_details::StrandDetails;
use crate::{FrameInput, HairPose, MAX_LIGHTS};

/// The carried hair of the last picture.
#[derive(Debug, Default)]
pub(super) struct CarriedStage {
    details: StrandDetails,
    /// Four 8-bit transmittances per point.
    pub packed: Vec<u32>,
    answers: [Vec<f32>; MAX_LIGHTS],
    points: Vec<ShadedPoint>,
    joined: Option<Joined>,
}

/// The segments of the hairstyle and those of the carried hair behind them.
#[derive(Debug)]
struct Joined {
    of: [Arc<Vec<u32>>; 2],
    whole: usize,
    first_point: usize,
    segments: Arc<Vec<u32>>,
}

impl CarriedStage {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        self.details.bytes()
            + list_bytes(&self.packed)
            + list_bytes(&self.points)
            + self.answers.iter().map(list_bytes).sum::<u64>()
            + self.joined.as_ref().map_or(0, |joined| list_bytes(&joined.segments))
    }

    /// Shades the strands of `input`, that of the carried hair, with its own `view`, by the maps of the last run of `shadow`, and adds them
    /// to the strands of `placed`.
    pub fn draw(&mut self, view: &View, input: &FrameInput, shadow: &ShadowStage, placed: &mut PlacedScene) {
        let HairPose::Strands(strands) = input.hair else { return };
        self.details.follow(input.style);
        shadow.look_up_more(|_| strands, &mut self.answers, &mut self.packed);
        let (details, transmittance) = (&self.details.words[..], &self.packed[..]);
        let from = PointsIn { strands, details, transmittance, colours: self.details.colours() };
        shade_all(placed.width, view, &from, ShadedPoints::All, &mut self.points);
        let (segments, whole) = placed.all_segments();
        let (of, first_point) = ([segments, &self.details.segments], placed.points.len());
        let is_known = self.joined.as_ref().is_some_and(|kept| {
            kept.whole == whole
                && kept.first_point == first_point
                && kept.of.iter().zip(of).all(|(kept, now)| Arc::ptr_eq(kept, now))
        });
        if !is_known {
            // A segment needs its second point.
            let complete = |first: &&u32| (**first as usize + 1) < self.points.len();
            let own = self.details.segments.iter().filter(complete).map(|first| first + first_point as u32);
            let joined = segments[..whole].iter().copied().chain(own);
            // The picture before has given its list back by now, as long as nobody else holds it.
            let mut list = self.joined.take().map(|kept| kept.segments).unwrap_or_default();
            if let Some(list) = Arc::get_mut(&mut list) {
                list.clear();
                list.extend(joined);
            } else {
                list = Arc::new(joined.collect());
            }
            self.joined = Some(Joined { of: of.map(Arc::clone), whole, first_point, segments: list });
        }
        if let Some(joined) = &self.joined {
            placed.append(&self.points, &joined.segments);
        }
    }
}
