//! Each tool alone, on hair in an image, without the window.

use std::sync::{Arc, LazyLock};

use egui::accesskit::Role;
use egui::{Pos2, Rect, Response, Sense, Ui, Vec2, pos2, vec2};
use egui_kittest::Harness;
use glam::Vec3;
use lovelock_groom::HairTie;
use lovelock_motion::{ColliderEdit, PlacedCollider, ScalpFit, place_colliders};
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_render::Camera;
use lovelock_session::engine::Engine;
use lovelock_session::scene::SceneLoader;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_style::operations::Lift;
use lovelock_style::{Layer, MaskBrush};

use super::brush::Stroke;
use super::head::Head;
use super::scalp::ScalpTool;
use super::scissors::Scissors;
use super::{View, brush, colliders, scalp, scissors, ties};
use crate::window::testing::{Shown, control, drag, screen_of};

/// Hair on the dancer, and a camera before it.
static STAGE: LazyLock<(Arc<FrameSnapshot>, Camera)> = LazyLock::new(|| {
    let mut project = Project::default();
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (60, 4);
    project.camera.distance = 0.9;
    let scene = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene").0;
    let snapshot = Engine::at_rest(scene, project.simulation, 1.0 / 60.0).snapshot();
    let camera = snapshot.camera(&project.camera);
    (snapshot, camera)
});

const SIZE: Vec2 = vec2(480.0, 480.0);

fn view_of(place: Rect) -> View {
    View::of_camera(&STAGE.1, place).expect("a view")
}

fn head() -> Head<'static> {
    let snapshot = &STAGE.0;
    Head { world_from_head: &snapshot.guides.world_from_head, scalp: &snapshot.scene.style.scalp }
}

/// An image with a tool over it.
fn image<S: 'static>(
    state: S,
    tool: impl Fn(&Ui, &Response, View, &mut S) + 'static,
) -> Harness<'static, Shown<(S, Rect)>> {
    screen_of(SIZE, (state, Rect::NOTHING), move |ui, (state, place)| {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        *place = rect;
        tool(ui, &response, view_of(rect), state);
    })
}

fn view<S>(harness: &Harness<'_, Shown<(S, Rect)>>) -> View {
    view_of(harness.state().state.1)
}

/// The place on the screen of a point in head space.
fn at<S>(harness: &Harness<'_, Shown<(S, Rect)>>, place: Vec3) -> Pos2 {
    view(harness).to_screen(head().world(place)).expect("before the camera")
}

/// A place where hair grows, turned toward the camera, on the screen.
fn hairy<S>(harness: &Harness<'_, Shown<(S, Rect)>>) -> Pos2 {
    let (scalp, eye) = (head().scalp, head().eye(view(harness)));
    let turned = |i: &usize| (eye - scalp.positions[*i]).normalize_or_zero().dot(scalp.normals[*i]);
    let inside = view(harness).place.shrink(80.0);
    let hairy = (0..scalp.positions.len())
        .filter(|i| scalp.mask[*i] > 0.9 && inside.contains(at(harness, scalp.positions[*i])));
    let place = hairy.max_by(|a, b| turned(a).total_cmp(&turned(b))).expect("hair");
    at(harness, scalp.positions[place])
}

/// A corner of the image, without hair.
const BESIDE: Pos2 = pos2(20.0, 20.0);

#[test]
fn scissors_return_the_line_that_was_drawn_and_cut_the_hair_across_it() {
    let mut harness =
        image((Scissors::default(), Vec::<[Pos2; 2]>::new()), |ui, response, view, (scissors, lines)| {
            lines.extend(scissors.drag(ui, view, response));
        });
    let guides = &STAGE.0.guides.guides;
    let middle = guides.point(guides.count() / 2, guides.points_per_guide / 2);
    let middle = view(&harness).to_screen(middle).expect("before the camera");
    for (from, to) in [
        (middle - vec2(80.0, 0.0), middle + vec2(80.0, 0.0)),
        (BESIDE, BESIDE + vec2(40.0, 0.0)),
        (BESIDE, BESIDE + vec2(10.0, 0.0)),
    ] {
        drag(&mut harness, from, to);
    }
    let (view, lines) = (view(&harness), harness.state().state.0.1.clone());
    let [across, beside, short] = lines[..] else { panic!("{lines:?}") };
    let cut = scissors::cut(view, &STAGE.0, across).expect("a cut");
    assert!(cut.kept.iter().any(|kept| *kept < 1.0) && cut.kept.contains(&1.0), "some hair, not all");
    assert_eq!(scissors::cut(view, &STAGE.0, beside), None);
    assert!(scissors::is_too_short(short) && !scissors::is_too_short(across));
}

#[test]
fn the_brush_of_masks_paints_where_it_is_dragged_over_the_head() {
    let state = (Stroke::default(), Layer::of(Lift::default()), 0_u32);
    let mut harness = image(state, |ui, response, view, (stroke, layer, begun)| {
        let brush = (&MaskBrush::default(), false);
        let done = stroke.paint(ui, (view, response), (head(), &*STAGE.0), brush, layer);
        *begun += u32::from(done.begins);
    });
    let (before, middle) = (harness.state().state.0.1.mask.clone(), hairy(&harness));
    drag(&mut harness, BESIDE, BESIDE + vec2(30.0, 0.0));
    assert_eq!((harness.state().state.0.2, &harness.state().state.0.1.mask), (0, &before), "beside the head");
    drag(&mut harness, middle, middle + vec2(15.0, 5.0));
    assert_eq!(harness.state().state.0.2, 1, "one stroke");
    assert!(harness.state().state.0.1.mask != before);
    assert!(brush::spot(view(&harness), head(), &STAGE.0, middle).is_some());
}

#[test]
fn the_scalp_is_painted_only_while_its_tool_is_in_use() {
    let skull = STAGE.0.scene.skull.as_ref().expect("the dancer has a skull");
    let state = (ScalpFit::default(), false);
    let mut harness = image(state, move |ui, response, view, (fit, paints)| {
        scalp::edit(ui, response, view, head(), skull, (ScalpTool::default(), *paints, fit));
    });
    let middle = hairy(&harness);
    drag(&mut harness, middle, middle + vec2(12.0, 0.0));
    assert!(!harness.state().state.0.0.is_painted(), "another tool");
    harness.state_mut().state.0.1 = true;
    drag(&mut harness, middle, middle + vec2(12.0, 0.0));
    assert!(harness.state().state.0.0.is_painted());
}

#[test]
fn the_handle_of_a_collider_moves_its_shape() {
    let (scene, mut placed) = (&STAGE.0.scene, Vec::<PlacedCollider>::new());
    place_colliders(&scene.fitted, &scene.body, &STAGE.0.pose, &mut placed);
    let near = scene.fitted.iter().position(|of| of.name.contains("skull") || of.name.contains("head"));
    let placed = placed[near.expect("a shape of the head")];
    let mut harness = image(ColliderEdit::default(), move |ui, _, view, edit| {
        let mut chosen = colliders::Chosen { placed, edit: *edit };
        colliders::edit(ui, view, &mut chosen);
        *edit = chosen.edit;
    });
    let from = control(&harness, Role::Button, "Collider in the image").rect().center();
    drag(&mut harness, from, from + vec2(30.0, 0.0));
    let edit = harness.state().state.0;
    assert!(edit.offset != ColliderEdit::default().offset && edit.scale == ColliderEdit::default().scale);
}

#[test]
fn a_ring_is_selected_and_dragged_over_the_head() {
    let side = |x: f32| HairTie { at: Vec3::new(x, 0.12, 0.06), ..HairTie::default() };
    let state = ([side(-0.05), side(0.05)], 0_usize);
    let mut harness = image(state, |ui, _, view, (ties, selected)| {
        ties::edit(ui, view, head(), ties, selected);
    });
    let from = control(&harness, Role::Button, "Tie 2 in the image").rect().center();
    drag(&mut harness, from, from + vec2(0.0, -15.0));
    let (ties, selected) = &harness.state().state.0;
    assert_eq!((*selected, ties[0].at), (1, side(-0.05).at));
    assert!(ties[1].at.y > 0.12, "{}", ties[1].at);
}
