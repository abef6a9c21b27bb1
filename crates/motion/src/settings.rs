//! Units and axes of files that name neither.

use serde::{Deserialize, Serialize};

/// The length that one unit of a file stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    /// Guessed from the size of the figure.
    #[default]
    Auto,
    /// Metres, as glTF has it.
    Metres,
    /// Decimetres (`MakeHuman`).
    Decimetres,
    /// Centimetres.
    Centimetres,
    /// Millimetres.
    Millimetres,
    /// Inches.
    Inches,
    /// Inches over 0.45, the unit of the CMU motion library.
    Cmu,
}

impl LengthUnit {
    /// Metres of one unit; `None` for [`LengthUnit::Auto`].
    pub fn metres(self) -> Option<f32> {
        match self {
            Self::Auto => None,
            Self::Metres => Some(1.0),
            Self::Decimetres => Some(0.1),
            Self::Centimetres => Some(0.01),
            Self::Millimetres => Some(0.001),
            Self::Inches => Some(0.0254),
            Self::Cmu => Some(0.0254 / 0.45),
        }
    }

    /// What the interface and the notes call it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Auto => "automatic",
            Self::Metres => "metres",
            Self::Decimetres => "decimetres",
            Self::Centimetres => "centimetres",
            Self::Millimetres => "millimetres",
            Self::Inches => "inches",
            Self::Cmu => "CMU units (inches over 0.45)",
        }
    }
}

/// The axis of a file that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// The format's own (glTF: Y) or a guess from the figure (BVH).
    #[default]
    Auto,
    /// Y is up.
    Y,
    /// Z is up, and the front is -Y; turned by -90 degrees about X.
    Z,
}

/// The way that a rest pose faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Facing {
    /// Guessed from the legs.
    #[default]
    Auto,
    /// As glTF has it.
    PlusZ,
    /// Turned by a quarter to the figure's left.
    PlusX,
    /// Turned round.
    MinusZ,
    /// Turned by a quarter to the figure's right.
    MinusX,
}

/// How to read a character.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct BodySettings {
    /// The unit of the file. The guess is metres unless the figure would be a giant.
    pub unit: LengthUnit,
    /// The axis that points up. Automatic is Y, as glTF has it.
    pub up: UpAxis,
    /// The way that the rest pose faces; it is turned to +Z.
    pub facing: Facing,
}

/// How the root's position of a BVH row is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RootPosition {
    /// Guessed: whichever puts the figure's root at the height of its legs.
    #[default]
    Auto,
    /// It replaces the root's OFFSET (Rokoko, Bandai, CMU).
    Absolute,
    /// It is added to the root's OFFSET (`MakeHuman`).
    Added,
}

/// How to read a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionSettings {
    /// The unit of the file. The guess supposes a figure between 1.2 and 2.2 m.
    pub unit: LengthUnit,
    /// The axis that points up.
    pub up: UpAxis,
    /// What the root's position channels mean.
    pub root: RootPosition,
}
