//! The shipped hairstyles.

use glam::Vec3;
use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

use crate::{GroomSettings, HairLook, HairShading, HairTie, TieKind};

/// A shipped hairstyle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Brown, smooth, to the shoulders: 134 wisps, 3,350 strands, 100,500 segments.
    Smooth,
    /// Red curls: 134 wisps, 3,350 strands, 201,000 segments.
    Curly,
    /// Golden waves far past the shoulders.
    Long,
    /// Dark brown, combed back into a tie high on the back of the head.
    Ponytail,
    /// Dark blond, wound up in a bun on top of the head.
    Bun,
}

impl Preset {
    /// Every preset, in the order of menus.
    pub const ALL: [Self; 5] = [Self::Smooth, Self::Curly, Self::Long, Self::Ponytail, Self::Bun];

    /// Stable name in project files and on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Curly => "curly",
            Self::Long => "long",
            Self::Ponytail => "ponytail",
            Self::Bun => "bun",
        }
    }

    /// Name in the interface.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Smooth => "Smooth bob",
            Self::Curly => "Red curls",
            Self::Long => "Long waves",
            Self::Ponytail => "Ponytail",
            Self::Bun => "Bun",
        }
    }

    /// The preset with this id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.id() == id)
    }

    /// The ties of the style, on the head of an adult; most styles have none.
    pub const fn ties(self) -> &'static [HairTie] {
        match self {
            Self::Smooth | Self::Curly | Self::Long => &[],
            Self::Ponytail => &[PONYTAIL_TIE],
            Self::Bun => &[BUN_TIE],
        }
    }
}

impl Default for GroomSettings {
    fn default() -> Self {
        Self::preset(Preset::Smooth)
    }
}

impl Choices for Preset {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl GroomSettings {
    /// The settings of a shipped hairstyle.
    pub const fn preset(preset: Preset) -> Self {
        match preset {
            Preset::Smooth => SMOOTH,
            Preset::Curly => CURLY,
            Preset::Long => LONG,
            Preset::Ponytail => PONYTAIL,
            Preset::Bun => BUN,
        }
    }
}

const SMOOTH: GroomSettings = GroomSettings {
    seed: 1,
    wisps: 134,
    strands_per_wisp: 25,
    segments_per_strand: 30,
    length: 0.27,
    layering: 0.14,
    length_variation: 0.08,
    face_framing: 0.25,
    fringe: 0.0,
    fringe_length: 0.09,
    hairline: 0.5,
    part_position: 0.022,
    part_strength: 1.0,
    sweep: 0.5,
    volume: 0.015,
    crown_volume: 0.005,
    root_lift: 0.55,
    hold: 0.06,
    ends: 0.7,
    clump: 0.3,
    locks: 0.2,
    frizz: 0.0012,
    frizz_scale: 0.05,
    strays: 0.03,
    stray_reach: 0.012,
    curl_radius: 0.0,
    curl_pitch: 0.05,
    curl_onset: 0.05,
    curl_wander: 0.4,
    wave: 0.003,
    wave_length: 0.12,
    taper: 0.25,
    look: HairLook {
        eumelanin: 1.1,
        pheomelanin: 0.15,
        shading: HairShading::Fibre,
        grey: 0.0,
        dye: Vec3::new(0.25, 0.02, 0.08),
        dye_amount: 0.0,
        highlights: 0.0,
        highlight_lightening: 0.6,
        variation: 0.25,
        tip_lightening: 0.15,
        diameter: 80e-6,
        real_hairs: 100_000.0,
        width_scale: 0.3,
        primary_strength: 0.6,
        secondary_strength: 0.8,
        roughness: 0.2,
        roughness_around: 0.3,
        scale_tilt: 0.034_906_585,
        refraction: 1.55,
        many_scattering: 1.0,
        extinction_scale: 0.15,
    },
};

const CURLY: GroomSettings = GroomSettings {
    segments_per_strand: 60,
    length: 0.31,
    layering: 0.55,
    length_variation: 0.14,
    face_framing: 0.3,
    part_position: -0.015,
    part_strength: 0.6,
    sweep: 0.2,
    volume: 0.032,
    crown_volume: 0.006,
    root_lift: 1.1,
    hold: 0.10,
    ends: 0.0,
    clump: 0.75,
    locks: 0.6,
    frizz: 0.0015,
    frizz_scale: 0.03,
    strays: 0.05,
    stray_reach: 0.014,
    curl_radius: 0.0085,
    curl_pitch: 0.032,
    curl_onset: 0.03,
    curl_wander: 0.6,
    wave: 0.0,
    taper: 0.3,
    look: HairLook { eumelanin: 0.25, pheomelanin: 0.9, roughness: 0.25, ..SMOOTH.look },
    ..SMOOTH
};

const LONG: GroomSettings = GroomSettings {
    wisps: 180,
    strands_per_wisp: 30,
    segments_per_strand: 40,
    length: 0.58,
    layering: 0.3,
    length_variation: 0.10,
    face_framing: 0.3,
    part_position: 0.0,
    sweep: 0.25,
    volume: 0.016,
    crown_volume: 0.007,
    ends: 0.15,
    clump: 0.6,
    locks: 0.35,
    frizz: 0.0014,
    strays: 0.03,
    stray_reach: 0.014,
    curl_onset: 0.2,
    curl_wander: 0.5,
    wave: 0.009,
    wave_length: 0.10,
    look: HairLook { eumelanin: 0.25, pheomelanin: 0.06, ..SMOOTH.look },
    ..SMOOTH
};

const PONYTAIL: GroomSettings = GroomSettings {
    wisps: 200,
    strands_per_wisp: 36,
    segments_per_strand: 40,
    length: 0.55,
    layering: 0.1,
    length_variation: 0.08,
    face_framing: 0.0,
    part_position: 0.0,
    part_strength: 0.0,
    sweep: 1.0,
    volume: 0.010,
    crown_volume: 0.003,
    root_lift: 0.4,
    ends: 0.1,
    clump: 0.4,
    locks: 0.3,
    frizz: 0.0010,
    strays: 0.02,
    stray_reach: 0.010,
    wave: 0.004,
    wave_length: 0.16,
    taper: 0.35,
    look: HairLook { eumelanin: 4.0, pheomelanin: 0.0, ..SMOOTH.look },
    ..SMOOTH
};

const BUN: GroomSettings = GroomSettings {
    length: 0.62,
    layering: 0.0,
    length_variation: 0.12,
    strays: 0.01,
    stray_reach: 0.003,
    wave: 0.002,
    look: HairLook { eumelanin: 0.55, pheomelanin: 0.12, ..SMOOTH.look },
    ..PONYTAIL
};

const PONYTAIL_TIE: HairTie =
    HairTie { at: Vec3::new(0.0, 0.125, -0.10), axis: Vec3::new(0.0, -0.1, -1.0), ..HairTie::DEFAULT };

const BUN_TIE: HairTie = HairTie {
    kind: TieKind::Bun,
    at: Vec3::new(0.0, 0.165, -0.07),
    axis: Vec3::new(0.0, 1.0, -0.8),
    bun_radius: 0.046,
    ..HairTie::DEFAULT
};
