//! The settings of recordings, and the recording that runs.

use egui::{ProgressBar, RichText, Ui};
use lovelock_project::Project;
use lovelock_project::project::RecordingSection;
use lovelock_record::FilmQuality;

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Limits, choice, entry, note, row, setting, settings};
use crate::window::panel::Panel;
use crate::window::purpose::Purpose;
use crate::window::readings::Readings;
use crate::window::recorder::{State, bytes_in_words};
use crate::window::theme;

const SIZES: [((u32, u32), &str); 6] = [
    ((640, 360), "640 × 360"),
    ((1280, 720), "1280 × 720"),
    ((1920, 1080), "1920 × 1080"),
    ((2560, 1440), "2560 × 1440"),
    ((3840, 2160), "3840 × 2160"),
    ((1080, 1080), "1080 × 1080"),
];

/// A field for the number of a frame. A value outside its range is shown and not changed.
fn frame_number(ui: &mut Ui, label: &str, frame: &mut u64) -> egui::Response {
    let limits = Limits::of(ui, label, [0.0, 1e6], ("", 0));
    let field = egui::DragValue::new(frame)
        .range(0..=1_000_000)
        .clamp_existing_to_range(false)
        .update_while_editing(false)
        .custom_parser(limits.parser());
    ui.add(field)
}

/// The size in pixels, out of the usual ones.
fn size(ui: &mut Ui, section: &mut RecordingSection, default: &RecordingSection) {
    let mut size = (section.width, section.height);
    let own = format!("{} × {}", size.0, size.1);
    let mut sizes = SIZES.to_vec();
    if SIZES.iter().all(|(known, _)| *known != size) {
        sizes.push((size, &own));
    }
    let tip = "Width and height of the recorded images in pixels.";
    choice(ui, "Size", tip, &mut size, (default.width, default.height), &sizes);
    (section.width, section.height) = size;
}

/// The frame rate, out of the usual ones.
fn frame_rate(ui: &mut Ui, section: &mut RecordingSection, default: &RecordingSection) {
    let info = &entry::<RecordingSection>("fps").info;
    let own = section.fps.to_string();
    let mut rates = vec![(24.0, "24"), (25.0, "25"), (30.0, "30"), (50.0, "50"), (60.0, "60")];
    if rates.iter().all(|(known, _)| *known != section.fps) {
        rates.push((section.fps, &own));
    }
    choice(ui, info.label, &info.tooltip(), &mut section.fps, default.fps, &rates);
}

/// First and last frame. The range is never empty, whichever end is moved.
fn frame_range(ui: &mut Ui, section: &mut RecordingSection, default: &RecordingSection, clip_frames: u64) {
    let info = &entry::<RecordingSection>("first_frame").info;
    let first = &mut section.first_frame;
    row(
        ui,
        info.label,
        &info.tooltip(),
        *first != default.first_frame,
        first,
        default.first_frame,
        |ui, frame| frame_number(ui, info.label, frame),
    );
    let info = &entry::<RecordingSection>("end_frame").info;
    let end = &mut section.end_frame;
    row(ui, info.label, &info.tooltip(), end.is_some(), end, None, |ui, end| {
        let mut frame = end.unwrap_or(clip_frames);
        let response = frame_number(ui, info.label, &mut frame);
        if response.changed() {
            *end = Some(frame);
        }
        response
    });
    if let Some(end) = &mut section.end_frame {
        *end = (*end).max(section.first_frame + 1);
    }
}

/// Bits per pixel of a film. Measured are 0.038, 0.073, 0.12 and 0.22: six frames of the default hair of 640 × 360 pixels.
fn bits_per_pixel(quality: FilmQuality) -> f64 {
    match quality {
        FilmQuality::Draft => 0.04,
        FilmQuality::Good => 0.07,
        FilmQuality::High => 0.12,
        FilmQuality::Best => 0.22,
    }
}

/// Describes the recording: its frames, its duration, and about how large a film of them is.
fn summary(section: &RecordingSection, clip_frames: u64) -> String {
    let frames = section.frame_range(clip_frames);
    let count = frames.end.saturating_sub(frames.start);
    let pixels = f64::from(section.width) * f64::from(section.height);
    let bytes = count as f64 * pixels * bits_per_pixel(section.quality) / 8.0;
    format!(
        "{count} frames, {} to {}, {:.2} s. A film takes about {}.",
        frames.start,
        frames.end.saturating_sub(1),
        count as f64 / section.fps.max(1e-3),
        bytes_in_words(bytes),
    )
}

/// What the button does that stops a recording.
pub(crate) const CANCEL: &str = "Stops the recording. Complete images in a folder are kept. An unfinished film is \
                                 discarded, and an existing film of that name is unchanged.";

/// The settings of recordings, and the recording that runs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RecordingPanel {
    /// Whether it is unfolded; only then the image shows what a film shows.
    pub(crate) unfolded: bool,
}

impl Panel for RecordingPanel {
    fn title(&self) -> &'static str {
        "Recording"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, project, readings.recording, readings.film_frames)
    }

    fn end_pass(&mut self, unfolded: bool) {
        self.unfolded = unfolded;
    }
}

/// The turntable, and the frames of one turn.
fn turntable(ui: &mut Ui, project: &mut Project) {
    super::camera::turntable(ui, &mut project.camera);
    if !project.camera.turntable {
        return;
    }
    let section = &mut project.recording;
    let turn = (f64::from(project.camera.turn_secs) * section.fps).round().max(1.0) as u64;
    let end = section.first_frame + turn;
    let tip = "Sets the last frame so that the film is one turn: played in a loop it goes on without a jump of the camera.";
    let button = ui.add_enabled(section.end_frame != Some(end), egui::Button::new("Record one turn"));
    if button.hover_tooltip(tip).disabled_hover_tooltip(tip).clicked() {
        section.end_frame = Some(end);
    }
}

/// The controls of `project`'s recordings; `clip_frames` is the number of frames of the whole clip.
fn controls(ui: &mut Ui, project: &mut Project, state: &State, clip_frames: u64) -> Option<Command> {
    turntable(ui, project);
    let section = &mut project.recording;
    let default = RecordingSection::default();
    let mut request = None;
    size(ui, section, &default);
    frame_rate(ui, section, &default);
    setting(ui, "quality", section, &default);
    frame_range(ui, section, &default, clip_frames);
    note(ui, summary(section, clip_frames));
    settings(
        ui,
        &["format", "transparent", "subframes", "shutter_degrees", "label", "seamless"],
        section,
        &default,
    );
    if let Some((fraction, text)) = state.progress() {
        ui.add(ProgressBar::new(fraction).text(text).corner_radius(4));
        if ui.button("Cancel").hover_tooltip(CANCEL).clicked() {
            request = Some(Command::Record);
        }
    } else {
        ui.horizontal(|ui| {
            let dot = RichText::new("Record film…").color(theme::recording());
            if ui.button(dot).hover_tooltip("Records the dance as H.264 in MP4 (Ctrl+R).").clicked() {
                request = Some(Command::PickFile(Purpose::Film));
            }
            let tip = "Records the dance as a folder of PNG or EXR files.";
            if ui.button("Images…").hover_tooltip(tip).clicked() {
                request = Some(Command::PickFile(Purpose::Sequence));
            }
            let curves =
                "Writes the hair as animated curves, with the body, for other programs: USD or glTF.";
            if ui.button("Curves…").hover_tooltip(curves).clicked() {
                request = Some(Command::PickFile(Purpose::Curves));
            }
        });
        ui.horizontal(|ui| {
            let tip = "Records the dance as an animated PNG for a web page or a message.";
            if ui.button("Preview…").hover_tooltip(tip).clicked() {
                request = Some(Command::PickFile(Purpose::Preview));
            }
            let tip = "Continues a folder of images whose recording was stopped. Complete frames are kept.";
            if ui.button("Resume…").hover_tooltip(tip).clicked() {
                request = Some(Command::PickFile(Purpose::Resume));
            }
        });
    }
    match state {
        State::Done { what, .. } | State::Cancelled(what) => note(ui, what.as_str()),
        State::Failed(why) => {
            ui.label(RichText::new(why).color(theme::wrong()));
        }
        State::Idle | State::Running { .. } => {}
    }
    request
}
