//! Messages in a corner of the window that disappear after a while.

use egui::{Align2, Area, Color32, Frame, Id, Order, RichText};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{ICON_CHECK_CIRCLE, ICON_CLOSE, ICON_ERROR, ICON_WARNING};

use super::theme;

/// Seconds for which a message stays, and the seconds added per letter.
const STAYS_SECS: f64 = 6.0;
const READING_SECS: f64 = 0.06;
/// The most messages that are shown; the oldest are removed first.
const MOST: usize = 5;
/// Width of the longest line, points.
const WIDTH: f32 = 360.0;

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Something succeeded.
    Done,
    /// Something succeeded only in part.
    Warning,
    /// Something failed.
    Failed,
}

impl Kind {
    fn icon(self) -> (MaterialIcon, Color32) {
        match self {
            Self::Done => (ICON_CHECK_CIRCLE, theme::QUIET),
            Self::Warning => (ICON_WARNING, theme::ACCENT),
            Self::Failed => (ICON_ERROR, theme::WRONG),
        }
    }
}

#[derive(Clone, Debug)]
struct Notice {
    id: u64,
    kind: Kind,
    text: String,
    /// When it disappears, in seconds of the window's time; `None` before it was first shown.
    until_secs: Option<f64>,
}

/// The messages of the window.
#[derive(Clone, Debug, Default)]
pub(crate) struct Notices {
    list: Vec<Notice>,
    told: u64,
}

impl Notices {
    /// Adds a message. One that is already visible stays longer instead of appearing twice.
    pub(crate) fn push(&mut self, kind: Kind, text: impl Into<String>) {
        let text = text.into();
        self.list.retain(|notice| notice.text != text);
        if self.list.len() == MOST {
            self.list.remove(0);
        }
        self.told += 1;
        self.list.push(Notice { id: self.told, kind, text, until_secs: None });
    }

    /// Shows the messages, the newest at the bottom.
    pub(crate) fn show(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|input| input.time);
        for notice in &mut self.list {
            let stays = STAYS_SECS + READING_SECS * notice.text.chars().count() as f64;
            notice.until_secs.get_or_insert(now + stays);
        }
        self.list.retain(|notice| notice.until_secs.is_none_or(|until| until > now));
        let Some(first) = self.list.iter().filter_map(|notice| notice.until_secs).reduce(f64::min) else {
            return;
        };
        ctx.request_repaint_after(std::time::Duration::from_secs_f64((first - now).max(0.0)));
        let mut closed = None;
        Area::new(Id::unique("notices"))
            .anchor(Align2::RIGHT_BOTTOM, [-12.0, -52.0])
            .order(Order::Foreground)
            .show(ctx, |ui| {
                ui.set_max_width(WIDTH);
                for notice in &self.list {
                    Frame::popup(ui.style()).show(ui, |ui| {
                        ui.horizontal_top(|ui| {
                            let (icon, color) = notice.kind.icon();
                            ui.label(RichText::from(icon).color(color));
                            ui.vertical(|ui| {
                                ui.set_width(WIDTH - 72.0);
                                ui.add(egui::Label::new(&notice.text).wrap());
                            });
                            let close = ui.small_button(ICON_CLOSE).on_hover_text("Closes this message.");
                            close.widget_info(|| {
                                egui::WidgetInfo::labeled(egui::Role::Button, true, "Close message")
                            });
                            if close.clicked() {
                                closed = Some(notice.id);
                            }
                        });
                    });
                }
            });
        self.list.retain(|notice| Some(notice.id) != closed);
    }
}
