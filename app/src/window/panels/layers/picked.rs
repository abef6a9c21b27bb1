//! What is done to the picked layers, by keys and by menus.

use lovelock_style::StyleStack;

use super::LayersView;

/// Duplicates the picked layers and picks the copies.
pub(super) fn duplicate(stack: &mut StyleStack, view: &mut LayersView) {
    let copies: Vec<u32> = view.picked(stack).into_iter().filter_map(|id| stack.duplicate(id)).collect();
    if let Some((&last, others)) = copies.split_last() {
        view.select(Some(last));
        view.also.extend(others);
    }
}

/// Removes the picked layers and selects the one that takes their place.
pub(super) fn remove(stack: &mut StyleStack, view: &mut LayersView) {
    let picked = view.picked(stack);
    let first = stack.layers.iter().position(|layer| picked.contains(&layer.id));
    for id in picked {
        stack.remove(id);
    }
    let next = first.map(|i| i.min(stack.layers.len().saturating_sub(1)));
    view.select(next.and_then(|i| stack.layers.get(i)).map(|layer| layer.id));
}
