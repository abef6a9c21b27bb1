#[path = "../../../tests/common/catenary.rs"]
mod catenary;

use glam::Vec3;

use super::*;

/// A zigzag of `points` points with links of 1 cm, the same in every lane.
fn zigzag(points: usize) -> Vec<Lane3> {
    let mut rows = vec![ZERO3; points];
    let mut p = Vec3::ZERO;
    for (i, row) in rows.iter_mut().enumerate() {
        let angle = i as f32 * 1.3;
        if i > 0 {
            p += 0.01 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        }
        for k in 0..LANES {
            put(row, k, p);
        }
    }
    rows
}

fn velocities(points: usize) -> Vec<Lane3> {
    let mut rows = vec![ZERO3; points];
    for (i, row) in rows.iter_mut().enumerate() {
        for k in 0..LANES {
            let s = (i * 7 + k * 3) as f32;
            put(row, k, Vec3::new(s.sin(), (2.0 * s).cos(), (0.5 * s).sin()));
        }
    }
    rows
}

/// Projects the velocities of a zigzag of twelve points onto rigid links of 1 cm, without advancing time.
fn project_zigzag(first_free: usize, x: &[Lane3], v: &mut [Lane3]) {
    let over_length = [Lane::splat(100.0); 12];
    project_velocity(first_free, x, &over_length, v, 0.0, &mut zigzag(12), &mut LengthScratch::new(12));
}

#[test]
fn projected_velocities_stretch_no_link() {
    for first_free in 0..3 {
        let (x, mut v) = (zigzag(12), velocities(12));
        for carried in &mut v[..first_free] {
            *carried = ZERO3;
        }
        project_zigzag(first_free, &x, &mut v);
        for i in first_free.max(1)..12 {
            for k in 0..LANES {
                let n = (at(&x[i], k) - at(&x[i - 1], k)) * 100.0;
                let rate = n.dot(at(&v[i], k) - at(&v[i - 1], k));
                // Speeds of 1 m/s in f32, twelve rows of elimination.
                assert!(rate.abs() < 1e-5, "link {i} of lane {k} stretches by {rate} m/s");
            }
        }
    }
}

#[test]
fn a_free_chain_keeps_its_momentum() {
    let (x, mut v) = (zigzag(12), velocities(12));
    let sum = |v: &[Lane3]| v.iter().fold(Vec3::ZERO, |s, row| s + at(row, 3));
    let before = sum(&v);
    project_zigzag(0, &x, &mut v);
    assert!((sum(&v) - before).length() < 1e-6 * 12.0, "{before} became {}", sum(&v));
    let mut held = velocities(12);
    project_zigzag(1, &x, &mut held);
    assert!((sum(&held) - before).length() > 0.01, "a held chain does not conserve momentum");
}

#[test]
fn a_newton_step_squares_the_length_error() {
    let mut x = zigzag(12);
    let length = [Lane::splat(0.01); 12];
    let worst = |x: &[Lane3]| {
        (1..12).map(|i| ((at(&x[i], 0) - at(&x[i - 1], 0)).length() / 0.01 - 1.0).abs()).fold(0.0, f32::max)
    };
    for (i, row) in x.iter_mut().enumerate().skip(1) {
        for k in 0..LANES {
            let p = at(row, k) + 0.0004 * Vec3::new((i as f32).sin(), (3.0 * i as f32).cos(), 0.3);
            put(row, k, p);
        }
    }
    let before = worst(&x);
    project_position(1, &length, &mut x, &mut LengthScratch::new(12));
    let after = worst(&x);
    assert!(before > 0.02 && after < 4.0 * before * before, "{before} became {after}");
}

/// Points of a chain of `links` links, 0.5 m long in all, held at both ends 0.3 m apart, after it has come to
/// rest under gravity by the projections alone, as a substep uses them.
fn hung_at_both_ends(links: usize, gravity: Vec3) -> Vec<Vec3> {
    let (length, h) = (0.5 / links as f32, 1.0 / 240.0);
    let mut scratch = LengthScratch { tip_held: 1.0, ..LengthScratch::new(links + 1) };
    // Starts as two straight halves that meet below, off the middle, so that the chain has to find its shape.
    let (end, left) = (Vec3::X * 0.3, links / 2 - 2);
    let (a, b) = (length * left as f32, length * (links - left) as f32);
    let x = (a * a - b * b + 0.09) / 0.6;
    let low = Vec3::new(x, -(a * a - x * x).sqrt(), 0.0);
    let mut position: Vec<Lane3> = (0..=links)
        .map(|i| {
            let p = if i <= left {
                low * (i as f32 / left as f32)
            } else {
                low.lerp(end, (i - left) as f32 / (links - left) as f32)
            };
            crate::lanes::splat3(p)
        })
        .collect();
    let mut velocity = vec![ZERO3; links + 1];
    let lengths = vec![Lane::splat(length); links + 1];
    let inv = vec![Lane::splat(1.0 / length); links + 1];
    for _ in 0..6000 {
        for v in &mut velocity[1..links] {
            let now = (at(v, 0) + gravity * h) * 0.99;
            *v = crate::lanes::splat3(now);
        }
        let before = position.clone();
        project_velocity(1, &before, &inv, &mut velocity, h, &mut position, &mut scratch);
        project_position(1, &lengths, &mut position, &mut scratch);
        for ((v, p), was) in velocity.iter_mut().zip(&position).zip(&before) {
            let now = (at(p, 0) - at(was, 0)) / h;
            *v = crate::lanes::splat3(now);
        }
    }
    position.iter().map(|p| at(p, 0)).collect()
}

/// Largest distance of a point from the curve, along Y.
fn off_the_catenary(points: &[Vec3]) -> f64 {
    let points: Vec<_> = points.iter().map(|p| p.as_dvec3()).collect();
    catenary::off_the_catenary(&points, 0.5, 0.3)
}

#[test]
fn a_chain_held_at_both_ends_hangs_as_a_catenary() {
    let down = Vec3::NEG_Y * 9.81;
    let fine = off_the_catenary(&hung_at_both_ends(40, down));
    let coarse = off_the_catenary(&hung_at_both_ends(10, down));
    println!("deviation from the catenary: {coarse} m with 10 links, {fine} m with 40");
    // A chain of n links deviates from its curve by the square of its link length: 1.8 mm and 0.11 mm
    // measured.
    assert!(fine < 2e-4, "{fine} m");
    assert!(coarse > 8.0 * fine, "{coarse} m with 10 links, {fine} m with 40");
    // Control: under a tilted gravity the curve is another one.
    let leant = off_the_catenary(&hung_at_both_ends(40, Vec3::new(3.0, -9.34, 0.0)));
    assert!(leant > 0.01, "{leant} m");
}

#[test]
fn the_horizontal_tension_of_a_hanging_chain_is_constant() {
    // The same in terms of the chain, exact for any number of links: the slopes of its links grow by equal
    // steps.
    let points = hung_at_both_ends(16, Vec3::NEG_Y * 9.81);
    let slopes: Vec<f32> = points.windows(2).map(|w| (w[1].y - w[0].y) / (w[1].x - w[0].x)).collect();
    let steps: Vec<f32> = slopes.windows(2).map(|w| w[1] - w[0]).collect();
    let mean = steps.iter().sum::<f32>() / steps.len() as f32;
    for step in &steps {
        assert!((step / mean - 1.0).abs() < 0.01, "step {step}, mean {mean}");
    }
    assert!(mean > 0.1, "a straight chain would prove nothing");
}
