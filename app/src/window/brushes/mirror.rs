//! What brushes do on the other side of the head, chosen by pictures.

use egui::{Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2};
use lovelock_base::settings::Choices as _;
use lovelock_brush::{BrushMirror, BrushSettings};

use crate::window::control::HoverTooltip;
use crate::window::control::{entry, revealed, row};
use crate::window::theme;

/// Size of a picture, points.
const SIZE: Vec2 = vec2(44.0, 38.0);
/// Points of a drawn lock.
const POINTS: u8 = 12;

/// What a choice does.
fn text(mirror: BrushMirror) -> &'static str {
    match mirror {
        BrushMirror::Off => "Off: changes only the hair under the brush.",
        BrushMirror::Own => {
            "Mirrored stroke: the same stroke on the other side. Hair there moves the same way and keeps its own shape."
        }
        BrushMirror::Same => "Mirrored hair: makes hair on the other side a mirror image of this side.",
    }
}

/// The row with the three choices.
pub(super) fn choose(ui: &mut Ui, settings: &mut BrushSettings, default: &BrushSettings) {
    let info = &entry::<BrushSettings>("mirror").info;
    let mirror = &mut settings.mirror;
    let differs = *mirror != default.mirror;
    let response = row(ui, info.label, info.text, differs, mirror, default.mirror, |ui, mirror| {
        let pictures = BrushMirror::ALL.iter().map(|choice| {
            let response = picture(ui, *choice, *mirror == *choice).hover_tooltip(text(*choice));
            if response.clicked() {
                *mirror = *choice;
            }
            response
        });
        pictures.reduce(|all, one| all | one).unwrap_or_else(|| ui.label(""))
    });
    revealed(ui, info, &response);
}

/// One choice: a head from behind with a lock on either side, the changed ones in colour.
fn picture(ui: &mut Ui, choice: BrushMirror, on: bool) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(SIZE, Sense::click());
    let (_, name) = choice.names();
    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, on, name));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let visuals = ui.style().interact_selectable(&response, on);
    let painter = ui.painter();
    painter.rect(rect, visuals.corner_radius, visuals.weak_bg_fill, visuals.bg_stroke, StrokeKind::Inside);
    let middle = pos2(rect.center().x, rect.top() + 12.0);
    painter.circle_stroke(middle, 7.0, Stroke::new(1.0, theme::quiet()));
    let axis = [middle + vec2(0.0, 10.0), middle + vec2(0.0, 22.0)];
    painter.add(egui::Shape::dashed_line(&axis, Stroke::new(1.0, theme::quiet()), 2.0, 2.0));
    // The left lock is brushed outward. The right one has waves of its own.
    let (plain, waves) = (0.0, 1.6);
    let right = match choice {
        BrushMirror::Off => (waves, false),
        BrushMirror::Own => (waves, true),
        BrushMirror::Same => (plain, true),
    };
    for (side, (wave, is_brushed)) in [(-1.0, (plain, true)), (1.0, right)] {
        let color = if is_brushed { theme::accent() } else { theme::quiet() };
        painter.line(lock(middle, side, wave, is_brushed), Stroke::new(1.5, color));
    }
    response.rect = Rect::from_min_size(rect.min, SIZE);
    response
}

/// The points of a lock that hangs at one side of a head.
fn lock(head: Pos2, side: f32, wave: f32, is_brushed: bool) -> Vec<Pos2> {
    (0..=POINTS)
        .map(|i| {
            let along = f32::from(i) / f32::from(POINTS);
            let outward = if is_brushed { 9.0 * along * along } else { 1.0 };
            let across = 7.0 + outward + wave * (along * 14.0).sin();
            head + vec2(side * across, 20.0 * along)
        })
        .collect()
}
