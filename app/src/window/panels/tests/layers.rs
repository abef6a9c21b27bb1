//! The panel of layers: adding, switching, weighting, moving, renaming and grouping them, masks, ramps and keys.

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_style::operations::{Curl, Dye, Length, Melanin, Wave};
use lovelock_style::{Layer, MaskRegion, Operation, Ramp, StyleStack};

use super::{Bench, panel};
use crate::window::pointer_tool::PointerTool;
use crate::window::search::{best_first, fit};
use crate::window::testing::{
    Shown, click_at, control, controls, double_click, drag, is_marked, texts, type_at, unfold,
};

/// The text of the handles by which layers are dragged.
const GRIP: &str = egui_material_icons::icons::ICON_DRAG_INDICATOR.codepoint;
const COMMAND: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

type Panel = Harness<'static, Shown<Bench>>;

fn with_layers() -> Panel {
    let mut project = Project::default();
    for operation in [Operation::from(Length::default()), Wave::default().into(), Curl::default().into()] {
        project.hair.stack.push(Layer::of(operation));
    }
    panel("Layers", project)
}

fn stack(harness: &Panel) -> &StyleStack {
    &harness.state().state.project.hair.stack
}

fn kinds(harness: &Panel) -> Vec<&str> {
    stack(harness).layers.iter().map(|layer| layer.operation.id()).collect()
}

fn names(harness: &Panel) -> Vec<String> {
    stack(harness).layers.iter().map(|layer| layer.label().to_owned()).collect()
}

fn selected(harness: &Panel) -> Option<&str> {
    let id = harness.state().state.panels.layers.selected?;
    stack(harness).layer(id).map(|layer| layer.operation.id())
}

fn click(harness: &mut Panel, name: &str) {
    let at = harness.get_all_by_label(name).next().expect("the control").rect().center();
    click_at(harness, at);
}

fn key(harness: &mut Panel, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn write(harness: &mut Panel, text: &str) {
    harness.key_press_modifiers(COMMAND, Key::A);
    harness.run();
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run();
}

/// Waits until a click is not part of a double-click with the one before.
fn calm(harness: &mut Panel) {
    harness.run_steps(20);
}

/// Opens the context menu of a row and chooses an entry.
fn choose(harness: &mut Panel, row: &str, entry: &str) {
    harness.get_all_by_label(row).next().expect("the row").click_secondary();
    harness.run();
    let found = harness.query_all_by_label_contains(entry).next().expect("the entry").rect().center();
    click_at(harness, found);
}

#[test]
fn a_layer_is_added_from_the_menu_and_selected() {
    let mut harness = panel("Layers", Project::default());
    for name in ["Add layer", "Strands", "Curl"] {
        let found = harness.query_all_by_label_contains(name).next().expect("an entry").rect().center();
        click_at(&mut harness, found);
    }
    assert_eq!(kinds(&harness), ["curl"]);
    assert_eq!(harness.state().state.panels.layers.selected, Some(stack(&harness).layers[0].id));
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Pitch").is_some(), "its controls are shown");
}

#[test]
fn layers_of_pigment_offer_the_natural_colours() {
    let mut project = Project::default();
    project.hair.stack.push(Layer::of(Melanin::default()));
    project.hair.stack.push(Layer::of(Dye::default()));
    let mut harness = panel("Layers", project);
    click(&mut harness, "Natural colour");
    click(&mut harness, "Blonde");
    let Operation::Melanin(melanin) = &stack(&harness).layers[0].operation else { panic!("its kind") };
    assert_eq!((melanin.eumelanin, melanin.pheomelanin), (0.3, 0.05));
    assert!(harness.query_all_by_label("Grey").next().is_none(), "grey is no pigment");
    click(&mut harness, "Dye");
    assert!(harness.query_all_by_label("Blonde").next().is_none(), "a dye has none");
    assert!(harness.query_all_by_label("Bleach first").next().is_some());
}

#[test]
fn the_menu_of_layers_is_searched() {
    let mut harness = with_layers();
    click(&mut harness, "Wave");
    click(&mut harness, "Add layer");
    let field = control(&harness, Role::TextInput, "Search layers").rect().center();
    click_at(&mut harness, field);
    harness.event(egui::Event::Text("fRiz".to_owned()));
    harness.run();
    assert!(harness.query_by_label("Braid").is_none(), "others are left out");
    let field = control(&harness, Role::TextInput, "Search layers").rect().center();
    let typed = texts(&harness).into_iter().find(|(text, ..)| text == "fRiz").expect("the text").1.center();
    assert!((typed.y - field.y).abs() < 3.0, "{typed} in the middle of the field at {field}");
    click(&mut harness, "Frizz");
    assert_eq!(kinds(&harness), ["length", "wave", "frizz", "curl"], "after the selected one");
    assert_eq!(selected(&harness), Some("frizz"));
}

#[test]
fn the_search_of_layers_is_used_by_keys_alone() {
    let mut harness = with_layers();
    let before = kinds(&harness).len();
    click(&mut harness, "Add layer");
    harness.event(egui::Event::Text("curl".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(kinds(&harness).len(), before + 1);
    assert_eq!(selected(&harness), Some("curl"), "the exact name comes first");
    assert!(harness.query_by_label("Search layers").is_none(), "the menu is closed");
    // The arrow keys choose another match, and Escape adds nothing.
    click(&mut harness, "Add layer");
    harness.event(egui::Event::Text("st".to_owned()));
    harness.run();
    harness.key_press(Key::ArrowDown);
    harness.run();
    harness.key_press(Key::ArrowUp);
    harness.key_press(Key::ArrowDown);
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    let second = best_first("st", lovelock_style::Operation::KINDS, |typed, kind| {
        fit(typed, kind.label, &[kind.text])
    })[1];
    assert_eq!(selected(&harness), Some(second.id));
    let count = kinds(&harness).len();
    click(&mut harness, "Add layer");
    harness.event(egui::Event::Text("curl".to_owned()));
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(kinds(&harness).len(), count);
}

#[test]
fn layers_are_switched_weighted_and_heard_alone() {
    let mut harness = with_layers();
    click(&mut harness, "Layer on");
    assert!(!stack(&harness).layers[0].on && stack(&harness).layers[1].on);
    click(&mut harness, "S");
    assert_eq!(stack(&harness).solo, Some(stack(&harness).layers[0].id));
    click(&mut harness, "S");
    assert_eq!(stack(&harness).solo, None);
    click(&mut harness, "Wave");
    let at = control(&harness, Role::SpinButton, "Wave height").rect().center();
    type_at(&mut harness, at, "25");
    let Operation::Wave(wave) = &stack(&harness).layers[1].operation else { panic!("a wave") };
    assert!((wave.height - 0.025).abs() < 1e-6, "{}", wave.height);
    let weight = harness.get_all_by_label("Layer weight").nth(1).expect("a weight").rect().center();
    type_at(&mut harness, weight, "40");
    assert!((stack(&harness).layers[1].weight - 0.4).abs() < 1e-6);
    type_at(&mut harness, weight, "words");
    assert!((stack(&harness).layers[1].weight - 0.4).abs() < 1e-6);
    harness.key_press(Key::Escape);
    harness.run();
    double_click(&mut harness, weight);
    assert_eq!(stack(&harness).layers[1].weight, 1.0, "a double-click restores it");
}

#[test]
fn columns_stand_below_each_other_and_nothing_moves() {
    let mut harness = with_layers();
    let columns = |harness: &Panel, role: Role, name: &str| -> Vec<(f32, f32)> {
        let found = controls(harness, role).into_iter().filter(|(label, _)| label == name);
        found.map(|(_, rect)| (rect.left(), rect.right())).collect()
    };
    let before = columns(&harness, Role::SpinButton, "Layer weight");
    assert_eq!(before.len(), 3);
    assert!(before.iter().all(|column| *column == before[0]), "{before:?}");
    let tops: Vec<f32> = harness.get_all_by_label(GRIP).map(|node| node.rect().top()).collect();
    harness.state_mut().state.project.hair.stack.layers[1].name = "A very long name ".repeat(4);
    harness.state_mut().state.project.hair.stack.layers[2].mask.inverted = true;
    harness.run();
    assert_eq!(columns(&harness, Role::SpinButton, "Layer weight"), before);
    let row = harness.get_all_by_label("Length").next().expect("a row").rect().center();
    double_click(&mut harness, row);
    assert_eq!(columns(&harness, Role::SpinButton, "Layer weight"), before, "while one is renamed");
    let now: Vec<f32> = harness.get_all_by_label(GRIP).map(|node| node.rect().top()).collect();
    assert_eq!(now, tops);
}

#[test]
fn a_layer_is_dragged_to_another_place() {
    let mut harness = with_layers();
    let grips: Vec<_> = harness.get_all_by_label(GRIP).map(|node| node.rect()).collect();
    assert_eq!(grips.len(), 3);
    drag(&mut harness, grips[2].center(), grips[0].center_top());
    assert_eq!(kinds(&harness), ["curl", "length", "wave"]);
    let last = harness.get_all_by_label(GRIP).last().expect("a grip").rect();
    drag(&mut harness, grips[0].center(), last.center_bottom());
    assert_eq!(kinds(&harness), ["length", "wave", "curl"]);
}

#[test]
fn a_double_click_renames_and_escape_keeps_the_name() {
    let mut harness = with_layers();
    let row = harness.get_all_by_label("Wave").next().expect("a row").rect().center();
    double_click(&mut harness, row);
    write(&mut harness, "Beach");
    assert_eq!(names(&harness)[1], "Wave", "not before it is entered");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(names(&harness), ["Length", "Beach", "Curl"]);
    double_click(&mut harness, row);
    write(&mut harness, "Other");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    harness.run();
    assert_eq!(names(&harness), ["Length", "Beach", "Curl"]);
    double_click(&mut harness, row);
    write(&mut harness, "Wave");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(stack(&harness).layers[1].name, "", "the name of the operation is no name of its own");
}

#[test]
fn keys_move_the_selection_and_duplicate_group_and_remove_layers() {
    let mut harness = with_layers();
    key(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(kinds(&harness).len(), 3, "not before the list is clicked");
    click(&mut harness, "Length");
    key(&mut harness, Modifiers::NONE, Key::ArrowDown);
    assert_eq!(selected(&harness), Some("wave"));
    key(&mut harness, Modifiers::NONE, Key::ArrowUp);
    key(&mut harness, Modifiers::NONE, Key::ArrowUp);
    assert_eq!(selected(&harness), Some("length"));
    key(&mut harness, COMMAND, Key::D);
    assert_eq!(kinds(&harness), ["length", "length", "wave", "curl"]);
    key(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(kinds(&harness), ["length", "wave", "curl"]);
    assert_eq!(selected(&harness), Some("wave"), "the one that takes its place");
    // Several at once.
    click(&mut harness, "Length");
    let curl = harness.get_all_by_label("Curl").next().expect("a row").rect().center();
    harness.event_modifiers(egui::Event::PointerMoved(curl), COMMAND);
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        let event = egui::Event::PointerButton { pos: curl, button, pressed, modifiers: COMMAND };
        harness.event_modifiers(event, COMMAND);
    }
    harness.run();
    key(&mut harness, COMMAND, Key::G);
    assert_eq!(kinds(&harness), ["length", "curl", "wave"]);
    assert_eq!(stack(&harness).groups.len(), 1);
    key(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(kinds(&harness), ["wave"]);
    // A click elsewhere takes the keys from the list.
    click(&mut harness, "Wave");
    let at = control(&harness, Role::SpinButton, "Wave height").rect().center();
    click_at(&mut harness, at);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(kinds(&harness), ["wave"]);
}

#[test]
fn groups_are_renamed_folded_heard_alone_and_removed() {
    let mut harness = with_layers();
    choose(&mut harness, "Wave", "Group");
    let group = stack(&harness).layers[1].group.expect("a group");
    calm(&mut harness);
    let at = control(&harness, Role::Button, "Group").rect().center();
    double_click(&mut harness, at);
    write(&mut harness, "Texture");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(stack(&harness).groups[0].name, "Texture");
    let rows = |harness: &Panel| harness.get_all_by_label(GRIP).count();
    assert_eq!(rows(&harness), 4);
    click(&mut harness, "Fold the group");
    assert_eq!(rows(&harness), 3);
    click(&mut harness, "Fold the group");
    let solos: Vec<_> = harness.get_all_by_label("S").map(|node| node.rect().center()).collect();
    click_at(&mut harness, solos[1]);
    assert_eq!((stack(&harness).solo_group, stack(&harness).solo), (Some(group), None));
    click_at(&mut harness, solos[0]);
    assert_eq!(stack(&harness).solo_group, None, "one layer or group is soloed");
    // A layer is dragged into the group and the group over the first layer.
    let grips: Vec<_> = harness.get_all_by_label(GRIP).map(|node| node.rect()).collect();
    drag(&mut harness, grips[3].center(), grips[1].center_bottom());
    assert_eq!(kinds(&harness), ["length", "curl", "wave"]);
    assert_eq!(stack(&harness).layers[1].group, Some(group));
    drag(&mut harness, grips[1].center(), grips[0].center_top());
    assert_eq!(kinds(&harness), ["curl", "wave", "length"]);
    let before = harness.state().state.project.clone();
    choose(&mut harness, "Texture", "Ungroup");
    assert_eq!((kinds(&harness).len(), stack(&harness).groups.len()), (3, 0));
    harness.state_mut().state.project = before;
    harness.run();
    choose(&mut harness, "Texture", "Remove with its layers");
    assert_eq!(kinds(&harness), ["length"]);
}

#[test]
fn points_of_a_ramp_are_added_dragged_and_removed() {
    let mut harness = with_layers();
    click(&mut harness, "Length");
    unfold(&mut harness);
    // Sections open slowly.
    harness.run_steps(30);
    let rect = harness.query_all_by_role(Role::Canvas).last().expect("a curve").rect();
    let ramp = |harness: &Panel| stack(harness).layers[0].ramp.clone();
    assert_eq!(ramp(&harness).points, [[0.0, 1.0]]);
    let at = rect.lerp_inside(egui::vec2(0.8, 0.85));
    click_at(&mut harness, at);
    let [_, added] = ramp(&harness).points[..] else { panic!("two points") };
    assert!((added[0] - 0.8).abs() < 0.05 && added[1] < 0.4, "{added:?}");
    assert!(is_marked(&harness, "Strength along the hair"));
    drag(&mut harness, at, rect.lerp_inside(egui::vec2(0.4, 0.2)));
    let moved = ramp(&harness).points[1];
    assert!((moved[0] - 0.4).abs() < 0.05 && moved[1] > 1.4, "{moved:?}");
    // Keys move the point that has the focus, and its numbers can be typed.
    harness.key_press(Key::ArrowRight);
    harness.run();
    assert!((ramp(&harness).points[1][0] - moved[0] - 0.01).abs() < 1e-5);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    harness.run();
    assert!((ramp(&harness).points[1][1] - moved[1] + 0.2).abs() < 1e-5);
    let number = control(&harness, Role::SpinButton, "Value").rect().center();
    type_at(&mut harness, number, "75");
    assert!((ramp(&harness).points[1][1] - 0.75).abs() < 1e-5);
    // A point that is dropped below the curve goes, and so does one by its key.
    let handle = control(&harness, Role::Slider, "Strength along the hair, point 2").rect().center();
    drag(&mut harness, handle, handle + egui::vec2(0.0, 160.0));
    assert_eq!(ramp(&harness).points.len(), 1);
    click_at(&mut harness, at);
    let handle = control(&harness, Role::Slider, "Strength along the hair, point 2").rect().center();
    click_at(&mut harness, handle);
    harness.key_press(Key::Delete);
    harness.run();
    assert_eq!(ramp(&harness).points.len(), 1);
    assert_eq!(kinds(&harness).len(), 3, "the layer stays");
    // A double-click restores the default, also where its first click adds a point.
    click_at(&mut harness, at);
    calm(&mut harness);
    double_click(&mut harness, rect.lerp_inside(egui::vec2(0.3, 0.6)));
    assert_eq!(ramp(&harness), Ramp::default());
    assert!(!is_marked(&harness, "Strength along the hair"));
}

#[test]
fn presets_of_a_ramp_are_offered() {
    let mut harness = with_layers();
    click(&mut harness, "Length");
    unfold(&mut harness);
    harness.run_steps(30);
    click(&mut harness, "Presets of Strength along the hair");
    click(&mut harness, "Bell");
    let ramp = &stack(&harness).layers[0].ramp;
    assert_eq!((ramp.at(0.0), ramp.at(0.5), ramp.at(1.0)), (0.0, 1.0, 0.0));
}

#[test]
fn a_mask_is_made_of_regions() {
    let mut harness = with_layers();
    click(&mut harness, "Curl");
    unfold(&mut harness);
    click(&mut harness, "Add region");
    assert_eq!(stack(&harness).layers[2].mask.parts.len(), 1);
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Border").is_some());
    click(&mut harness, "Invert all");
    assert!(stack(&harness).layers[2].mask.inverted);
    click(&mut harness, "Remove");
    assert!(stack(&harness).layers[2].mask.parts.is_empty());
}

#[test]
fn the_mask_is_shown_and_filled() {
    let mut harness = with_layers();
    click(&mut harness, "Curl");
    unfold(&mut harness);
    let shown = |harness: &Panel| harness.state().state.panels.layers.shown_mask(stack(harness)).cloned();
    assert_eq!(shown(&harness), None);
    click(&mut harness, "Show mask");
    assert_eq!(shown(&harness), Some(stack(&harness).layers[2].mask.clone()));
    click(&mut harness, "Show mask");
    assert_eq!(shown(&harness), None);
    click(&mut harness, "Paint");
    assert!(
        harness.state().state.tool == PointerTool::Mask && shown(&harness).is_some(),
        "painting shows it"
    );
    click(&mut harness, "Fill");
    let part = &stack(&harness).layers[2].mask.parts[0];
    assert_eq!((&part.region, part.map.at(glam::Vec3::Y)), (&MaskRegion::Painted, 1.0));
    click(&mut harness, "Turn round");
    assert!(stack(&harness).layers[2].mask.parts[0].map.is_empty());
}
