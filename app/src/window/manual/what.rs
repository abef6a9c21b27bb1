//! *What is this?*: a click on a control opens what the manual writes about it.

use egui::accesskit;
use egui::{
    Area, Context, CornerRadius, Id, Key, LayerId, Modifiers, Order, Pos2, Rect, Sense, Stroke, StrokeKind,
};
use lovelock_base::settings::Info;

use crate::window::control::rows::{self, Row};
use crate::window::{key_press, theme};

/// A control that the user asks about.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    /// Its name in the window.
    pub(crate) name: String,
    /// The setting that it changes, if it is made from a table.
    pub(crate) info: Option<&'static Info>,
}

/// The mode in which a click asks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WhatIsThis {
    is_on: bool,
    /// Whether names of controls were made already, for a screen reader.
    had_names: bool,
    /// The control that had the focus: no click is needed.
    focused: Option<Id>,
}

fn key() -> Id {
    Id::unique("what is this")
}

impl WhatIsThis {
    /// Starts or ends the mode.
    pub(crate) fn toggle(&mut self, ctx: &Context) {
        self.is_on = !self.is_on;
        if self.is_on {
            self.had_names = ctx.viewport(|viewport| viewport.this_pass.accesskit_state.is_some());
            ctx.enable_accesskit();
            // The entry of the menu that starts this is no control to ask about.
            let focused = ctx.memory(egui::Memory::focused);
            self.focused = focused.filter(|id| {
                let layer = ctx.viewport(|viewport| viewport.prev_pass.widgets.order(*id));
                layer.is_some_and(|(layer, _)| layer.order == Order::Background)
            });
            rows::begin(ctx);
        } else {
            self.end(ctx);
        }
        ctx.request_repaint();
    }

    fn end(&mut self, ctx: &Context) {
        self.is_on = false;
        if !self.had_names {
            ctx.disable_accesskit();
        }
        rows::end(ctx);
    }

    /// Shows what the pointer is over and ends with a click. Comes after all controls. Returns what was clicked; its name is empty
    /// where there is no control.
    pub(crate) fn end_pass(&mut self, ctx: &Context) -> Option<Asked> {
        if !self.is_on {
            return None;
        }
        if key_press::consume(ctx, Modifiers::NONE, Key::Escape) {
            self.end(ctx);
            return None;
        }
        if let Some(id) = self.focused {
            let rows = rows::take(ctx);
            let has_names = ctx.viewport(|viewport| viewport.this_pass.accesskit_state.is_some());
            let rect = ctx.viewport(|viewport| viewport.this_pass.widgets.get(id).map(|w| w.interact_rect));
            ctx.request_repaint();
            if !has_names {
                return None;
            }
            self.end(ctx);
            return rect.and_then(|rect| under(ctx, rect.center(), &rows)).map(|(_, asked)| asked);
        }
        let screen = ctx.content_rect();
        // The click is that of this layer, so that no control gets it.
        let cover =
            Area::new(key()).order(Order::Tooltip).fixed_pos(screen.min).movable(false).show(ctx, |ui| {
                let response = ui.allocate_rect(screen, Sense::CLICK);
                ui.painter().text(
                    screen.center_top() + egui::vec2(0.0, 34.0),
                    egui::Align2::CENTER_TOP,
                    "Click a control to read about it. Escape cancels.",
                    egui::FontId::proportional(14.0),
                    theme::accent(),
                );
                response.on_hover_cursor(egui::CursorIcon::Help)
            });
        let cover = cover.inner;
        let rows = rows::take(ctx);
        ctx.request_repaint();
        let at = cover.hover_pos().or_else(|| cover.interact_pointer_pos())?;
        let found = under(ctx, at, &rows);
        if let Some((rect, _)) = &found {
            let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, key()));
            let edge = Stroke::new(1.5, theme::accent());
            painter.rect_stroke(rect.expand(2.0), CornerRadius::same(4), edge, StrokeKind::Middle);
        }
        if !cover.clicked() {
            return None;
        }
        self.end(ctx);
        Some(found.map_or(Asked { name: String::new(), info: None }, |(_, asked)| asked))
    }
}

/// The control at a place: the row of a setting, or whatever has a name.
fn under(ctx: &Context, at: Pos2, rows: &[Row]) -> Option<(Rect, Asked)> {
    // From the top layer down.
    let layers: Vec<LayerId> = ctx.memory(|memory| memory.layer_ids().collect());
    let above = layers.into_iter().rev().chain([LayerId::background()]);
    for layer in above.filter(|layer| layer.order != Order::Tooltip) {
        if let Some((rect, _, info)) =
            rows.iter().rev().find(|(rect, of, _)| *of == layer && rect.contains(at))
        {
            return Some((*rect, Asked { name: info.label.to_owned(), info: Some(info) }));
        }
        let widgets: Vec<(Id, Rect)> = ctx.viewport(|viewport| {
            let widgets = viewport.this_pass.widgets.get_layer(layer);
            widgets.filter(|w| w.interact_rect.contains(at)).map(|w| (w.id, w.interact_rect)).collect()
        });
        // The smallest is the innermost.
        let named = widgets.into_iter().filter_map(|(id, rect)| Some((rect, name_of(ctx, id)?)));
        if let Some((rect, name)) = named.min_by(|a, b| a.0.area().total_cmp(&b.0.area())) {
            return Some((rect, Asked { name, info: None }));
        }
    }
    None
}

/// The name that a control has for screen readers.
fn name_of(ctx: &Context, id: Id) -> Option<String> {
    ctx.viewport(|viewport| {
        let nodes = &viewport.this_pass.accesskit_state.as_ref()?.nodes;
        let node: &accesskit::Node = nodes.get(&id)?;
        let own = node.label().map(str::to_owned).filter(|label| !label.is_empty());
        // Controls of rows are named by another node.
        let by = || {
            let by = node.labelled_by().first()?;
            let named = nodes.iter().find(|(id, _)| id.accesskit_id() == *by)?;
            named.1.label().or_else(|| named.1.value()).map(str::to_owned)
        };
        own.or_else(by)
    })
}
