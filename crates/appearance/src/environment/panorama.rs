//! A picture of the surroundings, reduced to what a frame reads.

use std::path::Path;

use glam::{DVec3, Vec3};

use super::axes::Axes;
use super::error::{EnvironmentError, Problem};
use super::picture::{self, Notes, Reduced, Reducer};
use super::project::project;
use super::strongest::Strongest;
use super::surround::Surround;

/// Size of the thumbnail, width and height.
const THUMBNAIL: [usize; 2] = [64, 32];

/// A picture of the surroundings, reduced to what a frame reads. The pixels themselves are not kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    size: [u32; 2],
    surround: Surround,
    axes: Axes,
    strongest: Option<Strongest>,
    thumbnail: Thumbnail,
    notes: Notes,
}

/// A small copy of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Thumbnail {
    /// Texels per row, at most 64, fewer where the picture is smaller.
    pub width: usize,
    /// Rows, at most 32.
    pub height: usize,
    /// Linear radiance, row by row from the top.
    pub texels: Vec<Vec3>,
}

impl Thumbnail {
    /// The texels times `exposure` as sRGB with full alpha, four bytes each; what exceeds 1 is clipped.
    pub fn rgba8(&self, exposure: f32) -> Vec<u8> {
        let encode = |linear: f32| {
            let linear = (exposure * linear).clamp(0.0, 1.0);
            let srgb =
                if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
            (255.0 * srgb + 0.5) as u8
        };
        self.texels.iter().flat_map(|t| [encode(t.x), encode(t.y), encode(t.z), 255]).collect()
    }
}

impl Panorama {
    /// Reads a Radiance (`.hdr`) or an `OpenEXR` picture (`.exr`). The content decides which, not the name.
    ///
    /// The pixels are averaged while they are read, so memory is bounded for any file. Values that no light has are
    /// replaced and counted in [`notes`](Self::notes).
    ///
    /// # Errors
    ///
    /// Names the file, what was found and what it must be, where the file is no such picture, is damaged, or
    /// exceeds [`MAX_WIDTH`](super::MAX_WIDTH), [`MAX_HEIGHT`](super::MAX_HEIGHT) or
    /// [`MAX_FILE_BYTES`](super::MAX_FILE_BYTES).
    pub fn load(path: &Path) -> Result<Self, EnvironmentError> {
        let read = picture::open(path).and_then(picture::read);
        read.map(|reducer| Self::new(&reducer))
            .map_err(|problem| EnvironmentError { path: path.to_owned(), problem })
    }

    /// The picture of `width` x `height` pixels of linear radiance, row by row from the top.
    ///
    /// # Errors
    ///
    /// As [`load`](Self::load), and where the number of pixels is another.
    pub fn from_pixels(width: usize, height: usize, pixels: &[Vec3]) -> Result<Self, Problem> {
        let mut reducer = Reducer::new(width as u64, height as u64)?;
        if pixels.len() != width * height {
            return Err(Problem::CutShort {
                found: format!("{} pixels", pixels.len()),
                wanted: format!("{} pixels", width * height),
            });
        }
        for (y, row) in pixels.chunks_exact(width).enumerate() {
            reducer.add(0, y, row.iter().map(Vec3::to_array));
        }
        Ok(Self::new(&reducer))
    }

    pub(super) fn new(reducer: &Reducer) -> Self {
        let reduced = reducer.finish();
        Self {
            size: reducer.size(),
            surround: project(&reduced).without_ringing(),
            axes: Axes::new(&reduced),
            strongest: Strongest::find(&reduced),
            thumbnail: thumbnail(&reduced),
            notes: reducer.notes(),
        }
    }

    /// Width and height of the picture as it was read, in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The light on surfaces, not turned.
    pub fn surround(&self) -> Surround {
        self.surround
    }

    /// As [`Environment::axis_radiance`](super::Environment::axis_radiance).
    pub fn axis_radiance(&self, turn: f32) -> [Vec3; 6] {
        self.axes.turned(turn)
    }

    /// The light that stands out, not turned; none where no direction does.
    pub fn strongest(&self) -> Option<Strongest> {
        self.strongest
    }

    /// A small copy of the picture, for the interface.
    pub fn thumbnail(&self) -> &Thumbnail {
        &self.thumbnail
    }

    /// What was replaced or stretched while reading.
    pub fn notes(&self) -> Notes {
        self.notes
    }
}

fn thumbnail(picture: &Reduced) -> Thumbnail {
    let mut reducer = Reducer::onto([picture.width, picture.height], THUMBNAIL);
    for (y, row) in picture.rows().enumerate() {
        reducer.add(0, y, row.iter().map(|texel: &DVec3| texel.as_vec3().to_array()));
    }
    let small = reducer.finish();
    let texels = small.texels.iter().map(|texel| texel.as_vec3()).collect();
    Thumbnail { width: small.width, height: small.height, texels }
}
