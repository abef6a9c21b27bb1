//! The menu of the clip's lane: clip, trim, tempo and loop.

use egui::{Rect, RichText, Ui, UiBuilder};
use egui_material_icons::icons::ICON_EXPAND_MORE;
use lovelock_project::project::{MotionSection, MotionSource};

use super::{Edited, View};
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{popup, settings};
use crate::window::purpose::Purpose;
use crate::window::theme;

/// The name of the lane, which opens the menu. Returns a request beyond a change of the motion.
pub(super) fn menu(ui: &mut Ui, place: Rect, view: &View, edited: &mut Edited<'_>) -> Option<Command> {
    let mut request = None;
    let text = |text: &str| RichText::new(text).size(10.5).color(theme::quiet());
    let button = egui::Button::new((text("Clip"), text(ICON_EXPAND_MORE.codepoint))).frame(false);
    let middle = egui::Layout::left_to_right(egui::Align::Center);
    // A child of its own leaves the cursor of the panel below the lanes, where the tracks begin.
    let ui = &mut ui.new_child(UiBuilder::new().id_salt("clip").max_rect(place).layout(middle));
    ui.spacing_mut().button_padding = egui::vec2(2.0, 0.0);
    let response = ui.add(button);
    popup(&response, |ui| {
        ui.set_width(270.0);
        request = contents(ui, view, edited);
    });
    let response = response.hover_tooltip("Clip, trim, tempo and loop of the motion.");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Clip"));
    request
}

fn contents(ui: &mut Ui, view: &View, edited: &mut Edited<'_>) -> Option<Command> {
    let mut request = None;
    let d = MotionSection::default();
    let recording = &*edited.recording;
    let pointed = recording.first_frame > 0 || recording.end_frame.is_some();
    let motion = &mut *edited.motion;
    for clip in &view.clips {
        let plays = if motion.clip.is_empty() { &view.clip } else { &motion.clip };
        let on = motion.source == MotionSource::Clip && plays == clip;
        if ui.selectable_label(on, clip).clicked() {
            (motion.source, motion.clip) = (MotionSource::Clip, clip.clone());
            (motion.start_secs, motion.end_secs) = (d.start_secs, d.end_secs);
        }
    }
    if ui.selectable_label(motion.source == MotionSource::File, "Motion file…").clicked() {
        request = Some(Command::PickFile(Purpose::Motion));
        ui.close();
    }
    ui.separator();
    let trim = ui.add_enabled(pointed, egui::Button::new("Trim to in and out points"));
    if trim.hover_tooltip("Plays only the part between the brackets on the ruler.").clicked() {
        request = Some(Command::TrimToPoints);
        ui.close();
    }
    let trimmed = motion.start_secs > 0.0 || motion.end_secs.is_some();
    let whole = ui.add_enabled(trimmed, egui::Button::new("Whole clip"));
    if whole.hover_tooltip("Removes the trim.").clicked() {
        request = Some(Command::RemoveTrim);
        ui.close();
    }
    if trimmed {
        let end = motion.end_secs.map_or_else(|| "its end".to_owned(), |end| format!("{end:.2} s"));
        ui.label(RichText::new(format!("From {:.2} s to {end}", motion.start_secs)).color(theme::quiet()));
    }
    ui.separator();
    settings(ui, &["speed", "looping", "loop_blend_secs", "loop_blend"], motion, &d);
    request
}
