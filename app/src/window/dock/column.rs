//! A column of panels beside the image.

use egui::{Context, CursorIcon, DragAndDrop, Id, Rect, ScrollArea, Sense, Ui};

use super::held::Held;
use super::{Column, Move, menu};
use crate::window::control::context_popup;
use crate::window::shelf::{Shelf, Side};

/// The usual width of a column, points.
const WIDTH: f32 = 312.0;

fn reset_key() -> Id {
    Id::unique("pass that reset the widths of columns")
}

/// Gives the columns their usual width.
pub(crate) fn reset_widths(ctx: &Context) {
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| data.insert_temp(reset_key(), pass));
    ctx.request_repaint();
}

/// Whether the widths were reset in this pass or the one before.
fn is_reset(ui: &Ui) -> bool {
    let pass: Option<u64> = ui.data(|data| data.get_temp(reset_key()));
    pass.is_some_and(|pass| ui.ctx().cumulative_pass_nr() <= pass + 1)
}

/// Shows panels one below the other in a column, which scrolls. While a take plays, those that cannot be used with one are disabled below
/// the others.
pub(crate) fn column(
    ui: &mut Ui,
    side: Side,
    mut titles: Vec<&'static str>,
    shelf: &mut Shelf<'_>,
    moves: &mut Vec<Move>,
) -> Column {
    let mut column = Column::default();
    titles.retain(|title| shelf.is_shown(title));
    if titles.is_empty() {
        return column;
    }
    titles.sort_by_key(|title| shelf.is_disabled(title));
    let frame = match side {
        Side::Left => egui::Panel::left("left"),
        Side::Right => egui::Panel::right("right"),
    };
    let widths = if is_reset(ui) { WIDTH..=WIDTH } else { 260.0..=460.0 };
    let shown = frame.default_size(WIDTH).size_range(widths).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if titles.iter().any(|title| shelf.is_of_takes(title)) {
                shelf.note(ui);
            }
            for title in titles {
                if shelf.is_disabled(title) {
                    ui.disable();
                }
                let header = handle(ui, title);
                column.headers.push((title, header));
                if let Some(header) = shelf.headed(ui, title)
                    && let Some(place) = context_popup(&header, |ui| menu(ui, title)).flatten()
                {
                    moves.push(Move { title, place });
                }
            }
            column.end_y = Some(ui.cursor().top());
        });
    });
    column.rect = shown.response.rect;
    column
}

/// The place where the header of a panel comes next, by which the panel can be dragged.
fn handle(ui: &Ui, title: &'static str) -> Rect {
    let top = ui.cursor().min;
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let rect = Rect::from_min_size(top, size);
    // Below the header, which takes clicks. Not focusable: the menu of the header does the same.
    let response = ui.interact(rect, ui.scope_id().with((title, "handle")), Sense::DRAG);
    if response.drag_started_by(egui::PointerButton::Primary) {
        DragAndDrop::set_payload(ui.ctx(), Held(title));
    }
    if response.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    }
    rect
}
