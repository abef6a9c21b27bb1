//! What is behind the figure, colours or a picture, and the picture that lies over the image.

use egui::{Label, Sense, Ui};
use lovelock_project::Project;
use lovelock_project::project::ReferenceSection;
use lovelock_render::{BackgroundForm, PictureSettings};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{row, setting, settings};
use crate::window::purpose::Purpose;

const PICTURE: [&str; 4] = ["background_fit", "background_stops", "background_blur", "background_top"];

/// The controls of the project's background.
pub(super) fn ui(ui: &mut Ui, project: &mut Project) -> Option<Command> {
    let default = PictureSettings::default();
    setting(ui, "background", &mut project.picture, &default);
    let mut request = None;
    let picture = &mut project.picture;
    match picture.background {
        BackgroundForm::Plain => drop(setting(ui, "background_top", picture, &default)),
        BackgroundForm::Picture => {
            request = file(ui, project);
            settings(ui, &PICTURE, &mut project.picture, &default);
        }
        BackgroundForm::Studio | BackgroundForm::Vertical | BackgroundForm::Radial => {
            settings(ui, &["background_top", "background_bottom"], picture, &default);
        }
    }
    setting(ui, "ground", &mut project.picture, &default);
    request
}

/// The file of the picture.
fn file(ui: &mut Ui, project: &mut Project) -> Option<Command> {
    let mut request = None;
    let file = &mut project.surroundings.backdrop;
    let tip = "The picture behind the figure.";
    row(ui, "Background file", tip, file.is_some(), file, None, |ui, file| {
        let name = file.as_ref().and_then(|file| file.path.file_name());
        let name = name.map_or_else(|| "None: one colour".into(), |name| name.to_string_lossy());
        ui.add(Label::new(name).truncate().sense(Sense::CLICK))
    });
    ui.horizontal_wrapped(|ui| {
        let tip = "Shows a picture behind the figure: PNG, JPEG, Radiance (.hdr) or OpenEXR (.exr).";
        if ui.button("Background file…").hover_tooltip(tip).clicked() {
            request = Some(Command::PickFile(Purpose::Backdrop));
        }
        let tip = "Removes the picture behind the figure.";
        if file.is_some() && ui.button("Remove background").hover_tooltip(tip).clicked() {
            *file = None;
        }
    });
    request
}

/// The controls of the picture that lies over the image.
pub(super) fn reference(ui: &mut Ui, project: &mut Project) -> Option<Command> {
    let mut request = None;
    let reference = &mut project.reference;
    let tip = "A picture over the image, to compare with it. Films and saved images do not have it.";
    row(ui, "Reference file", tip, reference.file.is_some(), &mut reference.file, None, |ui, file| {
        let name = file.as_ref().and_then(|file| file.path.file_name());
        let name = name.map_or_else(|| "None".into(), |name| name.to_string_lossy());
        ui.add(Label::new(name).truncate().sense(Sense::CLICK))
    });
    ui.horizontal_wrapped(|ui| {
        let tip = "Lays a picture over the image: PNG, JPEG, Radiance (.hdr) or OpenEXR (.exr).";
        if ui.button("Reference file…").hover_tooltip(tip).clicked() {
            request = Some(Command::PickFile(Purpose::Reference));
        }
        let tip = "Removes the reference picture.";
        if reference.file.is_some() && ui.button("Remove reference").hover_tooltip(tip).clicked() {
            reference.file = None;
        }
    });
    if reference.file.is_some() {
        settings(ui, &["shown", "opacity", "fit", "flip"], reference, &ReferenceSection::default());
    }
    request
}
