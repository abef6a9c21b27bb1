//! What to record, and how far it is.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_record::FilmQuality;
use lovelock_render::{Backend, Gpu, ShadowMethod, Transparency};

use crate::{Access, Problem, Sheet};

/// What to record; where a field is none, the project says.
#[derive(Clone, Debug, Default)]
pub struct RecordRequest {
    /// Where it goes: a name ending in `.mp4` is a film, a folder a PNG sequence.
    pub out: PathBuf,
    /// Frames, half open.
    pub frames: Option<Range<u64>>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Shadow method.
    pub shadow: Option<ShadowMethod>,
    /// Transparency mode.
    pub transparency: Option<Transparency>,
    /// How finely a film is coded.
    pub quality: Option<FilmQuality>,
    /// Whether the shadow method, the transparency and the frame's number are written into each picture.
    pub label: bool,
    /// Whether the end of the film goes over into its start, hair and all; the project may say so too.
    pub seamless: bool,
    /// Which curves an output of curves holds; by its format where none.
    pub curves: Option<super::CurveSource>,
    /// Whether an output of curves leaves the body out.
    pub no_body: bool,
    /// What draws; the project says where none.
    pub backend: Option<Backend>,
    /// What the project may read.
    pub access: Access,
    /// The device to draw on; one is opened where none.
    pub gpu: Option<Arc<Gpu>>,
    /// The project's panes beside each other in place of its picture.
    pub panes: Option<Sheet>,
}

/// How far a recording or a comparison is.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// Files are read and hair grows.
    Loading {
        /// What is being done.
        what: String,
    },
    /// The scene is loaded: what of it is missing.
    Loaded {
        /// What could not be loaded, and notes of the files.
        problems: Vec<Problem>,
    },
    /// The hair lives through the frames before the first one that is drawn.
    Simulating {
        /// Steps done.
        done: u64,
        /// Steps in all.
        total: u64,
    },
    /// A frame is done.
    Frame {
        /// Frames done.
        done: u64,
        /// Frames in all.
        total: u64,
    },
    /// Methods are compared.
    Comparing {
        /// What is being done.
        what: String,
        /// Parts done.
        done: u64,
        /// Parts in all.
        total: u64,
    },
    /// The file is made whole.
    Finishing,
}
