//! What to compare.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_project::files::Access;
use lovelock_render::{Backend, Gpu, ShadowMethod, Transparency};

use super::sweep::Sweep;

/// What to compare; where a field is empty, the project says.
#[derive(Clone, Debug)]
pub struct CompareRequest {
    /// The folder for the report.
    pub out: PathBuf,
    /// What the report calls the project.
    pub name: String,
    /// Frames, half open: pictures, errors and times are of the first one, swim, pop and flicker of all.
    pub frames: Option<Range<u64>>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Shadow methods, in the order of the report; all where there are none.
    pub methods: Vec<ShadowMethod>,
    /// Transparency modes, each with every method.
    pub transparencies: Vec<Transparency>,
    /// What draws, each with every method. One that this machine has not is left out with a note, unless it is the only
    /// one.
    pub backends: Vec<Backend>,
    /// Settings that methods run through; a method without a setting of that name runs once.
    pub sweeps: Vec<Sweep>,
    /// Pixels whose hair is probed, from the upper left corner; some are chosen where there are none.
    pub probes: Vec<[u32; 2]>,
    /// Draws that a time is the median of, after a warm-up; at least one.
    pub draws: u32,
    /// What the project may read.
    pub access: Access,
    /// The device to draw on in place of what `backends` opens.
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
            transparencies: Vec::new(),
            backends: Vec::new(),
            sweeps: Vec::new(),
            probes: Vec::new(),
            draws: Self::LEAST_DRAWS,
            access: Access::default(),
            gpu: None,
        }
    }
}

impl CompareRequest {
    /// Fewer draws than this are no basis for a median with a spread.
    pub const LEAST_DRAWS: u32 = 30;
}
