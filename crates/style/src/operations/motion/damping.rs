//! Makes hair come to rest sooner or later than the Simulation settings do.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::motion::scale;
use crate::operate::{Kind, Operate, Subject};

/// Makes hair come to rest sooner or later than the Simulation settings do.
#[derive(Clone, Debug, PartialEq)]
pub struct Damping {
    /// Factor on the damping of bending and on the settling.
    pub factor: f32,
}

impl Default for Damping {
    fn default() -> Self {
        Self { factor: 2.0 }
    }
}

impl Settings for Damping {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, factor),
        [0.0, 8.0],
        "Factor",
        "Multiplies bend damping and settling. Higher values stop hair sooner, lower ones let it keep swaying.",
    )
    .unit(Unit::TIMES)
    .soft([0.0, 4.0])];
}

impl Operate for Damping {
    const KIND: Kind = Kind {
        id: "damping",
        label: "Damping",
        text: "Makes hair come to rest sooner or later than the Simulation settings do.",
        subject: Subject::Motion,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        scale(style, scope, self.factor, |motion| &mut motion.damping);
    }
}
