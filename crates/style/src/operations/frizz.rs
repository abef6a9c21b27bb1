//! Small irregular bends of the drawn strands.

use std::f32::consts::TAU;

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::strands::{displace, refine};

/// Points that a bend has at least.
const POINTS_PER_BEND: f32 = 8.0;

/// Small irregular bends of each strand.
#[derive(Clone, Debug, PartialEq)]
pub struct Frizz {
    /// Height of the bends, metres.
    pub amplitude: f32,
    /// Length of a bend, metres.
    pub wavelength: f32,
}

impl Default for Frizz {
    fn default() -> Self {
        Self { amplitude: 0.001, wavelength: 0.02 }
    }
}

impl Settings for Frizz {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, amplitude), [0.0, 0.01], "Amplitude", "Height of the bends.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(field!(Self, wavelength), [0.004, 0.1], "Wavelength", "Length of a bend.")
            .unit(Unit::METRES_AS_MM)
            .logarithmic(),
    ];
}

impl Operate for Frizz {
    const KIND: Kind = Kind {
        id: "frizz",
        label: "Frizz",
        text: "Adds small irregular bends to each strand.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.amplitude == 0.0 {
            return;
        }
        refine(style, scope, self.wavelength / POINTS_PER_BEND);
        displace(style, scope, |point| {
            let mut random = scope.random(0, point.strand);
            let size = self.amplitude * (0.6 + 0.8 * random.unit());
            let bends = TAU * point.metres / self.wavelength;
            // Two waves of different lengths on each axis, as in grown hair.
            let mut wobble = || {
                let (a, b) = (random.angle(), random.angle());
                0.6 * (bends * 0.73 + a).sin() + 0.4 * (bends * 1.57 + b).sin()
            };
            let bend = Vec3::new(wobble(), wobble(), 0.0);
            let grown = (0.3 + 0.7 * point.place) * smoothstep(0.0, 0.03, point.metres);
            point.offset + bend * (size * grown * point.strength * scope.along(point.place))
        });
    }
}
