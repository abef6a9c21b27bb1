use lovelock_wisp::BodyPart;

use super::*;
use crate::session::tests::{load, scene, small_project};
use lovelock_wisp::StepReport;

use crate::Engine;

#[test]
fn good_hair_gets_no_advice_and_every_limit_has_a_sentence() {
    let settings = SimulationSettings::default();
    let scene = scene();
    let well = health(&Totals::default(), None, &scene, &settings);
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
    let rest = InsidePoint { depth_m: 0.05, guide: 1, point: 2, within: BodyPart::Collider(0) };
    let told = health(&ill, Some(rest), &scene, &settings);
    assert!(told[4].advice.contains(&scene.colliders[0].name), "{told:?}");
    assert_eq!(told[4].within.as_ref(), Some(&scene.colliders[0].name));
    assert_eq!(told[4].in_words(), format!("50.0 mm in {}", scene.colliders[0].name));
    assert!(well.iter().chain(&told[..4]).all(|gauge| gauge.within.is_none()), "{told:?}");
    for gauge in told {
        assert_eq!(gauge.level, HealthLevel::Wrong, "{gauge:?}");
        assert!(gauge.advice.ends_with('.') && gauge.fill() == 1.0, "{gauge:?}");
        assert!(!gauge.kind.in_words(gauge.value).is_empty());
    }
    let inside = InsidePoint { depth_m: 2e-3, guide: 0, point: 9, within: BodyPart::Field };
    let some = Totals { max_penetration_m: 2e-3, deepest: Some(inside), ..Totals::default() };
    let watched = health(&some, None, &scene, &settings);
    assert_eq!(watched[1].level, HealthLevel::Watch);
    assert_eq!(watched[1].in_words(), "2.0 mm in head and shoulders");
    assert!((watched[1].fill() - 0.4).abs() < 1e-6);
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
        println!("{}: {totals:?} {:?}", preset.id(), frame.rest_inside);
        for gauge in health(&totals, frame.rest_inside, &frame.scene, &project.simulation) {
            // How deep hair goes is held by the simulator's own tests, over whole dances.
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
    let gauge = &torn.health(&storm.simulation)[2];
    assert_eq!(gauge.level, HealthLevel::Wrong);
    assert!(gauge.advice.contains("wind"), "{gauge:?}");
}
