//! Takes: files that hold a recorded simulation, from which pictures are made later as often as wanted.
//!
//! A take holds the guides of every frame, the project as it was and as it changed, and which files the scene was made
//! from. [`TakeWriter`] records one while the simulation runs, [`TakeReader`] plays it. `docs/file_formats.md` has the
//! layout byte by byte.
//!
//! - Chunks of a second or less, each readable by itself, are on the disk as soon as they are full: whatever happens to
//!   the program or the machine, all but the last second can be played.
//! - Positions are whole numbers of 0.05 mm about the head: no point is off by more than [`MOST_ERROR_M`].
//! - Hair may get other guides on the way: every chunk says how many its frames have, and nothing lies between two frames
//!   that differ in that.
//! - Every byte is under a checksum. Damage costs its own chunk and is told.

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
pub use error::TakeError;
pub use frame::TakeFrame;
pub use header::{AssetState, MOST_PROJECT_BYTES, TakeAsset, TakeHeader, hairstyle_fingerprint};
pub use interpolate::mix_guides;
pub use layout::{MOST_GUIDE_POINTS, TakeLayout};
pub use reader::TakeReader;
pub use writer::{TakeReport, TakeWriter};

/// The ending of takes, without the dot.
pub const TAKE_EXTENSION: &str = "take";

/// Version of the format that this program writes, and the newest that it reads.
pub const TAKE_VERSION: u32 = 2;

/// The most that a point of a played frame is off, metres, within 50 m of the world's origin: half a step of 0.05 mm
/// along each axis makes 0.0433 mm, and single precision adds less than 0.004 mm there.
pub const MOST_ERROR_M: f64 = 5e-5;

/// The most frames in one chunk.
const MOST_CHUNK_FRAMES: u32 = 60;

#[cfg(test)]
mod tests;
