//! What a recording is, and the one that runs.

use egui::{ProgressBar, RichText, Ui};
use lovelock_project::project::RecordingSection;
use lovelock_record::{FilmQuality, SequenceFormat};
use lovelock_session::clock::Pace;

use crate::window::control::{Number, choice, count, is_left, note, row, toggle, typed};
use crate::window::theme;

/// A recording that runs or has ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum State {
    /// None has been made.
    Idle,
    /// Frames done and frames in all, and seconds left where that can be said.
    Running {
        /// What is being done.
        what: String,
        /// Frames that are done.
        done: u64,
        /// Frames in all.
        total: u64,
        /// Seconds left, about.
        left_secs: Option<f64>,
    },
    /// The last one is finished: what was written.
    Done(String),
    /// The last one failed: why.
    Failed(String),
    /// The user stopped the last one.
    Cancelled,
}

impl State {
    /// How far the one that runs is, 0 to 1, and in words; none where none runs.
    pub(crate) fn progress(&self) -> Option<(f32, String)> {
        let Self::Running { what, done, total, left_secs } = self else { return None };
        let fraction = *done as f32 / (*total).max(1) as f32;
        // What has no parts to count is said in its own words.
        let count = if *total > 1 { format!(" {done} of {total}") } else { String::new() };
        let left = left_secs.map_or_else(String::new, |secs| format!(", {} left", Pace::in_words(secs)));
        Some((fraction, format!("{what}{count}{left}")))
    }
}

/// What the panel asks for beyond a change of the project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ask {
    /// Start recording to a place that a dialog picks: a film.
    Film,
    /// The same: a folder of pictures.
    Sequence,
    /// The same: an animated preview.
    Preview,
    /// Go on with a folder of pictures that a dialog picks.
    Resume,
    /// The same: curves for other programs.
    Curves,
    /// Stop the one that runs.
    Cancel,
}

const SIZES: [((u32, u32), &str); 6] = [
    ((640, 360), "640 × 360"),
    ((1280, 720), "1280 × 720"),
    ((1920, 1080), "1920 × 1080"),
    ((2560, 1440), "2560 × 1440"),
    ((3840, 2160), "3840 × 2160"),
    ((1080, 1080), "1080 × 1080"),
];

/// A field for the number of a frame. What a project holds beyond its range is shown, not changed.
fn frame_number(ui: &mut Ui, frame: &mut u64) -> egui::Response {
    let left = is_left(ui);
    let field = egui::DragValue::new(frame)
        .range(0..=1_000_000)
        .clamp_existing_to_range(false)
        .update_while_editing(false)
        .custom_parser(move |text| typed(text, "").filter(|_| !left));
    ui.add(field)
}

/// What is left of a recording that was stopped.
pub(crate) const CANCELLED: &str = "Cancelled: of a film nothing is left, of pictures those that are whole.";

/// What each picture is.
fn pictures(ui: &mut Ui, section: &mut RecordingSection, d: &RecordingSection) {
    let formats = SequenceFormat::ALL.map(|format| (format, format.label()));
    choice(
        ui,
        "Pictures as",
        "What the files of a folder are: PNG as the screen shows it, or EXR for a compositor: linear light with depth and the light that reaches the hair.",
        &mut section.format,
        d.format,
        &formats,
    );
    toggle(
        ui,
        "Clear behind",
        "Leaves background and ground out, so that pictures can be laid over others. A film has no alpha and is refused.",
        &mut section.transparent,
        d.transparent,
    );
    count(
        ui,
        "Motion blur",
        1..=RecordingSection::MOST_SUBFRAMES,
        "Pictures that a frame is the mean of while the shutter is open: 1 is none, 8 to 16 are smooth. A frame takes as many times as long.",
        &mut section.subframes,
        d.subframes,
    );
    Number::new(
        "Shutter",
        0.0..=360.0,
        "How long the shutter is open for motion blur: 360° is all of a frame.",
    )
    .unit("°", 1.0)
    .decimals(0)
    .show(ui, &mut section.shutter_degrees, d.shutter_degrees);
    toggle(
        ui,
        "Label",
        "Writes the shadow method, the transparency and the frame's number into each picture.",
        &mut section.label,
        d.label,
    );
}

/// The controls of `section`; `clip_frames` is the number of frames of the whole clip.
pub(crate) fn ui(
    ui: &mut Ui,
    section: &mut RecordingSection,
    state: &State,
    clip_frames: u64,
) -> Option<Ask> {
    let d = RecordingSection::default();
    let mut ask = None;
    let mut size = (section.width, section.height);
    let own = format!("{} × {}", size.0, size.1);
    let mut sizes = SIZES.to_vec();
    if SIZES.iter().all(|(known, _)| *known != size) {
        sizes.push((size, &own));
    }
    choice(ui, "Size", "Size of the film in pixels.", &mut size, (d.width, d.height), &sizes);
    (section.width, section.height) = size;
    let own = section.fps.to_string();
    let mut rates = vec![(24.0, "24"), (25.0, "25"), (30.0, "30"), (50.0, "50"), (60.0, "60")];
    if rates.iter().all(|(known, _)| *known != section.fps) {
        rates.push((section.fps, &own));
    }
    choice(ui, "Frames a second", "Rate of the film.", &mut section.fps, d.fps, &rates);
    let qualities = FilmQuality::ALL.map(|quality| (quality, quality.label()));
    choice(
        ui,
        "Quality",
        "How finely the film is coded: finer keeps single hairs apart and takes more bytes.",
        &mut section.quality,
        d.quality,
        &qualities,
    );
    row(
        ui,
        "From frame",
        "First frame.",
        section.first_frame != d.first_frame,
        &mut section.first_frame,
        d.first_frame,
        frame_number,
    );
    let end = &mut section.end_frame;
    row(
        ui,
        "To frame",
        "One past the last frame; the default is the whole clip.",
        end.is_some(),
        end,
        None,
        |ui, end| {
            let mut frame = end.unwrap_or(clip_frames);
            let response = frame_number(ui, &mut frame);
            if response.changed() {
                *end = Some(frame);
            }
            response
        },
    );
    pictures(ui, section, &d);
    // A range is never empty, whichever end was moved.
    if let Some(end) = &mut section.end_frame {
        *end = (*end).max(section.first_frame + 1);
    }
    toggle(
        ui,
        "Seamless loop",
        "Lets the hair at the end go over into the hair at the start: a film of one round of a looping dance then goes round without a jump.",
        &mut section.seamless,
        d.seamless,
    );
    if let Some((fraction, text)) = state.progress() {
        ui.add(ProgressBar::new(fraction).text(text).corner_radius(4));
        if ui.button("Cancel").on_hover_text("Stops the recording; an unfinished film is removed.").clicked()
        {
            ask = Some(Ask::Cancel);
        }
    } else {
        ui.horizontal(|ui| {
            let dot = RichText::new("Record film…").color(theme::RECORDING);
            if ui.button(dot).on_hover_text("Records the dance as H.264 in MP4 (Ctrl+R).").clicked() {
                ask = Some(Ask::Film);
            }
            let tip = "Records the dance as a folder of PNG or EXR files.";
            if ui.button("Pictures…").on_hover_text(tip).clicked() {
                ask = Some(Ask::Sequence);
            }
            let curves =
                "Writes the hair as curves that move, with the body, for other programs: USD or glTF.";
            if ui.button("Curves…").on_hover_text(curves).clicked() {
                ask = Some(Ask::Curves);
            }
        });
        ui.horizontal(|ui| {
            let tip = "Records the dance as an animated PNG, for a page or a message.";
            if ui.button("Preview…").on_hover_text(tip).clicked() {
                ask = Some(Ask::Preview);
            }
            let tip = "Goes on with a folder of pictures whose recording was stopped: whole frames stay.";
            if ui.button("Go on…").on_hover_text(tip).clicked() {
                ask = Some(Ask::Resume);
            }
        });
    }
    match state {
        State::Done(what) => note(ui, what.as_str()),
        State::Failed(why) => {
            ui.label(RichText::new(why).color(theme::WRONG));
        }
        State::Cancelled => note(ui, CANCELLED),
        State::Idle | State::Running { .. } => {}
    }
    ask
}
