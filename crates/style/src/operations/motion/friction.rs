//! Makes hair cling to the body more or less than the Simulation settings do.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::motion::scale;
use crate::operate::{Kind, Operate, Subject};

/// Makes hair cling to the body more or less than the Simulation settings do.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// Factor on the friction with the body.
    pub factor: f32,
}

impl Default for Friction {
    fn default() -> Self {
        Self { factor: 2.0 }
    }
}

impl Settings for Friction {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, factor),
        [0.0, 8.0],
        "Factor",
        "Multiplies the friction with skin and clothes. With higher values hair clings to the body, with lower ones it slides off.",
    )
    .unit(Unit::TIMES)
    .soft([0.0, 4.0])];
}

impl Operate for Friction {
    const KIND: Kind = Kind {
        id: "friction",
        label: "Friction",
        text: "Makes hair cling to the body more or less than the Simulation settings do.",
        subject: Subject::Motion,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        scale(style, scope, self.factor, |motion| &mut motion.friction);
    }
}
