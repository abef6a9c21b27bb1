//! The timeline: transport buttons, and a ruler with the clip, the take, in and out points, markers and tracks.

mod clip;
mod lanes;
mod scale;
mod sound;
mod thumbnails;
mod tracks;
mod transport;
mod zoom;

pub(crate) use thumbnails::Thumbnails;
pub(crate) use zoom::Zoom;

use std::sync::Arc;

use egui::Ui;
use lovelock_project::project::{Marker, MotionSection, RecordingSection, SoundSection};
use lovelock_project::tracks::Track;
use lovelock_style::StyleStack;

use super::command::Command;
use super::soundtrack::Loaded;

/// Frames per second in which times are counted: the steps of the simulation.
const FRAMES_PER_SEC: f64 = 1.0 / lovelock_session::clock::STEP_SECS;

/// Height of the panel without tracks, points.
pub(crate) const HEIGHT: f32 = 92.0 + thumbnails::HEIGHT;

/// Height of the panel with that number of tracks, points; more tracks scroll.
pub(crate) fn height(tracks: usize, has_sound: bool) -> f32 {
    HEIGHT + tracks::height(tracks) + if has_sound { sound::HEIGHT } else { 0.0 }
}

/// The state that the timeline shows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {
    /// The current time, seconds.
    pub(crate) time_secs: f64,
    /// The length of the dance, seconds.
    pub(crate) duration_secs: f64,
    /// Whether it plays.
    pub(crate) playing: bool,
    /// Whether it starts again at its end.
    pub(crate) looping: bool,
    /// Seconds of the dance per second.
    pub(crate) rate: f64,
    /// Name of the clip; empty if the body is at rest.
    pub(crate) clip: String,
    /// The clips of the character.
    pub(crate) clips: Vec<String>,
    /// The take that plays instead of the simulation.
    pub(crate) take: Option<Take>,
    /// Whether there is a recorded take to play.
    pub(crate) can_play_take: bool,
    /// Seconds of the take that is being recorded, and how many of them are on the disk.
    pub(crate) recording: Option<[f64; 2]>,
    /// Thumbnails by their times.
    pub(crate) thumbs: Vec<(f64, egui::TextureId)>,
    /// The recording of tracks.
    pub(crate) writing: Writing,
    /// The sound beside the dance.
    pub(crate) sound: Option<SoundLane>,
}

/// The sound beside the dance.
#[derive(Clone, Debug)]
pub(crate) struct SoundLane {
    /// The file's name.
    pub(crate) name: String,
    /// The sound; an empty one while it is read.
    pub(crate) loaded: Arc<Loaded>,
}

impl PartialEq for SoundLane {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.loaded, &other.loaded)
    }
}

/// The recording of tracks by moving controls.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Writing {
    /// Whether moved controls are recorded from now on.
    pub(crate) armed: bool,
    /// Targets of the tracks that are being recorded.
    pub(crate) targets: Vec<String>,
}

/// A take that plays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Take {
    /// The file's name.
    pub(crate) name: String,
    /// Whether it plays backwards.
    pub(crate) backwards: bool,
}

/// What the timeline requests beyond changes of the project.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimelineRequest {
    /// Run a command.
    Run(Command),
    /// Seek to a time, seconds.
    Seek(f64),
    /// Change the rate of playback.
    Rate(f64),
    /// Trim the clip to the in and out points.
    Trim,
    /// Remove the trim.
    Untrim,
    /// Pick a motion file.
    PickMotion,
}

/// The parts of the project that the timeline edits.
pub(crate) struct Edited<'a> {
    /// The frames of a recording, which are the in and out points.
    pub(crate) recording: &'a mut RecordingSection,
    /// Named times.
    pub(crate) markers: &'a mut Vec<Marker>,
    /// Animated values.
    pub(crate) tracks: &'a mut Vec<Track>,
    /// The motion.
    pub(crate) motion: &'a mut MotionSection,
    /// The sound.
    pub(crate) sound: &'a mut SoundSection,
    /// The layers of the hairstyle, which name their tracks.
    pub(crate) stack: &'a StyleStack,
}

/// The row of buttons, and the ruler with its lanes.
pub(crate) fn ui(
    ui: &mut Ui,
    view: &View,
    zoom: &mut Zoom,
    edited: &mut Edited<'_>,
) -> Option<TimelineRequest> {
    ui.spacing_mut().item_spacing.y = 2.0;
    let pressed = ui.horizontal(|ui| transport::ui(ui, view)).inner;
    let sought = lanes::ui(ui, view, zoom, edited);
    pressed.or(sought)
}
