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

use egui::{CursorIcon, Id, Panel, Rect, Sense, Stroke, Ui};
use lovelock_project::project::{Marker, MotionSection, RecordingSection, SoundSection};
use lovelock_project::tracks::Track;
use lovelock_style::StyleStack;

use super::command::Command;
use super::control::HoverTooltip;
use super::soundtrack::Loaded;
use super::theme;

/// Height of the panel without tracks, points.
pub(crate) const HEIGHT: f32 = 92.0 + thumbnails::HEIGHT;

/// The largest part of the height of the window that the timeline takes.
const MAX_SHARE_OF_WINDOW: f32 = 0.6;

/// Height of the panel without tracks, points.
fn fixed_height(has_sound: bool) -> f32 {
    HEIGHT + if has_sound { sound::HEIGHT } else { 0.0 }
}

/// Shows the timeline at the bottom of the window. Its height follows the tracks up to a few of them, unless the user drags the
/// upper edge, which sets `tracks_height`, points; a double-click on the edge makes it follow again. Further tracks scroll.
pub(crate) fn panel(
    ui: &mut Ui,
    view: &View,
    (zoom, tracks_height): (&mut Zoom, &mut Option<f32>),
    edited: &mut Edited<'_>,
) -> Option<Command> {
    let fixed = fixed_height(view.sound.is_some());
    let most = MAX_SHARE_OF_WINDOW * ui.ctx().content_rect().height() - fixed;
    let rows = edited.tracks.len();
    let room = tracks::room(rows, *tracks_height, most);
    Panel::bottom("timeline")
        .exact_size(fixed + room)
        .resizable(false)
        .show(ui, |ui| {
            if rows > 0 {
                edge(ui, room, tracks_height);
            }
            self::ui(ui, view, zoom, edited)
        })
        .inner
}

/// The upper edge of the panel, which a drag moves; the tracks are `room` points high.
fn edge(ui: &Ui, room: f32, tracks_height: &mut Option<f32>) {
    const REACH: f32 = 3.0;
    let panel = ui.max_rect();
    let y = panel.top() - 1.0;
    let handle = Rect::from_x_y_ranges(panel.x_range(), y - REACH..=y + REACH);
    let response = ui.interact(handle, Id::unique("timeline edge"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, "Height of the timeline"));
    let response = response
        .on_hover_cursor(CursorIcon::ResizeVertical)
        .hover_tooltip("Drag to show more or fewer tracks. Double-click to fit their number.");
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        *tracks_height = Some(room + y - at.y);
    }
    if response.double_clicked() {
        *tracks_height = None;
    }
    if response.hovered() || response.dragged() {
        ui.painter().with_clip_rect(handle).hline(panel.x_range(), y, Stroke::new(2.0, theme::accent()));
    }
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
    /// The take that is being recorded.
    pub(crate) recording: Option<Recorded>,
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

/// What has been recorded of a take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Recorded {
    /// Time of the timeline at which the recording began, seconds.
    pub(crate) from_secs: f64,
    /// Recorded time, seconds.
    pub(crate) secs: f64,
    /// Time of it that is on the disk, seconds.
    pub(crate) kept_secs: f64,
}

/// The recording of tracks by moving controls.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Writing {
    /// Whether moved controls are recorded from now on.
    pub(crate) armed: bool,
    /// The name of the control that is recorded alone, if one is.
    pub(crate) only: Option<String>,
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

/// Frames per second of the film, in which the timeline counts.
fn fps(recording: &RecordingSection) -> f64 {
    if recording.fps > 0.0 { recording.fps } else { RecordingSection::default().fps }
}

/// The row of buttons, and the ruler with its lanes.
pub(crate) fn ui(ui: &mut Ui, view: &View, zoom: &mut Zoom, edited: &mut Edited<'_>) -> Option<Command> {
    ui.spacing_mut().item_spacing.y = 2.0;
    let pressed = ui.horizontal(|ui| transport::ui(ui, view, fps(edited.recording))).inner;
    let sought = lanes::ui(ui, view, zoom, edited);
    pressed.or(sought)
}
