//! Popups that hold controls.
//!
//! egui remembers a single open popup, so a list or a colour that is opened inside one of its menus closes the menu. These popups remember
//! themselves whether they are open, and what is opened inside them is the popup that egui remembers.

use egui::{Context, Id, Popup, PopupCloseBehavior, Pos2, Response, Ui};

/// The state of one popup, dropped when it has not been shown for a pass.
#[derive(Clone, Copy, Default)]
struct State {
    open: bool,
    /// Where a context menu was opened.
    at: Option<Pos2>,
    pass: u64,
    /// Whether a text or a number was being typed in the last pass.
    typing: bool,
}

/// Shows controls below `button` after a click on it, until a click beside them, Escape outside of a text, or `Ui::close`.
pub(crate) fn popup<R>(button: &Response, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    show(button, None, button.clicked(), content)
}

/// Shows controls where `response` is clicked with the secondary button; closed like [`popup`], and by a click on `response`.
pub(crate) fn context_popup<R>(response: &Response, content: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    let at = response.interact_pointer_pos().filter(|_| response.secondary_clicked());
    show(response, at, false, content)
}

/// Whether a popup, a menu or a list is open.
pub(crate) fn is_any_open(ctx: &Context) -> bool {
    let shown: Option<u64> = ctx.data(|data| data.get_temp(last_shown()));
    Popup::is_any_open(ctx) || shown.is_some_and(|pass| pass + 1 >= ctx.cumulative_pass_nr())
}

/// Closes every popup, menu and list. Comes before they are shown.
pub(crate) fn close_all(ctx: &Context) {
    Popup::close_all(ctx);
    let pass = ctx.cumulative_pass_nr();
    ctx.data_mut(|data| data.insert_temp(last_closed(), pass));
}

/// Where the last pass that closed all popups is stored.
fn last_closed() -> Id {
    Id::unique("popups of controls closed")
}

/// Where the last pass that showed a popup is stored.
fn last_shown() -> Id {
    Id::unique("popup of controls shown")
}

fn show<R>(
    response: &Response,
    opened_at: Option<Pos2>,
    toggled: bool,
    content: impl FnOnce(&mut Ui) -> R,
) -> Option<R> {
    let ctx = &response.ctx;
    let id = response.id.with("popup of controls");
    let pass = ctx.cumulative_pass_nr();
    let mut state: State = ctx.data(|data| data.get_temp(id)).unwrap_or_default();
    let closed: Option<u64> = ctx.data(|data| data.get_temp(last_closed()));
    state.open &= state.pass + 1 >= pass && closed != Some(pass);
    state.open ^= toggled;
    if opened_at.is_some() {
        (state.open, state.at) = (true, opened_at);
    }
    if !state.open {
        ctx.data_mut(|data| data.remove::<State>(id));
        return None;
    }
    // A click or Escape that closes a list inside leaves the popup open, and Escape that ends typing does.
    let has_inner = Popup::is_any_open(ctx);
    let ends_typing = state.typing && ctx.input(|input| input.key_pressed(egui::Key::Escape));
    let mut open = true;
    let mut menu = Popup::menu(response)
        .id(id.with("area"))
        .open_bool(&mut open)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    if let Some(at) = state.at {
        menu = menu.at_position(at);
    }
    let shown = menu.show(|ui| {
        let result = content(ui);
        (result, ui.will_parent_close())
    });
    let (result, is_done) = shown.map(|shown| shown.inner).unzip();
    state.open = (open || has_inner || ends_typing) && is_done != Some(true);
    (state.pass, state.typing) = (pass, ctx.text_edit_focused());
    ctx.data_mut(|data| {
        if state.open {
            data.insert_temp(id, state);
            data.insert_temp(last_shown(), pass);
        } else {
            data.remove::<State>(id);
        }
    });
    result
}

#[cfg(test)]
mod tests {
    use egui::accesskit::Role;
    use egui::{Color32, ComboBox, Key};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use crate::window::testing::{Shown, choose_in_popup, click, control, screen_of};

    #[derive(Default)]
    struct Bench {
        choice: usize,
        colour: Color32,
        count: u32,
        number: f32,
    }

    fn contents(ui: &mut Ui, bench: &mut Bench) {
        ui.set_width(200.0);
        let list =
            ComboBox::from_id_salt("list").show_index(ui, &mut bench.choice, 3, |i| format!("Entry {i}"));
        list.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "List"));
        let colour = ui.color_edit_button_srgba(&mut bench.colour);
        colour.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Colour"));
        if ui.button("Count").clicked() {
            bench.count += 1;
        }
        let number = ui.add(egui::DragValue::new(&mut bench.number).update_while_editing(false));
        number.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, "Number"));
        ui.button("More").context_menu(|ui| {
            if ui.button("Count twice").clicked() {
                bench.count += 2;
                ui.close();
            }
        });
        if ui.button("Done").clicked() {
            ui.close();
        }
    }

    fn bench() -> Harness<'static, Shown<Bench>> {
        screen_of(egui::vec2(700.0, 700.0), Bench::default(), |ui, bench: &mut Bench| {
            let button = ui.button("Settings");
            popup(&button, |ui| contents(ui, bench));
            ui.add_space(300.0);
            let area = ui.button("An area of the image");
            context_popup(&area, |ui| contents(ui, bench));
        })
    }

    fn press(harness: &mut Harness<'_, Shown<Bench>>, name: &str) {
        let at = control(harness, Role::Button, name).rect().center();
        click(harness, at);
    }

    fn is_open(harness: &Harness<'_, Shown<Bench>>) -> bool {
        harness.query_by_role_and_label(Role::Button, "Count").is_some()
    }

    fn lists_and_colours_leave_it_open(harness: &mut Harness<'_, Shown<Bench>>) {
        assert!(is_open(harness));
        choose_in_popup(harness, "List", "Entry 2");
        assert_eq!(harness.state().state.choice, 2);
        // A click beside an open list closes the list alone.
        let list = control(harness, Role::ComboBox, "List").rect().center();
        click(harness, list);
        click(harness, egui::pos2(690.0, 690.0));
        assert!(is_open(harness) && harness.query_by_role_and_label(Role::Button, "Entry 1").is_none());
        press(harness, "Colour");
        assert!(is_open(harness));
        harness.key_press(Key::Escape);
        harness.run();
        assert!(is_open(harness), "Escape closes the colours alone");
        let more = control(harness, Role::Button, "More").rect().center();
        harness.hover_at(more);
        harness.get_by_role_and_label(Role::Button, "More").click_secondary();
        harness.run();
        press(harness, "Count twice");
        press(harness, "Count");
        assert_eq!(harness.state().state.count, 3);
        assert!(is_open(harness) && is_any_open(&harness.ctx));
    }

    #[test]
    fn lists_colours_and_menus_inside_leave_a_popup_open() {
        let mut harness = bench();
        assert!(!is_open(&harness) && !is_any_open(&harness.ctx));
        press(&mut harness, "Settings");
        lists_and_colours_leave_it_open(&mut harness);
        // Each of these closes it.
        for close in 0..4 {
            assert!(is_open(&harness), "{close}");
            match close {
                0 => press(&mut harness, "Done"),
                1 => press(&mut harness, "Settings"),
                2 => {
                    harness.key_press(Key::Escape);
                    harness.run();
                }
                _ => click(&mut harness, egui::pos2(690.0, 690.0)),
            }
            assert!(!is_open(&harness), "{close}");
            harness.run_steps(2);
            assert!(!is_any_open(&harness.ctx));
            press(&mut harness, "Settings");
        }
    }

    #[test]
    fn escape_in_a_number_ends_typing_alone() {
        let mut harness = bench();
        press(&mut harness, "Settings");
        let at = control(&harness, Role::SpinButton, "Number").rect().center();
        click(&mut harness, at);
        harness.event(egui::Event::Text("7".to_owned()));
        harness.run();
        harness.key_press(Key::Escape);
        harness.run();
        assert!(is_open(&harness), "the first one ends typing");
        harness.key_press(Key::Escape);
        harness.run();
        assert!(!is_open(&harness), "the next one closes the popup");
    }

    #[test]
    fn popups_are_closed_from_outside() {
        let mut harness = screen_of(egui::vec2(700.0, 700.0), Bench::default(), |ui, bench: &mut Bench| {
            if ui.input(|input| input.key_pressed(Key::F6)) {
                close_all(ui.ctx());
            }
            let button = ui.button("Settings");
            popup(&button, |ui| contents(ui, bench));
        });
        for _ in 0..2 {
            press(&mut harness, "Settings");
            assert!(is_open(&harness));
            harness.key_press(Key::F6);
            harness.run();
            assert!(!is_open(&harness));
        }
    }

    #[test]
    fn a_popup_at_the_pointer_holds_lists_too() {
        let mut harness = bench();
        harness.get_by_label("An area of the image").click_secondary();
        harness.run();
        lists_and_colours_leave_it_open(&mut harness);
        click(&mut harness, egui::pos2(690.0, 690.0));
        assert!(!is_open(&harness));
    }

    /// Negative control: what egui's own menu does.
    #[test]
    fn a_list_closes_a_menu_of_egui() {
        let mut harness = screen_of(egui::vec2(700.0, 700.0), Bench::default(), |ui, bench: &mut Bench| {
            let config = egui::containers::menu::MenuConfig::new()
                .close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            let button = egui::containers::menu::MenuButton::new("Settings").config(config);
            button.ui(ui, |ui| contents(ui, bench));
        });
        press(&mut harness, "Settings");
        assert!(is_open(&harness));
        let list = control(&harness, Role::ComboBox, "List").rect().center();
        click(&mut harness, list);
        assert!(!is_open(&harness), "egui remembers several popups now: use its menus");
    }
}
