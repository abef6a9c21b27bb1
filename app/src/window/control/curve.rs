//! The editor of a ramp: a small curve whose points are dragged.

use egui::{Color32, CursorIcon, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use lovelock_style::{Ramp, RampShape};

/// Height of the curve, points.
const HEIGHT: f32 = 72.0;
/// Radius of a handle, and how far from it the pointer takes hold of it, points.
const HANDLE: f32 = 4.0;
const GRASP: f32 = 10.0;
/// Segments with which the curve is drawn.
const SEGMENTS: usize = 96;

/// The editor of a ramp. Points are dragged; a double click adds one or removes the one under the pointer. Right click offers ramps that
/// are often needed.
pub(crate) fn curve(ui: &mut Ui, label: &str, tip: &str, ramp: &mut Ramp) {
    ui.label(label).on_hover_text(tip);
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width().max(80.0), HEIGHT), Sense::click_and_drag());
    let inner = rect.shrink(HANDLE + 1.0);
    let top = Ramp::RANGE[1];
    let to_screen = |[place, value]: [f32; 2]| {
        Pos2::new(inner.left() + place * inner.width(), inner.bottom() - value / top * inner.height())
    };
    let from_screen = |at: Pos2| {
        let place = ((at.x - inner.left()) / inner.width()).clamp(0.0, 1.0);
        [place, ((inner.bottom() - at.y) / inner.height()).clamp(0.0, 1.0) * top]
    };
    let nearest = |ramp: &Ramp, at: Pos2| {
        let distances = ramp.points.iter().map(|&point| to_screen(point).distance(at));
        distances.enumerate().filter(|(_, d)| *d < GRASP).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    };
    let held_id = response.id.with("held");
    // A drag starts some way from where the button went down.
    if response.drag_started()
        && let Some(at) = ui.input(|input| input.pointer.press_origin())
    {
        let held = nearest(ramp, at);
        ui.data_mut(|data| data.insert_temp(held_id, held));
    }
    if response.dragged()
        && let Some(Some(held)) = ui.data(|data| data.get_temp::<Option<usize>>(held_id))
        && let Some(at) = response.interact_pointer_pos()
        && held < ramp.points.len()
    {
        // A point stays between its neighbours.
        let low = held.checked_sub(1).map_or(0.0, |before| ramp.points[before][0] + 0.01);
        let high = ramp.points.get(held + 1).map_or(1.0, |after| after[0] - 0.01);
        let [place, value] = from_screen(at);
        ramp.points[held] = [place.clamp(low.min(high), high.max(low)), (value * 50.0).round() / 50.0];
    }
    if response.double_clicked()
        && let Some(at) = ui.input(|input| input.pointer.latest_pos())
    {
        match nearest(ramp, at) {
            Some(i) if ramp.points.len() > 1 => {
                ramp.points.remove(i);
            }
            _ => ramp.points.push(from_screen(at)),
        }
        *ramp = ramp.clamped();
    }
    response.context_menu(|ui| menu(ui, ramp));
    let tip = format!(
        "{tip}\nThe root is at the left, the tip at the right. Drag points; double-click adds or removes one; right click offers ramps."
    );
    let response = response.on_hover_text(tip).on_hover_cursor(CursorIcon::Crosshair);
    paint(ui, rect, inner, ramp, &to_screen);
    let described = format!("{label}: {:.2} at the root, {:.2} at the tip", ramp.at(0.0), ramp.at(1.0));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, &described));
}

fn menu(ui: &mut Ui, ramp: &mut Ramp) {
    for (name, preset) in Ramp::presets() {
        if ui.button(name).clicked() {
            *ramp = preset;
            ui.close();
        }
    }
    ui.separator();
    for (shape, name) in
        [(RampShape::Smooth, "Smooth"), (RampShape::Linear, "Lines"), (RampShape::Steps, "Steps")]
    {
        if ui.radio(ramp.shape == shape, name).clicked() {
            ramp.shape = shape;
            ui.close();
        }
    }
}

fn paint(ui: &Ui, rect: Rect, inner: Rect, ramp: &Ramp, to_screen: &dyn Fn([f32; 2]) -> Pos2) {
    let visuals = ui.visuals();
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, visuals.extreme_bg_color);
    let faint = Stroke::new(1.0, visuals.weak_text_color().gamma_multiply(0.5));
    let one = to_screen([0.0, 1.0]).y;
    painter.hline(inner.x_range(), one, faint);
    let points: Vec<Pos2> = (0..=SEGMENTS)
        .map(|i| i as f32 / SEGMENTS as f32)
        .map(|place| to_screen([place, ramp.at(place)]))
        .collect();
    painter.line(points, Stroke::new(1.5, visuals.selection.bg_fill));
    for &point in &ramp.points {
        painter.circle(
            to_screen(point),
            HANDLE,
            visuals.strong_text_color(),
            Stroke::new(1.0, Color32::BLACK),
        );
    }
}
