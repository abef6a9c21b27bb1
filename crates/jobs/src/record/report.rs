//! The result of a recording: the keys of `record --json`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lovelock_session::health::Gauge;
use lovelock_session::stats::StageTimes;
use serde::{Serialize, Serializer};

/// Medians over the frames of a recording, milliseconds.
pub type StageMedians = StageTimes;

/// The result of a recording, as `record --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordReport {
    /// The film, or the folder.
    #[serde(serialize_with = "as_text")]
    pub out: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Number of frames kept from an earlier recording.
    pub frames_kept: u64,
    /// Number of the first one.
    pub first_frame: u64,
    /// Frames per second.
    pub fps: f64,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// `gpu` or `cpu`; `panes` for a film of panes, which have one each.
    pub backend: String,
    /// Name of the device that rendered.
    pub adapter: String,
    /// Id of the shadow method.
    pub shadow: String,
    /// What hair was drawn as: `strands`, `clusters` or `auto`.
    pub draw: String,
    /// Id of the transparency mode.
    pub transparency: String,
    /// Format: `mp4`, `apng`, `png` or `exr`.
    pub format: String,
    /// Whether it has a sound: in the film, or as `sound.wav` in the folder.
    pub sound: bool,
    /// Whether the background is transparent.
    pub transparent: bool,
    /// Samples per frame.
    pub motion_blur: u32,
    /// Places of the aperture per frame for depth of field, 1 if there is none.
    pub lens_samples: u32,
    /// Shutter angle, degrees of 360 per frame.
    pub shutter_degrees: f32,
    /// Number of rendered strands.
    pub strands: u64,
    /// Number of their segments.
    pub segments: u64,
    /// Median of the total time per frame, milliseconds.
    pub frame_ms: f64,
    /// Medians of the stages, milliseconds.
    pub stage_ms: StageMedians,
    /// Medians of the rendering passes by name, milliseconds, if the renderer measures them. With several samples per frame, those of
    /// one sample.
    pub passes_ms: BTreeMap<String, f64>,
    /// Peak bytes of shadow maps.
    pub shadow_bytes: u64,
    /// Peak bytes of pixel buffers for blending strands.
    pub draw_bytes: u64,
    /// Largest relative change of a link's length in the frames.
    pub max_stretch: f32,
    /// Deepest point inside the body, metres.
    pub max_penetration_m: f32,
    /// Number of guides that became non-finite and were reset.
    pub recovered_guides: u64,
    /// The gauges of the simulation with advice for those over their limits; none for a take.
    pub health: Vec<Gauge>,
    /// Hash of the last simulated state, 16 hexadecimal digits; empty for a take.
    pub state_hash: String,
    /// Bytes written.
    pub bytes: u64,
    /// Simulation steps per frame; 0 for a take.
    pub steps_per_frame: u32,
    /// Notes, such as parts that could not be loaded, as sentences.
    pub notes: Vec<String>,
}

fn as_text<S: Serializer>(path: &std::path::Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}
