//! Contacts whose result is known on paper.

use glam::{Affine3A, Vec3};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};

use crate::common::{bare, straight, style};
use crate::{device, points, step_on};

fn ball(centre: Vec3, radius: f32) -> PlacedCollider {
    let shape = ColliderShape::Capsule { a: centre, b: centre, radius_a: radius, radius_b: radius };
    PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY }
}

fn still(step: i32, colliders: &[PlacedCollider]) -> StepInput<'_> {
    StepInput::new(f64::from(step) / 60.0, Affine3A::IDENTITY, colliders)
}

#[test]
fn a_link_that_falls_on_a_ball_rests_where_the_triangle_closes() {
    let Some(mut device) = device() else { return };
    let (length, radius, margin) = (0.1, 0.05, 0.003);
    let centre = Vec3::new(0.07, -0.08, 0.0);
    // The ball keeps its place relative to the head, so that layers would keep their height over it.
    let settings = SimulationSettings { skin_margin: margin, layering: 0.0, settle: 8.0, ..bare() };
    let balls = [ball(centre, radius)];
    let mut simulation = Simulation::new(style(&[straight(Vec3::ZERO, Vec3::X, 1, length)]));
    simulation.reset(&still(0, &balls));
    for step in 1..120 {
        step_on(&mut device, &mut simulation, &still(step, &balls), &settings, 1.0 / 60.0);
    }
    let tip = points(&simulation)[1];
    // The triangle of root, tip and centre: cos g = (l^2 + D^2 - R^2) / (2 l D), R with the margin.
    let (far, touching) = (centre.length(), radius + margin);
    let angle = ((length * length + far * far - touching * touching) / (2.0 * length * far)).acos();
    let beside = centre.y.atan2(centre.x) + angle;
    let wanted = length * Vec3::new(beside.cos(), beside.sin(), 0.0);
    println!("{tip} for {wanted}");
    // Measured: 0.01 micrometres.
    assert!(tip.distance(wanted) < 5e-6, "{tip} for {wanted}");
    // Control: without the ball it hangs.
    let mut free = Simulation::new(style(&[straight(Vec3::ZERO, Vec3::X, 1, length)]));
    free.reset(&still(0, &[]));
    for step in 1..120 {
        step_on(&mut device, &mut free, &still(step, &[]), &settings, 1.0 / 60.0);
    }
    assert!(points(&free)[1].y < -0.09, "{}", points(&free)[1]);
}

#[test]
fn falling_guides_stay_outside_of_balls_and_ellipsoids() {
    let Some(mut device) = device() else { return };
    let guides: Vec<_> =
        (0..20).map(|g| straight(Vec3::new(0.0, 0.2, 0.01 * g as f32), Vec3::X, 20, 0.3)).collect();
    let egg = Affine3A::from_scale(Vec3::new(0.1, 0.06, 0.3));
    let egg = PlacedCollider {
        shape: ColliderShape::Ellipsoid {
            from_unit: Affine3A::from_translation(Vec3::new(0.15, 0.02, 0.1)) * egg,
        },
        world_from_rest: Affine3A::IDENTITY,
    };
    let bodies = [ball(Vec3::new(0.05, 0.05, 0.1), 0.06), egg];
    // The deepest point of any step, by the surfaces themselves.
    let run = |device: &mut crate::GuideDevice, given: &[PlacedCollider]| {
        let mut simulation = Simulation::new(style(&guides));
        simulation.reset(&still(0, given));
        let mut deepest = 0.0_f32;
        for step in 1..60 {
            let report = step_on(device, &mut simulation, &still(step, given), &bare(), 1.0 / 60.0);
            assert!(report.max_stretch < 1e-5, "{}", report.max_stretch);
            assert!(report.max_penetration_m < 1e-4, "step {step}: {report:?}");
            let depth = |p: &Vec3| {
                let of = |body: &PlacedCollider| -lovelock_motion::signed_distance(&body.shape, *p);
                bodies.iter().map(of).fold(0.0, f32::max)
            };
            deepest = points(&simulation).iter().map(depth).fold(deepest, f32::max);
        }
        deepest
    };
    let deepest = run(&mut device, &bodies);
    println!("{deepest} m deep");
    assert!(deepest < 1e-4, "{deepest} m");
    // Control: without bodies the same guides pass through where they were.
    let through = run(&mut device, &[]);
    assert!(through > 0.02, "{through} m");
}
