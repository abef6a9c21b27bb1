//! Painting masks in the viewport of the whole window, and showing them.

use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lovelock_session::render_thread::ShownMask;
use lovelock_style::operations::Lift;
use lovelock_style::{HeadBox, Layer};

use super::tools::{drag_over, into_view, unfold, view, with_picture};
use super::whole::{CTRL, Whole, go, key, of, project, wait};
use crate::window::overlay;
use crate::window::overlay::head::Head;
use crate::window::overlay::pick::SeenHair;
use crate::window::pointer_tool::PointerTool;

/// The window with a layer that is selected, and its mask being painted.
fn painting() -> Option<Whole> {
    let mut harness = with_picture()?;
    let mut changed = (*project(&harness)).clone();
    let id = changed.hair.stack.push(Layer::of(Lift::default()));
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.document.change("layer", |project| *project = changed);
    window.panels.layers.selected = id;
    go(&mut harness);
    key(&mut harness, Modifiers::SHIFT, Key::K);
    assert!(of(&harness).tools.active == PointerTool::Mask && of(&harness).tools.shown_mask.is_some());
    Some(harness)
}

/// The mask of the layer at a place of the head, relative to its box.
fn mask_at(harness: &Whole, relative: Vec3) -> f32 {
    let scene = of(harness).session.scene.clone().expect("a scene");
    let head = HeadBox::of(&scene.style.scalp);
    project(harness).hair.stack.layers[0].mask.at(&head, head.place(relative))
}

/// The place in the image of a place of the head, relative to its box.
fn on_screen(harness: &Whole, relative: Vec3) -> Pos2 {
    let painted = of(harness).session.painted.clone().expect("an image");
    let head = HeadBox::of(&painted.snapshot.scene.style.scalp);
    let world = painted.snapshot.guides.world_from_head.transform_point3(head.place(relative));
    view(harness).to_screen(world).expect("before the camera")
}

const FOREHEAD: Vec3 = Vec3::new(0.0, 0.55, 0.85);

fn set_brush(harness: &mut Whole, change: impl FnOnce(&mut lovelock_style::MaskBrush)) {
    change(&mut harness.state_mut().state.as_mut().expect("a window").panels.layers.brush);
}

#[test]
fn a_stroke_paints_the_mask_in_one_undo_step() {
    let Some(mut harness) = painting() else { return };
    let before = project(&harness);
    let steps = of(&harness).document.history().undo_len();
    set_brush(&mut harness, |brush| (brush.radius, brush.strength) = (0.03, 1.0));
    let middle = on_screen(&harness, FOREHEAD);
    drag_over(&mut harness, middle - egui::vec2(6.0, 0.0), middle + egui::vec2(6.0, 0.0));
    let part = project(&harness).hair.stack.layers[0].mask.parts[0].clone();
    assert!(!part.map.is_empty(), "nothing is painted");
    assert!(mask_at(&harness, FOREHEAD) > 0.9, "{}", mask_at(&harness, FOREHEAD));
    assert_eq!(mask_at(&harness, -FOREHEAD), 0.0);
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one stroke is one step");
    assert_eq!(project(&harness).camera, before.camera, "the camera stands while it paints");
    // Hair and image follow.
    let shown = of(&harness).tools.shown_mask.clone().expect("a mask");
    assert_eq!(shown.mask, project(&harness).hair.stack.layers[0].mask);
    // A second stroke at once is a step of its own; Ctrl erases.
    harness.event_modifiers(Event::PointerMoved(middle), CTRL);
    for pressed in [true, false] {
        let button = PointerButton::Primary;
        harness.event_modifiers(Event::PointerButton { pos: middle, button, pressed, modifiers: CTRL }, CTRL);
        harness.run_steps(2);
    }
    go(&mut harness);
    assert_eq!(of(&harness).document.history().undo_len(), steps + 2);
    assert!(mask_at(&harness, FOREHEAD) < 0.1, "{}", mask_at(&harness, FOREHEAD));
    key(&mut harness, CTRL, Key::Z);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    // Keys change the radius.
    let radius = of(&harness).panels.layers.brush.radius;
    key(&mut harness, Modifiers::NONE, Key::CloseBracket);
    assert!(of(&harness).panels.layers.brush.radius > 1.1 * radius);
    key(&mut harness, Modifiers::NONE, Key::OpenBracket);
    assert!((of(&harness).panels.layers.brush.radius - radius).abs() < 1e-6);
    // The image of the mask arrives, and another after it is hidden.
    wait(&mut harness, "the image of the mask", |window| {
        window.session.drawn.as_ref().is_some_and(|drawn| drawn.mask.is_some())
            && window.session.draw_error.is_none()
    });
    key(&mut harness, Modifiers::NONE, Key::K);
    assert!(of(&harness).session.drawn.as_ref().is_some_and(|drawn| drawn.mask.is_none()));
}

#[test]
fn the_other_side_is_painted_with_it_if_the_brush_mirrors() {
    let Some(mut harness) = painting() else { return };
    let side = Vec3::new(0.35, 0.5, 0.78);
    let other = Vec3::new(-0.35, 0.5, 0.78);
    let at = on_screen(&harness, side);
    set_brush(&mut harness, |brush| (brush.radius, brush.strength) = (0.015, 1.0));
    drag_over(&mut harness, at, at);
    let [own, far] = [side, other].map(|place| mask_at(&harness, place));
    assert!(own > 0.5 && far == 0.0, "{own} {far}");
    set_brush(&mut harness, |brush| brush.mirror = true);
    drag_over(&mut harness, at, at);
    let [own, far] = [side, other].map(|place| mask_at(&harness, place));
    assert!(own > 0.5 && (own - far).abs() < 0.3, "{own} {far}");
}

#[test]
fn a_map_is_painted_into_a_layer_of_its_own() {
    let Some(mut harness) = with_picture() else { return };
    let removed = |scene: &lovelock_session::scene::Scene| {
        scene.style.strands.taper.iter().filter(|width| **width == 0.0).count()
    };
    let before = removed(of(&harness).session.scene.as_ref().expect("a scene"));
    key(&mut harness, Modifiers::NONE, Key::H);
    unfold(&mut harness, "Brushes");
    let start = |harness: &mut Whole| {
        into_view(harness, egui::accesskit::Role::Button, "Density");
        super::control(harness, egui::accesskit::Role::Button, "Density").click();
        go(harness);
    };
    start(&mut harness);
    assert_eq!(of(&harness).tools.active, PointerTool::Mask, "painting takes the place of the brush");
    let layers = project(&harness).hair.stack.layers.clone();
    assert_eq!(layers.iter().map(|layer| layer.operation.id()).collect::<Vec<_>>(), ["density"]);
    assert_eq!(mask_at(&harness, FOREHEAD), 0.0, "it acts nowhere yet");
    set_brush(&mut harness, |brush| (brush.radius, brush.strength) = (0.05, 1.0));
    let middle = on_screen(&harness, FOREHEAD);
    drag_over(&mut harness, middle - egui::vec2(6.0, 0.0), middle + egui::vec2(6.0, 0.0));
    assert!(mask_at(&harness, FOREHEAD) > 0.9 && mask_at(&harness, -FOREHEAD) == 0.0);
    wait(&mut harness, "thinner hair", |window| {
        window.session.scene.as_ref().is_some_and(|scene| removed(scene) > before)
    });
    // Another start goes on with the same layer.
    key(&mut harness, Modifiers::NONE, Key::H);
    start(&mut harness);
    assert_eq!(project(&harness).hair.stack.layers.len(), 1);
}

#[test]
fn strange_strokes_are_safe() {
    let Some(mut harness) = painting() else { return };
    let before = project(&harness);
    let middle = on_screen(&harness, FOREHEAD);
    // A stroke that is undone while it goes on ends there.
    harness.hover_at(middle);
    harness.run_steps(1);
    super::press(&harness, middle, true);
    harness.run_steps(2);
    assert_ne!(project(&harness), before);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    for i in 0..4_u8 {
        harness.hover_at(middle + egui::vec2(f32::from(i), 0.0));
        harness.run_steps(1);
    }
    super::press(&harness, middle, false);
    go(&mut harness);
    assert_eq!(project(&harness), before, "it paints no further");
    // Out of the image and back, with the smallest and the largest brush.
    for radius in [0.0, 0.002, 0.2, 1e6] {
        set_brush(&mut harness, |brush| brush.radius = radius);
        drag_over(&mut harness, middle, Pos2::new(-4000.0, 1e6));
        drag_over(&mut harness, middle, middle);
    }
    assert_eq!(project(&harness).camera, before.camera);
    // Beside the head a drag moves the camera.
    let steps = of(&harness).document.history().undo_len();
    let corner = super::control(&harness, egui::accesskit::Role::Image, "Viewport").rect().left_bottom();
    drag_over(&mut harness, corner + egui::vec2(30.0, -40.0), corner + egui::vec2(60.0, -60.0));
    assert_ne!(project(&harness).camera, before.camera);
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1);
}

/// Presses and releases the pointer at a place with modifiers held, as a stroke of one dab.
fn dab(harness: &mut Whole, at: Pos2, modifiers: Modifiers) {
    harness.event_modifiers(Event::PointerMoved(at), modifiers);
    harness.run_steps(1);
    for pressed in [true, false] {
        let button = PointerButton::Primary;
        harness.event_modifiers(Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        harness.run_steps(2);
    }
    go(harness);
}

#[test]
fn a_stroke_that_changes_nothing_says_so_and_is_no_undo_step() {
    let Some(mut harness) = painting() else { return };
    set_brush(&mut harness, |brush| (brush.radius, brush.strength, brush.falloff) = (0.02, 1.0, 0.0));
    let [left, right] = [1.0, -1.0].map(|side| on_screen(&harness, Vec3::new(0.35 * side, 0.5, 0.78)));
    dab(&mut harness, left, Modifiers::NONE);
    dab(&mut harness, right, Modifiers::NONE);
    key(&mut harness, CTRL, Key::Z);
    let before = project(&harness);
    let steps = [of(&harness).document.history().undo_len(), of(&harness).document.history().redo_len()];
    // Erasing what is not painted, and painting what is.
    for (at, modifiers, says) in
        [(right, CTRL, "The mask is empty here"), (left, Modifiers::NONE, "The mask is full here")]
    {
        dab(&mut harness, at, modifiers);
        assert_eq!(project(&harness), before, "{says}");
        let now = [of(&harness).document.history().undo_len(), of(&harness).document.history().redo_len()];
        assert_eq!(now, steps, "{says}: no step, and the stroke that was undone can be done again");
        assert!(harness.query_by_label_contains(says).is_some(), "{says}");
    }
    // Control: erasing what is painted is a step.
    dab(&mut harness, left, CTRL);
    assert_eq!(of(&harness).document.history().undo_len(), steps[0] + 1);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
}

#[test]
fn paint_is_seen_on_the_image_of_before() {
    let Some(mut harness) = painting() else { return };
    set_brush(&mut harness, |brush| (brush.radius, brush.strength) = (0.03, 1.0));
    wait(&mut harness, "the image of the mask", |window| {
        window.session.painted.as_ref().is_some_and(|painted| painted.mask == window.tools.shown_mask)
    });
    let image = of(&harness).session.painted.clone().expect("an image");
    let at = on_screen(&harness, FOREHEAD);
    let shapes = |harness: &Whole| {
        let view = view(harness);
        let snapshot = &image.snapshot;
        let head =
            Head { world_from_head: &snapshot.guides.world_from_head, scalp: &snapshot.scene.style.scalp };
        let mask = project(harness).hair.stack.layers[0].mask.clone();
        let shown = ShownMask { mask, scale: crate::window::theme::mask_colors() };
        overlay::mask::changed(view, head, &mut SeenHair::default(), &image, &shown)
    };
    assert!(shapes(&harness).is_empty(), "the image shows the mask already");
    dab(&mut harness, at, Modifiers::NONE);
    let new = shapes(&harness);
    let near = new.iter().filter(|shape| shape.visual_bounding_rect().expand(4.0).contains(at)).count();
    assert!(new.len() > 4 && near > 0, "{} shapes, {near} of them under the brush", new.len());
}
