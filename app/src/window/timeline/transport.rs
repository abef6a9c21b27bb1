//! The row of buttons: play, step, rate, record.

use super::super::command::Command;
use egui::{RichText, Ui, Vec2};
use egui_material_icons::icons;

use super::{Recorded, View};
use crate::window::control::{HoverTooltip, point};
use crate::window::keymap::Keymap;
use crate::window::theme;

/// The rates on offer, with their labels.
const RATES: [(f64, &str); 6] =
    [(0.1, "1/10 ×"), (0.25, "1/4 ×"), (0.5, "1/2 ×"), (1.0, "1 ×"), (1.5, "1 1/2 ×"), (2.0, "2 ×")];

/// The longest name of the control that is recorded alone, characters.
const LONGEST_NAME: usize = 24;

pub(super) fn ui(ui: &mut Ui, view: &View, fps: f64) -> Option<Command> {
    let mut request = None;
    let play = if view.playing { icons::ICON_PAUSE } else { icons::ICON_PLAY_ARROW };
    for (icon, command) in [
        (icons::ICON_SKIP_PREVIOUS, Command::JumpToStart),
        (icons::ICON_CHEVRON_LEFT, Command::StepBack),
        (play, Command::PlayPause),
        (icons::ICON_CHEVRON_RIGHT, Command::StepForward),
        (icons::ICON_SKIP_NEXT, Command::JumpToEnd),
    ] {
        if button(ui, icon.into(), &command) {
            request = Some(command);
        }
    }
    if toggle(ui, view.looping, icons::ICON_REPEAT, &Command::ToggleLoop) {
        request = Some(Command::ToggleLoop);
    }
    if let Some(take) = &view.take
        && toggle(ui, take.backwards, icons::ICON_FAST_REWIND, &Command::PlayBackwards)
    {
        request = Some(Command::PlayBackwards);
    }
    if toggle(ui, view.writing.armed, icons::ICON_TIMELINE, &Command::WriteTracks) {
        request = Some(Command::WriteTracks);
    }
    if let Some(only) = &view.writing.only {
        let name: String = only.chars().take(LONGEST_NAME).collect();
        ui.label(RichText::new(name).small().color(theme::recording()))
            .hover_tooltip(format!("Recording only {only}. Press W to stop."));
    }
    request = rate(ui, view.rate).or(request);
    ui.monospace(format!("{:6.2} s", view.time_secs));
    ui.label(RichText::new(format!("frame {}", frame(view.time_secs, fps))).small().color(theme::quiet())).hover_tooltip(
        format!(
            "Frame of the film at {fps} per second, as counted by the Recording panel and the in and out points. An arrow \
             key moves by one step of the simulation, 1/60 s."
        ),
    );
    ui.add_space(12.0);
    match (&view.take, view.recording) {
        (Some(take), _) => {
            ui.label(RichText::new(format!("Take {}", take.name)).color(theme::accent()))
                .hover_tooltip("Body and hair move as recorded. Lights, look and camera can be changed.");
            if button(ui, icons::ICON_CLOSE.into(), &Command::LeaveTake) {
                request = Some(Command::LeaveTake);
            }
        }
        (None, recording) => {
            let running = recording.is_some();
            let icon = if running { icons::ICON_STOP } else { icons::ICON_FIBER_MANUAL_RECORD };
            if button(ui, RichText::from(icon).color(theme::recording()), &Command::RecordTake) {
                request = Some(Command::RecordTake);
            }
            if !running && view.can_play_take && button(ui, "Play the take".into(), &Command::PlayTake) {
                request = Some(Command::PlayTake);
            }
            if let Some(Recorded { secs, kept_secs, .. }) = recording {
                ui.label(RichText::new(format!("{secs:.1} s")).color(theme::recording()))
                    .hover_tooltip(format!("{kept_secs:.1} s of the take are already saved to disk."));
            }
        }
    }
    request
}

/// The number of the frame at a time, with a digit after the point between two frames.
fn frame(secs: f64, fps: f64) -> String {
    let frame = secs * fps;
    let whole = frame.round();
    if (frame - whole).abs() < 0.05 { format!("{whole:.0}") } else { format!("{frame:.1}") }
}

/// A button for a command, which screen readers announce by the command's name.
fn button(ui: &mut Ui, icon: RichText, command: &Command) -> bool {
    let tip = tip(ui, command);
    let response = ui.add(egui::Button::new(icon).min_size(Vec2::splat(24.0))).hover_tooltip(tip);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, label(command)));
    point::note_command(&response, command);
    response.clicked()
}

fn toggle(ui: &mut Ui, on: bool, icon: egui_material_icons::MaterialIcon, command: &Command) -> bool {
    let tip = tip(ui, command);
    let response = ui.selectable_label(on, icon).hover_tooltip(tip);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::CheckBox, true, label(command)));
    response.clicked()
}

fn label(command: &Command) -> &'static str {
    command.info().map_or("", |info| info.label)
}

fn tip(ui: &Ui, command: &Command) -> String {
    let Some(info) = command.info() else { return String::new() };
    let keymap = Keymap::of(ui.ctx());
    let keys = keymap.keys(info);
    if keys.is_empty() { info.tooltip.to_owned() } else { format!("{} ({})", info.tooltip, keys.join(", ")) }
}

fn rate(ui: &mut Ui, rate: f64) -> Option<Command> {
    let mut chosen = rate;
    let name = RATES.iter().find(|(value, _)| *value == rate).map_or("other", |(_, name)| *name);
    let response = egui::ComboBox::from_id_salt("rate").width(64.0).selected_text(name).show_ui(ui, |ui| {
        for (value, name) in RATES {
            ui.selectable_value(&mut chosen, value, name);
        }
    });
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Rate"));
    response
        .response
        .hover_tooltip("Speed of playback: seconds of the dance per second. Hair slows down with it.");
    (chosen != rate).then_some(Command::SetRate(chosen))
}

#[cfg(test)]
mod tests {
    use super::frame;

    #[test]
    fn frames_are_those_of_the_film() {
        assert_eq!(frame(2.0, 30.0), "60");
        assert_eq!(frame(2.0 + 1.0 / 60.0, 30.0), "60.5");
        assert_eq!(frame(2.0 + 1.0 / 60.0, 60.0), "121");
        assert_eq!(frame(0.0, 23.976), "0");
    }
}
