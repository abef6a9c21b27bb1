//! Width of the drawn strands.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::strands::widen;

/// Makes strands wider or thinner along the layer's ramp.
#[derive(Clone, Debug, PartialEq)]
pub struct Width {
    /// Factor on the width.
    pub factor: f32,
}

impl Default for Width {
    fn default() -> Self {
        Self { factor: 0.7 }
    }
}

impl Settings for Width {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, factor),
        [0.1, 3.0],
        "Factor",
        "Width of strands relative to the present one.",
    )
    .unit(Unit::FRACTION)];
}

impl Operate for Width {
    const KIND: Kind = Kind {
        id: "width",
        label: "Width",
        text: "Makes strands wider or thinner.",
        subject: Subject::Strands,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        widen(style, scope, |_| self.factor);
    }
}
