//! A search field with a list of matches below it: typing, the arrow keys, Enter and the pointer act alike wherever there is one.

use egui::{Align, Align2, Key, Modifiers, Response, TextEdit, Ui, WidgetInfo};

use super::key_press;

/// What was typed, and which of the matches is chosen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picker {
    /// What was typed.
    pub(crate) typed: String,
    chosen: usize,
    /// Whether the chosen match must be brought into view.
    moved: bool,
}

/// What was done to the search field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Picked {
    /// Enter was pressed: the chosen match is taken.
    pub(crate) entered: bool,
    /// The down key was pressed.
    pub(crate) down: bool,
    /// Whether the field has the focus.
    pub(crate) has_focus: bool,
}

/// Matches that Page up and Page down pass.
const PAGE: usize = 10;

impl Picker {
    /// The search field, called `name`. `takes_focus`: it has the focus whenever no other control has.
    pub(crate) fn field(
        &mut self,
        ui: &mut Ui,
        name: &str,
        width: f32,
        takes_focus: bool,
    ) -> (Response, Picked) {
        let id = ui.make_persistent_id(("picker", name));
        if takes_focus && ui.memory(|memory| memory.focused().is_none()) {
            ui.memory_mut(|memory| memory.request_focus(id));
        }
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        let mut picked = Picked { has_focus, ..Picked::default() };
        if has_focus {
            let pressed = |key| key_press::consume(ui.ctx(), Modifiers::NONE, key);
            picked.down = pressed(Key::ArrowDown);
            picked.entered = pressed(Key::Enter);
            let before = self.chosen;
            if picked.down {
                self.chosen += 1;
            }
            if pressed(Key::ArrowUp) {
                self.chosen = self.chosen.saturating_sub(1);
            }
            if pressed(Key::PageDown) {
                self.chosen += PAGE;
            }
            if pressed(Key::PageUp) {
                self.chosen = self.chosen.saturating_sub(PAGE);
            }
            self.moved |= self.chosen != before;
        }
        let field = TextEdit::singleline(&mut self.typed).id(id).hint_text(name).char_limit(80);
        // Menus have no padding above the text.
        let response = ui.add(field.desired_width(width).align(Align2::LEFT_CENTER));
        let typed = self.typed.clone();
        response.widget_info(|| WidgetInfo {
            label: Some(name.to_owned()),
            ..WidgetInfo::text_edit(true, typed.as_str(), typed.as_str(), name)
        });
        if response.changed() {
            (self.chosen, self.moved) = (0, true);
        }
        (response, picked)
    }

    /// Keeps the choice among that many matches.
    pub(crate) fn among(&mut self, count: usize) {
        self.chosen = self.chosen.min(count.saturating_sub(1));
    }

    /// Whether the match at that place is chosen.
    pub(crate) fn is_chosen(&self, at: usize) -> bool {
        self.chosen == at
    }

    /// Brings the row of the chosen match into view after the choice has moved.
    pub(crate) fn show(&mut self, at: usize, row: &Response) {
        if self.chosen == at && std::mem::take(&mut self.moved) {
            row.scroll_to_me(None::<Align>);
        }
    }

    /// Forgets what was typed.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}
