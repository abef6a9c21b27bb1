//! The tools.

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// What a brush does to the hair that it touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tool {
    /// Hair follows the brush.
    #[default]
    Comb,
    /// Bends and differences between neighbours become smaller.
    Smooth,
    /// Hair becomes straight.
    Straighten,
    /// Hair rises from the scalp.
    Puff,
    /// Hair is pressed onto the scalp.
    Flatten,
    /// The strands of locks gather.
    Pinch,
    /// The strands of locks part.
    Spread,
    /// The strands of locks wind around each other.
    Twist,
    /// Strands become curls.
    Curl,
    /// Hair is pulled to the drawn line.
    Attract,
    /// Hair becomes longer.
    Grow,
    /// Hair becomes shorter.
    Shrink,
    /// Hair is cut where the brush touches it.
    Cut,
    /// Hair is combed away from the drawn line to both sides.
    Part,
    /// The locks under the brush at the start of the stroke are moved as a whole.
    Place,
    /// Wisps are removed.
    Remove,
    /// Wisps are protected from all other tools.
    Freeze,
}

impl Tool {
    /// What it does, in one sentence.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Comb => "Moves hair with the brush.",
            Self::Smooth => "Smooths bends of hair and differences between neighbouring locks.",
            Self::Straighten => "Straightens hair toward its tips.",
            Self::Puff => "Lifts hair from the scalp.",
            Self::Flatten => "Presses hair onto the scalp.",
            Self::Pinch => "Gathers the strands of locks.",
            Self::Spread => "Spreads the strands of locks.",
            Self::Twist => "Winds the strands of locks around each other.",
            Self::Curl => "Winds strands into curls.",
            Self::Attract => "Pulls hair toward the drawn line.",
            Self::Grow => "Lengthens hair at its tips.",
            Self::Shrink => "Shortens hair at its tips.",
            Self::Cut => "Cuts hair where the brush touches it.",
            Self::Part => "Combs hair away from the drawn line, to both sides.",
            Self::Place => "Moves the locks under the brush as a whole.",
            Self::Remove => "Removes the locks that the brush touches.",
            Self::Freeze => "Protects the locks that the brush touches from all other tools.",
        }
    }

    /// What it does while it is inverted, in one sentence; `None` if it cannot be.
    pub const fn inverse_text(self) -> Option<&'static str> {
        match self {
            Self::Puff => Some(Self::Flatten.text()),
            Self::Flatten => Some(Self::Puff.text()),
            Self::Pinch => Some(Self::Spread.text()),
            Self::Spread => Some(Self::Pinch.text()),
            Self::Grow => Some(Self::Shrink.text()),
            Self::Shrink => Some(Self::Grow.text()),
            Self::Twist => Some("Winds the strands of locks the other way."),
            Self::Curl => Some("Removes curls made with a brush."),
            Self::Attract => Some("Pushes hair away from the drawn line."),
            Self::Part => Some("Combs hair toward the drawn line, from both sides."),
            Self::Remove => Some("Restores removed locks."),
            Self::Freeze => Some("Unfreezes locks."),
            Self::Comb | Self::Smooth | Self::Straighten | Self::Cut | Self::Place => None,
        }
    }

    /// Whether it pushes points of hair, which may go against the hair.
    pub(crate) const fn pushes(self) -> bool {
        matches!(self, Self::Comb | Self::Puff | Self::Flatten | Self::Attract)
    }

    /// The tool that does the opposite, and whether that one is inverted.
    pub(crate) const fn resolved(self, inverted: bool) -> (Self, bool) {
        match (self, inverted) {
            (Self::Puff, true) => (Self::Flatten, false),
            (Self::Flatten, true) => (Self::Puff, false),
            (Self::Pinch, true) => (Self::Spread, false),
            (Self::Spread, true) => (Self::Pinch, false),
            (Self::Grow, true) => (Self::Shrink, false),
            (Self::Shrink, true) => (Self::Grow, false),
            _ => (self, inverted),
        }
    }
}

impl Choices for Tool {
    const ALL: &'static [Self] = &[
        Self::Comb,
        Self::Smooth,
        Self::Straighten,
        Self::Puff,
        Self::Flatten,
        Self::Pinch,
        Self::Spread,
        Self::Twist,
        Self::Curl,
        Self::Attract,
        Self::Grow,
        Self::Shrink,
        Self::Cut,
        Self::Part,
        Self::Place,
        Self::Remove,
        Self::Freeze,
    ];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Comb => ("comb", "Comb"),
            Self::Smooth => ("smooth", "Smooth"),
            Self::Straighten => ("straighten", "Straighten"),
            Self::Puff => ("puff", "Puff"),
            Self::Flatten => ("flatten", "Flatten"),
            Self::Pinch => ("pinch", "Pinch"),
            Self::Spread => ("spread", "Spread"),
            Self::Twist => ("twist", "Twist"),
            Self::Curl => ("curl", "Curl"),
            Self::Attract => ("attract", "Attract"),
            Self::Grow => ("grow", "Grow"),
            Self::Shrink => ("shrink", "Shrink"),
            Self::Cut => ("cut", "Cut"),
            Self::Part => ("part", "Part"),
            Self::Place => ("place", "Place"),
            Self::Remove => ("remove", "Remove"),
            Self::Freeze => ("freeze", "Freeze"),
        }
    }
}
