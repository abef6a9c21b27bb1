//! A summary of a hair file, for reports.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::orientation::Orientation;
use super::settings::ImportSettings;
use crate::io::{Bounds, HairFile, Unit, UpAxis, guess_units};

/// Summary of a hair file, in the unit and axes of the settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HairInfo {
    /// The format, with its version where it has one.
    pub format: String,
    /// Number of strands that can be drawn.
    pub strands: u64,
    /// Number of their points.
    pub points: u64,
    /// Number of their segments.
    pub segments: u64,
    /// Box of the points in metres, Y up, the face toward +Z.
    pub bounds_m: Bounds,
    /// `m`, `cm`, `mm`, `in`; `custom` where a number was given; `scaled` where the guess is a head's size.
    pub unit: String,
    /// Length of one unit of the file, metres.
    pub metres_per_unit: f32,
    /// The axis of the file that points up: `y`, `-z` and so on.
    pub up: String,
    /// Probability of it, 0 to 1; 1 where the file or the settings state it.
    pub up_confidence: f32,
    /// The axis of the file that the face looks along: `+y`, `-z` and so on.
    pub facing: String,
    /// Probability of it, 0 to 1; 1 where the settings state it.
    pub facing_confidence: f32,
    /// Whether the unit was guessed.
    pub unit_guessed: bool,
    /// How sure the unit is, 0 to 1; 1 where the file or the settings state it.
    pub unit_confidence: f32,
    /// Counts of dropped strands, points and bytes by kind.
    pub dropped: BTreeMap<String, u64>,
    /// Remarks as sentences, including the reason for a guess.
    pub notes: Vec<String>,
}

/// Summarises `file` in the unit and axes of `settings`.
pub fn hair_info(file: &HairFile, settings: &ImportSettings) -> HairInfo {
    let orientation = Orientation::resolve(file, settings);
    let mut bounds_m = Bounds::EMPTY;
    for &point in &file.points {
        bounds_m.include(orientation.head_axes_from_file(point));
    }
    let mut notes = file.notes.clone();
    let guess = guess_units(file);
    notes.extend(file.note_on_up(settings));
    if orientation.unit_guessed {
        notes.push(guess.reason);
    }
    let unit = match settings.unit.metres() {
        Some(_) => settings.unit.id(),
        None => guess.unit.map_or("scaled", Unit::id),
    };
    HairInfo {
        format: file.format.clone(),
        strands: file.strands() as u64,
        points: file.points.len() as u64,
        segments: file.segments() as u64,
        bounds_m,
        unit: unit.to_owned(),
        metres_per_unit: orientation.metres_per_unit,
        up: orientation.up.id().to_owned(),
        up_confidence: if settings.up == UpAxis::Auto { guess.up_confidence } else { 1.0 },
        facing: orientation.facing.id().to_owned(),
        facing_confidence: orientation.facing_confidence,
        unit_guessed: orientation.unit_guessed,
        unit_confidence: if orientation.unit_guessed { guess.unit_confidence } else { 1.0 },
        dropped: file.dropped.clone(),
        notes,
    }
}
