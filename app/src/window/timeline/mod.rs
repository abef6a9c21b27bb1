//! The dance's time: play, step, scrub, record; the clip, the take, in and out points and markers on one ruler.

mod clip;
mod lanes;
mod thumbnails;
mod tracks;
mod transport;
mod zoom;

pub(crate) use thumbnails::Thumbnails;
pub(crate) use zoom::Zoom;

use egui::Ui;
use lovelock_project::project::{Marker, MotionSection, RecordingSection};
use lovelock_project::tracks::Track;

use super::command::Command;

/// Frames a second that times are counted in: the steps of the simulation.
const FRAMES_PER_SEC: f64 = 1.0 / lovelock_session::clock::STEP_SECS;

/// Height of the panel without tracks, points.
pub(crate) const HEIGHT: f32 = 92.0 + thumbnails::HEIGHT;

/// Height of the panel with so many tracks, points; more of them scroll.
pub(crate) fn height(tracks: usize) -> f32 {
    HEIGHT + tracks::height(tracks)
}

/// What the timeline shows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {
    /// Where the dance is, seconds.
    pub(crate) time_secs: f64,
    /// How long it is, seconds.
    pub(crate) duration_secs: f64,
    /// Whether it plays.
    pub(crate) playing: bool,
    /// Whether it starts again at its end.
    pub(crate) looping: bool,
    /// Seconds of the dance a second.
    pub(crate) rate: f64,
    /// Name of the clip; empty where the body rests.
    pub(crate) clip: String,
    /// The body's own clips.
    pub(crate) clips: Vec<String>,
    /// The take that plays in place of the simulation.
    pub(crate) take: Option<Take>,
    /// Whether a take was recorded that can be played.
    pub(crate) can_play_take: bool,
    /// Seconds of the take that is being recorded, and of those that are on the disk.
    pub(crate) recording: Option<[f64; 2]>,
    /// Small pictures by their times.
    pub(crate) thumbs: Vec<(f64, egui::TextureId)>,
    /// Whether tracks are written, and which.
    pub(crate) writing: Writing,
}

/// Whether controls that are moved write tracks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Writing {
    /// Whether what is moved from now on is written.
    pub(crate) armed: bool,
    /// Targets of the tracks that are being written.
    pub(crate) targets: Vec<String>,
}

/// A take that plays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Take {
    /// The file's name.
    pub(crate) name: String,
    /// Whether it plays from its end to its start.
    pub(crate) backwards: bool,
}

/// What the timeline asks for beyond changes of the project.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ask {
    /// A command.
    Run(Command),
    /// To go to a time, seconds.
    Seek(f64),
    /// To play at another rate.
    Rate(f64),
    /// To dance what lies between the in and the out point.
    Trim,
    /// To dance the whole clip again.
    Untrim,
    /// A motion file in place of the clip.
    PickMotion,
}

/// The parts of the project that stand on the timeline.
pub(crate) struct Edited<'a> {
    /// In and out points are the frames of a recording.
    pub(crate) recording: &'a mut RecordingSection,
    /// Named times.
    pub(crate) markers: &'a mut Vec<Marker>,
    /// Numbers that follow the timeline.
    pub(crate) tracks: &'a mut Vec<Track>,
    /// Which clip is danced, and how.
    pub(crate) motion: &'a mut MotionSection,
}

/// The row of buttons, and the ruler with its lanes.
pub(crate) fn ui(ui: &mut Ui, view: &View, zoom: &mut Zoom, edited: &mut Edited<'_>) -> Option<Ask> {
    ui.spacing_mut().item_spacing.y = 2.0;
    let pressed = ui.horizontal(|ui| transport::ui(ui, view)).inner;
    let sought = lanes::ui(ui, view, zoom, edited);
    pressed.or(sought)
}
