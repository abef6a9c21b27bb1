//! Messages in a corner of the image. They disappear after a while, but for errors, which stay until they are closed.

use std::path::{Path, PathBuf};

use egui::{Align2, Area, Color32, Frame, Id, LayerId, Order, Rect, RichText, Ui, vec2};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{ICON_CHECK_CIRCLE, ICON_CLOSE, ICON_ERROR, ICON_WARNING};

use super::theme;
use crate::window::control::HoverTooltip;

/// Seconds for which a message stays, and the seconds added per letter.
const STAYS_SECS: f64 = 6.0;
const READING_SECS: f64 = 0.06;
/// The most messages that are shown. Of those that disappear by themselves the oldest are removed first; errors wait.
const MAX: usize = 5;
/// The most errors that wait to be read.
const MAX_WAITING: usize = 100;
/// Distance from the corner of the image, points.
const MARGIN: f32 = 12.0;
/// Width of the longest line, points.
const WIDTH: f32 = 360.0;

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Something succeeded.
    Done,
    /// Something succeeded only in part.
    Warning,
    /// Something failed. The message stays until it is closed.
    Failed,
}

impl Kind {
    fn icon(self) -> (MaterialIcon, Color32) {
        match self {
            Self::Done => (ICON_CHECK_CIRCLE, theme::quiet()),
            Self::Warning => (ICON_WARNING, theme::accent()),
            Self::Failed => (ICON_ERROR, theme::wrong()),
        }
    }
}

#[derive(Clone, Debug)]
struct Notice {
    id: u64,
    kind: Kind,
    text: String,
    /// The file or folder that was written.
    written: Option<PathBuf>,
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
        self.add(kind, text, None);
    }

    /// Adds the message that the file or folder at `path` was written, with buttons that open it.
    pub(crate) fn push_written(&mut self, text: impl Into<String>, path: PathBuf) {
        self.add(Kind::Done, text, Some(path));
    }

    /// Adds a message about a report, with buttons that open it.
    pub(crate) fn push_report(&mut self, kind: Kind, text: impl Into<String>, report: PathBuf) {
        self.add(kind, text, Some(report));
    }

    fn add(&mut self, kind: Kind, text: impl Into<String>, written: Option<PathBuf>) {
        let text = text.into();
        self.list.retain(|notice| notice.text != text);
        let most = if kind == Kind::Failed { MAX_WAITING } else { MAX };
        if self.list.len() >= most {
            let passing = self.list.iter().position(|notice| notice.kind != Kind::Failed);
            match passing {
                Some(at) => drop(self.list.remove(at)),
                // The first errors say most: later ones often follow from them.
                None if kind == Kind::Failed => return,
                None => {}
            }
        }
        self.told += 1;
        self.list.push(Notice { id: self.told, kind, text, written, until_secs: None });
    }

    /// The errors that were not closed yet.
    #[cfg(test)]
    pub(crate) fn errors(&self) -> Vec<&str> {
        let failed = self.list.iter().filter(|notice| notice.kind == Kind::Failed);
        failed.map(|notice| notice.text.as_str()).collect()
    }

    /// Shows the messages in the lower right corner of `image`, where they cover no control; the newest at the bottom. Returns the
    /// file or folder that shall be opened with the system's program for it.
    pub(crate) fn show(&mut self, ctx: &egui::Context, image: Rect) -> Option<PathBuf> {
        let now = ctx.input(|input| input.time);
        let visible = self.visible();
        for notice in self.list.iter_mut().filter(|notice| visible.contains(&notice.id)) {
            let stays = STAYS_SECS + READING_SECS * notice.text.chars().count() as f64;
            let until = if notice.kind == Kind::Failed { f64::INFINITY } else { now + stays };
            notice.until_secs.get_or_insert(until);
        }
        self.list.retain(|notice| notice.until_secs.is_none_or(|until| until > now));
        if self.list.is_empty() {
            return None;
        }
        let next = self.list.iter().filter_map(|notice| notice.until_secs).fold(f64::INFINITY, f64::min);
        if next.is_finite() {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64((next - now).max(0.0)));
        }
        let visible = self.visible();
        let waiting = self.list.len().saturating_sub(visible.len());
        let width = WIDTH.min(image.width() - 2.0 * MARGIN).max(160.0);
        let (mut closed, mut opened) = (Vec::new(), None);
        let layer = LayerId::new(Order::Middle, Id::unique("notices"));
        Area::new(layer.id)
            .pivot(Align2::RIGHT_BOTTOM)
            .fixed_pos(image.right_bottom() - vec2(MARGIN, MARGIN))
            .order(layer.order)
            .show(ctx, |ui| {
                ui.set_max_width(width);
                if waiting > 0 {
                    Frame::popup(ui.style()).show(ui, |ui| {
                        ui.horizontal(|ui| {
                            ui.label(format!("{waiting} more"));
                            let all = ui.button("Close all").hover_tooltip("Closes every message.");
                            if all.clicked() {
                                closed.extend(self.list.iter().map(|notice| notice.id));
                            }
                        });
                    });
                }
                for notice in self.list.iter().filter(|notice| visible.contains(&notice.id)) {
                    let (closes, opens) = one(ui, notice, width);
                    if closes {
                        closed.push(notice.id);
                    }
                    opened = opens.or(opened.take());
                }
            });
        send_below(ctx, layer);
        self.list.retain(|notice| !closed.contains(&notice.id));
        opened
    }

    /// The messages that are shown: all that disappear by themselves, and the oldest errors.
    fn visible(&self) -> Vec<u64> {
        let is_error = |notice: &&Notice| notice.kind == Kind::Failed;
        let passing = self.list.iter().filter(|notice| !is_error(notice));
        let room = MAX.saturating_sub(passing.clone().count()).max(1);
        let errors = self.list.iter().filter(is_error).take(room);
        errors.chain(passing).map(|notice| notice.id).collect()
    }
}

/// Sends the messages below windows and the bar of tools, over which they are when they are new or were clicked.
fn send_below(ctx: &egui::Context, messages: LayerId) {
    let layers: Vec<LayerId> = ctx.memory(|memory| {
        let beside = |layer: &LayerId| layer.order == messages.order && memory.areas().is_visible(layer);
        memory.layer_ids().filter(beside).collect()
    });
    if layers.first() == Some(&messages) {
        return;
    }
    // In their own order, which stays.
    for layer in layers.into_iter().filter(|layer| *layer != messages) {
        ctx.move_to_top(layer);
        ctx.request_repaint();
    }
}

/// One message; returns whether it was closed, and what of it shall be opened.
fn one(ui: &mut Ui, notice: &Notice, width: f32) -> (bool, Option<PathBuf>) {
    let row = |ui: &mut Ui| {
        let mut opened = None;
        let (icon, color) = notice.kind.icon();
        ui.label(RichText::from(icon).color(color));
        ui.vertical(|ui| {
            ui.set_width(width - 72.0);
            ui.add(egui::Label::new(&notice.text).wrap());
            opened = notice.written.as_deref().and_then(|path| written(ui, path));
        });
        let close = ui.small_button(ICON_CLOSE).hover_tooltip("Closes this message.");
        close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Close message"));
        (close.clicked(), opened)
    };
    Frame::popup(ui.style()).show(ui, |ui| ui.horizontal_top(row).inner).inner
}

/// The buttons of a file or folder that was written. Returns what shall be opened.
fn written(ui: &mut Ui, path: &Path) -> Option<PathBuf> {
    let mut opened = None;
    ui.horizontal(|ui| {
        let tip = "Opens it in the system's default program.";
        if ui.button("Open").hover_tooltip(tip).clicked() {
            opened = Some(path.to_owned());
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or_else(|| Path::new("."));
        if ui.button("Show in folder").hover_tooltip(format!("Opens {}.", folder.display())).clicked() {
            opened = Some(folder.to_owned());
        }
    });
    opened
}
