//! A picture behind the figure: a photograph, or a picture of measured light.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Cursor, Read as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader, Limits};

use super::error::Problem;
use super::picture::{self, Reducer};

/// Pixels along the longest side of the largest picture that is read.
pub const MAX_BACKDROP_SIDE: u32 = 16_384;
/// Pixels of the largest picture that is read.
pub const MAX_BACKDROP_PIXELS: u64 = 120_000_000;
/// Bytes of the largest PNG or JPEG file that is read.
const MAX_BYTES: u64 = 256 << 20;
/// Bytes that a decoder may allocate.
const MAX_DECODED_BYTES: u64 = 1 << 30;
/// Pixels along the longest side that are kept of a photograph, and of a picture of light; larger ones are averaged.
const KEPT_SIDE: [u32; 2] = [4096, 2560];

/// What a file must be.
const FORMATS: &str = "a PNG, JPEG, Radiance (.hdr) or OpenEXR (.exr) picture";

/// The pixels of a picture, row after row from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum BackdropPixels {
    /// Colours as a screen shows them: red, green, blue and opacity, sRGB-encoded.
    Display(Vec<[u8; 4]>),
    /// Radiance, linear with the primaries of Rec. 709.
    Light(Vec<[f32; 3]>),
}

/// A picture behind the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct BackdropPicture {
    size: [u32; 2],
    pixels: BackdropPixels,
}

/// Why a file could not be read as a picture behind the figure.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct BackdropError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: BackdropProblem,
}

/// What is wrong with a picture: what was found, and what it must be.
#[derive(Debug, thiserror::Error)]
pub enum BackdropProblem {
    /// The system does not give the file's content.
    #[error("cannot be read ({0}); must be {FORMATS}")]
    Io(#[from] std::io::Error),
    /// Of a picture of light.
    #[error(transparent)]
    Light(#[from] Problem),
    /// Neither of the formats.
    #[error("contains {0}; must be {FORMATS}")]
    Format(String),
    /// More bytes than the limit.
    #[error("has {0} bytes; must be at most {MAX_BYTES}")]
    TooManyBytes(u64),
    /// More pixels than the limit.
    #[error(
        "is {width} x {height} pixels; must be at most {MAX_BACKDROP_SIDE} on each side and {} million in all",
        MAX_BACKDROP_PIXELS / 1_000_000
    )]
    TooLarge {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The content contradicts its format.
    #[error("is damaged: {0}; must be {FORMATS}")]
    Damaged(String),
}

impl BackdropPicture {
    /// Reads a PNG, JPEG, Radiance or `OpenEXR` picture. The content decides which, not the name. Photographs are turned upright as their
    /// camera noted, and what is larger than the program can use is averaged.
    ///
    /// # Errors
    /// Names the file, what was found and what it must be, where the file is no such picture, is damaged, or exceeds
    /// [`MAX_BACKDROP_SIDE`] or [`MAX_BACKDROP_PIXELS`].
    pub fn load(path: &Path) -> Result<Self, BackdropError> {
        let read = picture::open(path).map_err(BackdropProblem::from).and_then(Self::read);
        read.map_err(|problem| BackdropError { path: path.to_owned(), problem })
    }

    fn read(mut content: BufReader<File>) -> Result<Self, BackdropProblem> {
        let start = content.fill_buf()?;
        let format = image::guess_format(start).ok();
        match format {
            Some(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => {
                let bytes = content.get_ref().metadata()?.len();
                if bytes > MAX_BYTES {
                    return Err(BackdropProblem::TooManyBytes(bytes));
                }
                let mut all = Vec::new();
                content.take(MAX_BYTES).read_to_end(&mut all)?;
                Self::decode(&all, format)
            }
            _ if start.starts_with(b"#?") || start.starts_with(&exr::meta::magic_number::BYTES) => {
                Ok(Self::of_light(&picture::read_onto(content, KEPT_SIDE[1])?))
            }
            _ => Err(BackdropProblem::Format(picture::describe(start))),
        }
    }

    /// Decodes a PNG or JPEG picture in memory.
    ///
    /// # Errors
    /// What is wrong with it, or that it is too large.
    pub fn decode(content: &[u8], format: ImageFormat) -> Result<Self, BackdropProblem> {
        // Files may come from anywhere, and assertions of a decoder may fail on damaged ones.
        catch_unwind(AssertUnwindSafe(|| Self::decode_image(content, format)))
            .unwrap_or_else(|_| Err(BackdropProblem::Damaged("pixels that cannot be decoded".to_owned())))
    }

    fn decode_image(content: &[u8], format: ImageFormat) -> Result<Self, BackdropProblem> {
        // Some decoders end their messages with a line break.
        let in_one_line = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let failed = |error: ImageError| BackdropProblem::Damaged(in_one_line(error.to_string()));
        let mut reader = ImageReader::with_format(Cursor::new(content), format);
        let mut limits = Limits::default();
        limits.max_alloc = Some(MAX_DECODED_BYTES);
        reader.limits(limits);
        let mut decoder = reader.into_decoder().map_err(failed)?;
        let (width, height) = decoder.dimensions();
        check_size(width, height)?;
        let orientation = decoder.orientation().map_err(failed)?;
        let mut image = DynamicImage::from_decoder(decoder).map_err(failed)?;
        if width.max(height) > KEPT_SIDE[0] {
            image = image.thumbnail(KEPT_SIDE[0], KEPT_SIDE[0]);
        }
        image.apply_orientation(orientation);
        let image = image.into_rgba8();
        let size = [image.width(), image.height()];
        let pixels = image.as_raw().as_chunks::<4>().0.to_vec();
        Ok(Self { size, pixels: BackdropPixels::Display(pixels) })
    }

    fn of_light(reducer: &Reducer) -> Self {
        let reduced = reducer.finish();
        let pixels = reduced.texels.iter().map(|texel| texel.as_vec3().to_array()).collect();
        let size = [reduced.width as u32, reduced.height as u32];
        Self { size, pixels: BackdropPixels::Light(pixels) }
    }

    /// The picture of `size` (width and height, pixels); `None` unless there are as many pixels, and at least one.
    pub fn from_pixels(size: [u32; 2], pixels: BackdropPixels) -> Option<Self> {
        let count = match &pixels {
            BackdropPixels::Display(pixels) => pixels.len(),
            BackdropPixels::Light(pixels) => pixels.len(),
        };
        let whole = u64::from(size[0]) * u64::from(size[1]);
        (whole > 0 && whole == count as u64).then_some(Self { size, pixels })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels.
    pub fn pixels(&self) -> &BackdropPixels {
        &self.pixels
    }

    /// Memory of the pixels, bytes.
    pub fn bytes(&self) -> u64 {
        match &self.pixels {
            BackdropPixels::Display(pixels) => size_of_val(pixels.as_slice()) as u64,
            BackdropPixels::Light(pixels) => size_of_val(pixels.as_slice()) as u64,
        }
    }
}

fn check_size(width: u32, height: u32) -> Result<(), BackdropProblem> {
    let pixels = u64::from(width) * u64::from(height);
    if width == 0 || height == 0 {
        return Err(BackdropProblem::Damaged("no pixels".to_owned()));
    }
    if width.max(height) > MAX_BACKDROP_SIDE || pixels > MAX_BACKDROP_PIXELS {
        return Err(BackdropProblem::TooLarge { width, height });
    }
    Ok(())
}
