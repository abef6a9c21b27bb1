//! Describes a picture of the surroundings.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_appearance::environment::Panorama;
use lovelock_project::error::ProjectError;
use serde::Serialize;

/// Description of a picture of the surroundings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurroundingsInfo {
    /// `Radiance` or `OpenEXR`.
    pub format: String,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Mean radiance over all directions, linear sRGB.
    pub mean: [f32; 3],
    /// The light that stands out, if there is one.
    pub strongest: Option<StrongestInfo>,
    /// Always empty: a picture is read whole. Descriptions of other files count here what they leave out.
    pub dropped: BTreeMap<String, u64>,
    /// What was replaced or stretched.
    pub notes: Vec<String>,
}

/// The light that stands out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrongestInfo {
    /// Unit vector toward it.
    pub direction: [f32; 3],
    /// Its colour, with the largest component 1.
    pub colour: [f32; 3],
}

impl SurroundingsInfo {
    /// Reads the picture at `path`.
    ///
    /// # Errors
    /// If the file is no such picture, is damaged or too large.
    pub(super) fn of(path: &Path) -> Result<Self, ProjectError> {
        let picture = Panorama::load(path).map_err(|error| ProjectError::input(path, error))?;
        let [width, height] = picture.size();
        let mut start = [0; 2];
        let is_radiance = std::fs::File::open(path)
            .and_then(|mut file| std::io::Read::read_exact(&mut file, &mut start))
            .is_ok_and(|()| start == *b"#?");
        Ok(Self {
            format: if is_radiance { "Radiance" } else { "OpenEXR" }.to_owned(),
            width,
            height,
            mean: picture.surround().mean().to_array(),
            strongest: picture.strongest().map(|light| StrongestInfo {
                direction: light.direction.to_array(),
                colour: light.colour().to_array(),
            }),
            dropped: BTreeMap::new(),
            notes: picture.notes().messages(),
        })
    }
}
