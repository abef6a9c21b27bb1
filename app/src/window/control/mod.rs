//! The rows of a panel: a label, a control with its unit, a tooltip, and a mark where the value differs from its default.

mod curve;
mod dialog;
mod keying;
mod menu_key;
mod number;
mod plot_axis;
pub(crate) mod point;
mod popup;
mod reveal;
pub(crate) mod rows;
mod setting;
mod spoken;
mod stops;
mod tooltip;

use std::borrow::Cow;

use egui::{Id, PointerButton, Response, RichText, Sense, TextStyle, Ui, Vec2};

pub(crate) use curve::{Axis, Curve, CurveModel, curve};
pub(crate) use dialog::titled_dialog;
pub(crate) use keying::{
    Keying, begin as begin_keying, end as end_keying, enter_pane, leave_pane, of_setting,
};
pub(crate) use menu_key::MenuKey;
pub(crate) use number::{Limits, Number, is_escaped, typed};
pub(crate) use plot_axis::{axis_number, axis_of_short_numbers};
pub(crate) use popup::{close_all as close_popups, context_popup, is_any_open, popup};
pub(crate) use reveal::{
    end_pass as end_reveal, is_looking, reveal, section as revealed_section, shown as revealed,
};
pub(crate) use setting::{all_settings, any_setting, entry, setting, settings};
pub(crate) use spoken::{spoken_part, spoken_value};
pub(crate) use tooltip::{HoverTooltip, keep_free_area};

use super::theme;

/// Width of the column of labels, points.
const LABEL_WIDTH: f32 = 118.0;

/// Shows the user a message about a control, without moving the other controls.
fn say(ctx: &egui::Context, sentence: String) {
    ctx.data_mut(|data| {
        let said: &mut Vec<String> = data.get_temp_mut_or_default(said_key());
        if !said.contains(&sentence) {
            said.push(sentence);
        }
    });
}

fn said_key() -> Id {
    Id::unique("said by controls")
}

/// The messages of controls since the last call.
pub(crate) fn said(ctx: &egui::Context) -> Vec<String> {
    ctx.data_mut(|data| data.remove_temp(said_key())).unwrap_or_default()
}

/// The smallest text of a name, as a fraction of the usual.
const SMALLEST: f32 = 0.8;

/// A choice among a few.
pub(crate) fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &'static str,
    tip: &str,
    value: &mut T,
    default: T,
    options: &[(T, &str)],
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| {
        let chosen = options.iter().find(|(option, _)| option == value).map_or("", |(_, name)| name);
        let width = ui.available_width() - 4.0;
        egui::ComboBox::from_id_salt(label)
            .selected_text(chosen)
            .width(width)
            // Room for a dozen options without scrolling.
            .height(320.0)
            .truncate()
            .show_ui(ui, |ui| {
                for (option, name) in options {
                    ui.selectable_value(value, *option, *name);
                }
            })
            .response
    })
}

/// Something that is on or off.
pub(crate) fn toggle(
    ui: &mut Ui,
    label: &'static str,
    tip: &str,
    value: &mut bool,
    default: bool,
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| ui.checkbox(value, ""))
}

/// Controls that have no effect if there is a reason `why_not`: they are disabled then, and their tooltips give the reason.
pub(crate) fn unless<R>(ui: &mut Ui, why_not: Option<&str>, add: impl FnOnce(&mut Ui) -> R) -> R {
    let id = Id::unique("why not");
    if let Some(why_not) = why_not {
        ui.data_mut(|data| data.insert_temp(id, why_not.to_owned()));
    }
    let shown = ui.add_enabled_ui(why_not.is_none(), add).inner;
    ui.data_mut(|data| data.remove::<String>(id));
    shown
}

/// A colour, linear sRGB.
fn color(ui: &mut Ui, label: &'static str, tip: &str, value: &mut [f32; 3], default: [f32; 3]) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| {
        // The button converts the colour to hue and back, which rounds: only what the user picks is taken.
        let mut picked = *value;
        let response = ui.color_edit_button_rgb(&mut picked);
        if response.changed() {
            *value = picked;
        }
        response
    })
}

/// One row: the label with its mark, then the control of `add`, which is tied to the label for screen readers and tests.
pub(crate) fn row<T>(
    ui: &mut Ui,
    label: impl Into<Cow<'static, str>>,
    tip: &str,
    differs: bool,
    value: &mut T,
    default: T,
    add: impl FnOnce(&mut Ui, &mut T) -> Response,
) -> Response {
    let label = label.into();
    ui.horizontal(|ui| {
        // A longer name is written smaller, so that none is cut off.
        let shown = lovelock_glyphs::visual_words(&label);
        let plain = egui::WidgetText::from(&*shown);
        let galley = plain.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, TextStyle::Body);
        let size = TextStyle::Body.resolve(ui.style()).size;
        let fitting = size * (LABEL_WIDTH / galley.size().x.max(1.0)).clamp(SMALLEST, 1.0);
        let text = RichText::new(&*shown).size((2.0 * fitting).floor() / 2.0);
        let text = if differs { text.color(theme::accent()) } else { text };
        let size = Vec2::new(LABEL_WIDTH, ui.spacing().interact_size.y);
        let name = ui
            .allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.set_min_width(LABEL_WIDTH);
                // Not focusable: Tab goes from control to control.
                ui.add(egui::Label::new(text).sense(Sense::CLICK).truncate())
            })
            .inner;
        let tip = if differs {
            format!("{tip}\n\nChanged: double-click restores the default.")
        } else {
            tip.to_owned()
        };
        let why_not: Option<String> = ui.data(|data| data.get_temp(Id::unique("why not")));
        let tip = why_not.map_or(tip.clone(), |why_not| format!("{tip}\n\n{why_not}"));
        let mut response = add(ui, value).labelled_by(name.id);
        // An open tooltip stays while the pointer rests: a dialog that opens over it must close it.
        if ui.memory(|memory| memory.is_above_modal_layer(ui.layer_id())) {
            let whole = name.rect | response.rect;
            tooltip::beside(&response, whole, &tip);
            tooltip::beside(&name, whole, &tip);
        }
        // A slider's rail senses drags but no clicks, so its own response does not report a double-click.
        let twice = ui.input(|input| input.pointer.button_double_clicked(PointerButton::Primary));
        let twice = twice && ui.is_enabled() && (name.contains_pointer() || response.contains_pointer());
        let whole = (name.rect | response.rect).with_max_x(ui.max_rect().right());
        let fixed = match label {
            Cow::Borrowed(label) => Some(label),
            Cow::Owned(_) => None,
        };
        let reset = keying::row(ui, whole, &name, fixed, differs);
        if differs && (twice || reset) {
            *value = default;
            response.mark_changed();
        }
        response
    })
    .inner
}

/// The row with the button that restores all of `value`.
pub(crate) fn restore_all<T: Clone>(ui: &mut Ui, label: &'static str, tip: &str, value: &mut T, default: &T) {
    row(ui, label, tip, false, value, default.clone(), |ui, value| {
        let response = ui.button("Restore all");
        if response.clicked() {
            value.clone_from(default);
        }
        response
    });
}

/// A titled part of a panel that folds.
///
/// Returns what `add` returned if the part is unfolded.
pub(crate) fn section<R>(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    headed(ui, title, open, add).0
}

/// As [`section`]; also returns the header, which is not shown while a control is looked for.
fn headed<R>(
    ui: &mut Ui,
    title: &str,
    open: bool,
    add: impl FnOnce(&mut Ui) -> R,
) -> (Option<R>, Option<Response>) {
    let header = egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(open);
    let shown = match reveal::enter(ui.ctx(), title) {
        reveal::Section::Usual => {
            let unfolds = point::unfolds(ui.ctx(), title);
            let shown = header.open(unfolds.then_some(true)).show(ui, add);
            point::heading(title, &shown.header_response);
            Some(shown)
        }
        reveal::Section::Through => {
            ui.ctx().allow_widget_id_changes_in(egui::Rect::EVERYTHING);
            let shown = ui.push_id(title, add).inner;
            reveal::leave(ui.ctx());
            return (Some(shown), None);
        }
        reveal::Section::Unfolded => Some(header.open(Some(true)).show(ui, add)),
    };
    reveal::leave(ui.ctx());
    shown.map_or((None, None), |shown| (shown.body_returned, Some(shown.header_response)))
}

/// A titled part whose title stands elsewhere, such as on a window or a tab, so that it is always unfolded.
pub(crate) fn untitled_section<R>(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    reveal::enter(ui.ctx(), title);
    let shown = ui.push_id(title, add);
    point::heading(title, &shown.response);
    reveal::leave(ui.ctx());
    shown.inner
}

/// What [`section_with`] has shown.
pub(crate) struct Headed<R> {
    /// What the contents returned, if they are unfolded.
    pub(crate) inner: Option<R>,
    /// The header; `None` while a control is looked for.
    pub(crate) header: Option<Response>,
    /// Whether the mark of problems was clicked.
    pub(crate) is_mark_clicked: bool,
}

/// As [`section`], with a mark in the heading while there are `problems`. It takes no place from the controls: its tooltip says what is
/// wrong.
pub(crate) fn section_with<R>(
    ui: &mut Ui,
    title: &str,
    open: bool,
    problems: &[String],
    add: impl FnOnce(&mut Ui) -> R,
) -> Headed<R> {
    let (top, right, side) = (ui.cursor().top(), ui.max_rect().right(), ui.spacing().interact_size.y);
    let id = ui.make_persistent_id((title, "problems"));
    let (inner, header) = headed(ui, title, open, add);
    if problems.is_empty() {
        return Headed { inner, header, is_mark_clicked: false };
    }
    let rect = egui::Rect::from_min_size(egui::pos2(right - side, top), Vec2::splat(side));
    let said = problems.join("\n");
    let mark = ui.interact(rect, id, Sense::click());
    mark.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Problem: {said}")));
    let icon: &str = egui_material_icons::icons::ICON_ERROR.into();
    let font = egui::TextStyle::Button.resolve(ui.style());
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, icon, font, theme::wrong());
    Headed { inner, header, is_mark_clicked: mark.hover_tooltip(said).clicked() }
}

/// A line of quiet text.
pub(crate) fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text.into()).small().color(theme::quiet()));
}
