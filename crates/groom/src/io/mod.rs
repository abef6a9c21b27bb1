//! Hair files: Cem Yuksel's `.hair`, AMD's TressFX `.tfx`, and curves of USD.
//!
//! A [`HairFile`] holds what a file says, in the file's own unit and axes, less what cannot be hair (see
//! [`HairFile::dropped`]). [`guess_units`] reads its size and orientation, and [`crate::import`] makes a
//! hairstyle of it.

mod bytes;
mod clean;
mod error;
mod guess;
mod info;
mod tressfx;
mod usd;
mod write;
mod yuksel;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use error::HairFileError;
pub use guess::{Facing, Unit, UnitGuess, UpAxis, guess_units};
pub(crate) use guess::{RootShape, fit_sphere, guess_facing, rotation_to_head_axes};
pub use info::{Bounds, HairInfo, hair_info};

/// The format that a hair file was read from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum HairFormat {
    /// Cem Yuksel's `.hair`.
    Yuksel,
    /// AMD TressFX 3.x `.tfx`, with its version.
    TressFx3(f32),
    /// AMD TressFX 4.x `.tfx`, with its version.
    TressFx4(f32),
    /// `BasisCurves` of a USD stage. It says its unit and axes: its points come in metres, Y up.
    Usd,
}

impl std::fmt::Display for HairFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Yuksel => write!(f, "Yuksel .hair"),
            Self::TressFx3(version) | Self::TressFx4(version) => write!(f, "TressFX .tfx {version:.1}"),
            Self::Usd => write!(f, "USD BasisCurves"),
        }
    }
}

/// The strands of a hair file, in the file's unit and axes, cleaned of what cannot be drawn.
///
/// Every strand has at least two points, no two consecutive points coincide, and every number is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct HairFile {
    /// What the file is called, for messages.
    pub name: String,
    /// What it was read as.
    pub format: HairFormat,
    /// Index of the first point of each strand, with the number of points at the end (strands + 1).
    pub first_point: Vec<u32>,
    /// Points of all strands, root first, file units and axes.
    pub points: Vec<Vec3>,
    /// Width of the hair at each point, file units, where the file says so for each point.
    pub thickness: Option<Vec<f32>>,
    /// Transparency of each point, 0 opaque to 1, where the file says so for each point.
    pub transparency: Option<Vec<f32>>,
    /// Colour of each point, as the file has it (display values, usually in 0..=1).
    pub colours: Option<Vec<[f32; 3]>>,
    /// Width of all hair, file units, where the file says so.
    pub default_thickness: Option<f32>,
    /// Transparency of all hair, where the file says so.
    pub default_transparency: Option<f32>,
    /// Colour of all hair, where the file says so.
    pub default_colour: Option<[f32; 3]>,
    /// The file marks both ends of its strands as held (TressFX); only roots are held here.
    pub both_ends_pinned: bool,
    /// How many of what were left out: strands, points, bytes. Empty where nothing was.
    pub dropped: BTreeMap<String, u64>,
    /// Remarks in sentences, for people.
    pub notes: Vec<String>,
    /// Smallest box of the points, file units and axes.
    pub bounds: Bounds,
}

impl HairFile {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.first_point.len() - 1
    }

    /// Number of segments of all strands.
    pub fn segments(&self) -> usize {
        self.points.len() - self.strands()
    }

    /// The points of strand `strand`, root first, file units and axes.
    pub fn strand(&self, strand: usize) -> &[Vec3] {
        &self.points[self.first_point[strand] as usize..self.first_point[strand + 1] as usize]
    }

    /// The roots of all strands, file units and axes.
    pub fn roots(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.first_point[..self.strands()].iter().map(|&first| self.points[first as usize])
    }
}

/// Reads a hair file, by its content: the extension plays no part.
///
/// # Errors
/// Where the file cannot be read, is of no known format, contradicts itself, ends early or holds no strand
/// that could be drawn. Nothing is allocated before the counts in it agree with its size.
pub fn load_hair(path: &Path) -> Result<HairFile, HairFileError> {
    let name = path.display().to_string();
    let io_error = |source| HairFileError::Io { name: name.clone(), source };
    let mut file = File::open(path).map_err(io_error)?;
    // Look at the start before reading the rest, so that a film dropped by mistake is refused at once.
    let mut data = Vec::new();
    file.by_ref().take(bytes::LONGEST_HEADER).read_to_end(&mut data).map_err(io_error)?;
    if is_crate(&data) {
        return clean::clean(&name, usd::read_crate_file(&name, file)?);
    }
    format_of(&name, &data)?;
    file.read_to_end(&mut data).map_err(io_error)?;
    load_hair_bytes(&name, &data)
}

/// Reads a hair file that is in memory; `name` is used in messages alone.
///
/// # Errors
/// As [`load_hair`], except for reading.
pub fn load_hair_bytes(name: &str, data: &[u8]) -> Result<HairFile, HairFileError> {
    let raw = match format_of(name, data)? {
        HairFormat::Yuksel => yuksel::read(name, data)?,
        HairFormat::TressFx3(version) => tressfx::read_v3(name, data, version)?,
        HairFormat::TressFx4(version) => tressfx::read_v4(name, data, version)?,
        HairFormat::Usd if is_crate(data) => usd::read_crate(name, usd::Input::Memory(data))?,
        HairFormat::Usd => usd::read_text(name, data)?,
    };
    clean::clean(name, raw)
}

fn is_crate(data: &[u8]) -> bool {
    data.starts_with(usd::CRATE_MAGIC)
}

/// Tells the formats apart by their first bytes: `HAIR`, USD's names, or TressFX's version as a float.
fn format_of(name: &str, data: &[u8]) -> Result<HairFormat, HairFileError> {
    let refuse = |found: String| HairFileError::Malformed {
        name: name.to_owned(),
        offset: 0,
        found,
        wanted: "`HAIR` (Yuksel), `#usda` or `PXR-USDC` (USD), or a TressFX version from 3.0 to 4.9"
            .to_owned(),
    };
    let Some(start) = data.first_chunk::<4>() else {
        return Err(refuse(format!("a file of {} bytes", data.len())));
    };
    if start == b"HAIR" {
        return Ok(HairFormat::Yuksel);
    }
    if is_crate(data) || data.starts_with(usd::TEXT_MAGIC) {
        return Ok(HairFormat::Usd);
    }
    match f32::from_le_bytes(*start) {
        version if (3.0..4.0).contains(&version) => Ok(HairFormat::TressFx3(version)),
        version if (4.0..5.0).contains(&version) => Ok(HairFormat::TressFx4(version)),
        _ => Err(refuse(format!("`{}`", start.escape_ascii()))),
    }
}
