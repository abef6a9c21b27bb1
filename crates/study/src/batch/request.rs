//! The request for a comparison.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_project::files::Access;
use lovelock_render::{Backend, Gpu, HairDrawing, ShadowMethod, Transparency};

use super::sweep::Sweep;

/// What to compare. Empty fields use the project's values.
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// The folder for the report.
    pub out: PathBuf,
    /// Name of the project in the report.
    pub name: String,
    /// Frames, half open. Images, errors and times are of the first one; swim, pop and flicker of all.
    pub frames: Option<Range<u64>>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Shadow methods in the order of the report; all if empty.
    pub methods: Vec<ShadowMethod>,
    /// What hair is drawn as, combined with every method.
    pub draws_as: Vec<HairDrawing>,
    /// Transparency modes, combined with every method.
    pub transparencies: Vec<Transparency>,
    /// Backends, combined with every method. An unavailable one is skipped with a note, unless it is the only one.
    pub backends: Vec<Backend>,
    /// Sweeps of settings; a method without a setting runs once.
    pub sweeps: Vec<Sweep>,
    /// Pixels to probe, from the upper left corner; chosen automatically if empty.
    pub probes: Vec<[u32; 2]>,
    /// Number of draws per time measurement, after a warm-up; at least one.
    pub draws: u32,
    /// Whether the tests of stability, swim and banding are left out: images, errors, times, memory and probes only, and pop and flicker
    /// of several frames.
    pub quick: bool,
    /// Whether several frames become films of panes and sequences of error maps.
    pub film: bool,
    /// The files that the project may read.
    pub access: Access,
    /// The device to render on instead of opening one for `backends`.
    pub gpu: Option<Arc<Gpu>>,
}

impl Default for CompareRequest {
    fn default() -> Self {
        Self {
            out: PathBuf::new(),
            name: "default project".to_owned(),
            frames: None,
            fps: None,
            size: None,
            methods: Vec::new(),
            draws_as: Vec::new(),
            transparencies: Vec::new(),
            backends: Vec::new(),
            sweeps: Vec::new(),
            probes: Vec::new(),
            draws: Self::DEFAULT_DRAWS,
            quick: false,
            film: false,
            access: Access::default(),
            gpu: None,
        }
    }
}

impl CompareRequest {
    /// Default number of draws. Medians and percentiles of fewer draws are rough, and the report says so.
    pub const DEFAULT_DRAWS: u32 = 30;
    /// Default number of draws of a quick comparison.
    pub const QUICK_DRAWS: u32 = 5;
}
