//! Brushes in the viewport of the whole window.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lovelock_base::settings::Choices as _;
use lovelock_brush::{BrushSettings, Tool};
use lovelock_style::Operation;
use lovelock_style::hand::HandEdits;
use lovelock_testkit::suite::is_long;

use super::tools::{drag_over, view, with_picture};
use super::whole::{CTRL, Whole, go, key, of, project, wait};
use super::{control, press};
use crate::window::keymap::Preset;
use crate::window::pointer_tool::PointerTool;

/// The window with brushes on, and the place of hair in the image.
fn brushing() -> Option<(Whole, Pos2)> {
    let mut harness = with_picture()?;
    key(&mut harness, Modifiers::NONE, Key::H);
    assert_eq!(of(&harness).tools.active, PointerTool::Brush);
    for tool in Tool::ALL {
        let settings =
            BrushSettings { radius: 0.07, strength: 1.0, front_only: false, ..BrushSettings::default() };
        let window = harness.state_mut().state.as_mut().expect("a window");
        window.panels.brushes.kept.set_for_tests(*tool, settings);
    }
    let painted = of(&harness).session.painted.clone().expect("an image");
    let guides = &painted.snapshot.guides.guides;
    // The hair nearest to the camera, half-way along.
    let half = guides.points_per_guide / 2;
    let eye = painted.camera.eye;
    let nearest = (0..guides.count()).map(|guide| guides.point(guide, half));
    let nearest = nearest.min_by(|a, b| a.distance(eye).total_cmp(&b.distance(eye))).expect("hair");
    let at = view(&harness).to_screen(nearest).expect("before the camera");
    Some((harness, at))
}

/// The ends of a line over the top of the head, beside the parting that the hair has.
fn beside_the_parting(harness: &Whole) -> [Pos2; 2] {
    let painted = of(harness).session.painted.clone().expect("an image");
    [(0.13, 0.07), (0.15, 0.0)].map(|(y, z)| {
        let place = painted.snapshot.guides.world_from_head.transform_point3(Vec3::new(0.05, y, z));
        view(harness).to_screen(place).expect("before the camera")
    })
}

fn edits(harness: &Whole) -> Option<HandEdits> {
    let project = project(harness);
    let layers = project.hair.stack.layers.iter();
    layers.rev().find_map(|layer| match &layer.operation {
        Operation::Hand(hand) => Some(hand.edits.clone()),
        _ => None,
    })
}

fn done(harness: &mut Whole) {
    wait(harness, "the end of the stroke", |window| !window.panels.brushes.has_open_strokes());
    // The hair of the project must be there before the next stroke.
    let project = project(harness);
    wait(harness, "the hair", |window| {
        window.session.scene.as_ref().is_some_and(|scene| scene.source.stack == project.hair.stack)
    });
}

#[test]
fn each_tool_changes_hair_by_one_undo_step_and_undo_restores_the_project() {
    let Some((mut harness, at)) = brushing() else { return };
    let before = project(&harness);
    let steps = of(&harness).document.history().undo_len();
    let few = [Tool::Comb, Tool::Curl, Tool::Part, Tool::Freeze];
    for tool in Tool::ALL.iter().filter(|tool| is_long() || few.contains(tool)) {
        let (_, name) = tool.names();
        control(&harness, egui::accesskit::Role::RadioButton, name).click();
        go(&mut harness);
        assert_eq!(of(&harness).panels.brushes.tool, *tool);
        let way =
            if *tool == Tool::Part { beside_the_parting(&harness) } else { [at, at + vec2(40.0, 14.0)] };
        drag_over(&mut harness, way[0], way[1]);
        done(&mut harness);
        assert_eq!(project(&harness).camera, before.camera, "{name}: the camera stands");
        if *tool == Tool::Freeze {
            assert!(of(&harness).panels.brushes.has_frozen(), "{name}");
            let redo = of(&harness).document.history().redo_len();
            assert!(redo > 0, "the tool before can be done again");
            // A stroke on frozen hair is no undo step, and says so.
            control(&harness, egui::accesskit::Role::RadioButton, Tool::Comb.names().1).click();
            go(&mut harness);
            drag_over(&mut harness, way[0], way[1]);
            done(&mut harness);
            assert!(harness.query_by_label_contains("changes no hair").is_some());
            assert_eq!(project(&harness), before, "what is frozen is no part of the project");
            assert_eq!(of(&harness).document.history().undo_len(), steps);
            assert_eq!(
                of(&harness).document.history().redo_len(),
                redo,
                "what was undone can still be done again"
            );
            harness.state_mut().state.as_mut().expect("a window").session.worker().thaw();
            continue;
        }
        let hand = edits(&harness).unwrap_or_else(|| panic!("{name} made no layer"));
        assert!(!hand.is_empty(), "{name} did nothing");
        assert_eq!(of(&harness).document.history().undo_len(), steps + 1, "{name}: one step");
        let label = of(&harness).document.history().undo_label();
        assert_eq!(
            label,
            Some(name.to_lowercase().as_str()),
            "also of the first stroke, which adds the layer"
        );
        key(&mut harness, CTRL, Key::Z);
        assert_eq!(project(&harness), before, "{name}");
        wait(&mut harness, "the image of the hair of before", |window| {
            let painted = window.session.painted.as_ref();
            painted.is_some_and(|painted| painted.snapshot.scene.source.stack.layers.is_empty())
                && window.session.worker().settling().is_none()
                && window
                    .session
                    .frame
                    .as_ref()
                    .zip(painted)
                    .is_some_and(|(frame, painted)| std::sync::Arc::ptr_eq(frame, &painted.snapshot))
        });
    }
}

#[test]
fn a_drag_beside_the_hair_moves_the_camera_and_an_undo_in_a_stroke_ends_it() {
    let Some((mut harness, at)) = brushing() else { return };
    let before = project(&harness);
    // Notices lie on the right.
    let viewport = control(&harness, egui::accesskit::Role::Image, "Viewport").rect();
    let beside = viewport.left_center() + vec2(60.0, 0.0);
    drag_over(&mut harness, beside, beside + vec2(20.0, 0.0));
    assert_ne!(project(&harness).camera, before.camera);
    assert!(edits(&harness).is_none());
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    wait(&mut harness, "the image of before", |window| {
        window.session.drawn.as_ref().is_some_and(|drawn| drawn.project.camera == before.camera)
            && window.session.painted.as_ref().is_some_and(|painted| {
                let camera = painted.snapshot.camera(&before.camera);
                painted.camera.eye.distance(camera.eye) < 1e-4
            })
    });
    // In the middle of a stroke.
    harness.hover_at(at);
    harness.run_steps(1);
    press(&harness, at, true);
    harness.run_steps(2);
    harness.hover_at(at + vec2(20.0, 5.0));
    wait(&mut harness, "the stroke", |window| {
        let layers = &window.document.project().hair.stack.layers;
        layers.iter().any(|layer| matches!(&layer.operation, Operation::Hand(hand) if !hand.edits.is_empty()))
    });
    key(&mut harness, CTRL, Key::Z);
    harness.hover_at(at + vec2(40.0, 9.0));
    harness.run_steps(8);
    press(&harness, at + vec2(40.0, 9.0), false);
    go(&mut harness);
    wait(&mut harness, "the hair of before", |window| {
        window.session.frame.as_ref().is_some_and(|frame| frame.scene.source.stack.layers.is_empty())
            && window.session.worker().settling().is_none()
            && !window.session.worker().is_loading()
    });
    assert_eq!(project(&harness), before, "nothing of the stroke is left");
    assert!(!of(&harness).panels.brushes.has_open_strokes());
}

#[test]
fn alt_moves_the_camera_over_hair_as_in_maya() {
    let Some((mut harness, at)) = brushing() else { return };
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.layout.keys.set_preset(Preset::Maya);
    harness.run_steps(1);
    let before = project(&harness);
    let (to, button, modifiers) = (at + vec2(20.0, 0.0), PointerButton::Primary, Modifiers::ALT);
    let click = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    let events = [Event::PointerMoved(at), click(at, true), Event::PointerMoved(to), click(to, false)];
    for (event, held) in events.into_iter().zip([modifiers, modifiers, Modifiers::NONE, Modifiers::NONE]) {
        // Released during the drag, which stays the camera's.
        harness.event_modifiers(event, held);
        harness.run_steps(2);
    }
    go(&mut harness);
    assert_ne!(project(&harness).camera, before.camera);
    assert!(edits(&harness).is_none(), "the brush leaves the hair alone");
}

#[test]
fn b_and_the_brackets_change_the_radius_and_shift_b_the_strength() {
    let Some((mut harness, at)) = brushing() else { return };
    let settings = |harness: &Whole| of(harness).panels.brushes.kept.of(Tool::Comb);
    let before = settings(&harness);
    key(&mut harness, Modifiers::NONE, Key::CloseBracket);
    let larger = settings(&harness);
    assert!(larger.radius > 1.05 * before.radius);
    key(&mut harness, Modifiers::NONE, Key::OpenBracket);
    assert!((settings(&harness).radius / before.radius - 1.0).abs() < 1e-3);
    for (modifiers, moved) in [(Modifiers::NONE, -60.0), (Modifiers::SHIFT, -60.0)] {
        harness.hover_at(at);
        harness.run_steps(1);
        let down =
            |pressed| Event::Key { key: Key::B, physical_key: None, pressed, repeat: false, modifiers };
        harness.event_modifiers(down(true), modifiers);
        harness.run_steps(2);
        harness.event_modifiers(Event::PointerMoved(at + vec2(moved, 0.0)), modifiers);
        harness.run_steps(2);
        harness.event_modifiers(down(false), modifiers);
        harness.run_steps(2);
    }
    let after = settings(&harness);
    assert!(after.radius < 0.8 * before.radius && after.strength < 0.9 * before.strength, "{after:?}");
    assert!(edits(&harness).is_none(), "no stroke");
    // Its menu.
    harness.hover_at(at);
    harness.run_steps(1);
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        harness.event(Event::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
        harness.run_steps(2);
    }
    go(&mut harness);
    assert!(harness.query_all_by_label("Brush radius").count() > 0);
}

#[test]
fn a_pen_presses_with_its_force_and_its_eraser_inverts() {
    use crate::window::pen::PenEnd;
    let Some((mut harness, at)) = brushing() else { return };
    let stroke = |harness: &mut Whole, end: Option<(PenEnd, f32)>| {
        let hear = |harness: &Whole, force: f32| {
            if let Some((end, _)) = end {
                of(harness).tools.pen.hear_for_tests(&[(end, force)]);
            }
        };
        hear(harness, end.map_or(0.0, |(_, force)| force));
        drag_over(harness, at, at + vec2(40.0, 14.0));
        hear(harness, 0.0);
        done(harness);
        of(harness).panels.brushes.last_stroke().expect("a stroke").clone()
    };
    for (pen, pressure, inverted) in [
        (None, 1.0, false),
        (Some((PenEnd::Tip, 0.25)), 0.25, false),
        (Some((PenEnd::Eraser, 0.5)), 0.5, true),
    ] {
        // A tool that has an inverse.
        let tool = Tool::ALL.iter().find(|tool| tool.inverse_text().is_some()).expect("one has");
        control(&harness, egui::accesskit::Role::RadioButton, tool.names().1).click();
        go(&mut harness);
        let stroke = stroke(&mut harness, pen);
        assert_eq!(stroke.inverted, inverted, "{pen:?}");
        assert!(stroke.samples.iter().all(|sample| sample.pressure == pressure), "{pen:?}");
    }
}
