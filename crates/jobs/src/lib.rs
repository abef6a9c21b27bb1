//! The work of the command line: recording, measuring, converting and describing files.
//!
//! - [`record`]: films, sequences of images, takes and curves.
//! - [`mod@bench`]: times of known scenes.
//! - [`farm`]: a recording as a job for many machines.
//! - [`convert`]: hair files from one format to another.
//! - [`info`]: what a file holds.
//! - [`mod@papers`]: the figures and tables of the implemented papers, on one page.
//! - [`presets`]: the list of hairstyles, contact sheets of them, and thumbnails.
//! - [`satf`]: the database of hair clusters as a file.
//! - [`reference`](mod@reference): scenes for a path tracer, beside our images of them.

pub mod bench;
pub mod convert;
pub mod examples;
pub mod farm;
pub mod info;
pub mod papers;
pub mod presets;
pub mod record;
pub mod reference;
pub mod satf;
pub mod strokes;
