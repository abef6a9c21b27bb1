//! Keys that controls and tools take for themselves.

use egui::{Event, FocusDirection, Key, Modifiers};

/// Whether a dialog is open. It holds the keyboard until it is answered: no key means a command or a tool meanwhile.
pub(crate) fn are_held(ctx: &egui::Context) -> bool {
    ctx.memory(|memory| memory.top_modal_layer().is_some())
}

/// Whether a key was pressed in this pass with these modifiers and no others; the key is consumed.
pub(crate) fn consume(ctx: &egui::Context, modifiers: Modifiers, key: Key) -> bool {
    consume_all(ctx, modifiers, key) > 0
}

/// How often a key was pressed in this pass with these modifiers and no others; the key is consumed.
///
/// `?`, `+`, `[` and `]` need Shift or `AltGr` on many keyboards, which are therefore no modifiers of these keys.
pub(crate) fn consume_all(ctx: &egui::Context, modifiers: Modifiers, key: Key) -> usize {
    let is_symbol = matches!(key, Key::Questionmark | Key::OpenBracket | Key::CloseBracket);
    let fits = |pressed: Modifiers| {
        if is_symbol && modifiers.is_none() {
            // Control and Alt together are AltGr on some systems.
            return pressed.alt == pressed.ctrl && (pressed.alt || !pressed.command);
        }
        // Shift makes a plus on many keyboards.
        let shift = if key == Key::Plus { modifiers.shift } else { pressed.shift };
        Modifiers { shift, ..pressed }.matches_exact(modifiers)
    };
    let mut found = 0;
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let is_it = matches!(event, Event::Key { key: pressed_key, modifiers: pressed, pressed: true, .. }
                if *pressed_key == key && fits(*pressed));
            found += usize::from(is_it);
            !is_it
        });
    });
    if found > 0 {
        // Tab and arrow keys also move the keyboard focus to another control, which would then receive all other keys.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
    }
    found
}
