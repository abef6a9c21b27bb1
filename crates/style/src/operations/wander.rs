//! Slow drift of strands from their lock.

use std::f32::consts::TAU;

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::strands::displace;

/// Slow drift of each strand from its lock and back.
#[derive(Clone, Debug, PartialEq)]
pub struct Wander {
    /// Distance of the drift, metres.
    pub distance: f32,
    /// Length along the strand over which it drifts and returns, metres.
    pub wavelength: f32,
}

impl Default for Wander {
    fn default() -> Self {
        Self { distance: 0.004, wavelength: 0.2 }
    }
}

impl Settings for Wander {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, distance),
            [0.0, 0.05],
            "Distance",
            "How far strands drift from their lock.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, wavelength),
            [0.05, 1.0],
            "Wavelength",
            "Length along the hair over which a strand drifts and returns.",
        )
        .unit(Unit::METRES_AS_CM)
        .logarithmic(),
    ];
}

impl Operate for Wander {
    const KIND: Kind = Kind {
        id: "wander",
        label: "Wander",
        text: "Lets strands drift slowly from their lock and back.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.distance == 0.0 {
            return;
        }
        displace(style, scope, |point| {
            let mut random = scope.random(0, point.strand);
            let turns = TAU * point.metres / self.wavelength;
            let mut drift = || (turns * (0.7 + 0.6 * random.unit()) + random.angle()).sin();
            let drift = Vec3::new(drift(), drift(), 0.0);
            let grown = smoothstep(0.0, 0.5 * self.wavelength, point.metres);
            point.offset + drift * (self.distance * grown * point.strength * scope.along(point.place))
        });
    }
}
