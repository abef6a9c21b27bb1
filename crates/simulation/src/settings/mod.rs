//! What the artist can change about how hair moves.

mod table;

use lovelock_groom::Preset;
use serde::{Deserialize, Serialize};

use crate::integrator::Integrator;

/// How hair moves. Ranges are in its table of settings; the simulator clamps what it is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SimulationSettings {
    /// Gravity, downwards, metres per second squared.
    pub gravity: f32,
    /// How much of its own weight the hairstyle carries at rest: 1 keeps the style exactly as drawn, 0 lets it sag as far as its
    /// stiffness allows.
    pub style_support: f32,
    /// Substeps per step; a fast head raises them.
    pub substeps: u32,
    /// Bending stiffness near the roots, as the angular frequency (1/s) with which a wisp 0.2 m long, clamped at one end and without
    /// weight, would sway. 0 is a chain, 200 wire; one real hair has about 3.
    pub stiffness_root: f32,
    /// Bending stiffness at the tips, 1/s, as `stiffness_root`.
    pub stiffness_tip: f32,
    /// Fraction of the change from the root's stiffness to the tip's that is reached at the middle of a wisp: low values keep it stiff
    /// nearly to the tip, high ones only at the roots, and 0.5 is a straight ramp.
    pub stiffness_bias: f32,
    /// Damping of bending, seconds. A sway of frequency f has the damping ratio pi * f * this.
    pub bend_damping: f32,
    /// Pull toward the style as drawn, as an angular frequency, 1/s; it falls to zero at `hold_reach`.
    pub hold: f32,
    /// Distance along a guide from its root up to which `hold` acts, metres; at most the whole guide.
    pub hold_reach: f32,
    /// Rate at which motion relative to the head decays, 1/s: a stand-in for friction against the hair around.
    pub settle: f32,
    /// Drag of the air, as the rate at which hair takes on the speed of the wind, 1/s.
    pub drag: f32,
    /// The drag at the tips, as a multiple of that at the roots.
    pub drag_tip: f32,
    /// Fraction of the air that the surrounding hair keeps from a point inside the hair.
    pub air_shelter: f32,
    /// Mass of hair per length, as a multiple of the default: heavy hair yields less to air, stiffness and hold.
    pub weight: f32,
    /// The weight at the tips, as a multiple of that at the roots.
    pub weight_tip: f32,
    /// The wind.
    pub wind: Wind,
    /// Friction coefficient of hair on the head.
    pub friction: f32,
    /// Friction coefficient of hair on the rest of the body and its clothes.
    pub cloth_friction: f32,
    /// Friction coefficient of hair on hair, which presses on it with its own weight.
    pub hair_friction: f32,
    /// The friction of hair on hair at the tips, as a multiple of that at the roots.
    pub hair_friction_tip: f32,
    /// Distance that hair keeps from the body, metres. Hair that rests nearer keeps its distance of rest.
    pub skin_margin: f32,
    /// Fraction of its height above the skull that a wisp keeps when it is pressed down, so that layers keep their order and the hair its
    /// volume.
    pub layering: f32,
    /// How hair keeps other hair away.
    pub repulsion: Repulsion,
    /// How the guides of a wisp stay together.
    pub locks: Locks,
    /// Number of links at the root that leave the scalp in the direction of rest; 0 is a hinge.
    pub clamped_links: u32,
    /// The method that keeps links at their length.
    pub integrator: Integrator,
    /// Relaxation iterations along the chain per substep of [`Integrator::Relaxation`].
    pub relaxation_sweeps: u32,
    /// Fraction of the correction of its follower that a point's velocity takes in [`Integrator::FollowTheLeader`]; with 0 chains gain
    /// energy.
    pub follow_damping: f32,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self {
            gravity: 9.81,
            style_support: 1.0,
            substeps: 4,
            stiffness_root: 18.0,
            stiffness_tip: 5.0,
            stiffness_bias: 0.5,
            bend_damping: 0.03,
            hold: 5.0,
            hold_reach: 0.3,
            settle: 2.5,
            drag: 1.2,
            drag_tip: 1.5,
            air_shelter: 0.3,
            weight: 1.0,
            weight_tip: 1.0,
            wind: Wind::default(),
            friction: 0.3,
            cloth_friction: 0.3,
            hair_friction: 0.03,
            hair_friction_tip: 1.0,
            skin_margin: 0.003,
            layering: 0.35,
            repulsion: Repulsion::default(),
            locks: Locks::default(),
            clamped_links: 1,
            integrator: Integrator::Direct,
            relaxation_sweeps: 20,
            follow_damping: 0.9,
        }
    }
}

impl SimulationSettings {
    /// How a shipped hairstyle moves: the defaults with the stiffness, the damping, the hold and the settling of that style.
    #[must_use]
    pub fn preset(preset: Preset) -> Self {
        let default = Self::default();
        match preset {
            // Locks that lie close carry each other: a bob swings as one and opens little.
            Preset::Smooth => default,
            Preset::Ponytail | Preset::Bun => Self { stiffness_root: 14.0, ..default },
            // Curls are springs: nearly as stiff at their tips, and sway on for longer.
            Preset::Curly => {
                Self { stiffness_root: 16.0, stiffness_tip: 10.0, bend_damping: 0.02, ..default }
            }
            // Long hair hangs by its weight.
            Preset::Long => {
                Self { stiffness_root: 10.0, stiffness_tip: 3.0, hold: 4.0, settle: 3.0, ..default }
            }
        }
    }

    /// The same settings with the stiffness, the damping, the hold and the settling of `to` in place of those of `from`; where they are neither
    /// those nor the defaults somebody has chosen them, and they stay.
    #[must_use]
    pub fn restyled(&self, from: &Self, to: &Self) -> Self {
        if ![*from, Self::default()].iter().any(|style| self.of_style(style) == *self) {
            return *self;
        }
        self.of_style(to)
    }

    /// The same settings with what is a style's own of `style`.
    fn of_style(&self, style: &Self) -> Self {
        Self {
            stiffness_root: style.stiffness_root,
            stiffness_tip: style.stiffness_tip,
            stiffness_bias: style.stiffness_bias,
            bend_damping: style.bend_damping,
            hold: style.hold,
            settle: style.settle,
            ..*self
        }
    }

    /// Mass per length at a fraction `along` of a lock, 0 at the root and 1 at the tip, as a multiple of the default.
    #[must_use]
    pub fn weight_at(&self, along: f32) -> f32 {
        self.weight * (1.0 + (self.weight_tip - 1.0) * along)
    }

    /// Bending stiffness at a fraction `along` of a lock, 0 at the root and 1 at the tip, 1/s: the ramp from root
    /// to tip, bent by the bias (Schlick 1994, *Fast alternatives to Perlin's bias and gain functions*).
    #[must_use]
    pub fn stiffness_at(&self, along: f32) -> f32 {
        let gone = along / ((1.0 / self.stiffness_bias - 2.0) * (1.0 - along) + 1.0);
        self.stiffness_root + (self.stiffness_tip - self.stiffness_root) * gone
    }
}

/// The most substeps that one step may take.
pub const MAX_SUBSTEPS: u32 = 16;

/// Air that moves: a direction, a speed, gusts in time and eddies in space. The same seed blows the same wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Wind {
    /// Where the wind blows to, world space, any length; a zero vector is still air.
    pub direction: [f32; 3],
    /// Mean speed, metres per second.
    pub speed: f32,
    /// How far gusts raise and lower the speed, as a fraction of it.
    pub gusts: f32,
    /// Speed of the eddies as a fraction of the mean speed.
    pub turbulence: f32,
    /// Fraction of the wind that the body keeps from the hair behind it.
    pub sheltering: f32,
    /// Seed of the random numbers of the wind.
    pub seed: u32,
}

impl Default for Wind {
    fn default() -> Self {
        Self { direction: [1.0, 0.0, 0.0], speed: 0.0, gusts: 0.5, turbulence: 0.3, sheltering: 0.8, seed: 1 }
    }
}

/// How the three guides of a wisp stay together as one lock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Locks {
    /// Rate at which guides return that have left their lock, 1/s. 0 lets them go.
    pub cohesion: f32,
    /// The cohesion at the tips, as a multiple of that at the roots.
    pub cohesion_tip: f32,
    /// Rate at which the guides of a lock take on each other's velocity, 1/s.
    pub friction: f32,
    /// How much wider a lock may become that moves fast, as a fraction of its width.
    pub opening: f32,
}

impl Default for Locks {
    fn default() -> Self {
        Self { cohesion: 60.0, cohesion_tip: 1.0, friction: 15.0, opening: 0.4 }
    }
}

/// How over-dense cells of the density grid push hair out, and how near hair moves together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Repulsion {
    /// Which force.
    pub mode: RepulsionMode,
    /// Strength, metres squared per second squared: a push of `strength / cell` for a cell twice as dense as it may be.
    pub strength: f32,
    /// Multiple of the density at rest above which a cell counts as over-dense.
    pub threshold: f32,
    /// Rate at which hair takes on the mean velocity of the hair around it, 1/s.
    pub cohesion: f32,
    /// How much the push depends on the direction of the hair around it. 1 pushes only across the hair, harder where wisps cross than
    /// where they run in parallel, and lets them slide along each other; 0 pushes alike in all directions.
    pub anisotropy: f32,
}

impl Default for Repulsion {
    fn default() -> Self {
        Self { mode: RepulsionMode::Pressure, strength: 0.05, threshold: 1.3, cohesion: 2.0, anisotropy: 1.0 }
    }
}

/// The force with which an over-dense cell pushes hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RepulsionMode {
    /// Away from the centre of the over-dense cell (Bertails, Ménier, Cani 2005, section 4.1).
    Centre,
    /// Down the gradient of the excess density, which has no preferred lattice planes.
    Pressure,
}

#[cfg(test)]
mod tests {
    use lovelock_base::settings::Settings;

    use super::*;

    #[test]
    fn the_defaults_lie_inside_their_ranges() {
        let d = SimulationSettings::default();
        assert_eq!(d, d.clamped());
    }

    #[test]
    fn the_ramp_goes_from_root_to_tip_and_its_bias_is_its_middle() {
        let ramp =
            SimulationSettings { stiffness_root: 20.0, stiffness_tip: 4.0, ..SimulationSettings::default() };
        for bias in [0.05, 0.3, 0.5, 0.95] {
            let s = SimulationSettings { stiffness_bias: bias, ..ramp };
            assert!((s.stiffness_at(0.0) - 20.0).abs() < 1e-5 && (s.stiffness_at(1.0) - 4.0).abs() < 1e-5);
            assert!((s.stiffness_at(0.5) - (20.0 - 16.0 * bias)).abs() < 1e-4, "{}", s.stiffness_at(0.5));
        }
        assert!((ramp.stiffness_at(0.25) - 16.0).abs() < 1e-5, "a bias of a half is a straight line");
    }

    #[test]
    fn another_style_brings_its_stiffness_unless_somebody_chose_one() {
        let of = SimulationSettings::preset;
        for preset in Preset::ALL {
            assert_eq!(of(preset), of(preset).clamped(), "{preset:?}");
        }
        assert_eq!(of(Preset::Smooth), SimulationSettings::default());
        let windy = SimulationSettings { gravity: 5.0, ..of(Preset::Curly) };
        let long = windy.restyled(&of(Preset::Curly), &of(Preset::Long));
        assert_eq!(long, SimulationSettings { gravity: 5.0, ..of(Preset::Long) }, "the rest stays");
        assert_eq!(long.restyled(&of(Preset::Long), &of(Preset::Curly)), windy, "and back");
        let usual = SimulationSettings::default();
        assert_eq!(usual.restyled(&of(Preset::Curly), &of(Preset::Long)), of(Preset::Long));
        let chosen = SimulationSettings { hold: 9.0, ..of(Preset::Curly) };
        assert_eq!(chosen.restyled(&of(Preset::Curly), &of(Preset::Long)), chosen);
    }

    #[test]
    fn nonsense_becomes_a_value_that_can_be_simulated() {
        let mut s = SimulationSettings {
            gravity: f32::NAN,
            stiffness_root: f32::INFINITY,
            drag: -3.0,
            substeps: 0,
            clamped_links: 99,
            relaxation_sweeps: 0,
            follow_damping: 7.0,
            ..SimulationSettings::default()
        };
        s.wind.direction = [f32::NAN, 0.0, 1.0];
        s.repulsion.strength = -1.0;
        let c = s.clamped();
        assert_eq!(c.gravity, SimulationSettings::default().gravity);
        assert_eq!((c.stiffness_root, c.drag, c.substeps, c.clamped_links), (200.0, 0.0, 1, 2));
        assert_eq!((c.relaxation_sweeps, c.follow_damping), (1, 1.0));
        assert_eq!(c.wind.direction, Wind::default().direction);
        assert_eq!(c.repulsion.strength, 0.0);
    }
}
