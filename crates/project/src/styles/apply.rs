//! A project takes a style, wholly or in part.

use lovelock_groom::{GroomSettings, HairTie, Preset};
use lovelock_simulation::SimulationSettings;
use lovelock_style::Layer;

use super::document::Style;
use super::mix::{StyleParts, mixed};
use super::motion;
use super::shipped::{self, Shipped};
use crate::Project;
use crate::project::{HairSection, HairSource, StyleGrowth};

impl Project {
    /// Takes the parts `parts` of a style. Where the shape is taken, settings of the simulation that somebody has chosen stay; motion
    /// alone is taken as it is. Gravity, wind and the method always stay.
    pub fn apply_style(&mut self, style: &Style, parts: StyleParts) {
        self.take_style(style, parts, &|_| false);
    }

    /// As [`Project::apply_style`], but the layers that the user has added stay, with their tracks, and act after those of the style.
    /// Returns how many stay that the style would have replaced.
    pub fn apply_style_below_layers(&mut self, style: &Style, parts: StyleParts) -> usize {
        let shipped = self.hair.shipped().map(|shipped| shipped.style.hair.stack.layers.clone());
        let listed = self.hair.style_layers.clone();
        let kind = |layer: &Layer| layer.operation.known().map(|operation| operation.kind().id);
        // Files of older versions do not list the layers of their style.
        let is_users = move |layer: &Layer| {
            let of_shipped =
                |known: &Layer| listed.is_empty() && known.id == layer.id && kind(known) == kind(layer);
            !listed.contains(&layer.id) && !shipped.iter().flatten().any(of_shipped)
        };
        self.take_style(style, parts, &is_users)
    }

    fn take_style(&mut self, style: &Style, parts: StyleParts, stays: &dyn Fn(&Layer) -> bool) -> usize {
        let before = self.hair.simulation();
        let (stack, from_style, kept) =
            mixed(&self.hair.stack, &style.hair.stack, parts, &self.hair.style_layers, stays);
        if parts.shape {
            let old = std::mem::take(&mut self.hair);
            self.hair = style.hair.clone();
            if self.hair.source == HairSource::Grown {
                // The hair file that was picked before can be returned to.
                (self.hair.file, self.hair.import) = (old.file, old.import);
            }
            (self.hair.moves, self.hair.grows) = (None, None);
            let is_own = self.hair.shipped().is_none();
            if is_own && style.simulation != self.hair.simulation() {
                self.hair.moves = Some(style.simulation);
            }
            if is_own && self.hair.source == HairSource::Grown {
                self.remember_growth();
            }
        }
        self.hair.style_layers = from_style;
        self.hair.stack = stack;
        if parts.colour {
            self.look = self.look.with_style(&style.look);
        }
        if parts.motion {
            self.simulation = if parts.shape {
                motion::follow(&self.simulation, &before, &style.simulation)
            } else {
                motion::of_style(&self.simulation, &style.simulation)
            };
        }
        kept
    }

    /// Makes the hair as it is now that of a style of this id, to which the controls return from now on.
    pub fn become_style(&mut self, id: &str) {
        id.clone_into(&mut self.hair.style);
        self.hair.moves = Some(motion::own(&self.simulation));
        self.hair.groom.look = self.look;
        self.hair.style_layers = self.hair.stack.layers.iter().map(|layer| layer.id).collect();
        self.remember_growth();
    }

    /// Lets the controls of growing and of ties return to what they are now.
    fn remember_growth(&mut self) {
        let grows = StyleGrowth { groom: self.hair.groom, ties: self.hair.ties.clone() };
        self.hair.grows = Some(Box::new(grows));
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
        match (self.shipped(), &self.grows) {
            (Some(shipped), _) => shipped.style.hair.groom,
            (None, Some(grows)) => grows.groom,
            (None, None) => GroomSettings::preset(self.preset),
        }
    }

    /// Where the controls of ties return to.
    pub fn shipped_ties(&self) -> Vec<HairTie> {
        match (self.shipped(), &self.grows) {
            (Some(shipped), _) => shipped.style.hair.ties.clone(),
            (None, Some(grows)) => grows.ties.clone(),
            (None, None) => self.preset.ties().to_vec(),
        }
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
