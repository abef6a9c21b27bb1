//! Published figures of the measured scenes.

use super::scenes::BenchScene;

/// The stage of the simulation together with the strands that follow it, as animation is published.
pub(super) const ANIMATION: &str = "animation";

/// A published time, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Published {
    /// As printed.
    pub ms: f64,
    /// The sum of its parts as they are printed, if it is another.
    pub parts_ms: Option<f64>,
}

impl Published {
    const fn of(ms: f64) -> Self {
        Self { ms, parts_ms: None }
    }
}

impl BenchScene {
    /// Published time of a stage, a pass or the whole frame, if any.
    ///
    /// `smooth` and `curly`: Bertails, Ménier, Cani 2005, tables 1 and 2 (a Pentium 4 at 3 GHz). Animation includes the update and
    /// the smoothing of the interpolated strands, so it stands with the collisions between hairs beside our simulation and interpolation
    /// together; density and transmittance beside our shadow, filtering and drawing beside our drawing. `simulate-402` compares the
    /// animation with the method of the paper.
    ///
    /// `woman-300k` and `dog-2m`: Sintorn, Assarsson 2009 (a `GeForce` GTX 280). The rates of figure 1 are those of an image. The
    /// paper's table has passes of a frame with 20,000 strands, as many as the woman has and a twentieth of the dog's: its
    /// occupancy and slab-size maps are one pass here, its shadow map of the background the body's depth, its
    /// composition our last pass.
    #[expect(clippy::match_same_arms, reason = "figures that are equal by chance")]
    pub(super) fn published(self, name: &str) -> Option<Published> {
        let found = match (self, name) {
            (Self::Smooth, ANIMATION) | (Self::Simulate402, "animation/relaxation") => 67.0 + 3.0,
            (Self::Smooth, "shadow") => 38.0 + 15.0,
            (Self::Smooth, "draw") => 37.0,
            (Self::Smooth, "frame") => 160.0,
            (Self::Curly, ANIMATION) => 254.0 + 3.0,
            (Self::Curly, "shadow") => 62.0 + 15.0,
            (Self::Curly, "draw") => 53.0,
            (Self::Curly, "frame") => {
                return Some(Published { ms: 557.0, parts_ms: Some(254.0 + 3.0 + 130.0) });
            }
            (Self::Woman300k, "picture") => 1e3 / 37.3,
            (Self::Dog2M, "picture") => 1e3 / 17.2,
            (Self::Woman300k, pass) => PASSES.iter().find(|(name, _)| *name == pass)?.1,
            _ => return None,
        };
        Some(Published::of(found))
    }

    /// A note about the published figures.
    pub(super) const fn published_note(self) -> Option<&'static str> {
        match self {
            Self::Smooth => Some(
                "published: Bertails, Ménier, Cani 2005, a Pentium 4 at 3 GHz, without collisions with the body, which lower 6 frames a \
                 second to 3.5; animation includes the update and smoothing of strands; three processors doubled the rate",
            ),
            Self::Curly => Some(
                "published: Bertails, Ménier, Cani 2005, a Pentium 4 at 3 GHz, without collisions with the body, with which it is 1.5 \
                 frames a second; the frame is printed as 557 ms, but its parts (254 + 3 + 130) sum to 387 ms",
            ),
            Self::Woman300k => Some(
                "published: Sintorn, Assarsson 2009, GeForce GTX 280; the picture is this scene's in figure 1, the stages \
                 and passes are those of the paper's table, of a frame with 20,000 strands that took 31.6 ms in all",
            ),
            Self::Dog2M => Some(
                "published: Sintorn, Assarsson 2009, GeForce GTX 280; the picture is this scene's in figure 1; no times of its passes are \
                 published",
            ),
            Self::Simulate402 => Some(
                "published: Bertails, Ménier, Cani 2005, a Pentium 4 at 3 GHz: animation 67 ms, with the update and smoothing of 3,350 \
                 strands and without collisions with the body; collisions between hairs 3 ms",
            ),
            _ => None,
        }
    }
}

/// The table of Sintorn, Assarsson 2009, milliseconds, by our stages and passes.
const PASSES: [(&str, f64); 11] = [
    ("interpolate", 2.9),
    ("shadow", 2.54 + 2.56 + 2.89),
    ("shadow/range", 2.54),
    ("shadow/occupancy", 2.56 + 2.89),
    ("draw", 2.63 + 1.8 + 1.88 + 0.5 + 1.0 + 12.8 + 0.1),
    ("draw/body-depth", 0.5),
    ("draw/body", 1.0),
    ("draw/range", 2.63),
    ("draw/occupancy", 1.8 + 1.88),
    ("draw/light", 12.8),
    ("draw/picture", 0.1),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_parts_sum_to_what_the_papers_print() {
        let ms = |scene: BenchScene, name: &str| scene.published(name).expect(name).ms;
        let parts =
            |scene: BenchScene| [ANIMATION, "shadow", "draw"].map(|stage| ms(scene, stage)).iter().sum();
        let smooth: f64 = parts(BenchScene::Smooth);
        assert_eq!(BenchScene::Smooth.published("frame"), Some(Published::of(smooth)));
        // The print says 557 ms for the curly one.
        let curly: f64 = parts(BenchScene::Curly);
        assert_eq!(
            BenchScene::Curly.published("frame"),
            Some(Published { ms: 557.0, parts_ms: Some(curly) })
        );
        assert_eq!(BenchScene::Smooth.published("simulate"), None, "animation includes the strands");
        assert_eq!(BenchScene::Smooth1M.published("frame"), None);
        let of = |name: &str| ms(BenchScene::Woman300k, name);
        let begins = |start: &str| -> f64 {
            PASSES.iter().filter(|(name, _)| name.starts_with(start)).map(|(_, ms)| ms).sum()
        };
        // Except for 0.01 ms of keyframes.
        assert!((of("interpolate") + of("shadow") + of("draw") - 31.6).abs() < 1e-9);
        assert!((begins("shadow/") - of("shadow")).abs() < 1e-9);
        assert!((begins("draw/") - of("draw")).abs() < 1e-9);
        assert_eq!((1e3 / of("picture")).round(), 37.0);
    }

    #[test]
    fn a_scene_has_only_figures_of_its_own_hair() {
        assert_eq!((1e4 / BenchScene::Dog2M.published("picture").expect("a rate").ms).round(), 172.0);
        let others = PASSES.iter().map(|(name, _)| *name).chain(["frame", ANIMATION]);
        for name in others {
            assert_eq!(BenchScene::Dog2M.published(name), None, "{name}: of 20,000 strands");
        }
        for scene in BenchScene::ALL {
            let named = ["simulate", ANIMATION, "animation/relaxation", "shadow", "draw", "picture", "frame"];
            let has_figures = named.iter().any(|name| scene.published(name).is_some());
            assert_eq!(scene.published_note().is_some(), has_figures, "{scene}");
        }
    }
}
