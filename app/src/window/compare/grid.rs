//! The positions of panes.

use egui::{Rect, Vec2, pos2};
use lovelock_panes::sheet::pane_columns;

use super::header;

/// Room between panes, points.
pub(super) const GAP: f32 = 3.0;

/// Columns of a grid of `panes` on a page of that size.
pub(super) fn columns(panes: usize, page: Vec2) -> usize {
    pane_columns(panes, page.into(), header::height)
}

/// The positions of `panes` on a page, row by row.
pub(super) fn places(panes: usize, page: Rect) -> Vec<Rect> {
    let columns = columns(panes, page.size());
    let rows = panes.div_ceil(columns).max(1);
    // Whole points keep images sharp.
    let edge =
        |i: usize, of: usize, from: f32, length: f32| (from + (length + GAP) * i as f32 / of as f32).round();
    (0..panes)
        .map(|pane| {
            let (row, column) = (pane / columns, pane % columns);
            let x = |i| edge(i, columns, page.left(), page.width());
            let y = |i| edge(i, rows, page.top(), page.height());
            Rect::from_min_max(pos2(x(column), y(row)), pos2(x(column + 1) - GAP, y(row + 1) - GAP))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panes_fill_a_wide_page_and_do_not_overlap() {
        let page = Rect::from_min_size(pos2(10.0, 20.0), Vec2::new(1200.0, 700.0));
        for (panes, expected) in [(1, 1), (2, 2), (3, 3), (4, 2), (5, 3), (6, 3)] {
            assert_eq!(columns(panes, page.size()), expected, "{panes}");
            let places = places(panes, page);
            assert_eq!(places.len(), panes);
            for (i, a) in places.iter().enumerate() {
                assert!(page.expand(1.0).contains_rect(*a) && a.width() > 100.0, "{a:?}");
                assert!(places[i + 1..].iter().all(|b| !a.shrink(0.5).intersects(*b)));
            }
        }
        assert_eq!(columns(2, Vec2::new(300.0, 900.0)), 1, "a narrow page has them in a column");
        assert!(places(0, page).is_empty());
    }
}
