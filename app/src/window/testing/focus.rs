//! The keyboard focus: areas, Tab within them, menus by Alt, and what is scrolled into view.

use egui::{CentralPanel, Key, Modifiers, Panel, ScrollArea, Sense, Ui, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::super::command::Command;
use super::super::focus::{Area, Focus};
use super::super::keymap;
use super::super::keys::{self, MenuKeys};
use super::{Shown, screen_of};

#[derive(Default)]
struct Page {
    focus: Focus,
    menus: MenuKeys,
    asked: Vec<Command>,
}

/// The areas of the window with a few controls each.
fn page() -> Harness<'static, Shown<Page>> {
    screen_of(vec2(700.0, 400.0), Page::default(), show)
}

fn show(ui: &mut Ui, page: &mut Page) {
    let ctx = ui.ctx().clone();
    page.focus.begin_pass(&ctx);
    page.menus.begin_pass(&ctx);
    page.asked.extend(keys::pressed(&ctx, |_| true));
    let mut area = |ui: &mut Ui, of: Area, add: &mut dyn FnMut(&mut Ui)| {
        let begin = Focus::begin_area(ui);
        add(ui);
        page.focus.end_area(ui, of, begin);
    };
    let menus = &mut page.menus;
    area(ui, Area::Menu, &mut |ui| {
        Panel::top("menu").show(ui, |ui| {
            egui::MenuBar::new().ui(ui, |ui| keys::menus(ui, menus, |_| true));
        });
    });
    area(ui, Area::Timeline, &mut |ui| {
        Panel::bottom("timeline").resizable(false).show(ui, |ui| ui.button("Play"));
    });
    area(ui, Area::Left, &mut |ui| {
        Panel::left("left").exact_size(160.0).resizable(false).show(ui, |ui| {
            ScrollArea::vertical().show(ui, |ui| {
                for i in 0..40 {
                    let _ = ui.button(format!("Left {i}"));
                }
            });
        });
    });
    area(ui, Area::Right, &mut |ui| {
        Panel::right("right").exact_size(160.0).resizable(false).show(ui, |ui| {
            let _ = ui.button("Right 0");
            let _ = ui.button("Right 1");
        });
    });
    area(ui, Area::Page, &mut |ui| {
        CentralPanel::default().show(ui, |ui| {
            ui.allocate_exact_size(ui.available_size(), Sense::CLICK | Sense::DRAG);
        });
    });
    page.focus.end_pass(&ctx);
}

fn press(harness: &mut Harness<'_, Shown<Page>>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

/// The name of the control with the focus; empty for the image.
fn focused(harness: &Harness<'_, Shown<Page>>) -> String {
    use egui_kittest::kittest::NodeT;
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is not general enough")]
    let node = harness
        .query_all_by(|node| node.is_focused())
        .find(|node| node.accesskit_node().label().is_some_and(|label| !label.is_empty()));
    node.and_then(|node| node.accesskit_node().label()).unwrap_or_default()
}

#[test]
fn f6_goes_round_the_areas_and_tab_stays_in_one() {
    let mut harness = page();
    assert_eq!(focused(&harness), "");
    let mut seen = Vec::new();
    for _ in 0..6 {
        press(&mut harness, Modifiers::NONE, Key::F6);
        seen.push(focused(&harness));
    }
    // From the image on; nothing floats over it.
    assert_eq!(seen, ["Right 0", "Play", "File", "Left 0", "", "Right 0"]);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert_eq!(focused(&harness), "Right 1");
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert_eq!(focused(&harness), "Right 0", "Tab stays in the panel");
    press(&mut harness, Modifiers::SHIFT, Key::Tab);
    assert_eq!(focused(&harness), "Right 1");
    press(&mut harness, Modifiers::SHIFT, Key::F6);
    assert!(harness.state().state.focus.is_at_image());
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert_eq!(focused(&harness), "Right 1", "an area gives the focus back to the control that had it");
    assert!(harness.state().state.asked.is_empty(), "{:?}", harness.state().state.asked);
    // Escape leads back to the image, where Tab hides the panels.
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert_eq!(harness.state().state.asked, [Command::TogglePanels]);
    assert_eq!(focused(&harness), "");
}

#[test]
fn a_control_that_gets_the_focus_is_scrolled_into_view() {
    let mut harness = page();
    press(&mut harness, Modifiers::SHIFT, Key::F6);
    assert_eq!(focused(&harness), "Left 0");
    let bottom = |harness: &Harness<'_, Shown<Page>>| harness.get_by_label("Play").rect().top();
    // Backwards from the first to the last, far below.
    press(&mut harness, Modifiers::SHIFT, Key::Tab);
    assert_eq!(focused(&harness), "Left 39");
    harness.run_steps(3);
    let rect = harness.get_by_label("Left 39").rect();
    assert!(rect.bottom() <= bottom(&harness) + 1.0, "{rect}");
    press(&mut harness, Modifiers::NONE, Key::Tab);
    harness.run_steps(3);
    let rect = harness.get_by_label("Left 0").rect();
    assert!(rect.top() > 0.0, "{rect}");
}

#[test]
fn alt_and_a_letter_open_a_menu_and_run_nothing() {
    let mut harness = page();
    for (key, entry) in
        [(Key::F, "New project"), (Key::E, "Undo"), (Key::A, "Settle the hair"), (Key::H, "Start page")]
    {
        press(&mut harness, Modifiers::ALT, key);
        harness.run_steps(3);
        assert!(focused(&harness).starts_with(entry), "{key:?}: {}", focused(&harness));
        assert!(harness.state().state.asked.is_empty(), "{key:?}");
    }
    // The arrow keys go on to the next menu, round the end.
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    harness.run_steps(3);
    assert!(focused(&harness).starts_with("New project"), "{}", focused(&harness));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label_contains("New project").is_none());
}

#[test]
fn keys_with_further_modifiers_are_other_keys() {
    use super::super::command::{COMMANDS, Shortcut};
    let mut harness = page();
    let bound: Vec<Shortcut<'_>> =
        COMMANDS.iter().flat_map(|info| info.shortcuts).filter_map(|text| Shortcut::parse(text)).collect();
    for shortcut in &bound {
        if matches!(shortcut.key, "?" | "[" | "]" | "Tab" | "Plus") {
            continue;
        }
        let Some(key) = keymap::shortcut(shortcut.key).map(|known| known.logical_key) else {
            panic!("{}", shortcut.key)
        };
        for more in 1..8_u8 {
            let other = Shortcut {
                ctrl: shortcut.ctrl || more & 1 > 0,
                shift: shortcut.shift || more & 2 > 0,
                alt: shortcut.alt || more & 4 > 0,
                key: shortcut.key,
            };
            // Alt with some letters opens a menu.
            if bound.contains(&other) || (other.alt && !other.ctrl && !other.shift) {
                continue;
            }
            let modifiers = Modifiers {
                ctrl: other.ctrl,
                command: other.ctrl,
                shift: other.shift,
                alt: other.alt,
                ..Modifiers::NONE
            };
            press(&mut harness, modifiers, key);
            assert!(harness.state().state.asked.is_empty(), "{other:?}: {:?}", harness.state().state.asked);
        }
    }
}
