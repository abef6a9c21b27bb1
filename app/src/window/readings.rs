//! What the panels show besides the project: what is loaded, what is recorded, the frame and the image.

use std::sync::Arc;

use lovelock_appearance::environment::Panorama;
use lovelock_groom::Scalp;
use lovelock_motion::ColliderEdits;
use lovelock_project::error::Problem;
use lovelock_session::health::GaugeKind;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::stats::{PassHistory, StageHistory};

use super::pointer_tool::PointerTool;
use super::recorder::State;
use super::soundtrack::Loaded;

/// The hairstyle that is loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedHair {
    /// Wisps, strands and segments.
    pub(crate) counts: [usize; 3],
    /// Width, height and depth at rest, metres.
    pub(crate) size_m: [f32; 3],
    /// Notes of the loader: what was guessed and what was dropped.
    pub(crate) notes: Vec<String>,
}

/// The body that is loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedBody {
    /// Names of the clips.
    pub(crate) clips: Vec<String>,
    /// The name of the clip that plays; empty where none does.
    pub(crate) clip: String,
    /// Paths of the joints, such as `hips/spine/neck/head`.
    pub(crate) joints: Vec<String>,
    /// Path of the joint that carries the hair.
    pub(crate) head: String,
    /// Names of its expressions, otherwise of its morph targets.
    pub(crate) face: Vec<String>,
    /// Notes of the loaders.
    pub(crate) notes: Vec<String>,
}

/// The surroundings that are loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedSurroundings {
    /// The picture that gives light.
    pub(crate) picture: Option<Arc<Panorama>>,
    /// Notes of the loader.
    pub(crate) notes: Vec<String>,
}

/// A number with its name and its tooltip, for the statistics.
#[derive(Clone, Debug)]
pub(crate) struct Fact {
    /// The name.
    pub(crate) name: &'static str,
    /// What the number is.
    pub(crate) tip: &'static str,
    /// The number with its unit.
    pub(crate) value: String,
}

/// The pane of the comparison whose settings are in place of the project's.
#[derive(Clone, Debug)]
pub(crate) struct PaneReading {
    /// Its number, from 0.
    pub(crate) pane: usize,
    /// The panes on the screen.
    pub(crate) visible: Vec<usize>,
    /// Memory of its shadow maps if it is drawn, bytes, and the records that are read in a simpler way.
    pub(crate) maps: Option<(u64, u64)>,
}

/// What the panels show besides the project.
pub(crate) struct Readings<'a> {
    /// The tool that has the pointer in the image.
    pub(crate) tool: PointerTool,
    /// What could not be loaded as requested.
    pub(crate) problems: &'a [Problem],
    /// The hairstyle that is loaded.
    pub(crate) hair: &'a LoadedHair,
    /// The body that is loaded.
    pub(crate) body: &'a LoadedBody,
    /// The surroundings that are loaded.
    pub(crate) surroundings: &'a LoadedSurroundings,
    /// Notes on the curves that play.
    pub(crate) take_notes: &'a [String],
    /// The scalp of a head of the default size, if a scene is loaded.
    pub(crate) scalp: Option<&'a Scalp>,
    /// Whether the body has a surface on which hair can grow.
    pub(crate) has_skull: bool,
    /// The names of the colliders that were fitted to the body.
    pub(crate) colliders: Vec<&'a str>,
    /// Whether hair collides with the skin in place of a collider, by its place in the list.
    pub(crate) is_replaced: &'a dyn Fn(&ColliderEdits, usize) -> bool,
    /// The newest frame of the simulation.
    pub(crate) frame: Option<&'a FrameSnapshot>,
    /// Memory of the shadow maps of the single image, bytes, and the records that are read in a simpler way.
    pub(crate) maps: Option<(u64, u64)>,
    /// The times of the stages of the last images.
    pub(crate) stages: &'a StageHistory,
    /// The times of the passes of the last images.
    pub(crate) passes: &'a PassHistory,
    /// Numbers of the image and of the simulation, and what is kept in memory.
    pub(crate) facts: &'a dyn Fn() -> [Vec<Fact>; 2],
    /// The pane of the comparison that the panels edit.
    pub(crate) pane: Option<PaneReading>,
    /// The gauge whose place is marked in the image.
    pub(crate) marked_gauge: Option<GaugeKind>,
    /// The sound that was read.
    pub(crate) sound: Option<&'a Loaded>,
    /// Why no sound plays.
    pub(crate) sound_problem: Option<String>,
    /// The length of the dance, seconds.
    pub(crate) duration_secs: f64,
    /// The state of the newest recording.
    pub(crate) recording: &'a State,
    /// Frames of a film of the whole dance.
    pub(crate) film_frames: u64,
}
