//! What a person may decide about an import.

use std::f64::consts::PI;

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{self, Choices, Setting, Settings};
use lovelock_base::statistics::upper_median_by;
use serde::{Deserialize, Serialize};

use crate::{Facing, Unit, UpAxis};

/// How a hair file becomes a hairstyle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ImportSettings {
    /// Unit of the file's coordinates.
    pub unit: Unit,
    /// Axis of the file that points up.
    pub up: UpAxis,
    /// Axis of the file that the face looks along.
    pub facing: Facing,
    /// Also import strands that the file hides, and guides or proxies that stand for other strands.
    pub include_hidden: bool,
    /// Scale the groom evenly so that its roots fit the scalp; else it keeps the size that the unit gives it.
    pub fit_scale: bool,
    /// Move each strand as a whole by the gap that is left between its root and the skin.
    pub snap_roots: bool,
    /// Number of wisps to aim for; 0 takes one per 25 strands, 64 to 512.
    pub wisps: u32,
    /// Points per guide; 0 takes the median of the file's strands, 8 to 40.
    pub points_per_guide: u32,
    /// Where to put the groom after it was fitted.
    pub placement: Placement,
    /// Seed of the random numbers that group strands and vary their shades.
    pub seed: u32,
}

/// A change of place after the fit, about the middle of the scalp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Placement {
    /// Uniform scale.
    pub scale: f32,
    /// Turns about the axes x (nod), then y (shake), then z (tilt), radians.
    pub turn: Vec3,
    /// Shift along the axes of the head, metres.
    pub offset_m: Vec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, turn: Vec3::ZERO, offset_m: Vec3::ZERO }
    }
}

impl Default for ImportSettings {
    fn default() -> Self {
        Self {
            unit: Unit::Auto,
            up: UpAxis::Auto,
            facing: Facing::Auto,
            include_hidden: false,
            fit_scale: true,
            snap_roots: true,
            wisps: 0,
            points_per_guide: 0,
            placement: Placement::default(),
            seed: 0,
        }
    }
}

impl Choices for Unit {
    const ALL: &'static [Self] =
        &[Self::Auto, Self::Metre, Self::Centimetre, Self::Millimetre, Self::Inch, Self::Custom(0.00254)];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("Auto", "Automatic"),
            Self::Metre => ("Metre", "Metres"),
            Self::Centimetre => ("Centimetre", "Centimetres"),
            Self::Millimetre => ("Millimetre", "Millimetres"),
            Self::Inch => ("Inch", "Inches"),
            Self::Custom(_) => ("Custom", "Tenths of an inch"),
        }
    }
}

impl Choices for UpAxis {
    const ALL: &'static [Self] =
        &[Self::Auto, Self::X, Self::MinusX, Self::Y, Self::MinusY, Self::Z, Self::MinusZ];

    fn names(self) -> (&'static str, &'static str) {
        let id = match self {
            Self::Auto => "Auto",
            Self::X => "X",
            Self::MinusX => "MinusX",
            Self::Y => "Y",
            Self::MinusY => "MinusY",
            Self::Z => "Z",
            Self::MinusZ => "MinusZ",
        };
        (id, self.label())
    }
}

impl Choices for Facing {
    const ALL: &'static [Self] =
        &[Self::Auto, Self::PlusX, Self::MinusX, Self::PlusY, Self::MinusY, Self::PlusZ, Self::MinusZ];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Auto => ("Auto", "Automatic"),
            Self::PlusX => ("PlusX", "+X"),
            Self::MinusX => ("MinusX", "-X"),
            Self::PlusY => ("PlusY", "+Y"),
            Self::MinusY => ("MinusY", "-Y"),
            Self::PlusZ => ("PlusZ", "+Z"),
            Self::MinusZ => ("MinusZ", "-Z"),
        }
    }
}

impl Settings for ImportSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<Unit>(
            field!(Self, unit),
            "Unit",
            "The length of one unit of the file, which hair files do not state.",
        ),
        Setting::choice::<UpAxis>(field!(Self, up), "Up axis", "The axis of the file that points up."),
        Setting::choice::<Facing>(
            field!(Self, facing),
            "Facing",
            "The axis of the file along which the face looks.",
        ),
        Setting::switch(
            field!(Self, include_hidden),
            "Include hidden",
            "Imports strands that the file hides, and guides or proxies that stand for other strands.",
        ),
        Setting::switch(
            field!(Self, fit_scale),
            "Fit size",
            "Scales the hair so that its roots fit the scalp.",
        ),
        Setting::switch(
            field!(Self, snap_roots),
            "Roots on skin",
            "Moves each strand as a whole so that its root lies on the skin.",
        ),
        Setting::count(
            field!(Self, wisps),
            [0, 4096],
            "Wisps",
            "Number of groups of strands that move together. 0 makes one per 25 strands.",
        )
        .logarithmic(),
        Setting::count(
            field!(Self, points_per_guide),
            [4, 64],
            "Points per guide",
            "Number of points of each simulated guide strand. 0 takes the median of the file's \
             strands.",
        )
        .soft([0.0, 64.0])
        .or_zero(),
        Setting::number(
            field!(Self, placement.scale),
            [0.25, 4.0],
            "Scale",
            "Scales the hair after it is fitted.",
        )
        .logarithmic(),
        Setting::vector(
            field!(Self, placement.turn),
            [-PI, PI],
            "Rotation",
            ["Nod", "Shake", "Tilt"],
            "Turns the hair about the middle of the scalp.",
        )
        .unit(settings::Unit::RADIANS),
        Setting::vector(
            field!(Self, placement.offset_m),
            [-0.5, 0.5],
            "Offset",
            ["Left", "Up", "Forward"],
            "Moves the hair.",
        )
        .unit(settings::Unit::METRES_AS_CM),
        Setting::count(
            field!(Self, seed),
            [0, u32::MAX as u64],
            "Seed",
            "Seed of the random numbers that group strands and vary their shades.",
        )
        .soft([0.0, 999.0]),
    ];
}

impl ImportSettings {
    /// How many wisps to make of `strands` strands. Left to itself it keeps three strands a wisp, as many as
    /// a wisp has guides.
    pub(super) fn wisps_for(&self, strands: usize) -> usize {
        match self.wisps as usize {
            0 => (strands / 25).clamp(64, 512).min(strands / 3).max(1),
            wisps => wisps.min(strands),
        }
    }

    pub(super) fn points_per_guide_for(&self, first_point: &[u32]) -> usize {
        if self.points_per_guide > 0 {
            return self.points_per_guide as usize;
        }
        let mut counts: Vec<u32> = first_point.array_windows().map(|[a, b]| b - a).collect();
        upper_median_by(&mut counts, Ord::cmp).unwrap_or_default().clamp(8, 40) as usize
    }
}
