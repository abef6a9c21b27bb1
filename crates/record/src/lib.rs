//! Films, picture sequences, takes and curves, written beside their final name and renamed when whole.
//!
//! A picture comes in as 8-bit sRGB, four bytes a pixel (RGBA, row by row from the top), and goes out either as
//! an H.264 film in an MP4 file ([`FilmWriter`]) or as a folder of PNG files with a manifest
//! ([`SequenceWriter`], which writes EXR files of linear light and its layers as well), or as a small animated PNG ([`PreviewWriter`]). [`PictureSink`] is the one type over them; it picks
//! by the output's name.
//!
//! Three promises hold for every film and sequence:
//!
//! - Nothing unfinished ever carries the final name: a file grows as `NAME.partial` beside it and is renamed when it
//!   is whole. An error or a cancel removes it.
//! - Memory does not grow with the length: frames are encoded on a named thread behind a short bounded queue, so
//!   `push` waits when the encoder is behind.
//! - The same pictures give the same bytes: the encoder runs on one thread and no clock is read.
//!
//! A [`TakeWriter`] records the simulation itself, and a [`TakeReader`] plays it. A take grows as `NAME.part`, and what
//! is there is kept and can be played, whatever ends it.
//!
//! A [`CurveWriter`] hands the hair and the body on to other programs, as USD or glTF.
//!
//! [`read_film`] and [`FilmReader`] read a film back without any other program.

mod claim;
mod curves;
mod error;
mod film;
mod join;
mod manifest;
mod mp4;
mod partial;
mod preview;
mod rate;
mod reader;
mod sequence;
mod sink;
mod still;
mod take;
mod yuv;

pub use curves::{BodyFrame, CurveBody, CurveFormat, CurveFrame, CurveReport, CurveScene, CurveWriter};
pub use error::RecordError;
pub use film::{FilmQuality, FilmReport, FilmSettings, FilmWriter, MAX_FILM_SIDES};
pub use join::join_sequences;
pub use manifest::{MANIFEST_NAME, Manifest, ManifestFrame, read_manifest};
pub use preview::{MOST_PREVIEW_FRAMES, MOST_PREVIEW_SIDE, PreviewReport, PreviewSettings, PreviewWriter};
pub use rate::FrameRate;
pub use reader::{FilmInfo, FilmReader, read_film};
pub use sequence::{
    FrameLayers, SequenceFormat, SequenceReport, SequenceSettings, SequenceWriter, frame_name,
};
pub use sink::{OutputKind, PictureSink, SinkReport, SinkSettings};
pub use still::write_png;
pub use take::{
    AssetState, MOST_ERROR_M, MOST_GUIDE_POINTS, MOST_PROJECT_BYTES, TAKE_EXTENSION, TAKE_VERSION, TakeAsset,
    TakeCondition, TakeError, TakeFrame, TakeHeader, TakeLayout, TakeReader, TakeReport, TakeWriter,
    hairstyle_fingerprint, mix_guides,
};
