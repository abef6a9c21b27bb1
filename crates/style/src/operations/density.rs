//! Fewer strands.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// What random numbers of strands are for, apart from those of other operations.
const STRANDS: u32 = 0xde;

/// Removes a part of the strands, as thinning scissors do: with a ramp along the hair, strands end where there are to be fewer.
///
/// A removed strand keeps its place in the hairstyle with no width, so that layers after this one do the same to the other strands as before,
/// and the strands that are left do not become wider for those that are missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Share of the strands that remain.
    pub share: f32,
}

impl Default for Density {
    fn default() -> Self {
        Self { share: 0.3 }
    }
}

impl Settings for Density {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, share),
        [0.0, 1.0],
        "Strands kept",
        "Share of the strands that remain.",
    )
    .unit(Unit::FRACTION)];
}

impl Operate for Density {
    const KIND: Kind = Kind {
        id: "density",
        label: "Density",
        text: "Thins hair out by removing a share of its strands. With a curve along the hair, strands end at different lengths.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let strengths = scope.strands(style);
        let set = &mut style.strands;
        for (strand, strength) in strengths.into_iter().enumerate() {
            let removed = strength * (1.0 - self.share);
            if removed <= 0.0 {
                continue;
            }
            let points = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
            let end = set.guide_param[points.end - 1].max(1e-6);
            // From 0 up to, but without, 1.
            let own = scope.random(STRANDS, strand).unit();
            let is_removed = |i: &usize| own < removed * scope.along(set.guide_param[*i] / end);
            let Some(first) = points.clone().find(is_removed) else { continue };
            set.taper[first..points.end].fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{GroomSettings, Hairstyle, NoObstacle, PlainHead, grow};

    use super::*;
    use crate::operations::Strays;
    use crate::{Layer, Ramp, apply_layer};

    /// The number of strands that have a width at a place along the guides, in links.
    fn reach(style: &Hairstyle, place: f32) -> f32 {
        let set = &style.strands;
        let reaches = |strand: &usize| {
            let points = set.first_point[*strand] as usize..set.first_point[strand + 1] as usize;
            points.into_iter().any(|i| set.guide_param[i] >= place && set.taper[i] > 0.0)
        };
        (0..set.count()).filter(reaches).count() as f32
    }

    #[test]
    fn the_share_of_strands_stays_and_ends_where_the_ramp_says() {
        let settings = GroomSettings { wisps: 12, strands_per_wisp: 100, ..GroomSettings::default() };
        let style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
        let made = |layer: &Layer| {
            let made = apply_layer(layer, 1.0, &style, &NoObstacle).expect("a change");
            made.check().expect("sound");
            made
        };
        let even = Layer::of(Density { share: 0.25 });
        let half = Layer { weight: 0.5, ..even.clone() };
        let rising = Layer { ramp: Ramp::line(0.0, 1.0), ..even.clone() };
        for (layer, place, wanted) in
            [(&even, 3.0, 0.25), (&even, 27.0, 0.25), (&half, 15.0, 0.625), (&rising, 15.0, 0.625)]
        {
            let (all, found) = (reach(&style, place), reach(&made(layer), place));
            assert!(all > 600.0, "{all} strands are that long");
            // Four standard deviations of the number of strands that stay, and the link before a strand ends.
            let allowed = 4.0 * (wanted * (1.0 - wanted) / all).sqrt() + 0.75 / 30.0;
            assert!((found / all - wanted).abs() < allowed, "{found} of {all} against {wanted}");
        }
        assert_eq!(made(&even).guides, style.guides);
        assert_eq!(made(&even).strands.count(), style.strands.count());
        // At the root nothing is removed yet.
        assert!(reach(&made(&rising), 0.0) == reach(&style, 0.0));
        assert_eq!(reach(&made(&Layer::of(Density { share: 0.0 })), 0.0), 0.0);
    }

    #[test]
    fn other_operations_choose_their_strands_apart_from_it() {
        let settings = GroomSettings { wisps: 12, strands_per_wisp: 100, ..GroomSettings::default() };
        let style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
        let strays = apply_layer(&Layer::of(Strays::default()), 1.0, &style, &NoObstacle).expect("strays");
        let thin =
            apply_layer(&Layer::of(Density { share: 0.3 }), 1.0, &strays, &NoObstacle).expect("thinned");
        let first = |strand: usize| thin.strands.first_point[strand] as usize;
        let is_stray = |strand: &usize| {
            let points = first(*strand)..first(strand + 1);
            strays.strands.offset_normal[points.clone()] != style.strands.offset_normal[points]
        };
        let all: Vec<usize> = (0..style.strands.count()).filter(is_stray).collect();
        let left = all.iter().filter(|strand| thin.strands.taper[first(**strand)] > 0.0).count();
        let (all, left) = (all.len() as f32, left as f32);
        println!("{left} of {all} strays are left");
        assert!(all > 80.0 && (left / all - 0.3).abs() < 4.0 * (0.21 / all).sqrt());
    }
}
