//! Resolves the unit and axes of a file.

use glam::{Quat, Vec3};

use super::settings::ImportSettings;
use crate::StrandMarks;
use crate::io::{Bounds, Facing, HairFile, UpAxis, guess_facing, guess_units, rotation_to_head_axes};

/// The unit and axes of a file: as set, otherwise as guessed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Orientation {
    pub(crate) metres_per_unit: f32,
    pub(crate) unit_guessed: bool,
    /// Never `Auto`.
    pub(crate) up: UpAxis,
    /// An axis perpendicular to `up`.
    pub(crate) facing: Facing,
    /// Probability of it; 1 if it is set.
    pub(crate) facing_confidence: f32,
    rotation: Quat,
}

impl Orientation {
    pub(crate) fn resolve(file: &HairFile, settings: &ImportSettings) -> Self {
        let guess = guess_units(file);
        let up = if settings.up == UpAxis::Auto { guess.up } else { settings.up };
        let (facing, facing_confidence) =
            if settings.facing != Facing::Auto && settings.facing.is_square_to(up) {
                (settings.facing, 1.0)
            } else if up == guess.up {
                (guess.facing, guess.facing_confidence)
            } else {
                guess_facing(file, up)
            };
        Self {
            metres_per_unit: settings.unit.metres().unwrap_or(guess.metres_per_unit),
            unit_guessed: settings.unit.metres().is_none() && !file.is_in_metres,
            up,
            facing,
            facing_confidence,
            rotation: rotation_to_head_axes(up, facing),
        }
    }

    /// A point of the file in metres, Y up, the face toward +Z, about the file's own origin.
    pub(crate) fn head_axes_from_file(&self, point: Vec3) -> Vec3 {
        self.rotation * (point * self.metres_per_unit)
    }
}

impl HairFile {
    /// What a person should know about the up axis that is used with `settings`, as a sentence.
    pub fn note_on_up(&self, settings: &ImportSettings) -> Option<String> {
        if settings.up == UpAxis::Auto { guess_units(self).note_on_up() } else { None }
    }

    /// At most `most` of the strands, evenly spaced, without widths, colours and marks.
    pub fn some_strands(&self, most: usize) -> Self {
        let step = self.strands().div_ceil(most.max(1)).max(1);
        let (mut first_point, mut points, mut bounds) = (vec![0], Vec::new(), Bounds::EMPTY);
        for strand in (0..self.strands()).step_by(step) {
            points.extend_from_slice(self.strand(strand));
            first_point.push(points.len() as u32);
        }
        for &point in &points {
            bounds.include(point);
        }
        Self {
            name: self.name.clone(),
            format: self.format.clone(),
            first_point,
            points,
            bounds,
            thickness: None,
            transparency: None,
            colours: None,
            marks: StrandMarks::default(),
            dropped: self.dropped.clone(),
            notes: self.notes.clone(),
            ..*self
        }
    }

    /// The same strands in metres, Y up, the face toward +Z, by the unit and axes of `settings`, about the file's origin.
    pub fn in_metres(&self, settings: &ImportSettings) -> Self {
        let orientation = Orientation::resolve(self, settings);
        let mut file = self.clone();
        file.bounds = Bounds::EMPTY;
        for point in &mut file.points {
            *point = orientation.head_axes_from_file(*point);
            file.bounds.include(*point);
        }
        let scale = orientation.metres_per_unit;
        file.thickness.iter_mut().flatten().for_each(|width| *width *= scale);
        file.default_thickness = file.default_thickness.map(|width| width * scale);
        file.is_in_metres = true;
        file
    }
}
