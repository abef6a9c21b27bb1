//! A project takes a style, wholly or in part.

use lovelock_groom::{GroomSettings, HairLook, HairTie, Preset};
use lovelock_simulation::SimulationSettings;

use super::document::Style;
use super::mix::{StyleParts, mixed};
use super::motion;
use super::shipped::{self, Shipped};
use crate::Project;
use crate::project::{HairSection, HairSource};

impl Project {
    /// Takes the parts `parts` of a style. How much light hair blocks stays, whatever its colour. Where the shape is taken, settings of
    /// the simulation that somebody has chosen stay; motion alone is taken as it is. Gravity, wind and the method always stay.
    pub fn apply_style(&mut self, style: &Style, parts: StyleParts) {
        let before = self.hair.simulation();
        let stack = mixed(&self.hair.stack, &style.hair.stack, parts);
        if parts.shape {
            let old = std::mem::take(&mut self.hair);
            self.hair = style.hair.clone();
            if self.hair.source == HairSource::Grown {
                // The hair file that was picked before can be returned to.
                (self.hair.file, self.hair.import) = (old.file, old.import);
            }
            self.hair.moves = None;
            if shipped::by_id(&self.hair.style).is_none() && style.simulation != self.hair.simulation() {
                self.hair.moves = Some(style.simulation);
            }
        }
        self.hair.stack = stack;
        if parts.colour {
            self.look = HairLook { extinction_scale: self.look.extinction_scale, ..style.look };
        }
        if parts.motion {
            self.simulation = if parts.shape {
                motion::follow(&self.simulation, &before, &style.simulation)
            } else {
                motion::of_style(&self.simulation, &style.simulation)
            };
        }
    }

    /// Switches to a shipped hairstyle with its colours and ties, and with its stiffness unless the user has changed that.
    pub fn set_preset(&mut self, preset: Preset) {
        self.apply_style(&Style::of_preset(preset), StyleParts::ALL);
    }

    /// Switches between the grown hairstyle and the hair file that was picked before. Simulation settings that still have the
    /// defaults of the old hair get those of the new hair.
    pub fn set_hair_source(&mut self, source: HairSource) {
        let before = self.hair.simulation();
        self.hair.source = source;
        self.simulation = motion::follow(&self.simulation, &before, &self.hair.simulation());
    }
}

impl HairSection {
    /// The shipped style that the hair began as; `None` for one of the user's own.
    pub fn shipped(&self) -> Option<&'static Shipped> {
        let own = !self.style.is_empty();
        shipped::by_id(if own { &self.style } else { self.preset.id() })
    }

    /// How this hair moves unless it is changed: where the controls of the simulation return to.
    pub fn simulation(&self) -> SimulationSettings {
        match self.source {
            HairSource::Grown => match (self.shipped(), self.moves) {
                (Some(shipped), _) => shipped.style.simulation,
                (None, Some(moves)) => moves,
                (None, None) => SimulationSettings::preset(self.preset),
            },
            HairSource::File => self.moves.unwrap_or_default(),
        }
    }

    /// Where the controls of growing return to.
    pub fn shipped_groom(&self) -> GroomSettings {
        self.shipped().map_or_else(|| GroomSettings::preset(self.preset), |shipped| shipped.style.hair.groom)
    }

    /// Where the controls of ties return to.
    pub fn shipped_ties(&self) -> Vec<HairTie> {
        self.shipped().map_or_else(|| self.preset.ties().to_vec(), |shipped| shipped.style.hair.ties.clone())
    }
}

impl Style {
    /// A shipped hairstyle of the crate `groom` as a style.
    pub(super) fn of_preset(preset: Preset) -> Self {
        let groom = GroomSettings::preset(preset);
        let ties = preset.ties().to_vec();
        Self {
            name: preset.label().to_owned(),
            hair: HairSection { preset, groom, ties, ..HairSection::default() },
            look: groom.look,
            simulation: SimulationSettings::preset(preset),
            ..Self::default()
        }
    }
}
