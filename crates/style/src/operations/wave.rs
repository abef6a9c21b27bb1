//! Waves that swing whole locks sideways.

use std::f32::consts::TAU;

use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Hairstyle, reference_normal, transport};

use crate::Scope;
use crate::guides::{Lengths, reshape};
use crate::operate::{Kind, Operate, Subject};

/// Waves of guides.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Height of the waves, metres.
    pub height: f32,
    /// Length of a wave, metres.
    pub length: f32,
    /// Angle of the plane of the waves about the hair: 0 is along the scalp, radians.
    pub turn: f32,
    /// How much height, length and phase differ between locks, as a fraction.
    pub variation: f32,
}

impl Default for Wave {
    fn default() -> Self {
        Self { height: 0.01, length: 0.09, turn: 0.0, variation: 0.4 }
    }
}

impl Settings for Wave {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, height), [0.0, 0.05], "Wave height", "How far locks swing sideways.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(field!(Self, length), [0.01, 0.5], "Wave length", "Length of one wave.")
            .unit(Unit::METRES_AS_CM)
            .logarithmic(),
        Setting::number(
            field!(Self, turn),
            [-1.6, 1.6],
            "Turn",
            "Plane of the waves: at 0° they run along the head, at 90° away from it.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Variation",
            "How much waves differ between locks. At 0 % all locks wave alike, as after crimping irons.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Wave {
    const KIND: Kind = Kind {
        id: "wave",
        label: "Wave",
        text: "Adds waves to whole locks. The waves move with the hair.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        reshape(style, scope, Lengths::Keep, |shape| {
            let mut random = scope.random(0, shape.wisp.unwrap_or(shape.index));
            let mut vary = || 1.0 + self.variation * 0.5 * random.signed();
            let (height, length) = (self.height * vary(), self.length * vary());
            let phase = TAU * self.variation * random.unit();
            let root = shape.points[0];
            let outward = (root - scope.head.middle).normalize_or_zero();
            let count = shape.points.len();
            let directions: Vec<_> = (0..count).map(|i| shape.direction(i)).collect();
            // Square to the hair and to the direction away from the head, then carried along.
            let first =
                directions[0].cross(outward).normalize_or(reference_normal(directions[0].into()).into());
            let mut across = first;
            let mut moved = Vec::with_capacity(count);
            for i in 0..count {
                if i > 0 {
                    across = transport(across.into(), directions[i - 1].into(), directions[i].into()).into();
                }
                let metres = i as f32 * shape.link;
                let side = across * self.turn.cos() + directions[i].cross(across) * self.turn.sin();
                let swing = (TAU * metres / length + phase).sin() * smoothstep(0.0, 0.5 * length, metres);
                let strength = shape.strength * scope.along(shape.place(i));
                moved.push(shape.points[i] + side * (swing * height * strength));
            }
            shape.points = moved;
        });
    }
}
