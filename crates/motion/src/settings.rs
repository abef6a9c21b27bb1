//! Units and axes of files that do not specify them.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings};
use serde::{Deserialize, Serialize};

/// The length of one unit of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    /// Guessed from the size of the figure.
    #[default]
    Auto,
    /// Metres, as in glTF.
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
    /// Metres per unit; `None` for [`LengthUnit::Auto`].
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

    /// The name shown in the interface and in notes.
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
    /// The default of the format (glTF: Y) or a guess from the figure (BVH).
    #[default]
    Auto,
    /// Y is up.
    Y,
    /// Z is up, and the front is -Y; rotated by -90 degrees about X.
    Z,
}

/// The direction that a rest pose faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Facing {
    /// Guessed from the legs.
    #[default]
    Auto,
    /// As in glTF.
    PlusZ,
    /// Rotated by 90 degrees to the figure's left.
    PlusX,
    /// Rotated by 180 degrees.
    MinusZ,
    /// Rotated by 90 degrees to the figure's right.
    MinusX,
}

/// What becomes of the hair that a character was made with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OwnHair {
    /// Meshes and materials that are hair by their names, and by the spring bones of a VRM file, are left out.
    #[default]
    Hidden,
    /// They are part of the body.
    Shown,
}

/// How to interpret a character file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct BodySettings {
    /// The unit of the file. The guess is metres unless the figure would be larger than 10 m.
    pub unit: LengthUnit,
    /// The axis that points up. Automatic is Y, as in glTF.
    pub up: UpAxis,
    /// The direction that the rest pose faces; it is rotated to +Z.
    pub facing: Facing,
    /// The hair that is part of the model.
    pub own_hair: OwnHair,
    /// Also read meshes that the file hides, and guides or proxies that stand for other meshes.
    pub include_hidden: bool,
}

/// How the root position of a BVH row is interpreted.
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

/// Where the ends of a clip whose last pose is not its first are blended while it loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoopBlend {
    /// Its end is blended into its first pose; all poses before that are those of the file, from its first key on.
    #[default]
    End,
    /// Its end is blended into its start, and the clip is shorter by the blend. Its time is that on the clock of the file.
    Start,
}

/// How to interpret a motion file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionSettings {
    /// The unit of the file. The guess is one in which the figure is as tall as a person, otherwise its scale.
    pub unit: LengthUnit,
    /// The axis that points up.
    pub up: UpAxis,
    /// The meaning of the root's position channels.
    pub root: RootPosition,
}

impl Choices for LengthUnit {
    const ALL: &'static [Self] = &[
        Self::Auto,
        Self::Metres,
        Self::Decimetres,
        Self::Centimetres,
        Self::Millimetres,
        Self::Inches,
        Self::Cmu,
    ];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("auto", "Automatic"),
            Self::Metres => ("metres", "Metres"),
            Self::Decimetres => ("decimetres", "Decimetres"),
            Self::Centimetres => ("centimetres", "Centimetres"),
            Self::Millimetres => ("millimetres", "Millimetres"),
            Self::Inches => ("inches", "Inches"),
            Self::Cmu => ("cmu", "CMU units (inches over 0.45)"),
        }
    }
}

impl Choices for UpAxis {
    const ALL: &'static [Self] = &[Self::Auto, Self::Y, Self::Z];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("auto", "Automatic"),
            Self::Y => ("y", "Y"),
            Self::Z => ("z", "Z"),
        }
    }
}

impl Choices for Facing {
    const ALL: &'static [Self] = &[Self::Auto, Self::PlusZ, Self::PlusX, Self::MinusZ, Self::MinusX];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("auto", "Automatic"),
            Self::PlusZ => ("plus_z", "+Z"),
            Self::PlusX => ("plus_x", "+X"),
            Self::MinusZ => ("minus_z", "-Z"),
            Self::MinusX => ("minus_x", "-X"),
        }
    }
}

impl Choices for OwnHair {
    const ALL: &'static [Self] = &[Self::Hidden, Self::Shown];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Hidden => ("hidden", "Hidden"),
            Self::Shown => ("shown", "Shown"),
        }
    }
}

impl Choices for LoopBlend {
    const ALL: &'static [Self] = &[Self::End, Self::Start];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::End => ("end", "End of the clip"),
            Self::Start => ("start", "Start of the clip"),
        }
    }
}

impl Choices for RootPosition {
    const ALL: &'static [Self] = &[Self::Auto, Self::Absolute, Self::Added];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("auto", "Automatic"),
            Self::Absolute => ("absolute", "Absolute"),
            Self::Added => ("added", "Added to the offset"),
        }
    }
}

impl Settings for BodySettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<LengthUnit>(field!(Self, unit), "Unit", "The length of one unit of the file."),
        Setting::choice::<UpAxis>(field!(Self, up), "Up axis", "The axis of the file that points up."),
        Setting::choice::<Facing>(
            field!(Self, facing),
            "Facing",
            "The axis of the file along which the figure looks.",
        ),
        Setting::choice::<OwnHair>(
            field!(Self, own_hair),
            "Model's hair",
            "Draws the model's own hair as a part of the body.",
        ),
        Setting::switch(
            field!(Self, include_hidden),
            "Include hidden",
            "Draws meshes that the file hides, and guides or proxies that stand for other meshes.",
        ),
    ];
}

impl Settings for MotionSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<LengthUnit>(field!(Self, unit), "Unit", "The length of one unit of the file."),
        Setting::choice::<UpAxis>(field!(Self, up), "Up axis", "The axis of the file that points up."),
        Setting::choice::<RootPosition>(
            field!(Self, root),
            "Root position",
            "What the position channels of the root mean. Change it if the figure floats or sinks.",
        ),
    ];
}
