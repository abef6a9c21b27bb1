//! The shadow map of a light, drawn over the image.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::MAX_LIGHTS;

/// What is drawn of a shadow map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapValue {
    /// Nothing.
    #[default]
    None,
    /// The fraction of the light that arrives.
    Transmittance,
    /// How much light hair absorbs per metre: the density of the hair, scaled by its extinction.
    Density,
}

impl Choices for MapValue {
    const ALL: &'static [Self] = &[Self::None, Self::Transmittance, Self::Density];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::None => ("none", "Nothing"),
            Self::Transmittance => ("transmittance", "Transmittance"),
            Self::Density => ("density", "Density"),
        }
    }
}

/// Where a shadow map is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapForm {
    /// On a plane across the light, which a slider moves from the first hair to the last.
    #[default]
    AcrossLight,
    /// On a plane along the light, across the first axis of the map.
    AlongLightY,
    /// On a plane along the light, across the second axis of the map.
    AlongLightZ,
    /// At points where there is hair.
    Points,
}

impl Choices for MapForm {
    const ALL: &'static [Self] = &[Self::AcrossLight, Self::AlongLightY, Self::AlongLightZ, Self::Points];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::AcrossLight => ("across-light", "Slice across light"),
            Self::AlongLightY => ("along-light-y", "Slice along light, Y"),
            Self::AlongLightZ => ("along-light-z", "Slice along light, Z"),
            Self::Points => ("points", "Points"),
        }
    }
}

/// How the shadow map of a light is drawn over the image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapView {
    /// What is drawn.
    pub value: MapValue,
    /// Where it is drawn.
    pub form: MapForm,
    /// The light, counted from 1 among those that are on. Beyond the last of them it is the last.
    pub light: u32,
    /// The place of a slice in the extent of the hair, 0 to 1.
    pub slice: f32,
    /// Points along the longest edge of the extent of the hair.
    pub points: u32,
    /// Opacity where there is hair or shadow.
    pub opacity: f32,
    /// The density of the last colour, per metre.
    pub density_range: f32,
}

impl Default for MapView {
    fn default() -> Self {
        Self {
            value: MapValue::default(),
            form: MapForm::default(),
            light: 1,
            slice: 0.5,
            points: 28,
            opacity: 0.85,
            density_range: 60.0,
        }
    }
}

impl Settings for MapView {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<MapValue>(
            field!(Self, value),
            "Map shown",
            "Draws the shadow map of a light over the hair: how much light arrives, or how dense the hair is.",
        ),
        Setting::choice::<MapForm>(
            field!(Self, form),
            "Map as",
            "Draws the map on a plane across the light, on one of two planes along it, or at points inside the hair.",
        ),
        Setting::count(
            field!(Self, light),
            [1, MAX_LIGHTS as u64],
            "Light of map",
            "Which light's map is drawn, counted among the lights that are on.",
        ),
        Setting::number(
            field!(Self, slice),
            [0.0, 1.0],
            "Slice",
            "Moves the plane through the hair: from the light away, or from one side to the other.",
        )
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, points),
            [4, 96],
            "Points",
            "Number of points along the longest edge of the map.",
        ),
        Setting::number(
            field!(Self, opacity),
            [0.05, 1.0],
            "Map opacity",
            "Opacity of the map over the hair, where there is hair or shadow.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, density_range),
            [1.0, 10_000.0],
            "Density range",
            "Density of the brightest colour.",
        )
        .unit(Unit::PER_METRE)
        .logarithmic(),
    ];
}
