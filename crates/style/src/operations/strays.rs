//! Strands that leave their lock.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::strands::displace;

/// Moves a share of the strands out of their lock.
#[derive(Clone, Debug, PartialEq)]
pub struct Strays {
    /// Share of strands that leave their lock.
    pub share: f32,
    /// Greatest distance of their tips from where they were, metres.
    pub reach: f32,
}

impl Default for Strays {
    fn default() -> Self {
        Self { share: 0.15, reach: 0.02 }
    }
}

impl Settings for Strays {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, share), [0.0, 1.0], "Share", "Share of strands that leave their lock.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, reach),
            [0.0, 0.1],
            "Reach",
            "Largest distance between a stray tip and its lock.",
        )
        .unit(Unit::METRES_AS_MM),
    ];
}

impl Operate for Strays {
    const KIND: Kind = Kind {
        id: "strays",
        label: "Strays",
        text: "Lets some strands stray from their lock.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.reach == 0.0 || self.share == 0.0 {
            return;
        }
        displace(style, scope, |point| {
            let mut random = scope.random(0, point.strand);
            if random.unit() >= self.share {
                return point.offset;
            }
            let angle = random.angle();
            let out = self.reach * (0.4 + 0.6 * random.unit()) * point.place * point.place.sqrt();
            let out = out * point.strength * scope.along(point.place);
            point.offset + Vec3::new(angle.cos(), angle.sin(), 0.0) * out
        });
    }
}
