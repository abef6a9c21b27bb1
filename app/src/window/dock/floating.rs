//! Panels that float over the image.

use egui::{Context, Id, Pos2, Window, vec2};

use super::{Column, Move, Place};
use crate::window::shelf::Shelf;

/// Where the corner of a window that begins to float is.
fn corner_key(title: &str) -> Id {
    Id::unique(("corner of a floating panel", title))
}

/// Lets a panel begin to float with its corner there.
pub(super) fn begin_at(ctx: &Context, title: &str, corner: Pos2) {
    ctx.data_mut(|data| data.insert_temp(corner_key(title), corner));
}

/// Shows the panels that float. One that is dropped onto a column or closed is docked.
pub(crate) fn floating(
    ctx: &Context,
    titles: Vec<&'static str>,
    shelf: &mut Shelf<'_>,
    columns: &[Column; 2],
    moves: &mut Vec<Move>,
) {
    let free = ctx.content_rect();
    for (at, title) in titles.into_iter().enumerate() {
        if !shelf.is_shown(title) {
            continue;
        }
        let corner: Option<Pos2> = ctx.data_mut(|data| data.remove_temp(corner_key(title)));
        let mut open = true;
        let step = 28.0 * at as f32;
        let mut window = Window::new(title)
            .id(Id::unique(("floating panel", title)))
            .default_pos(free.left_top() + vec2(340.0 + step, 70.0 + step))
            .default_size([312.0, 420.0])
            .min_width(260.0)
            .max_width(560.0)
            .max_height((free.height() - 80.0).max(160.0))
            .collapsible(false)
            .vscroll(true)
            .open(&mut open);
        if let Some(corner) = corner {
            window = window.current_pos(corner);
        }
        let shown = window.show(ctx, |ui| {
            if shelf.is_disabled(title) {
                shelf.note(ui);
                ui.disable();
            }
            shelf.untitled(ui, title);
        });
        if !open {
            moves.push(Move { title, place: Place::Usual });
        }
        let Some(response) = shown.map(|shown| shown.response) else { continue };
        let pointer = ctx.input(|input| input.pointer.latest_pos());
        let over = pointer.filter(|at| columns.iter().any(|column| column.rect.contains(*at)));
        if let (true, Some(at)) = (response.drag_stopped(), over) {
            moves.push(Move { title, place: super::held::place_at(at, free, columns) });
        }
    }
}
