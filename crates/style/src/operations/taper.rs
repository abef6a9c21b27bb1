//! Thin tips of the drawn strands.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::strands::widen;

/// Makes strands thinner toward the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Taper {
    /// Fraction of the strand over which it thins.
    pub fraction: f32,
    /// Factor on the width at the tip.
    pub tip: f32,
}

impl Default for Taper {
    fn default() -> Self {
        Self { fraction: 0.4, tip: 0.1 }
    }
}

impl Settings for Taper {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, fraction),
            [0.0, 1.0],
            "Fraction",
            "Part of the strand, measured from the tip, that becomes thinner.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, tip),
            [0.0, 1.0],
            "Tip",
            "Width at the tip, relative to the untapered strand.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Taper {
    const KIND: Kind = Kind {
        id: "taper",
        label: "Taper",
        text: "Makes strands thinner toward the tip.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.fraction == 0.0 {
            return;
        }
        widen(style, scope, |place| {
            let into = ((place - 1.0 + self.fraction) / self.fraction).max(0.0);
            1.0 - (1.0 - self.tip) * into * into.sqrt()
        });
    }
}
