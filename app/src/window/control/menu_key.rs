//! Shift+F10: the menu of the control with the keyboard focus, as a click on it with the right button opens it.

use egui::{Context, Event, Id, Key, LayerId, Order, PointerButton, Pos2, RawInput, Ui};

use super::is_any_open;

/// The number of passes within which the menu must appear.
const PASSES: u8 = 4;

/// Turns the key into a click, and moves the keyboard focus into the menu and back.
#[derive(Debug, Default)]
pub(crate) struct MenuKey {
    /// The control whose menu was asked for, while its menu is not known to be closed.
    control: Option<Id>,
    /// The layers that were there before the menu, and the passes that are left for it to appear.
    waits: Option<(Vec<LayerId>, u8)>,
}

fn popups(ctx: &Context) -> Vec<LayerId> {
    ctx.viewport(|viewport| {
        let layers = viewport.this_pass.widgets.layer_ids();
        layers.filter(|layer| layer.order == Order::Foreground).collect()
    })
}

/// The part of a control that is visible has this middle.
fn middle(ctx: &Context, id: Id) -> Option<Pos2> {
    let rect = ctx.read_response(id)?.interact_rect;
    rect.is_positive().then(|| rect.center())
}

impl egui::Plugin for MenuKey {
    fn debug_name(&self) -> &'static str {
        "menu key"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let is_it = |event: &Event| matches!(event, Event::Key { key: Key::F10, pressed: true, modifiers, .. } if modifiers.shift_only());
        let Some(at) = input.events.iter().position(is_it) else { return };
        input.events.remove(at);
        let Some(id) = ctx.memory(egui::Memory::focused) else { return };
        let Some(pos) = middle(ctx, id) else { return };
        let click = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Secondary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        drop(input.events.splice(at..at, [Event::PointerMoved(pos), click(true), click(false)]));
        (self.control, self.waits) = (Some(id), Some((popups(ctx), PASSES)));
    }

    fn on_end_pass(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx();
        if let Some((before, left)) = &mut self.waits {
            let new = popups(ctx).into_iter().find(|layer| !before.contains(layer));
            let first = new.and_then(|layer| {
                ctx.viewport(|viewport| {
                    let mut widgets = viewport.this_pass.widgets.get_layer(layer);
                    widgets
                        .find(|widget| widget.enabled && widget.visible && widget.sense.is_focusable())
                        .map(|widget| widget.id)
                })
            });
            *left -= 1;
            if let Some(first) = first {
                ctx.memory_mut(|memory| memory.request_focus(first));
                self.waits = None;
            } else if *left == 0 {
                (self.control, self.waits) = (None, None);
            } else {
                ctx.request_repaint();
            }
        } else if let Some(control) = self.control
            && !is_any_open(ctx)
        {
            self.control = None;
            if ctx.memory(|memory| memory.focused().is_none()) {
                ctx.memory_mut(|memory| memory.request_focus(control));
            }
        }
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
