//! Makes hair stiffer or softer than the Simulation settings do.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::motion::scale;
use crate::operate::{Kind, Operate, Subject};

/// Makes hair stiffer or softer than the Simulation settings do.
#[derive(Clone, Debug, PartialEq)]
pub struct Stiffness {
    /// Factor on the bending stiffness, as an angular frequency.
    pub factor: f32,
}

impl Default for Stiffness {
    fn default() -> Self {
        Self { factor: 2.0 }
    }
}

impl Settings for Stiffness {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, factor),
        [0.0, 8.0],
        "Factor",
        "Multiplies the stiffness. Higher values keep the shape of the hair, lower ones let it swing.",
    )
    .unit(Unit::TIMES)
    .soft([0.0, 4.0])];
}

impl Operate for Stiffness {
    const KIND: Kind = Kind {
        id: "stiffness",
        label: "Stiffness",
        text: "Makes hair stiffer or softer than the Simulation settings do.",
        subject: Subject::Motion,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        scale(style, scope, self.factor, |motion| &mut motion.stiffness);
    }
}
