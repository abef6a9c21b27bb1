//! The sound of the dance.

use egui::{Label, RichText, Sense, Ui};
use lovelock_project::Project;
use lovelock_project::project::{Marker, SoundSection, TimelineSection};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{note, row, settings, unless};
use crate::window::panel::Panel;
use crate::window::purpose::Purpose;
use crate::window::readings::Readings;
use crate::window::soundtrack::Loaded;
use crate::window::theme;

/// The sound of the dance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SoundPanel;

impl Panel for SoundPanel {
    fn title(&self) -> &'static str {
        "Sound"
    }

    fn opens(&self, project: &Project, _readings: &Readings<'_>) -> bool {
        project.sound.file.is_some()
    }

    fn problems(&self, readings: &Readings<'_>) -> Vec<String> {
        readings.sound_problem.iter().cloned().collect()
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, project, readings.sound, readings.duration_secs)
    }
}

/// The controls of the project's sound.
fn controls(
    ui: &mut Ui,
    project: &mut Project,
    loaded: Option<&Loaded>,
    duration_secs: f64,
) -> Option<Command> {
    let mut request = None;
    let file = &mut project.sound.file;
    let tip = "The sound that plays with the dance and in films.";
    row(ui, "Sound", tip, file.is_some(), file, None, |ui, file| {
        let name = file.as_ref().and_then(|file| file.path.file_name());
        let name = name.map_or_else(|| "Silence".into(), |name| name.to_string_lossy());
        ui.add(Label::new(name).truncate().sense(Sense::CLICK))
    });
    ui.horizontal_wrapped(|ui| {
        let tip = "Adds a sound to the dance: WAV, MP3, Ogg Vorbis or FLAC.";
        if ui.button("Sound file…").hover_tooltip(tip).clicked() {
            request = Some(Command::PickFile(Purpose::Sound));
        }
        if file.is_some() && ui.button("Remove sound").hover_tooltip("Removes the sound.").clicked() {
            *file = None;
        }
    });
    if project.sound.file.is_none() {
        return request;
    }
    settings(ui, &["offset_secs", "gain", "muted"], &mut project.sound, &SoundSection::default());
    if let Some(loaded) = loaded {
        facts(ui, loaded);
        markers(ui, project, loaded, duration_secs);
    }
    request
}

/// What the file contains.
fn facts(ui: &mut Ui, loaded: &Loaded) {
    let secs = loaded.sound.secs();
    let tempo = match loaded.beats.tempo {
        Some(tempo) => format!("{tempo:.1} beats per minute"),
        None => "no regular beat".to_owned(),
    };
    let source = loaded.source.as_ref().map_or_else(String::new, |source| {
        let channels = match source.channels {
            1 => "mono".to_owned(),
            2 => "stereo".to_owned(),
            more => format!("{more} channels"),
        };
        format!("{}, {} Hz, {channels}, ", source.format, source.rate)
    });
    note(ui, format!("{source}{}:{:04.1}, {tempo}", (secs / 60.0) as u64, secs % 60.0));
    for text in loaded.source.iter().flat_map(|source| &source.notes) {
        ui.label(RichText::new(text).small().color(theme::watch()));
    }
}

/// The button that puts markers at the beats.
fn markers(ui: &mut Ui, project: &mut Project, loaded: &Loaded, duration_secs: f64) {
    let offset = project.sound.offset_secs;
    let times = loaded.beats.secs.iter().map(|beat| beat + offset);
    let times: Vec<f64> = times.filter(|secs| *secs >= 0.0 && *secs <= duration_secs).collect();
    let why_not = times.is_empty().then_some("No beat was found during the dance.");
    let clicked = unless(ui, why_not, |ui| {
        let tip = "Adds a marker at every beat of the dance, named by its number. Existing markers stay.";
        ui.button("Markers at the beats").hover_tooltip(tip).clicked()
    });
    if !clicked {
        return;
    }
    let markers = &mut project.timeline.markers;
    for (i, secs) in times.into_iter().enumerate() {
        let known = markers.iter().any(|marker| (marker.secs - secs).abs() < 1e-3);
        if !known && markers.len() < TimelineSection::MAX_MARKERS {
            markers.push(Marker { secs, name: format!("{}", i + 1) });
        }
    }
}
