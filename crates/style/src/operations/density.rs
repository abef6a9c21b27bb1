//! Fewer strands.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Removes a part of the strands, as thinning scissors do: with a ramp along the hair, strands end where there are to be fewer.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// The part of the strands that stays.
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
        "The part of the strands that stays.",
    )
    .unit(Unit::FRACTION)];
}

impl Operate for Density {
    const KIND: Kind = Kind {
        id: "density",
        label: "Density",
        text: "Thins hair out: removes a part of its strands, or shortens them where the ramp rises along the hair.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let strengths = scope.strands(style);
        let points = |strand: usize| {
            let set = &style.strands;
            let removed = strengths[strand] * (1.0 - self.share);
            // From 0 to 1, without 1: nothing is removed of no strand.
            let place = scope.random(0, strand).unit();
            let params =
                &set.guide_param[set.first_point[strand] as usize..set.first_point[strand + 1] as usize];
            let end = params[params.len() - 1].max(1e-6);
            let stays = |u: &&f32| place >= removed * scope.along(**u / end);
            params.iter().take_while(stays).count()
        };
        let points: Vec<usize> = (0..style.strands.count()).map(points).collect();
        let set = std::mem::take(&mut style.strands);
        style.strands = set.shortened(&mut style.wisps, |strand| points[strand]);
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{GroomSettings, Hairstyle, NoObstacle, PlainHead, grow};

    use super::*;
    use crate::{Layer, Ramp, apply_layer};

    /// The number of strands that reach a place along the guides, in links.
    fn reach(style: &Hairstyle, place: f32) -> f32 {
        let set = &style.strands;
        let reaches = |strand: &usize| set.guide_param[set.first_point[strand + 1] as usize - 1] >= place;
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
        // Only strands that would be shorter than a link are left out.
        assert!(reach(&made(&rising), 0.0) > 0.96 * reach(&style, 0.0));
        assert_eq!(made(&Layer::of(Density { share: 0.0 })).strands.count(), 0);
    }
}
