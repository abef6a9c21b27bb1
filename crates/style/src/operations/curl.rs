//! Curls and coils of the drawn strands.

use std::f32::consts::TAU;

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use lovelock_groom::fine::lock_numbers;

use crate::operate::{Kind, Operate, RampInfo, Subject};
use crate::strands::{displace, refine};
use crate::{Ramp, Scope};

/// Points that a turn of a curl has at least.
const POINTS_PER_TURN: f32 = 9.0;

/// Helices around the guides.
#[derive(Clone, Debug, PartialEq)]
pub struct Curl {
    /// Radius of the curls, metres.
    pub radius: f32,
    /// Length of one turn, metres.
    pub pitch: f32,
    /// Distance from the root over which curls grow to their full radius, metres.
    pub onset: f32,
    /// How much radius, pitch and phase differ between locks, as a fraction.
    pub variation: f32,
    /// How much of that differs between the strands of a lock too, as a fraction.
    pub looseness: f32,
    /// Factor on the radius along the strand.
    pub radius_ramp: Ramp,
    /// Factor on the pitch along the strand.
    pub pitch_ramp: Ramp,
}

impl Default for Curl {
    fn default() -> Self {
        Self {
            radius: 0.008,
            pitch: 0.035,
            onset: 0.04,
            variation: 0.4,
            looseness: 0.2,
            radius_ramp: Ramp::default(),
            pitch_ramp: Ramp::default(),
        }
    }
}

impl Settings for Curl {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, radius), [0.0, 0.04], "Radius", "Radius of the curls.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, pitch),
            [0.004, 0.4],
            "Pitch",
            "Length of one turn: coils are below 10 mm, curls 10 to 40 mm, waves more.",
        )
        .unit(Unit::METRES_AS_MM)
        .logarithmic(),
        Setting::number(
            field!(Self, onset),
            [0.0, 0.5],
            "Onset",
            "Distance from the root over which curls grow to their full radius.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Variation",
            "How much radius, pitch and phase differ between locks.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, looseness),
            [0.0, 1.0],
            "Looseness",
            "How much strands differ within a lock. At 0 % each lock is one ringlet.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Curl {
    const KIND: Kind = Kind {
        id: "curl",
        label: "Curl",
        text: "Winds strands into curls or coils, lock by lock.",
        subject: Subject::Strands,
    };
    const RAMPS: &'static [RampInfo] = &[
        RampInfo {
            name: "radius",
            label: "Radius along the hair",
            text: "Multiplies the radius along the hair.",
        },
        RampInfo {
            name: "pitch",
            label: "Pitch along the hair",
            text: "Multiplies the pitch along the hair.",
        },
    ];

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.radius == 0.0 {
            return;
        }
        refine(style, scope, self.pitch / POINTS_PER_TURN);
        let locks = lock_numbers(&style.strands);
        displace(style, scope, |point| {
            let lock = usize::from(locks[point.strand]) + point.wisp * 64;
            let (mut of_lock, mut of_strand) = (scope.random(0, lock), scope.random(1, point.strand));
            let mut vary = |share: f32| {
                share
                    * self.variation
                    * ((1.0 - self.looseness) * of_lock.signed() + self.looseness * of_strand.signed())
            };
            let (radius, pitch, phase) =
                (self.radius * (1.0 + vary(0.5)), self.pitch * (1.0 + vary(0.4)), TAU * vary(1.0));
            let pitch = pitch * self.pitch_ramp.at(point.place).max(0.1);
            let angle = phase + TAU * point.metres / pitch;
            let grown = smoothstep(0.0, self.onset.max(1e-6), point.metres);
            let strength = point.strength * scope.along(point.place) * self.radius_ramp.at(point.place);
            point.offset + Vec3::new(angle.cos(), angle.sin(), 0.0) * (radius * grown * strength)
        });
    }

    fn ramp(&self, index: usize) -> &Ramp {
        if index == 0 { &self.radius_ramp } else { &self.pitch_ramp }
    }

    fn ramp_mut(&mut self, index: usize) -> &mut Ramp {
        if index == 0 { &mut self.radius_ramp } else { &mut self.pitch_ramp }
    }
}
