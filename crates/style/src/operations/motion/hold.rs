//! Makes hair keep its styled shape more or less than the Simulation settings do.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::motion::scale;
use crate::operate::{Kind, Operate, Subject};

/// Makes hair keep its styled shape more or less than the Simulation settings do.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// Factor on the hold, as an angular frequency.
    pub factor: f32,
}

impl Default for Hold {
    fn default() -> Self {
        Self { factor: 2.0 }
    }
}

impl Settings for Hold {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, factor),
        [0.0, 8.0],
        "Factor",
        "Multiplies the hold. Higher values act like hair spray, lower ones let hair fly. Tied hair keeps its hold.",
    )
    .unit(Unit::TIMES)
    .soft([0.0, 4.0])];
}

impl Operate for Hold {
    const KIND: Kind = Kind {
        id: "hold",
        label: "Hold",
        text: "Makes hair keep its styled shape more or less than the Simulation settings do.",
        subject: Subject::Motion,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        scale(style, scope, self.factor, |motion| &mut motion.hold);
    }
}
