//! Turning the style of a project into a second one.

use lovelock_base::settings::{AnySettings, entries, find, set_value};
use lovelock_groom::HairLook;
use lovelock_simulation::SimulationSettings;

use super::document::Style;
use super::mix::StyleParts;
use super::motion::WORLD;
use crate::Project;
use crate::project::{HairMorph, MorphStyle};

impl Project {
    /// Sets the style that the hair turns into, and starts at the project's own. Tracks of the amount stay.
    pub fn start_morph(&mut self, to: &Style) {
        let mut hair = to.hair.clone();
        hair.morph = HairMorph::default();
        let to = MorphStyle { name: to.name.clone(), hair, look: to.look, simulation: to.simulation };
        self.hair.morph = HairMorph { amount: 0.0, to: Some(Box::new(to)) };
    }

    /// Ends the morph with the project's own style.
    pub fn end_morph(&mut self) {
        self.hair.morph = HairMorph::default();
    }

    /// Ends the morph with the second style, which becomes the project's own.
    pub fn take_morph(&mut self) {
        let Some(to) = self.hair.morph.to.take() else { return };
        let MorphStyle { name, hair, look, simulation } = *to;
        self.apply_style(&Style { name, hair, look, simulation, ..Style::default() }, StyleParts::ALL);
    }

    /// The colours between those of the two styles of the morph; `None` if they are the project's own.
    pub fn morphed_look(&self) -> Option<HairLook> {
        let (to, amount) = self.hair.morph.mix()?;
        let mut look = self.look;
        mix(&mut look, &to.look, f64::from(amount), &HairLook::SHARED);
        Some(look)
    }
}

/// The settings of the simulation of another style, to mix with.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MovesMix(Box<SimulationSettings>);

impl MovesMix {
    /// The settings to mix with.
    pub(crate) fn to(settings: &SimulationSettings) -> Self {
        Self(Box::new(*settings))
    }

    /// The settings between `own` and these. Those of the world and of the method stay `own`.
    pub(crate) fn mixed(&self, own: &SimulationSettings, amount: f64) -> SimulationSettings {
        let mut out = *own;
        mix(&mut out, &*self.0, amount, &WORLD);
        out
    }
}

/// Mixes each setting of `own` with that of `other`, but those whose paths begin with one of `kept`.
fn mix(own: &mut dyn AnySettings, other: &dyn AnySettings, amount: f64, kept: &[&str]) {
    for entry in entries(other) {
        if kept.contains(&entry.path.split('.').next().unwrap_or_default()) {
            continue;
        }
        if let Some((_, value)) = find(own, &entry.path) {
            set_value(own, &entry.path, value.between(&entry.value, amount));
        }
    }
}
