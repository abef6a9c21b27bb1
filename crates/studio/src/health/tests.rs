use glam::{Affine3A, Vec3};
use lovelock_groom::Guides;
use lovelock_motion::{Collider, ColliderShape};

use super::*;
use crate::session::tests::{load, scene, small_project};
use lovelock_wisp::StepReport;

use crate::Engine;

#[test]
fn good_hair_gets_no_advice_and_every_limit_has_a_sentence() {
    let settings = SimulationSettings::default();
    let well = health(&Totals::default(), None, &settings);
    assert_eq!(well.iter().map(|gauge| gauge.kind).collect::<Vec<_>>(), GaugeKind::ALL);
    assert!(well.iter().all(|gauge| gauge.level == HealthLevel::Good && gauge.advice.is_empty()));
    let ill = Totals {
        max_stretch: 0.5,
        max_penetration_m: 0.1,
        max_kinetic_energy: 1e4,
        recovered_guides: 3,
        recovered_at: Some(4),
        ..Totals::default()
    };
    let rest = RestInside { depth_m: 0.05, guide: 1, point: 2, collider: "neck".to_owned() };
    for gauge in health(&ill, Some(&rest), &settings) {
        assert_eq!(gauge.level, HealthLevel::Wrong, "{gauge:?}");
        assert!(gauge.advice.ends_with('.') && gauge.fill() == 1.0, "{gauge:?}");
        assert!(!gauge.kind.in_words(gauge.value).is_empty());
    }
    let some = Totals { max_penetration_m: 2e-3, ..Totals::default() };
    let watched = health(&some, None, &settings);
    assert_eq!(watched[1].level, HealthLevel::Watch);
    assert!((watched[1].fill() - 0.4).abs() < 1e-6);
}

#[test]
fn a_style_drawn_into_a_collider_is_found_with_its_name_and_place() {
    let scene = scene();
    let mut style = (*scene.style).clone();
    let (points, head) = (style.guides.points_per_guide, head_of(&scene));
    // A lock of its own, straight down beside the hair, whose fifth point is in the middle of a ball.
    let lock: Vec<Vec3> = (0..points).map(|i| Vec3::new(0.9, -0.02 * i as f32, 0.0)).collect();
    let mut guides = Guides { points_per_guide: points, ..Guides::default() };
    guides.push(&lock);
    style.guides = guides;
    let shape = |at: Vec3, radius| ColliderShape::Ellipsoid {
        from_unit: Affine3A::from_scale_rotation_translation(Vec3::splat(radius), glam::Quat::IDENTITY, at),
    };
    let collider = |name: &str, shape_at_rest| Collider { name: name.to_owned(), joint: 0, shape_at_rest };
    let colliders =
        [collider("far", shape(head - Vec3::X, 0.3)), collider("ball", shape(head + lock[5], 0.03))];
    let found = RestInside::find(&style, &scene.body, &colliders).expect("inside");
    assert_eq!((found.guide, found.point, found.collider.as_str()), (0, 5, "ball"));
    assert!((found.depth_m - 0.03).abs() < 1e-3, "{found:?}");
    assert_eq!(RestInside::find(&style, &scene.body, &colliders[..1]), None);
}

fn head_of(scene: &crate::Scene) -> Vec3 {
    Vec3::from(scene.body.skeleton.world_at_rest[scene.body.head_joint].translation)
}

#[test]
fn shipped_styles_are_well_over_the_dance_and_hair_in_a_storm_of_one_substep_is_not() {
    for preset in lovelock_groom::Preset::ALL {
        let mut project = small_project();
        project.set_preset(preset);
        project.hair.groom.wisps = 24;
        project.hair.groom.strands_per_wisp = 3;
        let scene = load(&project).0;
        let mut engine = Engine::new(scene, project.simulation);
        engine.advance_to_step(240);
        let frame = engine.snapshot();
        let totals = engine.totals();
        println!("{}: {totals:?} {:?}", preset.id(), frame.scene.rest_inside);
        for gauge in health(&totals, frame.scene.rest_inside.as_ref(), &project.simulation) {
            assert_eq!(gauge.level, HealthLevel::Good, "{}: {gauge:?}", preset.id());
        }
        let at = totals.fastest_at.expect("a fastest point");
        assert!(frame.guide_point(at).is_some_and(|p| p.is_finite()));
        assert_eq!(frame.guide_point((u32::MAX, 0)), None);
    }
    let mut storm = small_project();
    (storm.simulation.wind.speed, storm.simulation.drag, storm.simulation.settle) = (30.0, 20.0, 0.0);
    let mut engine = Engine::new(scene(), storm.simulation);
    engine.advance_to_step(60);
    let frame = engine.snapshot();
    let energy = StepReport { kinetic_energy: 500.0, ..frame.report };
    let mut torn = FrameSnapshot::clone(&frame);
    torn.report = energy;
    let gauge = &torn.health(&storm.simulation)[2];
    assert_eq!(gauge.level, HealthLevel::Wrong);
    assert!(gauge.advice.contains("wind"), "{gauge:?}");
}
