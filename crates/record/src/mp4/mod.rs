//! MP4 files (ISO/IEC 14496-12 and -15), as far as one track of images and one of sound need them.

mod boxes;
mod nal;
mod parse;
mod sound;
mod write;

pub(crate) use nal::{AvcConfig, append_sample};
pub(crate) use parse::{Movie, parse};
pub(crate) use sound::SoundTrack;
pub(crate) use write::{Mp4Writer, Tables, Track};

#[cfg(test)]
mod tests;
