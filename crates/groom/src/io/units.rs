//! Unit, axes and colour space of hair files.

use glam::{Mat3, Quat, Vec3};
use serde::{Deserialize, Serialize};

/// The unit of a file's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Unit {
    /// Guessed by [`guess_units`](super::guess_units).
    #[default]
    Auto,
    /// 1 m.
    Metre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
    /// 0.0254 m.
    Inch,
    /// Metres per unit, 1e-12 to 1e12.
    Custom(f32),
}

impl Unit {
    /// The named units, in the order in which they are tried.
    pub const NAMED: [Self; 4] = [Self::Metre, Self::Centimetre, Self::Millimetre, Self::Inch];

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
            Self::Custom(_) => "custom",
        }
    }

    /// Its name in sentences.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Metre => "metre",
            Self::Centimetre => "centimetre",
            Self::Millimetre => "millimetre",
            Self::Inch => "inch",
            Self::Auto | Self::Custom(_) => "unit of its own",
        }
    }

    /// The unit with this [`Self::id`], except for custom ones.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::NAMED.into_iter().chain([Self::Auto]).find(|unit| unit.id() == id)
    }

    /// Metres per unit; `None` for [`Self::Auto`] and for custom units outside their range.
    pub fn metres(self) -> Option<f32> {
        match self {
            Self::Auto => None,
            Self::Metre => Some(1.0),
            Self::Centimetre => Some(0.01),
            Self::Millimetre => Some(0.001),
            Self::Inch => Some(0.0254),
            Self::Custom(metres) => (1e-12..=1e12).contains(&metres).then_some(metres),
        }
    }
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// Guessed by [`guess_units`](super::guess_units).
    #[default]
    Auto,
    /// +X.
    X,
    /// -X.
    MinusX,
    /// +Y, as in TressFX.
    Y,
    /// -Y.
    MinusY,
    /// +Z, as in the known `.hair` files.
    Z,
    /// -Z.
    MinusZ,
}

impl UpAxis {
    /// All axes, without `Auto`.
    pub const AXES: [Self; 6] = [Self::X, Self::MinusX, Self::Y, Self::MinusY, Self::Z, Self::MinusZ];

    /// The values of an option, for messages.
    pub const IDS: &str = "auto, x, -x, y, -y, z or -z";

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::X => "x",
            Self::MinusX => "-x",
            Self::Y => "y",
            Self::MinusY => "-y",
            Self::Z => "z",
            Self::MinusZ => "-z",
        }
    }

    /// The axis with this [`Self::id`].
    pub fn from_id(id: &str) -> Option<Self> {
        Self::AXES.into_iter().chain([Self::Auto]).find(|up| up.id() == id)
    }

    /// Its name in sentences and menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Auto => "Automatic",
            Self::X => "X",
            Self::MinusX => "-X",
            Self::Y => "Y",
            Self::MinusY => "-Y",
            Self::Z => "Z",
            Self::MinusZ => "-Z",
        }
    }

    /// The unit vector along it; that of +Y for [`Self::Auto`].
    pub(crate) fn direction(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::MinusX => Vec3::NEG_X,
            Self::Auto | Self::Y => Vec3::Y,
            Self::MinusY => Vec3::NEG_Y,
            Self::Z => Vec3::Z,
            Self::MinusZ => Vec3::NEG_Z,
        }
    }
}

/// The axis of a file along which the face looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Facing {
    /// Guessed by [`guess_units`](super::guess_units).
    #[default]
    Auto,
    /// +X.
    PlusX,
    /// -X.
    MinusX,
    /// +Y, in files with Z up.
    PlusY,
    /// -Y, in files with Z up.
    MinusY,
    /// +Z, in files with Y up.
    PlusZ,
    /// -Z, in files with Y up.
    MinusZ,
}

impl Facing {
    /// All axes, without `Auto`.
    pub const AXES: [Self; 6] =
        [Self::PlusX, Self::MinusX, Self::PlusY, Self::MinusY, Self::PlusZ, Self::MinusZ];

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
            Self::PlusZ => "+z",
            Self::MinusZ => "-z",
        }
    }

    /// The axis with this [`Self::id`].
    pub fn from_id(id: &str) -> Option<Self> {
        Self::AXES.into_iter().chain([Self::Auto]).find(|facing| facing.id() == id)
    }

    pub(crate) fn is_square_to(self, up: UpAxis) -> bool {
        self.direction().dot(up.direction()) == 0.0
    }

    pub(crate) fn direction(self) -> Vec3 {
        match self {
            Self::PlusX => Vec3::X,
            Self::MinusX => Vec3::NEG_X,
            Self::PlusY => Vec3::Y,
            Self::MinusY => Vec3::NEG_Y,
            Self::Auto | Self::PlusZ => Vec3::Z,
            Self::MinusZ => Vec3::NEG_Z,
        }
    }
}

/// The rotation from file axes to head axes: `up` to +Y, `facing` to +Z. A facing along `up` is replaced by the common
/// one.
pub(crate) fn rotation_to_head_axes(up: UpAxis, facing: Facing) -> Quat {
    let up_direction = up.direction();
    let mut forward = facing.direction();
    if facing == Facing::Auto || !facing.is_square_to(up) {
        forward = usual_facing(up).direction();
    }
    let file_from_head = Mat3::from_cols(up_direction.cross(forward), up_direction, forward);
    Quat::from_mat3(&file_from_head.transpose())
}

/// +Y where Z is vertical, +Z otherwise.
pub(super) fn usual_facing(up: UpAxis) -> Facing {
    if matches!(up, UpAxis::Z | UpAxis::MinusZ) { Facing::PlusY } else { Facing::PlusZ }
}

/// From linear sRGB, as in USD and glTF, to display values, as in hair files.
pub(super) fn display_from_linear(v: f32) -> f32 {
    let v = v.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// From display values to linear sRGB.
pub(super) fn linear_from_display(v: f32) -> f32 {
    let v = v.clamp(0.0, 1.0);
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}
