//! A second style that the hair of a project turns into.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{GroomSettings, HairLook, Preset};
use lovelock_simulation::SimulationSettings;
use serde::{Deserialize, Serialize};

use super::sections::HairSection;

/// How far the hair has turned into a second style.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairMorph {
    /// 0 is the project's own style and 1 the second one.
    pub amount: f32,
    /// The second style; without one the amount has no effect.
    pub to: Option<Box<MorphStyle>>,
}

/// A style to which hair is morphed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MorphStyle {
    /// What it is called.
    pub name: String,
    /// How it grows and is styled. Its own morph is not used.
    pub hair: HairSection,
    /// Its colours.
    pub look: HairLook,
    /// How it moves.
    pub simulation: SimulationSettings,
}

impl Default for MorphStyle {
    fn default() -> Self {
        Self {
            name: String::new(),
            hair: HairSection::default(),
            look: GroomSettings::preset(Preset::Smooth).look,
            simulation: SimulationSettings::default(),
        }
    }
}

impl HairMorph {
    /// The longest name of a style, characters.
    pub const LONGEST_NAME: usize = 80;

    /// The second style and the amount, unless the hair is that of the project's own style alone.
    pub fn mix(&self) -> Option<(&MorphStyle, f32)> {
        self.to.as_deref().filter(|_| self.amount > 0.0).map(|to| (to, self.amount))
    }
}

impl Settings for HairMorph {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, amount),
        [0.0, 1.0],
        "Morph",
        "How far the hair has turned into the second style. 0 is the project's own style and 1 the second one.",
    )
    .unit(Unit::FRACTION)];

    fn reconcile(&mut self) {
        let Some(to) = &mut self.to else { return };
        to.name = to.name.chars().filter(|c| !c.is_control()).take(Self::LONGEST_NAME).collect();
        to.hair.morph = Self::default();
        to.hair = to.hair.clamped();
        to.look = to.look.clamped();
        to.simulation = to.simulation.clamped();
    }
}
