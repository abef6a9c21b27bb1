use lovelock_simulation::{BodyPart, StepReport};
use lovelock_testkit::suite::{is_long, sample};

use super::*;
use crate::engine::Engine;
use crate::testing::{load, scene, settled, small_project};

#[test]
fn good_hair_gets_no_advice_and_every_limit_has_advice() {
    let settings = SimulationSettings::default();
    let scene = scene();
    let well = health(&Totals::default(), None, &scene, &settings);
    assert_eq!(well.iter().map(|gauge| gauge.kind).collect::<Vec<_>>(), GaugeKind::ALL);
    assert!(well.iter().all(|gauge| gauge.level == HealthLevel::Good && gauge.advice.is_empty()));
    let ill = Totals {
        max_stretch: 0.5,
        max_penetration_m: 0.1,
        unsure_points: 500,
        unsure_at: Some((3, 8)),
        max_kinetic_energy: 1e4,
        recovered_guides: 3,
        recovered_at: Some(4),
        ..Totals::default()
    };
    let rest = InsidePoint { depth_m: 0.05, guide: 1, point: 2, within: BodyPart::Collider(0) };
    let told = health(&ill, Some(rest), &scene, &settings);
    assert!(told[5].advice.contains(&scene.colliders[0].name), "{told:?}");
    assert_eq!(told[5].within.as_ref(), Some(&scene.colliders[0].name));
    assert_eq!(told[5].in_words(), format!("50.0 mm in {}", scene.colliders[0].name));
    assert!(well.iter().chain(&told[..5]).all(|gauge| gauge.within.is_none()), "{told:?}");
    for gauge in told {
        assert_eq!(gauge.level, HealthLevel::Wrong, "{gauge:?}");
        assert!(gauge.advice.ends_with('.') && gauge.fill() == 1.0, "{gauge:?}");
        assert!(!gauge.kind.in_words(gauge.value).is_empty());
    }
    let inside = InsidePoint { depth_m: 2e-3, guide: 0, point: 9, within: BodyPart::Field };
    let found = Some(Occurrence { at_secs: Some(3.84), place: Vec3::new(0.1, 1.5, 0.2) });
    let some = Totals { max_penetration_m: 2e-3, deepest: Some(inside), ..Totals::default() };
    let watched = health(&some, None, &scene, &settings);
    assert_eq!(watched[1].level, HealthLevel::Watch);
    assert_eq!(watched[1].in_words(), "2.0 mm in head and shoulders");
    assert!((watched[1].fill() - 0.4).abs() < 1e-6);
    let dated = Totals { deepest_found: found, ..some };
    assert_eq!(
        health(&dated, None, &scene, &settings)[1].in_words(),
        "2.0 mm in head and shoulders at 3.8 s"
    );
}

#[test]
fn gauges_of_a_resting_body_have_no_time() {
    let still = Scene { clip: None, ..Scene::clone(&scene()) };
    let settings = SimulationSettings::default();
    let mut engine = Engine::new(std::sync::Arc::new(still), settings);
    engine.advance_to_step(20);
    let frame = engine.snapshot();
    let stretch = &frame.health(&settings)[0];
    assert!(stretch.at.is_some() && frame.place_of(stretch).is_some(), "{stretch:?}");
    assert_eq!((stretch.found_secs(), stretch.when_in_words()), (None, None));
}

#[test]
fn advice_names_existing_controls() {
    let (scene, settings) = (scene(), SimulationSettings::default());
    let advice = |within| {
        let inside = Some(InsidePoint { depth_m: 0.05, guide: 0, point: 9, within });
        let totals = Totals { max_penetration_m: 0.05, deepest: inside, ..Totals::default() };
        let told = health(&totals, inside, &scene, &settings);
        [told[1].advice.clone(), told[5].advice.clone()]
    };
    let [hair, style] = advice(BodyPart::Field);
    assert!(hair.contains("raise Lift (Colliders, Head and shoulders)"), "{hair}");
    assert!(style.contains("lower Lift (Colliders, Head and shoulders)"), "{style}");
    let [hair, style] = advice(BodyPart::Collider(0));
    let name = &scene.colliders[0].name;
    assert!(hair.contains(&format!("raise Size of {name} (Colliders)")), "{hair}");
    assert!(style.contains(&format!("lower Size of {name} (Colliders)")), "{style}");
    for said in [hair, style] {
        assert!(!said.contains("Lift"), "the skin's control has no effect on a shape: {said}");
    }
}

#[test]
fn the_worst_value_is_kept_with_its_time_and_position() {
    let project = small_project();
    let mut engine = settled(load(&project).0, &project);
    let duration = engine.scene().duration_secs();
    // After its end the timeline starts again.
    engine.seek(duration - 0.5);
    engine.settle();
    let (mut stretch, mut energy) = ((0.0, None), (0.0, None));
    for _ in 0..60 {
        engine.step();
        let frame = engine.snapshot();
        let here = |at| {
            let place = frame.guide_point(at).expect("a point");
            Occurrence { at_secs: Some(frame.position_secs), place }
        };
        if frame.report.max_stretch > stretch.0 {
            stretch = (frame.report.max_stretch, frame.report.worst_stretch_at.map(here));
        }
        if frame.report.kinetic_energy > energy.0 {
            energy = (frame.report.kinetic_energy, frame.report.fastest_at.map(here));
        }
    }
    let totals = engine.totals();
    assert_eq!((totals.max_stretch, totals.worst_stretch_found), stretch);
    assert_eq!((totals.max_kinetic_energy, totals.fastest_found), energy);
    let found = energy.1.expect("hair moves");
    assert!(found.at_secs.is_some_and(|secs| (0.0..duration).contains(&secs)), "{found:?} of {duration} s");
    // The point has moved since, and the gauge returns its old position.
    let frame = engine.snapshot();
    let gauges = health(&totals, None, &frame.scene, &project.simulation);
    let now = frame.guide_point(totals.fastest_at.expect("a point")).expect("a point");
    assert_eq!(frame.place_of(&gauges[3]), Some(found.place));
    assert!(now.distance(found.place) > 1e-3, "{now} is still at {}", found.place);
    // A value of this instant is at the point's current position.
    let gauges = frame.health(&project.simulation);
    let at = frame.report.fastest_at.expect("a point");
    assert_eq!(frame.place_of(&gauges[3]), frame.guide_point(at));
}

#[test]
fn penetration_at_rest_is_shown_at_the_style() {
    let project = small_project();
    let mut engine = settled(load(&project).0, &project);
    engine.advance_to_step(90);
    let frame = engine.snapshot();
    let tip = frame.scene.style.guides.points_per_guide as u32 - 1;
    let rest = InsidePoint { depth_m: 0.05, guide: 3, point: tip, within: BodyPart::Field };
    let gauge = &health(&Totals::default(), Some(rest), &frame.scene, &project.simulation)[5];
    let place = frame.place_of(gauge).expect("a place");
    // Positions relative to the head do not change.
    let in_head = frame.guides.world_from_head.inverse().transform_point3(place);
    let drawn = frame.scene.style.guides.point(3, tip as usize);
    assert!(in_head.distance(drawn) < 1e-5, "{in_head} was drawn at {drawn}");
    let swung = frame.guide_point((3, tip)).expect("a point");
    assert!(swung.distance(place) > 5e-3, "the guide has not moved: {swung}, {place}");
}

#[test]
fn shipped_styles_are_good_over_the_dance_and_hair_in_a_storm_with_one_substep_is_not() {
    for preset in sample(lovelock_groom::Preset::ALL, 4) {
        let mut project = small_project();
        project.set_preset(preset);
        project.hair.groom.wisps = 24;
        project.hair.groom.strands_per_wisp = 3;
        let scene = load(&project).0;
        let mut engine = settled(scene, &project);
        engine.advance_to_step(if is_long() { 240 } else { 120 });
        let frame = engine.snapshot();
        let totals = engine.totals();
        println!("{}: {totals:?} {:?}", preset.id(), frame.rest_inside);
        for gauge in health(&totals, frame.rest_inside, &frame.scene, &project.simulation) {
            // The simulator's own tests check penetration over whole dances.
            if gauge.kind != GaugeKind::Penetration {
                assert_eq!(gauge.level, HealthLevel::Good, "{}: {gauge:?}", preset.id());
            }
        }
        let at = totals.fastest_at.expect("a fastest point");
        assert!(frame.guide_point(at).is_some_and(glam::Vec3::is_finite));
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
    let gauge = &torn.health(&storm.simulation)[3];
    assert_eq!(gauge.level, HealthLevel::Wrong);
    assert!(gauge.advice.contains("wind"), "{gauge:?}");
}
