//! Where the rows of settings are on the screen, for the mode in which a click on a control explains it.

use egui::{Context, Id, LayerId, Rect, Ui};
use lovelock_base::settings::Info;

/// The place of a row, its layer, and the setting that it changes.
pub(crate) type Row = (Rect, LayerId, &'static Info);

/// The rows of a pass.
#[derive(Clone, Default)]
struct Rows(Vec<Row>);

fn key() -> Id {
    Id::unique("rows of settings")
}

/// Records rows from now on.
pub(crate) fn begin(ctx: &Context) {
    ctx.data_mut(|data| data.insert_temp(key(), Rows::default()));
}

/// Ends what [`begin`] began.
pub(crate) fn end(ctx: &Context) {
    ctx.data_mut(|data| data.remove::<Rows>(key()));
}

/// The rows since the last call. They are recorded again in each pass.
pub(crate) fn take(ctx: &Context) -> Vec<Row> {
    ctx.data_mut(|data| {
        let rows = data.get_temp::<Rows>(key()).unwrap_or_default();
        data.insert_temp(key(), Rows::default());
        rows.0
    })
}

/// Records the row of a setting, if rows are recorded.
pub(super) fn note_row(ui: &Ui, info: &'static Info, control: Rect) {
    let rect = Rect::from_x_y_ranges(ui.max_rect().x_range(), control.y_range()).intersect(ui.clip_rect());
    let layer = ui.layer_id();
    ui.data_mut(|data| {
        if let Some(mut rows) = data.get_temp::<Rows>(key()) {
            rows.0.push((rect, layer, info));
            data.insert_temp(key(), rows);
        }
    });
}
