//! How a brush touches hair.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use lovelock_style::Ramp;
use serde::{Deserialize, Serialize};

/// What a brush does on the other side of the head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrushMirror {
    /// Nothing.
    #[default]
    Off,
    /// The mirrored stroke, on the hair as it is there: each side keeps its own shape.
    Own,
    /// The hair there takes the mirrored shape: both sides become equal.
    Same,
}

impl Choices for BrushMirror {
    const ALL: &'static [Self] = &[Self::Off, Self::Own, Self::Same];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Off => ("off", "Off"),
            Self::Own => ("own", "Mirrored stroke"),
            Self::Same => ("same", "Mirrored hair"),
        }
    }
}

/// How a brush touches hair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BrushSettings {
    /// Radius around the place on the hair, metres.
    pub radius: f32,
    /// How strongly it acts at its centre: 1 is wholly.
    pub strength: f32,
    /// The part of the locks that it touches.
    pub share: f32,
    /// Whether it touches only hair in front of the head. Otherwise it acts through the head.
    pub front_only: bool,
    /// What it does on the other side of the head.
    pub mirror: BrushMirror,
    /// Whether hair keeps its length while it is moved.
    pub keep_lengths: bool,
    /// Radius of the curls that the tool *Curl* makes, metres.
    pub curl_radius: f32,
    /// Length of a turn of those curls, metres.
    pub curl_pitch: f32,
    /// Strength by the distance from the centre: 0 is the centre, 1 the edge.
    pub falloff: Ramp,
    /// Strength along the hair: 0 is the root, 1 the tip.
    pub along: Ramp,
}

impl Default for BrushSettings {
    fn default() -> Self {
        Self {
            radius: 0.04,
            strength: 0.7,
            share: 1.0,
            front_only: true,
            mirror: BrushMirror::Off,
            keep_lengths: true,
            curl_radius: 0.008,
            curl_pitch: 0.03,
            falloff: Ramp::through(&[[0.0, 1.0], [1.0, 0.0]]),
            along: Ramp::default(),
        }
    }
}

impl Settings for BrushSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, radius),
            [0.002, 0.5],
            "Brush radius",
            "Radius of the brush on the hair. The keys [ and ] make it smaller and larger.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([0.005, 0.2])
        .logarithmic(),
        Setting::number(
            field!(Self, strength),
            [0.0, 1.0],
            "Strength",
            "How strongly the brush acts at its centre. At 100 % combed hair stays under the brush.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, share),
            [0.0, 1.0],
            "Share of locks",
            "Share of the locks that the brush affects. Lower values make hair less even.",
        )
        .unit(Unit::FRACTION),
        Setting::switch(
            field!(Self, front_only),
            "Front only",
            "Leaves hair on the far side of the head unchanged.",
        ),
        Setting::choice::<BrushMirror>(
            field!(Self, mirror),
            "Mirror",
            "Makes brushes act on the other side of the head too. Mirrored stroke repeats the stroke there, on the hair as \
             it is. Mirrored hair makes the hair there a mirror image. Applies to all brushes.",
        ),
        Setting::switch(
            field!(Self, keep_lengths),
            "Keep length",
            "Keeps the length of hair. Off, combing stretches it.",
        ),
        Setting::number(field!(Self, curl_radius), [0.0, 0.05], "Curl radius", "Radius of new curls.")
            .unit(Unit::METRES_AS_MM)
            .soft([0.0, 0.02]),
        Setting::number(
            field!(Self, curl_pitch),
            [0.004, 0.5],
            "Curl pitch",
            "Length of one turn of new curls.",
        )
        .unit(Unit::METRES_AS_MM)
        .soft([0.005, 0.1])
        .logarithmic(),
    ];

    fn reconcile(&mut self) {
        self.falloff = self.falloff.clamped();
        self.along = self.along.clamped();
    }
}
