//! A panel that is dragged by its header, and where it would be dropped.

use egui::{
    Align2, Color32, Context, CornerRadius, DragAndDrop, Id, LayerId, Order, Pos2, Rect, Stroke, StrokeKind,
    vec2,
};

use super::{Column, Move, Place};
use crate::window::shelf::Side;

/// The panel that the pointer drags.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held(pub(super) &'static str);

/// How near to the edge of the window a panel must be dropped to open a column that is closed because it is empty, points.
const EDGE: f32 = 40.0;

/// Where a panel that is dropped at a position goes. `screen` is the window, `over` the part of it between menu and timeline where panels may
/// be.
pub(super) fn place_at(at: Pos2, screen: Rect, columns: &[Column; 2]) -> Place {
    if !screen.contains(at) {
        return Place::Second;
    }
    for side in Side::ALL {
        let column = &columns[side as usize];
        let edge = match side {
            Side::Left => Rect::everything_left_of(screen.left() + EDGE),
            Side::Right => Rect::everything_right_of(screen.right() - EDGE),
        };
        if column.rect.contains(at) || (!column.rect.is_positive() && edge.contains(at)) {
            let below = column.headers.iter().find(|(_, header)| at.y < header.center().y);
            return Place::Above(side, below.map(|(title, _)| *title));
        }
    }
    Place::Floating(Some(at - vec2(24.0, 10.0)))
}

/// Shows where the panel that is dragged would be dropped. Returns its new place when it is dropped.
pub(crate) fn drop_held(ctx: &Context, columns: &[Column; 2]) -> Option<Move> {
    let held = DragAndDrop::payload::<Held>(ctx)?;
    let title = held.0;
    let (at, released) = ctx.input(|input| (input.pointer.latest_pos(), input.pointer.any_released()));
    let screen = ctx.content_rect();
    let place = at.map_or(Place::Second, |at| place_at(at, screen, columns));
    if released {
        DragAndDrop::clear_payload(ctx);
        return Some(Move { title, place });
    }
    show(ctx, title, at.unwrap_or(screen.center()), place, columns);
    None
}

fn show(ctx: &Context, title: &str, at: Pos2, place: Place, columns: &[Column; 2]) {
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("panel that is dragged")));
    let visuals = ctx.global_style().visuals.clone();
    let color = visuals.selection.stroke.color;
    let line = Stroke::new(2.0, color);
    let what = match place {
        Place::Above(side, above) => {
            let column = &columns[side as usize];
            let rect =
                if column.rect.is_positive() { column.rect } else { edge_of(ctx.content_rect(), side) };
            let y = above
                .and_then(|above| column.headers.iter().find(|(title, _)| *title == above))
                .map(|(_, header)| header.top())
                .or(column.end_y)
                .unwrap_or(rect.top())
                .clamp(rect.top(), rect.bottom());
            painter.hline(rect.x_range(), y, line);
            String::new()
        }
        Place::Floating(_) => " over the image".to_owned(),
        Place::Second => " in the second window".to_owned(),
        Place::Usual => String::new(),
    };
    let font = egui::TextStyle::Button.resolve(&ctx.global_style());
    let galley = painter.layout_no_wrap(format!("{title}{what}"), font, visuals.strong_text_color());
    let screen = ctx.content_rect();
    let size = galley.size() + vec2(16.0, 10.0);
    let corner = (at + vec2(12.0, 12.0)).clamp(screen.min, (screen.max - size).max(screen.min));
    let tag = Rect::from_min_size(corner, size);
    painter.rect(
        tag,
        CornerRadius::same(4),
        visuals.window_fill,
        Stroke::new(1.0, color),
        StrokeKind::Inside,
    );
    let place = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), tag).min;
    painter.galley(place, galley, Color32::PLACEHOLDER);
}

fn edge_of(screen: Rect, side: Side) -> Rect {
    match side {
        Side::Left => screen.with_max_x(screen.left() + EDGE),
        Side::Right => screen.with_min_x(screen.right() - EDGE),
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn the_place_of_a_drop_follows_the_pointer() {
        let header = |y: f32| Rect::from_min_size(pos2(0.0, y), vec2(300.0, 20.0));
        let left = Column {
            rect: Rect::from_min_max(pos2(0.0, 30.0), pos2(300.0, 700.0)),
            headers: vec![("A", header(40.0)), ("B", header(60.0))],
            end_y: Some(80.0),
        };
        let columns = [left, Column::default()];
        let screen = Rect::from_min_size(Pos2::ZERO, vec2(1000.0, 800.0));
        let place = |x: f32, y: f32| place_at(pos2(x, y), screen, &columns);
        assert_eq!(place(10.0, 35.0), Place::Above(Side::Left, Some("A")));
        assert_eq!(place(10.0, 55.0), Place::Above(Side::Left, Some("B")));
        assert_eq!(place(10.0, 300.0), Place::Above(Side::Left, None));
        assert_eq!(place(500.0, 300.0), Place::Floating(Some(pos2(476.0, 290.0))));
        assert_eq!(place(990.0, 300.0), Place::Above(Side::Right, None), "a column that is closed");
        assert_eq!(place(-5.0, 300.0), Place::Second);
        assert_eq!(place(1200.0, 300.0), Place::Second);
    }
}
