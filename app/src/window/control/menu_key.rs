//! Shift+F10: the menu of the control with the keyboard focus, as a click on it with the right button opens it.

use egui::{Context, Event, Id, Key, LayerId, Order, PointerButton, Pos2, RawInput, Ui};

use super::is_any_open;

/// The number of passes within which a menu appears or disappears.
const PASSES: u8 = 4;

/// Turns the key into a click, and moves the keyboard focus into the menu and back.
#[derive(Debug, Default)]
pub(crate) struct MenuKey(Option<Asked>);

/// The menu of a control that was asked for.
#[derive(Debug)]
struct Asked {
    control: Id,
    /// The popups that were there before the menu; `None` when the menu has appeared.
    before: Option<Vec<LayerId>>,
    /// The passes that are left for it to appear or to disappear.
    left: u8,
}

fn popups(ctx: &Context) -> Vec<LayerId> {
    ctx.viewport(|viewport| {
        let widgets = &viewport.this_pass.widgets;
        // Layers are remembered without widgets after they are gone.
        let is_popup =
            |layer: &LayerId| layer.order == Order::Foreground && widgets.get_layer(*layer).next().is_some();
        widgets.layer_ids().filter(is_popup).collect()
    })
}

/// The first control of a layer that takes the focus.
fn first_in(ctx: &Context, layer: LayerId) -> Option<Id> {
    ctx.viewport(|viewport| {
        let mut widgets = viewport.this_pass.widgets.get_layer(layer);
        let found = widgets.find(|widget| widget.enabled && widget.visible && widget.sense.is_focusable());
        found.map(|widget| widget.id)
    })
}

/// The middle of the visible part of a control.
fn middle(ctx: &Context, id: Id) -> Option<Pos2> {
    let rect = ctx.read_response(id)?.interact_rect;
    rect.is_positive().then(|| rect.center())
}

impl Asked {
    /// What is left to do after a pass.
    fn next(mut self, ctx: &Context) -> Option<Self> {
        if let Some(before) = &self.before {
            let new = popups(ctx).into_iter().find(|layer| !before.contains(layer));
            if let Some(first) = new.and_then(|layer| first_in(ctx, layer)) {
                ctx.memory_mut(|memory| memory.request_focus(first));
                (self.before, self.left) = (None, PASSES);
                return Some(self);
            }
        } else if is_any_open(ctx) {
            return Some(self);
        } else {
            let focused = ctx.memory(egui::Memory::focused);
            let layer = focused.and_then(|id| {
                ctx.viewport(|viewport| viewport.this_pass.widgets.get(id).map(|widget| widget.layer_id))
            });
            // The entry that was chosen has the focus for a pass more.
            if layer.is_none_or(|layer| layer.order != Order::Foreground) {
                let is_free = layer.is_none() && ctx.memory(|memory| memory.top_modal_layer().is_none());
                if is_free {
                    ctx.memory_mut(|memory| memory.request_focus(self.control));
                }
                return None;
            }
        }
        self.left = self.left.checked_sub(1)?;
        ctx.request_repaint();
        Some(self)
    }
}

impl egui::Plugin for MenuKey {
    fn debug_name(&self) -> &'static str {
        "menu key"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let is_it = |event: &Event| match event {
            Event::Key { key, pressed, modifiers, .. } => {
                *key == Key::F10 && *pressed && modifiers.shift_only()
            }
            _ => false,
        };
        let Some(at) = input.events.iter().position(is_it) else { return };
        input.events.remove(at);
        let Some(control) = ctx.memory(egui::Memory::focused) else { return };
        let Some(pos) = middle(ctx, control) else { return };
        let click = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Secondary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        drop(input.events.splice(at..at, [Event::PointerMoved(pos), click(true), click(false)]));
        self.0 = Some(Asked { control, before: Some(popups(ctx)), left: PASSES });
    }

    fn on_end_pass(&mut self, ui: &mut Ui) {
        self.0 = self.0.take().and_then(|asked| asked.next(ui.ctx()));
    }
}

#[cfg(test)]
mod tests {
    use egui::Modifiers;
    use egui::accesskit::Role;
    use egui_kittest::kittest::{NodeT, Queryable};

    use super::*;
    use crate::window::testing::screen_of;

    #[test]
    fn the_key_opens_the_menu_of_the_focused_control_and_the_focus_returns() {
        let mut harness = screen_of(egui::vec2(400.0, 300.0), 0, |ui, chosen: &mut i32| {
            let _ = ui.button("Other");
            ui.button("Layer").context_menu(|ui| {
                for (number, name) in [(1, "Duplicate"), (2, "Remove")] {
                    if ui.button(name).clicked() {
                        *chosen = number;
                        ui.close();
                    }
                }
            });
        });
        let focused = |harness: &egui_kittest::Harness<'_, _>, name: &str| {
            harness.get_by_role_and_label(Role::Button, name).accesskit_node().is_focused()
        };
        // Nothing has the focus, and a control without a menu.
        harness.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        harness.run();
        harness.get_by_label("Other").focus();
        harness.run();
        harness.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        harness.run();
        assert!(harness.query_by_label("Duplicate").is_none() && focused(&harness, "Other"));
        harness.get_by_label("Layer").focus();
        harness.run();
        harness.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        harness.run();
        assert!(focused(&harness, "Duplicate"), "the first entry has the focus");
        harness.key_press(Key::ArrowDown);
        harness.run();
        harness.key_press(Key::Enter);
        harness.run();
        assert_eq!(harness.state().state, 2);
        assert!(harness.query_by_label("Remove").is_none() && focused(&harness, "Layer"));
        harness.key_press_modifiers(Modifiers::SHIFT, Key::F10);
        harness.run();
        harness.key_press(Key::Escape);
        harness.run();
        assert!(harness.query_by_label("Remove").is_none() && focused(&harness, "Layer"));
    }
}
