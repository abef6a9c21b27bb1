//! The keyboard focus: F6 cycles through the areas of the window, Tab moves within one.

use egui::accesskit::{Action, ActionRequest, TreeId};
use egui::{Context, CornerRadius, Event, Id, Key, LayerId, Modifiers, Order, Rect, Stroke, StrokeKind, Ui};

use super::control::{close_popups, is_any_open};
use super::{key_press, theme};

/// A part of the window that Tab does not leave, in the order in which F6 visits them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Area {
    /// The menu bar.
    Menu,
    /// The panel on the left.
    Left,
    /// The image or the images: no control has the focus, and all keys are shortcuts.
    #[default]
    Image,
    /// The controls beside and above the images: bars, tools, progress and messages.
    Page,
    /// The panel on the right.
    Right,
    /// The timeline.
    Timeline,
}

impl Area {
    const ALL: [Self; 6] = [Self::Menu, Self::Left, Self::Image, Self::Page, Self::Right, Self::Timeline];
}

/// Where the keyboard focus is and what each area holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Focus {
    /// The controls of each area in the order of Tab.
    controls: [Vec<Id>; Area::ALL.len()],
    /// The control of each area that had the focus last.
    last: [Option<Id>; Area::ALL.len()],
    area: Area,
    /// Whether the keyboard moved the focus last, so that it is marked.
    is_marked: bool,
    seen: Option<Id>,
    scroll_to: Option<Id>,
    image: Option<Rect>,
}

impl Focus {
    /// Moves the focus by the keys of this pass. Comes before all controls.
    pub(crate) fn begin_pass(&mut self, ctx: &Context) {
        if let Some(id) = self.scroll_to.take() {
            // A control that receives this request makes every scroll area around it show it.
            let request = ActionRequest {
                action: Action::ScrollIntoView,
                target_tree: TreeId::ROOT,
                target_node: id.accesskit_id(),
                data: None,
            };
            ctx.input_mut(|input| input.events.push(Event::AccessKitActionRequest(request)));
        }
        let focused = ctx.memory(egui::Memory::focused);
        let holder = Area::ALL
            .into_iter()
            .find(|area| focused.is_some_and(|id| self.controls[*area as usize].contains(&id)));
        if let Some(area) = holder {
            self.area = area;
            self.last[area as usize] = focused;
        } else if focused.is_none() {
            self.area = Area::Image;
        }
        // A dialog keeps the focus until it is answered.
        if ctx.memory(|memory| memory.top_modal_layer().is_none()) {
            if key_press::consume(ctx, Modifiers::NONE, Key::F6) {
                self.go_round(ctx, true);
            } else if key_press::consume(ctx, Modifiers::SHIFT, Key::F6) {
                self.go_round(ctx, false);
            } else if let Some(focused) = focused {
                let ids = match holder {
                    Some(area) => self.controls[area as usize].clone(),
                    None => beside(ctx, focused),
                };
                self.step(ctx, &ids, focused);
            } else {
                // Without focus Shift+Tab would enter the last area.
                key_press::consume(ctx, Modifiers::SHIFT, Key::Tab);
            }
        }
        ctx.input(|input| {
            let moves = [Key::Tab, Key::ArrowUp, Key::ArrowDown, Key::ArrowLeft, Key::ArrowRight];
            // At the image the same keys are shortcuts.
            self.is_marked |= focused.is_some() && moves.into_iter().any(|key| input.key_pressed(key));
            self.is_marked &= !input.pointer.any_pressed();
        });
        self.controls = Default::default();
        self.image = None;
    }

    /// Gives the focus to the next control of `ids` if Tab was pressed, to the one before with Shift.
    fn step(&mut self, ctx: &Context, ids: &[Id], focused: Id) {
        let at = ids.iter().position(|id| *id == focused);
        let count = ids.len();
        let next = if key_press::consume(ctx, Modifiers::NONE, Key::Tab) {
            at.map_or(0, |at| (at + 1) % count.max(1))
        } else if key_press::consume(ctx, Modifiers::SHIFT, Key::Tab) {
            at.map_or(count.saturating_sub(1), |at| (at + count - 1) % count.max(1))
        } else {
            return;
        };
        if let Some(id) = ids.get(next) {
            self.give(ctx, *id);
        }
    }

    fn give(&mut self, ctx: &Context, id: Id) {
        ctx.memory_mut(|memory| memory.request_focus(id));
        self.is_marked = true;
    }

    /// Goes to the next area that holds a control.
    fn go_round(&mut self, ctx: &Context, forward: bool) {
        close_popups(ctx);
        let count = Area::ALL.len();
        let step = if forward { 1 } else { count - 1 };
        for distance in 1..=count {
            let area = Area::ALL[(self.area as usize + distance * step) % count];
            let controls = &self.controls[area as usize];
            if area != Area::Image && controls.is_empty() {
                continue;
            }
            self.area = area;
            let known = self.last[area as usize].filter(|id| controls.contains(id));
            if let Some(id) = known.or_else(|| controls.first().copied()) {
                self.give(ctx, id);
            } else {
                ctx.memory_mut(egui::Memory::stop_text_input);
                self.is_marked = true;
            }
            return;
        }
    }

    /// The number of controls that this pass has shown so far, for [`Focus::end_area`].
    pub(crate) fn begin_area(ui: &Ui) -> usize {
        ui.ctx().viewport(|viewport| viewport.this_pass.widgets.get_layer(ui.layer_id()).count())
    }

    /// Notes the controls that were shown since [`Focus::begin_area`] as those of an area.
    pub(crate) fn end_area(&mut self, ui: &Ui, area: Area, begin: usize) {
        let ids = focusable(ui.ctx(), ui.layer_id(), begin);
        self.controls[area as usize].extend(ids);
    }

    /// Notes where the image is, which is marked while it has the focus.
    pub(crate) fn set_image(&mut self, rect: Rect) {
        self.image = Some(rect);
    }

    /// Marks the control with the focus and brings it into view. Comes after all controls.
    pub(crate) fn end_pass(&mut self, ctx: &Context) {
        let mut above: Vec<LayerId> = ctx.viewport(|viewport| {
            let layers = viewport.this_pass.widgets.layer_ids();
            layers.filter(|layer| matches!(layer.order, Order::Middle | Order::Foreground)).collect()
        });
        above.sort_unstable_by_key(|layer| (layer.order, layer.id.value()));
        // Tab stays in an open popup.
        if !is_any_open(ctx) {
            for layer in above {
                self.controls[Area::Page as usize].extend(focusable(ctx, layer, 0));
            }
        }
        let focused = ctx.memory(egui::Memory::focused);
        let moved = focused != self.seen;
        self.seen = focused;
        if !self.is_marked {
            return;
        }
        let edge = Stroke::new(1.5, theme::accent());
        let Some(id) = focused else {
            if let Some(rect) = self.image {
                let painter = ctx.layer_painter(LayerId::background());
                painter.rect_stroke(rect, CornerRadius::ZERO, edge, StrokeKind::Inside);
            }
            return;
        };
        let Some(widget) = ctx.viewport(|viewport| viewport.this_pass.widgets.get(id).copied()) else {
            return;
        };
        let is_clipped = widget.interact_rect.height() < widget.rect.height() - 1.0
            || widget.interact_rect.width() < widget.rect.width() - 1.0;
        if moved && is_clipped {
            self.scroll_to = Some(id);
            ctx.request_repaint();
        }
        if widget.interact_rect.is_positive() {
            let rect = widget.interact_rect.expand(2.0);
            let painter = ctx.layer_painter(widget.layer_id);
            painter.rect_stroke(rect, CornerRadius::same(4), edge, StrokeKind::Middle);
        }
    }

    /// Whether the image has the focus.
    #[cfg(test)]
    pub(crate) fn is_at_image(&self) -> bool {
        self.area == Area::Image
    }
}

/// The controls of the popup or dialog that holds `focused`.
fn beside(ctx: &Context, focused: Id) -> Vec<Id> {
    let layer = ctx.viewport(|viewport| viewport.prev_pass.widgets.order(focused).map(|(layer, _)| layer));
    let Some(layer) = layer.filter(|layer| layer.order != Order::Background) else { return Vec::new() };
    ctx.viewport(|viewport| {
        let widgets = viewport.prev_pass.widgets.get_layer(layer);
        widgets
            .filter(|widget| widget.enabled && widget.sense.is_focusable())
            .map(|widget| widget.id)
            .collect()
    })
}

/// The controls of a layer that can take the focus, from the one at `begin` on.
fn focusable(ctx: &Context, layer: LayerId, begin: usize) -> Vec<Id> {
    ctx.viewport(|viewport| {
        let widgets = viewport.this_pass.widgets.get_layer(layer).skip(begin);
        widgets
            .filter(|widget| widget.enabled && widget.visible && widget.sense.is_focusable())
            .map(|widget| widget.id)
            .collect()
    })
}
