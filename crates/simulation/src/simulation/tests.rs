use glam::{Affine3A, Quat};
use lovelock_groom::Guides;
use lovelock_motion::ColliderShape;

use super::*;
use crate::lanes::splat3;
use crate::{Integrator, Wind};

/// Thirty guides around a head of 8 cm, and the skull that they collide with.
fn head_of_hair() -> (Simulation, PlacedCollider) {
    let mut guides = Guides { points_per_guide: 16, ..Guides::default() };
    for g in 0..30 {
        let out = Vec3::new((g as f32).cos(), -0.3 + 0.03 * g as f32, (g as f32).sin()).normalize_or(Vec3::Y);
        let points: Vec<Vec3> = (0..16).map(|i| out * (0.08 + 0.015 * i as f32)).collect();
        guides.push(&points);
    }
    let shape = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: 0.08, radius_b: 0.08 };
    let skull = PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY };
    let mut simulation = Simulation::new(Arc::new(Hairstyle { guides, ..Hairstyle::default() }));
    simulation.reset(&input(0, &[skull]));
    (simulation, skull)
}

fn input(step: i32, colliders: &[PlacedCollider]) -> StepInput<'_> {
    let turn = Quat::from_rotation_y((step as f32 * 0.1).sin());
    StepInput::new(f64::from(step) / 60.0, Affine3A::from_quat(turn), colliders)
}

fn settings() -> SimulationSettings {
    let mut settings = SimulationSettings::default();
    settings.wind.speed = 3.0;
    settings
}

#[test]
fn all_vector_widths_give_the_same_bits() {
    for integrator in Integrator::ALL {
        let (mut wide, skull) = head_of_hair();
        let mut portable = Simulation { wide: false, ..wide.clone() };
        let settings = SimulationSettings { integrator, ..settings() };
        for step in 1..90 {
            wide.step(&input(step, &[skull]), &settings, 1.0 / 60.0);
            portable.step(&input(step, &[skull]), &settings, 1.0 / 60.0);
            assert_eq!(wide.state_hash(), portable.state_hash(), "{integrator:?}, step {step}");
        }
    }
}

#[test]
fn a_non_finite_guide_is_reset_and_counted_and_keeps_moving() {
    let (mut disturbed, skull) = head_of_hair();
    for step in 1..20 {
        disturbed.step(&input(step, &[skull]), &settings(), 1.0 / 60.0);
    }
    let mut undisturbed = disturbed.clone();
    let (block, lane) = disturbed.slots[17];
    let (mut lost, block, lane) = (disturbed.clone(), block as usize, lane as usize);
    lost.blocks[block].position[7][1][lane] = f32::INFINITY;
    let length = std::mem::replace(&mut disturbed.blocks[block].rest.length[7][lane], f32::NAN);
    let report = disturbed.step(&input(20, &[skull]), &settings(), 1.0 / 60.0);
    disturbed.blocks[block].rest.length[7][lane] = length;
    undisturbed.step(&input(20, &[skull]), &settings(), 1.0 / 60.0);
    assert_eq!((report.recovered_guides, report.recovered_at), (1, Some(17)));
    let tip = |s: &Simulation, guide: usize| {
        let (block, lane) = s.slots[guide];
        at(&s.blocks[block as usize].position[15], lane as usize)
    };
    // It was reset to where it was and carried with the head, so it is near where it would have been.
    assert!(
        (tip(&disturbed, 17) - tip(&undisturbed, 17)).length() < 0.05,
        "{} against {}",
        tip(&disturbed, 17),
        tip(&undisturbed, 17)
    );
    // A guide whose stored pose is lost too is reset to its rest pose.
    let report = lost.step(&input(20, &[skull]), &settings(), 1.0 / 60.0);
    assert_eq!((report.recovered_guides, report.recovered_at), (1, Some(17)));
    let styled = at(&lost.blocks[block].rest.position[15], lane);
    let styled = lost.head.map_from_head(lost.head.place).apply(styled);
    assert!((tip(&lost, 17) - styled).length() < 1e-5, "{} against {styled}", tip(&lost, 17));
    let before = tip(&disturbed, 17);
    for step in 21..60 {
        let report = disturbed.step(&input(step, &[skull]), &settings(), 1.0 / 60.0);
        undisturbed.step(&input(step, &[skull]), &settings(), 1.0 / 60.0);
        assert_eq!(report.recovered_guides, 0);
        assert!(report.max_stretch < 1e-5);
    }
    assert!((tip(&disturbed, 17) - before).length() > 0.01, "it must keep moving");
    // After half a second it is back to the undisturbed motion.
    assert!((tip(&disturbed, 17) - tip(&undisturbed, 17)).length() < 0.02);
}

#[test]
fn clamping_more_links_than_a_guide_has_clamps_it_entirely() {
    let mut guides = Guides { points_per_guide: 2, ..Guides::default() };
    guides.push(&[Vec3::ZERO, Vec3::X * 0.1]);
    let mut simulation = Simulation::new(Arc::new(Hairstyle { guides, ..Hairstyle::default() }));
    simulation.reset(&input(0, &[]));
    let stiff = SimulationSettings { clamped_links: 2, ..settings() };
    for step in 1..20 {
        simulation.step(&input(step, &[]), &stiff, 1.0 / 60.0);
    }
    let tip = input(19, &[]).world_from_head.transform_point3(Vec3::X * 0.1);
    assert!((at(&simulation.blocks[0].position[1], 0) - tip).length() < 1e-6);
}

#[test]
fn a_report_locates_its_maxima() {
    let (mut simulation, skull) = head_of_hair();
    for step in 1..40 {
        let report = simulation.step(&input(step, &[skull]), &settings(), 1.0 / 60.0);
        let points = |guide: u32| {
            let (block, lane) = simulation.slots[guide as usize];
            (&simulation.blocks[block as usize], lane as usize)
        };
        let (guide, point) = report.worst_stretch_at.expect("rounding stretches some link");
        let (block, lane) = points(guide);
        assert_eq!(block.stretch(lane, point as usize), report.max_stretch);
        let (guide, point) = report.fastest_at.expect("hair that moves");
        let (block, lane) = points(guide);
        assert_eq!(at(&block.velocity[point as usize], lane).length_squared().sqrt(), report.max_speed);
        assert_eq!(report.recovered_at, None);
    }
}

/// A skull with hair on it, its field, and a motion in which neck and shoulders turn under it.
#[test]
fn culling_does_not_change_the_motion() {
    use lovelock_motion::{BodyField, FieldPose, Pose, RestDistance, load_character, pose_at};
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    let character = load_character(&file).expect("the shipped dancer loads");
    let (body, dance) = (&character.body, &character.clips[0]);
    let field = Arc::new(BodyField::new(body, &RestDistance::new(body)).expect("a field"));
    let mut guides = Guides { points_per_guide: 16, ..Guides::default() };
    for g in 0..40 {
        let around = g as f32 * 0.7;
        let out = Vec3::new(around.sin(), 0.2, around.cos() - 0.4).normalize_or(Vec3::Y);
        let points: Vec<Vec3> =
            (0..16).map(|i| Vec3::new(0.0, 0.09 - 0.012 * i as f32, 0.0) + out * 0.13).collect();
        guides.push(&points);
    }
    let run = |culling: bool, with_field: bool, is_asked: bool| {
        let mut simulation =
            Simulation::new(Arc::new(Hairstyle { guides: guides.clone(), ..Hairstyle::default() }));
        simulation.culling = culling;
        let (mut pose, mut placed) = (Pose::default(), FieldPose::default());
        for step in 0..150 {
            pose_at(body, Some(dance), f64::from(step) / 60.0, &mut pose);
            field.place(body, &pose, 0.0, &mut placed);
            let place = with_field.then_some(crate::PlacedField { field: &field, pose: &placed });
            let input = StepInput {
                field: place,
                ..StepInput::new(f64::from(step) / 60.0, pose.world_from_head, &[])
            };
            if step == 0 {
                simulation.reset(&input);
            } else {
                simulation.step(&input, &settings(), 1.0 / 60.0);
            }
            if is_asked {
                simulation.body_now().distance(Vec3::new(0.1, -0.1, 0.0), (1.0, Vec3::Y));
            }
        }
        simulation.state_hash()
    };
    let culled = run(true, true, false);
    assert_eq!(culled, run(false, true, false), "culling changes the motion");
    assert_eq!(culled, run(true, true, true), "asking for the body changes the motion");
    assert_ne!(culled, run(true, false, false), "no hair touches the field: the test proves nothing");
}

#[test]
fn sheltering_shapes_block_the_wind_but_not_the_hair() {
    let mut guides = Guides { points_per_guide: 11, ..Guides::default() };
    guides.push(&std::array::from_fn::<Vec3, 11, _>(|i| Vec3::NEG_Y * (0.02 * i as f32)));
    let style = Arc::new(Hairstyle { guides, ..Hairstyle::default() });
    let wind = Wind { speed: 3.0, gusts: 0.0, turbulence: 0.0, ..Wind::default() };
    let windy = SimulationSettings { wind, ..settings() };
    let ball = |x: f32| {
        let at = Vec3::new(x, -0.1, 0.0);
        let shape = ColliderShape::Capsule { a: at, b: at, radius_a: 0.15, radius_b: 0.15 };
        PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY }
    };
    let blown = |sheltering: &[PlacedCollider]| {
        let mut simulation = Simulation::new(Arc::clone(&style));
        simulation.reset(&StepInput { sheltering, ..StepInput::new(0.0, Affine3A::IDENTITY, &[]) });
        for step in 1..120 {
            let still = StepInput::new(f64::from(step) / 60.0, Affine3A::IDENTITY, &[]);
            simulation.step(&StepInput { sheltering, ..still }, &windy, 1.0 / 60.0);
        }
        at(&simulation.blocks[0].position[10], 0).x
    };
    let (open, lee, beside) = (blown(&[]), blown(&[ball(-0.3)]), blown(&[ball(0.4)]));
    assert!(open > 0.01 && lee < 0.5 * open, "{open} m in the open, {lee} m in the lee");
    // Control: a shape downwind shelters nothing.
    assert!((beside - open).abs() < 0.05 * open, "{beside} m upwind, {open} m in the open");
}

#[test]
fn invisibly_short_links_report_no_stretch() {
    // As in some hair files: a link of 0.1 micrometres, a tenth of a metre from the head joint.
    let mut guides = Guides { points_per_guide: 11, ..Guides::default() };
    guides.push(&std::array::from_fn::<Vec3, 11, _>(|i| Vec3::new(0.0, 0.1, 1e-7 * i as f32)));
    let mut simulation = Simulation::new(Arc::new(Hairstyle { guides, ..Hairstyle::default() }));
    simulation.reset(&input(0, &[]));
    let (mut seen, mut of_itself) = (0.0_f32, 0.0_f32);
    for step in 1..60 {
        seen = seen.max(simulation.step(&input(step, &[]), &settings(), 1.0 / 60.0).max_stretch);
        let block = &simulation.blocks[0];
        let length = |i: usize| (at(&block.position[i], 0) - at(&block.position[i - 1], 0)).length();
        of_itself =
            (2..11).map(|i| (length(i) * block.rest.inv_length[i][0] - 1.0).abs()).fold(of_itself, f32::max);
    }
    // Half a unit in the last place at 0.1 m is 3.7 nanometres for each coordinate of either end.
    println!("{seen} reported, {of_itself} relative to its own length");
    assert!(seen < 2e-5, "{seen}");
    assert!(of_itself > 1e-3, "control, measured 0.5 %: {of_itself} relative to its own length");
}

#[test]
fn factorised_directions_are_part_of_the_state() {
    let (mut whole, skull) = head_of_hair();
    let slowly = |simulation: &mut Simulation, step: i32| {
        let turn = Quat::from_rotation_y(0.04 * (0.4 * step as f32).sin());
        let colliders = [skull];
        let at = StepInput::new(f64::from(step) / 60.0, Affine3A::from_quat(turn), &colliders);
        simulation.step(&at, &SimulationSettings::default(), 1.0 / 60.0);
        simulation.state_hash()
    };
    for step in 1..30 {
        slowly(&mut whole, step);
    }
    let (mut again, mut other) = (whole.clone(), whole.clone());
    again.blocks.iter_mut().for_each(|block| block.coupled.invalidate_factor());
    other.blocks.iter_mut().for_each(|block| block.coupled.reset());
    let same = slowly(&mut whole, 30);
    assert_eq!(slowly(&mut again, 30), same, "the directions determine the factor");
    assert_ne!(slowly(&mut other, 30), same, "control: other directions give another factor");
}

#[test]
fn clamping_and_releasing_links_leaves_no_unsaved_state() {
    let (mut whole, _) = head_of_hair();
    let stepped = |simulation: &mut Simulation, step: i32, clamped_links: u32| {
        let settings = SimulationSettings { clamped_links, ..settings() };
        simulation.step(&input(step, &[]), &settings, 1.0 / 60.0);
        simulation.state_hash()
    };
    stepped(&mut whole, 1, 1);
    // Contacts have displaced the points that are clamped next.
    for block in &mut whole.blocks {
        block.contact_push[2] = splat3(Vec3::splat(1e-3));
        block.has_contact_push = true;
    }
    for step in 2..6 {
        stepped(&mut whole, step, 2);
    }
    let mut other = whole.clone();
    other.restore(&whole.save()).expect("its own bytes");
    for step in 6..20 {
        assert_eq!(stepped(&mut whole, step, 1), stepped(&mut other, step, 1), "step {step}");
    }
}
