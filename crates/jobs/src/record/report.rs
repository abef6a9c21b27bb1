//! What a recording was: the keys of `record --json`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lovelock_session::health::Gauge;
use lovelock_session::stats::StageTimes;
use serde::{Serialize, Serializer};

/// Medians over the frames of a recording, milliseconds.
pub type StageMedians = StageTimes;

/// What was recorded, as `record --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordReport {
    /// The film, or the folder.
    #[serde(serialize_with = "as_text")]
    pub out: PathBuf,
    /// Frames written.
    pub frames: u64,
    /// Those of them that were there already and were kept.
    pub frames_kept: u64,
    /// Number of the first one.
    pub first_frame: u64,
    /// Frames a second.
    pub fps: f64,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// `gpu` or `cpu`; `panes` for a film of panes, which have one each.
    pub backend: String,
    /// Name of the adapter that drew.
    pub adapter: String,
    /// Id of the shadow method.
    pub shadow: String,
    /// Id of the transparency mode.
    pub transparency: String,
    /// What was written: `mp4`, `apng`, `png` or `exr`.
    pub format: String,
    /// Whether there is nothing behind hair and body.
    pub transparent: bool,
    /// Pictures that each frame is the mean of.
    pub motion_blur: u32,
    /// How long the shutter was open for them, degrees of 360 a frame.
    pub shutter_degrees: f32,
    /// Strands drawn.
    pub strands: u64,
    /// Their segments.
    pub segments: u64,
    /// Median of the frames' whole times, milliseconds.
    pub frame_ms: f64,
    /// Medians of the stages, milliseconds.
    pub stage_ms: StageMedians,
    /// Medians of the passes of drawing, milliseconds, by their names; as far as what drew measures them. Of one picture, where
    /// a frame is the mean of several.
    pub passes_ms: BTreeMap<String, f64>,
    /// The most bytes that shadow maps held.
    pub shadow_bytes: u64,
    /// The most bytes that were held for the pixels, to put strands together in them.
    pub draw_bytes: u64,
    /// Largest relative change of a link's length in the frames.
    pub max_stretch: f32,
    /// Deepest point inside the body, metres.
    pub max_penetration_m: f32,
    /// Guides that were not finite and were put back.
    pub recovered_guides: u64,
    /// The gauges of the simulation with what to change where one is over its limits; none of a take.
    pub health: Vec<Gauge>,
    /// Fingerprint of the last simulated state: 16 hexadecimal digits; empty where a take was drawn.
    pub state_hash: String,
    /// Bytes written.
    pub bytes: u64,
    /// Steps of the simulation a frame; 0 where a take was drawn.
    pub steps_per_frame: u32,
    /// What could not be loaded and other things to know, in sentences.
    pub notes: Vec<String>,
}

fn as_text<S: Serializer>(path: &std::path::Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}
