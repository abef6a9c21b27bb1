//! Ties, scissors and colliders in the viewport of the whole window.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_groom::{HairTie, TieKind, TieReach};
use lovelock_render::LightKind;

use super::whole::{CTRL, go, key, of, press_button, project, wait, window};
use super::{Shown, click_at, control, press};
use crate::window::Window;
use crate::window::overlay::View;
use crate::window::pointer_tool::PointerTool;

/// The window with an image, paused at the start; `None` if nothing can draw.
pub(super) fn with_picture() -> Option<Harness<'static, Shown<Option<Window>>>> {
    let mut harness = window();
    wait(&mut harness, "an image or the reason that there is none", |window| {
        window.session.painted.is_some() || window.session.draw_error.is_some()
    });
    of(&harness).session.painted.as_ref()?;
    wait(&mut harness, "the image of settled hair", |window| {
        let Some((painted, frame)) = window.session.painted.as_ref().zip(window.session.frame.as_ref())
        else {
            return false;
        };
        window.session.worker().settling().is_none() && Arc::ptr_eq(&painted.snapshot, frame)
    });
    Some(harness)
}

/// Opens a section of a panel.
pub(super) fn unfold(harness: &mut Harness<'_, Shown<Option<Window>>>, title: &str) {
    into_view(harness, Role::DisclosureTriangle, title);
    control(harness, Role::DisclosureTriangle, title).click();
    harness.run_steps(4);
}

/// Scrolls a control of a panel into view.
pub(super) fn into_view(harness: &mut Harness<'_, Shown<Option<Window>>>, role: Role, name: &str) {
    control(harness, role, name).scroll_to_me();
    harness.run_steps(4);
}

/// The projection of the current image.
pub(super) fn view(harness: &Harness<'_, Shown<Option<Window>>>) -> View {
    let window = of(harness);
    let rect = control(harness, Role::Image, "Viewport").rect();
    let painted = window.session.painted.as_ref().expect("a picture");
    View::new(painted, window.pages.image.place(rect).expect("a place")).expect("a view")
}

pub(super) fn drag_over(harness: &mut Harness<'_, Shown<Option<Window>>>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(1);
    press(harness, from, true);
    harness.run_steps(1);
    for i in 1..=6_u8 {
        harness.hover_at(from + (to - from) * (f32::from(i) / 6.0));
        harness.run_steps(1);
    }
    press(harness, to, false);
    go(harness);
}

#[test]
fn scissors_cut_hair_beyond_a_line_and_undo_restores_it() {
    let Some(mut harness) = with_picture() else { return };
    let before = project(&harness);
    let painted = of(&harness).session.painted.clone().expect("a picture");
    let head = glam::Vec3::from(painted.snapshot.guides.world_from_head.translation);
    // A line below the chin, across all hair.
    let middle = view(&harness).to_screen(head - glam::Vec3::Y * 0.04).expect("in the picture");
    let ends = [middle - egui::vec2(220.0, 0.0), middle + egui::vec2(220.0, 0.0)];
    // Without the scissors a drag moves the camera.
    drag_over(&mut harness, ends[0], ends[1]);
    assert!(project(&harness).hair == before.hair && project(&harness).camera != before.camera);
    key(&mut harness, CTRL, Key::Z);
    wait(&mut harness, "the picture of before", |window| {
        window.session.painted.as_ref().is_some_and(|now| now.camera.fov_y == painted.camera.fov_y)
            && window.session.drawn.as_ref().is_some_and(|drawn| drawn.project.camera == before.camera)
    });
    key(&mut harness, Modifiers::NONE, Key::X);
    assert_eq!(of(&harness).tools.active, PointerTool::Scissors);
    let points =
        |window: &Window| window.session.frame.as_ref().map_or(0, |frame| frame.scene.style.strands.points());
    let whole = points(of(&harness));
    drag_over(&mut harness, ends[0], ends[1]);
    let cut = project(&harness);
    assert_eq!(cut.camera, before.camera, "the camera stands while they cut");
    assert!(cut.hair.cut.kept.iter().any(|kept| (0.05..0.98).contains(kept)), "{:?}", cut.hair.cut);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    wait(&mut harness, "shorter hair", |window| points(window) < whole);
    // A line beside the hair cuts nothing.
    let corner = control(&harness, Role::Image, "Viewport").rect().left_bottom() + egui::vec2(30.0, -40.0);
    drag_over(&mut harness, corner, corner + egui::vec2(25.0, 0.0));
    assert_eq!(project(&harness), cut);
    let says = |harness: &Harness<'_, Shown<Option<Window>>>, what: &str| {
        super::texts(harness).iter().any(|(text, ..)| text.contains(what))
    };
    assert!(!says(&harness, "too short to cut"));
    drag_over(&mut harness, corner, corner + egui::vec2(10.0, 0.0));
    assert_eq!(project(&harness), cut);
    assert!(says(&harness, "too short to cut"));
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    wait(&mut harness, "long hair", |window| points(window) == whole);
}

#[test]
fn a_tie_can_be_dragged_in_the_viewport() {
    let Some(mut harness) = with_picture() else { return };
    add_ponytail(&mut harness);
    let tie = project(&harness).hair.ties[0];
    assert_eq!(tie.kind, TieKind::Ponytail);
    assert_ne!(tie.at, HairTie::default().at, "not placed on this head");
    wait(&mut harness, "tied hair", |window| {
        window.session.frame.as_ref().is_some_and(|frame| !frame.scene.style.held.is_empty())
    });
    let at = control(&harness, Role::Button, "Tie 1 in the image").rect().center();
    drag_over(&mut harness, at, at + egui::vec2(0.0, -30.0));
    let moved = project(&harness).hair.ties[0];
    assert!(moved.at.y > tie.at.y + 0.01, "{:?} from {:?}", moved.at, tie.at);
    assert_eq!(of(&harness).document.history().undo_len(), 2, "one drag is one step");
}

#[test]
fn a_lamp_is_dragged_and_moved_away_and_its_cone_is_turned_and_widened() {
    let Some(mut harness) = with_picture() else { return };
    let view_before = view(&harness);
    let head = {
        let painted = of(&harness).session.painted.clone().expect("a picture");
        glam::Vec3::from(painted.snapshot.guides.world_from_head.translation)
    };
    // Beside the head, so that lamp and cone are in the picture.
    let mut lit = (*project(&harness)).clone();
    lit.lights[0].kind = LightKind::Spot;
    lit.lights[0].position = head + glam::Vec3::new(0.1, 0.1, 0.1);
    lit.lights[0].direction = glam::Vec3::new(-1.0, -1.0, -0.2);
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.document.change("light", |project| *project = lit.clone());
    go(&mut harness);
    let steps = of(&harness).document.history().undo_len();
    let light = |harness: &Harness<'_, Shown<Option<Window>>>| project(harness).lights[0].clone();
    let at = |harness: &Harness<'_, Shown<Option<Window>>>, name| {
        control(harness, Role::Button, name).rect().center()
    };
    let lamp = at(&harness, "Light 1 in the image");
    drag_over(&mut harness, lamp, lamp + egui::vec2(24.0, 0.0));
    let moved = light(&harness);
    let way = moved.position - lit.lights[0].position;
    assert!(way.length() > 0.005, "{way}");
    let turned = moved.direction.angle_between(lit.lights[0].direction);
    assert!(turned < 1e-3, "its direction stays: {} {turned}", moved.direction);
    let to_lamp = moved.position - view_before.eye;
    assert!(
        way.dot(view_before.ray(view_before.place.center())).abs() < 0.05 * way.length(),
        "across the view"
    );
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
    let camera = project(&harness).camera;
    let lamp = at(&harness, "Light 1 in the image");
    harness.hover_at(lamp);
    harness.run_steps(1);
    let delta = egui::vec2(0.0, 30.0);
    let wheel = egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta,
        modifiers: Modifiers::NONE,
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
    };
    harness.event(wheel);
    go(&mut harness);
    let away = light(&harness).position - view_before.eye;
    assert!(away.length() > 1.01 * to_lamp.length(), "{away} from {to_lamp}");
    assert!(away.normalize_or_zero().dot(to_lamp.normalize_or_zero()) > 0.999, "along the view");
    assert_eq!(project(&harness).camera, camera, "the camera stands while the wheel turns over a lamp");
    let aim = at(&harness, "Direction of light 1 in the image");
    drag_over(&mut harness, aim, aim + egui::vec2(0.0, 20.0));
    assert_ne!(light(&harness).direction, moved.direction);
    let rim = at(&harness, "Width of light 1 in the image");
    drag_over(&mut harness, rim, rim + egui::vec2(20.0, 0.0));
    assert!(light(&harness).outer_angle > moved.outer_angle + 0.02);
    // Without its panel there are no handles.
    unfold(&mut harness, "Light");
    let names: Vec<_> = super::controls(&harness, Role::Button).into_iter().map(|(name, _)| name).collect();
    assert!(names.iter().all(|name| name != "Light 1 in the image"), "{names:?}");
}

#[test]
fn colliders_are_shown_and_edited() {
    let mut harness = window();
    key(&mut harness, Modifiers::NONE, Key::G);
    assert!(of(&harness).panels.colliders.on);
    let scene = of(&harness).session.scene.clone().expect("a scene");
    assert!(scene.field.is_some() && !scene.fitted.is_empty());
    assert!(scene.colliders.len() < scene.fitted.len(), "the skin replaces no shape");
    unfold(&mut harness, "Colliders");
    let before = project(&harness);
    // An edited shape is used for collision, even if the skin replaced it before.
    into_view(&mut harness, Role::SpinButton, "Size");
    let size = control(&harness, Role::SpinButton, "Size").rect().center();
    click_at(&mut harness, size);
    harness.event(egui::Event::Text("130".to_owned()));
    harness.key_press(Key::Enter);
    go(&mut harness);
    assert_eq!(project(&harness).body.colliders.shapes.len(), 1);
    wait(&mut harness, "the changed shape", |window| {
        window.session.scene.as_ref().is_some_and(|now| !Arc::ptr_eq(now, &scene))
    });
    let name = &scene.fitted[0].name;
    let met = of(&harness).session.scene.clone().expect("a scene");
    assert!(met.colliders.iter().any(|collider| collider.name == *name), "{name}");
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
}

/// The window with the camera at the dancer's left, facing the left side of the head.
fn seen_from_the_left() -> Option<Harness<'static, Shown<Option<Window>>>> {
    let mut harness = with_picture()?;
    let mut to_side = (*project(&harness)).clone();
    (to_side.camera.azimuth, to_side.camera.elevation) = (std::f32::consts::FRAC_PI_2, 0.1);
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.document.change("camera", |project| *project = to_side);
    go(&mut harness);
    wait(&mut harness, "the picture from the side", |window| {
        let now = window.session.painted.as_ref();
        // Waits until the camera has arrived: before that, the pointer may be over the other side of the head.
        now.is_some_and(|painted| (painted.camera.eye - painted.camera.target).normalize_or_zero().x > 0.99)
    });
    Some(harness)
}

/// The same with a ponytail tied at the back, and its section open.
fn ponytail_seen_from_the_left() -> Option<Harness<'static, Shown<Option<Window>>>> {
    let mut harness = seen_from_the_left()?;
    add_ponytail(&mut harness);
    Some(harness)
}

fn add_ponytail(harness: &mut Harness<'_, Shown<Option<Window>>>) {
    unfold(harness, "Ties and scissors");
    into_view(harness, Role::Button, "+ Ponytail");
    press_button(harness, "+ Ponytail");
}

#[test]
fn a_tie_dragged_over_the_head_turns_and_its_arrow_sets_its_direction() {
    let Some(mut harness) = ponytail_seen_from_the_left() else { return };
    let back = project(&harness).hair.ties[0];
    assert!(back.axis.z < -0.8 && back.axis.x.abs() < 0.2, "it aims back: {}", back.axis);
    let steps = of(&harness).document.history().undo_len();
    // Drags the ring to the middle of the side of the head that faces the camera.
    let from = control(&harness, Role::Button, "Tie 1 in the image").rect().center();
    let world_from_head = |harness: &Harness<'_, _>| {
        of(harness).session.painted.as_ref().expect("a picture").snapshot.guides.world_from_head
    };
    let middle = world_from_head(&harness).transform_point3(glam::Vec3::new(0.0, 0.12, 0.0));
    let to = view(&harness).to_screen(middle).expect("in the picture");
    drag_over(&mut harness, from, to);
    let side = project(&harness).hair.ties[0];
    assert!(side.at.x > 0.05, "not on the surface of the head: {}", side.at);
    assert!(side.axis.x > 0.6 && side.axis.z.abs() < 0.4, "it aims to the side: {}", side.axis);
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
    // The arrow points toward the camera; its end is dragged upward.
    let aim = "Direction of tie 1 in the image";
    let from = control(&harness, Role::Button, "Tie 1 in the image").rect().center();
    let end = control(&harness, Role::Button, aim).rect().center();
    let clear = if end.distance(from) > 14.0 { end } else { end - egui::vec2(0.0, 10.5) };
    drag_over(&mut harness, clear, from - egui::vec2(0.0, 90.0));
    let aimed = project(&harness).hair.ties[0];
    if clear == end {
        assert!(aimed.axis.y > side.axis.y + 0.3 && aimed.at == side.at, "{} from {}", aimed.axis, side.axis);
        assert_eq!(of(&harness).document.history().undo_len(), steps + 2);
    }
    key(&mut harness, CTRL, Key::Z);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness).hair.ties[0], back);
}

#[test]
fn a_tie_behind_the_head_stays_behind_it() {
    let Some(mut harness) = ponytail_seen_from_the_left() else { return };
    let mut other = (*project(&harness)).clone();
    other.hair.ties[0].at = glam::Vec3::new(-0.09, 0.12, 0.0);
    harness.state_mut().state.as_mut().expect("a window").document.change("tie", |project| *project = other);
    go(&mut harness);
    let from = control(&harness, Role::Button, "Tie 1 in the image").rect().center();
    drag_over(&mut harness, from, from + egui::vec2(25.0, -20.0));
    let moved = project(&harness).hair.ties[0].at;
    assert!(moved.x < -0.05 && moved.y > 0.13, "{moved}");
}

#[test]
fn a_patch_is_resized_and_moved_in_the_viewport() {
    let Some(mut harness) = ponytail_seen_from_the_left() else { return };
    let mut parted = (*project(&harness)).clone();
    let tie = &mut parted.hair.ties[0];
    (tie.reach, tie.sphere_radius) = (TieReach::InSphere, 0.06);
    let ring = tie.at;
    let edit = |harness: &mut Harness<'_, Shown<Option<Window>>>, to| {
        harness.state_mut().state.as_mut().expect("a window").document.change("tie", |project| *project = to);
        go(harness);
    };
    edit(&mut harness, parted.clone());
    let place = |harness: &Harness<'_, Shown<Option<Window>>>, name: &str| {
        control(harness, Role::Button, name).rect().center()
    };
    let (middle, rim) = ("Patch in the image", "Radius of the patch in the image");
    assert!(
        harness.query_by_role_and_label(Role::Button, middle).is_none(),
        "a patch that follows its ring has a handle"
    );
    let (at, rim_at) = (place(&harness, "Tie 1 in the image"), place(&harness, rim));
    let steps = of(&harness).document.history().undo_len();
    drag_over(&mut harness, rim_at, at + 1.5 * (rim_at - at));
    let sized = project(&harness).hair.ties[0];
    assert!((sized.sphere_radius - 0.09).abs() < 0.006 && sized.at == ring, "{sized:?}");
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
    // With its own centre, at first that of the ring, the patch is dragged over the visible side of the head.
    parted.hair.ties[0].sphere_at_ring = false;
    parted.hair.ties[0].sphere_centre = ring;
    edit(&mut harness, parted);
    let painted = of(&harness).session.painted.clone().expect("a picture");
    let side = painted.snapshot.guides.world_from_head.transform_point3(glam::Vec3::new(0.0, 0.12, 0.0));
    let to = view(&harness).to_screen(side).expect("in the picture");
    let (from, steps) = (place(&harness, middle), of(&harness).document.history().undo_len());
    drag_over(&mut harness, from, to);
    let moved = project(&harness).hair.ties[0];
    assert!(moved.sphere_centre.x > 0.05, "{}", moved.sphere_centre);
    assert!(moved.at == ring && moved.sphere_radius == 0.06, "{moved:?}");
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
}

#[test]
fn a_collider_is_moved_and_resized_in_the_viewport() {
    let Some(mut harness) = with_picture() else { return };
    key(&mut harness, Modifiers::NONE, Key::G);
    let scene = of(&harness).session.scene.clone().expect("a scene");
    let name = scene.fitted[0].name.clone();
    let before = project(&harness);
    let edit = |harness: &Harness<'_, Shown<Option<Window>>>| project(harness).body.colliders.of(&name);
    let place = |harness: &Harness<'_, Shown<Option<Window>>>, name: &str| {
        control(harness, Role::Button, name).rect().center()
    };
    let (middle, rim) = ("Collider in the image", "Radius of the collider in the image");
    let [first, out] = [place(&harness, middle), place(&harness, rim)];
    let at = first;
    // A shape grabbed beside its centre keeps its distance from the pointer.
    let hold = egui::vec2(3.0, 2.0);
    drag_over(&mut harness, at + hold, at + hold + egui::vec2(0.0, -30.0));
    let moved = edit(&harness);
    assert!(moved.offset[1] > 0.01 && moved.scale == 1.0 && moved.enabled, "{moved:?}");
    let shift = place(&harness, middle) - at;
    assert!((shift - egui::vec2(0.0, -30.0)).length() < 2.0, "the shape goes with the pointer: {shift:?}");
    assert_eq!(of(&harness).document.history().undo_len(), 1, "one drag is one step");
    // Dragging the rim to 1.5 times its distance scales the radius by 1.5.
    let [at, rim_at] = [place(&harness, middle), place(&harness, rim)];
    assert!(((rim_at - at) - (out - first)).length() < 2.0, "as large as before");
    drag_over(&mut harness, rim_at, at + 1.5 * (rim_at - at));
    let sized = edit(&harness);
    assert!((sized.scale - 1.5).abs() < 0.1 && sized.offset == moved.offset, "{sized:?}");
    assert_eq!(of(&harness).document.history().undo_len(), 2);
    wait(&mut harness, "the changed shape", |window| {
        let now = window.session.scene.as_ref();
        now.is_some_and(|now| now.colliders.iter().any(|collider| collider.name == name))
    });
    key(&mut harness, CTRL, Key::Z);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    // The camera has not moved.
    assert_eq!(project(&harness).camera, before.camera);
}

#[test]
fn the_hairline_is_dragged_and_the_scalp_painted_in_the_viewport() {
    let Some(mut harness) = with_picture() else { return };
    let automatic = project(&harness).body.scalp.clone();
    unfold(&mut harness, "Scalp");
    into_view(&mut harness, Role::CheckBox, "Show scalp");
    control(&harness, Role::CheckBox, "Show scalp").click();
    go(&mut harness);
    let name = "Hairline at the front";
    let at = control(&harness, Role::Button, name).rect().center();
    let steps = of(&harness).document.history().undo_len();
    drag_over(&mut harness, at, at - egui::vec2(0.0, 12.0));
    let raised = project(&harness).body.scalp.clone();
    assert!(raised.raise.front > 0.02, "{:?}", raised.raise);
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one drag is one step");
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness).body.scalp, automatic);
    into_view(&mut harness, Role::CheckBox, "Paint scalp");
    control(&harness, Role::CheckBox, "Paint scalp").click();
    go(&mut harness);
    let camera = project(&harness).camera;
    let painted = of(&harness).session.painted.clone().expect("a picture");
    let skull = painted.snapshot.scene.skull.expect("a skull");
    let cheek = skull.place(glam::Vec3::new(0.35, -0.35, 0.87));
    let cheek = painted.snapshot.guides.world_from_head.transform_point3(cheek);
    let at = view(&harness).to_screen(cheek).expect("in the picture");
    drag_over(&mut harness, at, at + egui::vec2(14.0, 6.0));
    let fit = project(&harness).body.scalp.clone();
    assert!(fit.is_painted() && !fit.moves_outline(), "{fit:?}");
    assert_eq!(project(&harness).camera, camera, "the camera stands while it paints");
    assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "one stroke is one step");
    wait(&mut harness, "hair on the cheek", |window| {
        window.session.frame.as_ref().is_some_and(|frame| frame.scene.style.scalp.hairy_area(0.5) > 0.0)
            && window.session.scene.as_ref().is_some_and(|scene| {
                let now = &scene.style.scalp;
                now.mask.iter().zip(&painted.snapshot.scene.style.scalp.mask).any(|(a, b)| a > b)
            })
    });
}
