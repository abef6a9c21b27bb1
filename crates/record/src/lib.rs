//! Writes films, image sequences, takes and curves under a temporary name and renames them when they are complete.
//!
//! Images are 8-bit sRGB, four bytes per pixel (RGBA, row by row from the top). [`FilmWriter`] writes them as an H.264 film
//! in an MP4 file, [`SequenceWriter`] as a folder of PNG files with a manifest, and [`PreviewWriter`] as a small animated
//! PNG. [`SequenceWriter`] also writes EXR files of linear light with depth and transmittance. [`PictureSink`] wraps the
//! three and picks one by the output's name.
//!
//! Films and sequences have these properties:
//!
//! - An unfinished file never has the final name. It is written as `NAME.partial` in the same folder and renamed when it is
//!   complete. An error or a cancel removes it.
//! - Memory does not grow with the number of frames. Frames are encoded on a separate thread behind a short bounded queue;
//!   `push` waits while the queue is full.
//! - The same images give the same bytes: the encoder runs on one thread, and nothing depends on the clock.
//!
//! A film and a sequence may have a sound ([`SoundSource`]): Opus in the film, a WAV file in the folder.
//!
//! [`TakeWriter`] records the simulation itself, and [`TakeReader`] plays it back. A take is written as `NAME.part`; whatever
//! ends the recording, the frames written so far are kept and can be played.
//!
//! [`CurveWriter`] exports the hair and the body to other programs, as USD, glTF or Alembic.
//!
//! [`read_film`] and [`FilmReader`] read films back without any other program.

mod claim;
mod curves;
mod dither;
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
mod sound;
mod still;
mod take;
mod unfinished;
mod yuv;

pub use claim::{claim, is_still};
pub use curves::{BodyFrame, CurveBody, CurveFormat, CurveFrame, CurveReport, CurveScene, CurveWriter};
pub use error::RecordError;
pub use film::{FilmQuality, FilmReport, FilmSettings, FilmWriter, MAX_FILM_SIDES};
pub use join::join_sequences;
pub use manifest::{MANIFEST_NAME, Manifest, ManifestFrame, ManifestSound, read_manifest};
pub use preview::{MAX_PREVIEW_FRAMES, MAX_PREVIEW_SIDE, PreviewReport, PreviewSettings, PreviewWriter};
pub use rate::FrameRate;
pub use reader::{FilmInfo, FilmReader, read_film};
pub use sequence::{
    FrameLayers, SOUND_NAME, SequenceFormat, SequenceReport, SequenceSettings, SequenceWriter, frame_name,
};
pub use sink::{OutputKind, PictureSink, SinkReport, SinkSettings};
pub use sound::{SOUND_RATE, SoundSource};
pub use still::{IMAGE_MARK, jpeg_within, read_jpeg, write_png};
pub use take::{
    AssetState, CACHE_BYTES, MAX_ERROR_M, MAX_GUIDE_POINTS, MAX_PROJECT_BYTES, TAKE_EXTENSION, TAKE_VERSION,
    TakeAsset, TakeCondition, TakeError, TakeFrame, TakeHeader, TakeLayout, TakeReader, TakeReport,
    TakeWriter, hairstyle_fingerprint, mix_guides,
};
pub use unfinished::{
    Kept, UnfinishedKind, can_be_kept, discard_unfinished, has_left, has_older, is_unfinished,
    keep_unfinished, tidy_finished, unfinished_outs,
};
