//! Takes: files with a recorded simulation, which can be rendered later any number of times.
//!
//! A take contains the guides of every frame, the project and its changes, and the names of the files that the scene was made
//! from. [`TakeWriter`] records a take while the simulation runs, and [`TakeReader`] plays it. `docs/file_formats.md` describes
//! the layout byte by byte.
//!
//! - Frames are stored in chunks of a second or less. Each chunk is written to the disk as soon as it is full and can be read
//!   independently, so a crash costs at most the last second.
//! - Positions are stored in head space as multiples of 0.05 mm. The error of a point is at most [`MAX_ERROR_M`].
//! - The number of guides may change during a take. Every chunk contains the layout of its frames, and nothing is
//!   interpolated between frames with different layouts.
//! - Every byte is covered by a checksum. Damage is reported and affects only its own chunk.

mod bytes;
mod cache;
mod chunk;
mod codec;
mod condition;
mod disk;
mod error;
mod frame;
mod header;
mod index;
mod interpolate;
mod layout;
mod locate;
mod map;
mod predict;
mod probe;
mod quantise;
mod reader;
mod scan;
mod settings;
mod source;
mod worker;
mod writer;

pub use condition::TakeCondition;
pub(crate) use disk::{cut_takes, part_path};
pub use error::TakeError;
pub use frame::TakeFrame;
pub use header::{AssetState, MAX_PROJECT_BYTES, TakeAsset, TakeHeader, hairstyle_fingerprint};
pub use interpolate::mix_guides;
pub use layout::{MAX_GUIDE_POINTS, TakeLayout};
pub use reader::{CACHE_BYTES, TakeReader};
pub use writer::{TakeReport, TakeWriter};

/// The file extension of takes, without the dot.
pub const TAKE_EXTENSION: &str = "take";

/// Version of the format that this program writes. It is also the newest that it reads.
pub const TAKE_VERSION: u32 = 2;

/// The largest error of a point of a played frame, in metres, within 50 m of the world's origin. Half a step of 0.05 mm along
/// each axis gives 0.0433 mm, and single precision adds less than 0.004 mm there.
pub const MAX_ERROR_M: f64 = 5e-5;

/// The most frames in one chunk.
const MAX_CHUNK_FRAMES: u32 = 60;

#[cfg(test)]
mod tests;
