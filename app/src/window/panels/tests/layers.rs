//! The panel of layers: adding, switching, weighting and moving them, masks and ramps.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_style::operations::{Curl, Dye, Length, Melanin, Wave};
use lovelock_style::{Layer, Operation, StyleStack};

use super::{Bench, panel};
use crate::window::testing::{Shown, click_at, control, double_click, drag, type_at, unfold};

/// The text of the handles by which layers are dragged.
const GRIP: &str = egui_material_icons::icons::ICON_DRAG_INDICATOR.codepoint;

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

fn click(harness: &mut Panel, name: &str) {
    let at = harness.get_all_by_label(name).next().expect("the control").rect().center();
    click_at(harness, at);
}

#[test]
fn a_layer_is_added_from_the_menu_and_selected() {
    let mut harness = panel("Layers", Project::default());
    for name in ["Add layer", "Strands", "Curl"] {
        let found = harness.query_all_by_label_contains(name).next().expect("an entry").rect().center();
        click_at(&mut harness, found);
    }
    assert_eq!(kinds(&harness), ["curl"]);
    assert_eq!(harness.state().state.selected_layer, Some(stack(&harness).layers[0].id));
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
fn points_of_a_ramp_are_dragged_added_and_removed() {
    let mut harness = with_layers();
    click(&mut harness, "Length");
    unfold(&mut harness);
    // Sections open slowly.
    harness.run_steps(30);
    let rect = harness.query_all_by_role(Role::Canvas).last().expect("a curve").rect();
    let ramp = |harness: &Panel| stack(harness).layers[0].ramp.clone();
    assert_eq!(ramp(&harness).points, [[0.0, 1.0]]);
    let at = rect.lerp_inside(egui::vec2(0.8, 0.9));
    double_click(&mut harness, at);
    let [_, added] = ramp(&harness).points[..] else { panic!("two points") };
    assert!((added[0] - 0.8).abs() < 0.05 && added[1] < 0.4, "{added:?}");
    drag(&mut harness, at, rect.lerp_inside(egui::vec2(0.4, 0.2)));
    let moved = ramp(&harness).points[1];
    assert!((moved[0] - 0.4).abs() < 0.05 && moved[1] > 1.4, "{moved:?}");
    double_click(&mut harness, rect.lerp_inside(egui::vec2(0.4, 0.2)));
    assert_eq!(ramp(&harness).points.len(), 1);
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
