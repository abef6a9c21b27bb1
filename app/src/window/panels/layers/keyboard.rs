//! Keys of the list of layers.

use egui::{Key, Modifiers, Ui};
use lovelock_style::StyleStack;

use super::LayersView;
use super::list::Row;
use super::picked::{duplicate, remove};
use crate::window::key_press;

/// Carries out the keys that were pressed while the list has them.
pub(super) fn run(ui: &mut Ui, stack: &mut StyleStack, view: &mut LayersView) {
    // Delete at a point of a curve, or an arrow key at a slider, is meant for that control.
    let taken = ui.ctx().egui_wants_keyboard_input() || crate::window::key_press::are_held(ui.ctx());
    if !view.has_keys || !ui.is_enabled() || taken || view.renamed.is_some() {
        return;
    }
    let pressed = |modifiers: Modifiers, key: Key| key_press::consume(ui.ctx(), modifiers, key);
    if pressed(Modifiers::COMMAND, Key::D) {
        duplicate(stack, view);
    }
    if pressed(Modifiers::COMMAND, Key::G) {
        stack.make_group(&view.picked(stack), "Group");
    }
    if pressed(Modifiers::NONE, Key::Delete) {
        remove(stack, view);
    }
    if pressed(Modifiers::NONE, Key::F2)
        && let Some(layer) = view.selected.and_then(|id| stack.layer(id))
    {
        view.renamed = Some((Row::Layer(layer.id), layer.label().to_owned()));
    }
    for (key, down) in [(Key::ArrowUp, false), (Key::ArrowDown, true)] {
        if pressed(Modifiers::NONE, key) {
            step(stack, view, down);
        }
    }
}

/// Selects the next layer that is shown.
fn step(stack: &StyleStack, view: &mut LayersView, down: bool) {
    let hidden = |group: Option<u32>| group.is_some_and(|id| view.folded.contains(&id));
    let shown: Vec<u32> =
        stack.layers.iter().filter(|layer| !hidden(layer.group)).map(|layer| layer.id).collect();
    let at = view.selected.and_then(|id| shown.iter().position(|shown| *shown == id));
    let next = match at {
        Some(i) if down => (i + 1).min(shown.len() - 1),
        Some(i) => i.saturating_sub(1),
        None => 0,
    };
    if let Some(&id) = shown.get(next) {
        view.select(Some(id));
    }
}
