//! Panels that are moved: between the columns, over the image, and into the second window.

use egui::accesskit::Role;
use egui::{Pos2, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable};

use super::whole::{Whole, go, of, project, window};
use super::{control, press};
use crate::window::command::Command;
use crate::window::dock::{Place, Spot};
use crate::window::shelf::{Panels, Side};
use crate::window::{Layout, Window};

fn with<T>(harness: &mut Whole, change: impl FnOnce(&mut Window, &egui::Context) -> T) -> T {
    let ctx = harness.ctx.clone();
    change(harness.state_mut().state.as_mut().expect("a window"), &ctx)
}

fn header(harness: &Whole, title: &str) -> Rect {
    control(harness, Role::DisclosureTriangle, title).rect()
}

/// The window with all panels folded, so that all headers are visible.
fn folded() -> Whole {
    let mut harness = window();
    for title in Panels::usual().iter().flatten() {
        let node = harness.query_by_role_and_label(Role::DisclosureTriangle, title);
        if let Some(node) = node.filter(|node| node.accesskit_node().data().is_expanded() == Some(true)) {
            node.click_accesskit();
            go(&mut harness);
        }
    }
    harness
}

fn spot(harness: &Whole, title: &str) -> Spot {
    of(harness).layout.dock.spot(title, Panels::usual())
}

fn move_to(harness: &mut Whole, title: &'static str, place: Place) {
    with(harness, |window, _| window.layout.dock.set(title, place, Panels::usual()));
    go(harness);
}

fn drag(harness: &mut Whole, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(2);
    press(harness, from, true);
    harness.run_steps(2);
    for i in 1..=6 {
        harness.hover_at(from + (to - from) * (i as f32 / 6.0));
        harness.run_steps(1);
    }
    press(harness, to, false);
    go(harness);
}

#[test]
fn a_panel_is_dragged_by_its_header_and_reset() {
    let mut harness = folded();
    let usual = Panels::usual().clone();
    assert_eq!(of(&harness).layout.dock.columns(Panels::usual()), usual);
    let before = header(&harness, "Camera");
    let from = pos2(before.left() + 60.0, before.center().y);
    // Below the first panel of the other column.
    let hair = header(&harness, "Hairstyle");
    let below = header(&harness, "Layers");
    assert!(hair.top() < below.top());
    drag(&mut harness, from, pos2(below.center().x, below.top() + 2.0));
    assert_eq!(spot(&harness, "Camera"), Spot::Column(Side::Left));
    let camera = header(&harness, "Camera");
    assert!(camera.right() < before.left() && camera.top() < header(&harness, "Layers").top());
    assert!(camera.top() > header(&harness, "Hairstyle").top());
    assert_eq!(of(&harness).document.history().undo_len(), 0, "the project is unchanged");
    // Back to its place within the column, and over the image.
    let from = pos2(camera.left() + 60.0, camera.center().y);
    drag(&mut harness, from, pos2(600.0, 300.0));
    assert_eq!(spot(&harness, "Camera"), Spot::Floating);
    assert!(harness.query_by_role_and_label(Role::DisclosureTriangle, "Camera").is_none());
    assert!(harness.query_all_by_label("Camera").count() > 0, "its title is on the window");
    with(&mut harness, |window, ctx| window.run(Command::ResetLayout, ctx));
    go(&mut harness);
    assert_eq!(of(&harness).layout.dock.columns(Panels::usual()), usual);
    assert_eq!(header(&harness, "Camera"), before, "as at the start");
    let layout = of(&harness).stored_layout();
    assert_eq!(layout.dock, Layout::default().dock);
}

#[test]
fn a_click_on_a_header_folds_and_a_column_may_be_empty() {
    let mut harness = folded();
    let at = header(&harness, "Statistics");
    let is_open = |harness: &Whole| {
        control(harness, Role::DisclosureTriangle, "Statistics").accesskit_node().data().is_expanded()
    };
    let before = is_open(&harness);
    super::click_at(&mut harness, pos2(at.left() + 40.0, at.center().y));
    assert_ne!(is_open(&harness), before);
    let image = control(&harness, Role::Image, "Viewport").rect();
    for title in Panels::usual()[1].clone() {
        move_to(&mut harness, title, Place::Above(Side::Left, None));
    }
    let wider = control(&harness, Role::Image, "Viewport").rect();
    assert!(wider.width() > image.width() + 250.0, "the image takes the place of the column");
    // The column opens again where a panel is dropped at the edge.
    let camera = header(&harness, "Hairstyle");
    drag(&mut harness, pos2(camera.left() + 60.0, camera.center().y), pos2(1195.0, 300.0));
    assert_eq!(spot(&harness, "Hairstyle"), Spot::Column(Side::Right));
    assert!(header(&harness, "Hairstyle").left() > 600.0);
}

#[test]
fn the_second_window_holds_panels_in_tabs_and_gives_them_back() {
    let mut harness = window();
    move_to(&mut harness, "Light", Place::Second);
    move_to(&mut harness, "Simulation", Place::Second);
    for title in ["Light", "Simulation"] {
        assert_eq!(spot(&harness, title), Spot::Second);
        assert!(harness.query_by_role_and_label(Role::DisclosureTriangle, title).is_none(), "{title}");
        assert!(harness.query_by_role_and_label(Role::Button, title).is_some(), "{title} has a tab");
    }
    // What is stored is shown again.
    let stored = of(&harness).stored_layout();
    let text = serde_json::to_string(&stored).expect("text");
    let read: Layout = serde_json::from_str(&text).expect("a layout");
    assert_eq!(read, stored);
    // Hidden panels: the second window stays.
    with(&mut harness, |window, ctx| window.run(Command::TogglePanels, ctx));
    go(&mut harness);
    assert!(harness.query_by_role_and_label(Role::DisclosureTriangle, "Hairstyle").is_none());
    assert!(harness.query_by_role_and_label(Role::Button, "Light").is_some());
    with(&mut harness, |window, ctx| window.run(Command::TogglePanels, ctx));
    go(&mut harness);
    // The control of a setting is found behind a tab.
    let info = &crate::window::control::entry::<lovelock_simulation::SimulationSettings>("bend_damping").info;
    with(&mut harness, |window, ctx| {
        window.layout.panels_hidden = false;
        crate::window::control::reveal(ctx, info);
    });
    harness.run_steps(40);
    assert!(harness.query_all_by_label(info.label).count() > 0, "{}", info.label);
    // Closing a tab docks the panel.
    let close = harness.query_all_by_role_and_label(Role::Button, "Close").next().expect("a button");
    let at = close.rect().center();
    super::click_at(&mut harness, at);
    let left = ["Light", "Simulation"].map(|title| spot(&harness, title));
    assert_eq!(left.iter().filter(|spot| **spot == Spot::Second).count(), 1, "{left:?}");
    with(&mut harness, |window, ctx| window.run(Command::ResetLayout, ctx));
    go(&mut harness);
    assert!(!of(&harness).layout.dock.has_second());
    let _ = header(&harness, "Light");
}

#[test]
fn a_floating_panel_edits_in_one_undo_step_and_its_button_docks_it() {
    let mut harness = window();
    move_to(&mut harness, "Sound", Place::Floating(Some(pos2(420.0, 120.0))));
    move_to(&mut harness, "Simulation", Place::Floating(None));
    assert_eq!(spot(&harness, "Simulation"), Spot::Floating);
    let steps = of(&harness).document.history().undo_len();
    let before = project(&harness);
    let slider = super::controls(&harness, Role::Slider).into_iter().map(|(_, rect)| rect).find(|rect| {
        rect.left() > 320.0 && rect.right() < 880.0 && rect.top() > 90.0 && rect.bottom() < 560.0
    });
    if let Some(rect) = slider {
        drag(&mut harness, rect.center(), rect.center() + vec2(30.0, 0.0));
        assert!(project(&harness) != before);
        assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
    }
    with(&mut harness, |window, _| {
        let usual = Panels::usual();
        window.layout.dock.set("Simulation", Place::Usual, usual);
        window.layout.dock.set("Sound", Place::Usual, usual);
    });
    go(&mut harness);
    assert_eq!(of(&harness).layout.dock, Layout::default().dock);
}

#[test]
fn panels_have_names_for_screen_readers_in_a_column_and_floating() {
    let mut harness = window();
    assert!(harness.query_by_role_and_label(Role::Group, "Hairstyle").is_some());
    assert!(harness.query_by_role_and_label(Role::Group, "Sound").is_none(), "it is folded");
    move_to(&mut harness, "Sound", Place::Floating(None));
    for role in [Role::Window, Role::Group] {
        assert!(harness.query_by_role_and_label(role, "Sound").is_some(), "{role:?}");
    }
}

#[test]
fn the_menu_lists_the_places_of_all_panels() {
    let mut harness = window();
    super::whole::press_button(&mut harness, "Panels");
    for title in Panels::usual().iter().flatten() {
        for place in ["Left column", "Right column", "Floating", "Second window"] {
            let name = format!("{title}: {place}");
            assert!(harness.query_by_role_and_label(Role::RadioButton, &name).is_some(), "{name}");
        }
    }
    control(&harness, Role::RadioButton, "Light: Floating").click();
    go(&mut harness);
    assert_eq!(spot(&harness, "Light"), Spot::Floating);
}
