//! The header of a take: the scene that it was recorded from.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use lovelock_groom::Hairstyle;
use serde::{Deserialize, Serialize, Serializer};
use xxhash_rust::xxh3::Xxh3;

use super::TAKE_VERSION;
use super::layout::Layout;
use crate::FrameRate;

/// The longest project text in bytes. A project has some kilobytes.
pub const MAX_PROJECT_BYTES: usize = 4 << 20;

/// The header of a take.
///
/// Use `..TakeHeader::default()` for the fields that you do not set, so that new fields do not break your code.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TakeHeader {
    /// Version of the format; [`super::TakeWriter::create`] sets it to [`TAKE_VERSION`].
    pub version: u32,
    /// The program that recorded it and its version, such as `lovelock 0.1.0`.
    pub program: String,
    /// Frames per second: frame `n` is `n / rate` seconds after the start of the take.
    #[serde(with = "Rate")]
    pub frames_per_second: FrameRate,
    /// Number of guide strands at the start of the take, 1 or more. Later frames may have another number
    /// ([`super::TakeWriter::set_layout`]).
    pub guides: u32,
    /// Points per guide at the start of the take, 2 or more.
    pub points_per_guide: u32,
    /// Number of rendered strands of the hairstyle at the start.
    pub strands: u32,
    /// [`hairstyle_fingerprint`] of that hairstyle.
    pub hairstyle: u64,
    /// The text of the project at frame 0, which this crate does not interpret. [`super::TakeWriter::change`] records later states.
    pub project: String,
    /// The files that the scene was made from.
    pub assets: Vec<TakeAsset>,
    /// The seed that the hairstyle was grown from.
    pub seed: u64,
    /// Name of the clip; empty if the body was at rest.
    pub clip: String,
    /// Duration of the clip in seconds; 0 if the body was at rest.
    pub clip_secs: f64,
    /// Time of the scene at frame 0, in seconds.
    pub start_secs: f64,
}

impl Default for TakeHeader {
    fn default() -> Self {
        Self {
            version: TAKE_VERSION,
            program: String::new(),
            frames_per_second: FrameRate { num: 60, den: 1 },
            guides: 0,
            points_per_guide: 0,
            strands: 0,
            hairstyle: 0,
            project: String::new(),
            assets: Vec::new(),
            seed: 0,
            clip: String::new(),
            clip_secs: 0.0,
            start_secs: 0.0,
        }
    }
}

impl TakeHeader {
    /// The layout of the first frames.
    pub(super) fn layout(&self) -> Result<Layout, (String, String)> {
        Layout::new(self.guides, self.points_per_guide)
    }

    /// Seconds from the start of the take to frame `frame`.
    pub fn secs_of(&self, frame: u64) -> f64 {
        frame as f64 * f64::from(self.frames_per_second.den) / f64::from(self.frames_per_second.num)
    }

    /// Checks the values. An error is what was found and what is valid.
    pub(super) fn check(&self) -> Result<(), (String, String)> {
        let wrong = |found: String, wanted: &str| Err((found, wanted.to_owned()));
        let FrameRate { num, den } = self.frames_per_second;
        if num == 0 || den == 0 || !(1.0..=240.0).contains(&self.frames_per_second.as_f64()) {
            return wrong(format!("{num}/{den} frames per second"), "1 to 240");
        }
        self.layout()?;
        if self.project.len() > MAX_PROJECT_BYTES {
            return wrong(
                format!("a project of {} bytes", self.project.len()),
                &format!("at most {MAX_PROJECT_BYTES} bytes"),
            );
        }
        if !(self.clip_secs.is_finite() && self.clip_secs >= 0.0 && self.start_secs.is_finite()) {
            return wrong(
                format!("a clip of {} s, started at {} s", self.clip_secs, self.start_secs),
                "finite times",
            );
        }
        Ok(())
    }
}

/// The fields of [`FrameRate`] in the file.
#[derive(Serialize, Deserialize)]
#[serde(remote = "FrameRate")]
struct Rate {
    num: u32,
    den: u32,
}

/// A file that a take was recorded from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TakeAsset {
    /// Its role in the scene: `hair`, `body` or `motion`.
    pub role: String,
    /// The file. A name that is not UTF-8 is stored with replacement characters, so that the file is not found later.
    #[serde(serialize_with = "as_text")]
    pub path: PathBuf,
    /// XXH3-64 of its bytes, seed 0.
    pub checksum: u64,
    /// Its length in bytes.
    pub bytes: u64,
}

fn as_text<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

/// The state of the file of a [`TakeAsset`].
#[derive(Debug)]
pub enum AssetState {
    /// The file is the same as when the take was recorded.
    Same,
    /// The file has changed.
    Changed {
        /// Its length in bytes.
        bytes: u64,
        /// XXH3-64 of its bytes.
        checksum: u64,
    },
    /// The file cannot be read.
    Missing(io::Error),
}

impl TakeAsset {
    /// The asset for a file with its present contents. Reads the whole file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn of_file(role: impl Into<String>, path: impl Into<PathBuf>) -> io::Result<Self> {
        let path = path.into();
        let (checksum, bytes) = checksum_of(&path)?;
        Ok(Self { role: role.into(), path, checksum, bytes })
    }

    /// Compares the file with its recorded length and checksum.
    pub fn state(&self) -> AssetState {
        match checksum_of(&self.path) {
            Ok((checksum, bytes)) if (checksum, bytes) == (self.checksum, self.bytes) => AssetState::Same,
            Ok((checksum, bytes)) => AssetState::Changed { bytes, checksum },
            Err(error) => AssetState::Missing(error),
        }
    }
}

fn checksum_of(path: &Path) -> io::Result<(u64, u64)> {
    let mut file = File::open(path)?;
    let mut hash = Xxh3::new();
    let mut buffer = vec![0; 1 << 18];
    let mut bytes = 0;
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok((hash.digest(), bytes)),
            Ok(read) => {
                hash.update(&buffer[..read]);
                bytes += read as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// XXH3-64 of the guides at rest, the wisps and the number of strands of a hairstyle. If the value differs, the strands of the
/// hairstyle cannot follow recorded guides.
pub fn hairstyle_fingerprint(style: &Hairstyle) -> u64 {
    let mut hash = Xxh3::new();
    let mut add = |value: u64| hash.update(&value.to_le_bytes());
    add(style.guides.points_per_guide as u64);
    add(style.guides.x.len() as u64);
    for axis in [&style.guides.x, &style.guides.y, &style.guides.z] {
        for v in axis {
            add(u64::from(v.to_bits()));
        }
    }
    add(style.strands.count() as u64);
    add(style.wisps.len() as u64);
    for wisp in &style.wisps {
        for guide in wisp.guides {
            add(u64::from(guide));
        }
        add(u64::from(wisp.first_strand));
        add(u64::from(wisp.strand_count));
    }
    hash.digest()
}
