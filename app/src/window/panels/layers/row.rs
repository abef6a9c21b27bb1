//! The parts of one row of the list, each in its column.

use egui::{Align, Color32, Layout, Rect, Response, RichText, Ui, UiBuilder, Widget, pos2, vec2};
use egui_material_icons::icons::{ICON_DRAG_INDICATOR, ICON_VISIBILITY, ICON_VISIBILITY_OFF};

use crate::window::control::HoverTooltip;
use crate::window::control::{Limits, is_escaped};
use crate::window::theme;

/// Height of a row, and the margin around what is in it, points.
pub(super) const HEIGHT: f32 = 28.0;
const AIR: f32 = 2.0;
/// Side of a thumbnail, points.
pub(super) const PICTURE: f32 = 24.0;
/// How far the layers of a group are moved to the right, points.
const INDENT: f32 = 12.0;
const GRIP: f32 = 16.0;
const EYE: f32 = 22.0;
const WEIGHT: f32 = 48.0;
const SOLO: f32 = 22.0;

/// The columns of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    pub(super) grip: Rect,
    pub(super) eye: Rect,
    pub(super) picture: Rect,
    pub(super) name: Rect,
    pub(super) weight: Rect,
    pub(super) solo: Rect,
}

impl Columns {
    /// Those of a row; rows in groups begin further to the right, but weights stand below each other.
    pub(super) fn of(row: Rect, in_group: bool) -> Self {
        let (top, bottom) = (row.top() + AIR, row.bottom() - AIR);
        let column = |left: f32, width: f32| Rect::from_min_max(pos2(left, top), pos2(left + width, bottom));
        let left = row.left() + if in_group { INDENT } else { 0.0 };
        let grip = column(left, GRIP);
        let eye = column(grip.right(), EYE);
        let picture = Rect::from_center_size(
            pos2(eye.right() + 2.0 + 0.5 * PICTURE, row.center().y),
            vec2(PICTURE, PICTURE),
        );
        let solo = column(row.right() - SOLO - AIR, SOLO);
        let weight = column(solo.left() - WEIGHT - 3.0, WEIGHT);
        let name_left = picture.right() + 6.0;
        let name = column(name_left, (weight.left() - 4.0 - name_left).max(10.0));
        Self { grip, eye, picture, name, weight, solo }
    }
}

/// Puts a widget into a column.
fn put(ui: &mut Ui, rect: Rect, name: &str, widget: impl Widget) -> Response {
    let place = UiBuilder::new()
        .id_salt(name)
        .max_rect(rect)
        .layout(Layout::centered_and_justified(egui::Direction::TopDown));
    ui.new_child(place).add(widget)
}

/// The handle by which a row is dragged.
pub(super) fn grip(ui: &mut Ui, rect: Rect) -> Response {
    let icon = ICON_DRAG_INDICATOR.rich_text().color(theme::quiet());
    let grip = put(ui, rect, "grip", egui::Label::new(icon).sense(egui::Sense::drag()));
    grip.hover_tooltip("Drag to move the layer. Layers act from the top to the bottom.")
        .on_hover_cursor(egui::CursorIcon::Grab)
}

/// An eye that switches something, which screen readers call `name`.
pub(super) fn eye(ui: &mut Ui, rect: Rect, on: &mut bool, (name, tip): (&str, &str)) {
    let icon = if *on { ICON_VISIBILITY } else { ICON_VISIBILITY_OFF };
    let text = icon.rich_text().color(if *on { theme::bright() } else { theme::quiet() });
    let response = put(ui, rect, "eye", egui::Button::new(text).frame(false)).hover_tooltip(tip);
    if response.clicked() {
        *on = !*on;
    }
    let on = *on;
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, name));
}

/// The name of a row, in one line.
pub(super) fn name(ui: &mut Ui, rect: Rect, text: RichText) {
    let place = UiBuilder::new().id_salt("name").max_rect(rect).layout(Layout::left_to_right(Align::Center));
    ui.new_child(place).add(egui::Label::new(text).truncate().selectable(false));
}

/// The field in which a row is renamed. Returns the new name when it is entered, and whether the field is to close.
pub(super) fn rename(ui: &mut Ui, rect: Rect, text: &mut String, longest: usize) -> (Option<String>, bool) {
    let canceled = is_escaped(ui);
    let field = egui::TextEdit::singleline(text).char_limit(longest).desired_width(rect.width());
    let response = put(ui, rect, "rename", field.margin(vec2(3.0, 2.0)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "New name"));
    let first = response.id.with("shown");
    // The field takes the keys as soon as it is shown.
    let is_new = ui.data_mut(|data| !data.get_temp_mut_or_default::<bool>(first).to_owned());
    if is_new {
        response.request_focus();
        ui.data_mut(|data| data.insert_temp(first, true));
    }
    let ends = canceled || (response.lost_focus() && !is_new);
    if ends {
        ui.data_mut(|data| data.remove::<bool>(first));
    }
    let entered = (ends && !canceled).then(|| text.trim().to_owned());
    response.hover_tooltip("Enter renames, Escape cancels.");
    (entered, ends)
}

/// The weight of a row, marked where it is not 100 %. A double-click restores that.
pub(super) fn weight(ui: &mut Ui, rect: Rect, value: &mut f32, (name, tip): (&str, &str)) {
    let limits = Limits::of(ui, name, [0.0, 200.0], (" %", 0));
    let mut percent = *value * 100.0;
    let differs = (*value - 1.0).abs() > 1e-6;
    let drag = egui::DragValue::new(&mut percent)
        .range(0.0..=200.0)
        .clamp_existing_to_range(false)
        .suffix(" %")
        .max_decimals(0)
        .update_while_editing(false)
        .custom_parser(limits.parser());
    let place = UiBuilder::new().id_salt("weight").max_rect(rect);
    let mut child = ui.new_child(place);
    if differs {
        child.visuals_mut().override_text_color = Some(theme::accent());
    }
    let response = child.add_sized(rect.size(), drag);
    let changed = if differs { "\n\nChanged: double-click restores 100 %." } else { "" };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
    let twice = ui.input(|input| input.pointer.button_double_clicked(egui::PointerButton::Primary));
    if differs && twice && response.contains_pointer() {
        *value = 1.0;
    } else if response.changed() {
        *value = percent / 100.0;
    }
    response.hover_tooltip(format!("{tip}{changed}"));
}

/// The button that makes a row the only one that acts. Returns whether it was clicked.
pub(super) fn solo(ui: &mut Ui, rect: Rect, on: bool, tip: &str) -> bool {
    let text = RichText::new("S").color(if on { theme::accent() } else { theme::quiet() });
    put(ui, rect, "solo", egui::Button::selectable(on, text)).hover_tooltip(tip).clicked()
}

/// The picture of a mask.
pub(super) fn picture(ui: &Ui, rect: Rect, disk: egui::epaint::Mesh, masked: bool) {
    ui.painter().add(disk);
    // A rim, and a mark where the face is.
    let color = if masked { theme::quiet() } else { theme::line() };
    ui.painter().circle_stroke(rect.center(), 0.5 * PICTURE, egui::Stroke::new(1.0, color));
    let nose = rect.center_top() + vec2(0.0, 1.0);
    ui.painter().circle_filled(nose, 1.5, color);
}

/// The colour behind a row.
pub(super) fn background(ui: &Ui, selected: bool, also: bool, hovered: bool) -> Option<Color32> {
    let strong = ui.visuals().selection.bg_fill;
    match (selected, also, hovered) {
        (true, ..) => Some(strong.gamma_multiply(0.45)),
        (_, true, _) => Some(strong.gamma_multiply(0.25)),
        (.., true) => Some(theme::line().gamma_multiply(0.6)),
        _ => None,
    }
}
