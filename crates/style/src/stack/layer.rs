//! A layer: an operation with its weight, mask and ramp.

use lovelock_base::field;
use lovelock_base::settings::{Part, PartMut, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::{Mask, Operation, Ramp};

/// An operation with its weight, mask and ramp.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layer {
    /// A number that no other layer of the stack has; tracks name the layer by it.
    pub id: u32,
    /// Its name; that of the operation where empty.
    pub name: String,
    /// Whether it acts.
    pub on: bool,
    /// How much it acts: 1 wholly, more than that where the operation can.
    pub weight: f32,
    /// Seed of the random numbers of the layer.
    pub seed: u32,
    /// The number of its group, if it is in one.
    pub group: Option<u32>,
    /// Where on the scalp it acts.
    pub mask: Mask,
    /// Where along the strand it acts.
    pub ramp: Ramp,
    /// What it does.
    pub operation: Operation,
}

impl Default for Layer {
    fn default() -> Self {
        Self::of(crate::operations::Length::default())
    }
}

impl Layer {
    /// The longest name, characters.
    pub const LONGEST_NAME: usize = 80;

    /// A layer that acts wholly on all hair. It gets its number from the stack.
    pub fn of(operation: impl Into<Operation>) -> Self {
        Self {
            id: 0,
            name: String::new(),
            on: true,
            weight: 1.0,
            seed: 0,
            group: None,
            mask: Mask::default(),
            ramp: Ramp::default(),
            operation: operation.into(),
        }
    }

    /// Its name, or that of its operation.
    pub fn label(&self) -> &str {
        if self.name.is_empty() { self.operation.label() } else { &self.name }
    }

    /// Whether two layers do the same to hair.
    pub fn acts_like(&self, other: &Self) -> bool {
        self.on == other.on
            && self.weight.to_bits() == other.weight.to_bits()
            && self.seed == other.seed
            && self.mask == other.mask
            && self.ramp == other.ramp
            && self.operation == other.operation
    }
}

impl Settings for Layer {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(field!(Self, on), "On", "Turns the layer on or off."),
        Setting::number(
            field!(Self, weight),
            [0.0, 2.0],
            "Weight",
            "Strength of the layer. Above 100 % its effect is exaggerated.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 1.0]),
        Setting::count(
            field!(Self, seed),
            [0, u32::MAX as u64],
            "Seed",
            "Seed of the random numbers of the layer.",
        )
        .soft([0.0, 999.0]),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        let mut parts: Vec<Part<'_>> = Vec::new();
        if let Some(operation) = self.operation.known() {
            parts.push((operation.kind().id.into(), operation.settings()));
        }
        let masks = self.mask.parts.iter().enumerate();
        parts.extend(masks.map(|(i, part)| -> Part<'_> { (format!("mask{i}").into(), part) }));
        parts
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        let mut parts: Vec<PartMut<'_>> = Vec::new();
        if let Some(operation) = self.operation.known_mut() {
            parts.push((operation.kind().id.into(), operation.settings_mut()));
        }
        let masks = self.mask.parts.iter_mut().enumerate();
        parts.extend(masks.map(|(i, part)| -> PartMut<'_> { (format!("mask{i}").into(), part) }));
        parts
    }

    fn reconcile(&mut self) {
        self.name = self.name.chars().filter(|c| !c.is_control()).take(Self::LONGEST_NAME).collect();
        self.mask = self.mask.clamped();
        self.ramp = self.ramp.clamped();
        self.operation = self.operation.clamped();
    }
}

/// Layers that are switched and weighted together. They follow each other in the stack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Group {
    /// A number that no other group of the stack has.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// Whether its layers act.
    pub on: bool,
    /// Factor on the weights of its layers.
    pub weight: f32,
}

impl Default for Group {
    fn default() -> Self {
        Self { id: 0, name: "Group".to_owned(), on: true, weight: 1.0 }
    }
}

impl Settings for Group {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(field!(Self, on), "On", "Turns the layers of the group on or off."),
        Setting::number(
            field!(Self, weight),
            [0.0, 2.0],
            "Weight",
            "Multiplies the weights of the layers in the group.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 1.0]),
    ];

    fn reconcile(&mut self) {
        self.name = self.name.chars().filter(|c| !c.is_control()).take(Layer::LONGEST_NAME).collect();
    }
}
