//! The three integrators compared: `compare_integrators [--quick]` prints a table.
//!
//! - *pendulum*: a chain of 30 links of 1 cm released from a horizontal position. Tip error: RMS over 0.4 s
//!   against the equations of motion in double precision (Runge-Kutta, 12 kHz). Energy: the largest gain over
//!   10 s, and what remains at the end.
//! - *dance*: the same chain on a sway of 25 cm at 2.2 Hz with a bob and a spin, its root at up to 3.5 m/s. A
//!   fast head raises the number of substeps; the table gives their mean.
//! - *cost*: CPU time of one thread for 402 such chains, without colliders, wind and grid, per point and
//!   substep.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_simulation::{Integrator, Simulation, SimulationSettings, Wind};
use lovelock_testkit::clock::thread_time;

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, bare, frame, head, reference::Chain, straight, stretches, style};

const LINKS: usize = 30;
const LENGTH: f32 = 0.3;

/// The frames of the comparison with the reference: 0.4 s.
const FRAMES: u32 = 24;

struct Method {
    name: String,
    settings: SimulationSettings,
}

fn methods() -> Vec<Method> {
    let with = |name: &str, settings: SimulationSettings| Method { name: name.to_owned(), settings };
    let relaxation = |sweeps| SimulationSettings {
        integrator: Integrator::Relaxation,
        relaxation_sweeps: sweeps,
        ..bare()
    };
    let follow = |damping| SimulationSettings {
        integrator: Integrator::FollowTheLeader,
        follow_damping: damping,
        ..bare()
    };
    vec![
        with("relaxation, 4 sweeps", relaxation(4)),
        with("relaxation, 20 sweeps", relaxation(20)),
        with("follow the leader, no correction", follow(0.0)),
        with("follow the leader, 0.9", follow(0.9)),
        with("direct", bare()),
    ]
}

fn level() -> Vec<Vec3> {
    straight(Vec3::ZERO, Vec3::X, LINKS, LENGTH)
}

fn chain() -> Simulation {
    let mut simulation = Simulation::new(style(&[level()]));
    simulation.reset(&head(0.0, Affine3A::IDENTITY));
    simulation
}

#[derive(Default)]
struct Stretch {
    squares: f64,
    count: f64,
    most: f32,
}

impl Stretch {
    fn take(&mut self, simulation: &Simulation) {
        for s in stretches(simulation) {
            self.squares += f64::from(s) * f64::from(s);
            self.count += 1.0;
            self.most = self.most.max(s);
        }
    }

    fn text(&self) -> String {
        format!("{} / {}", percent((self.squares / self.count).sqrt()), percent(f64::from(self.most)))
    }
}

/// In per cent if it exceeds the rounding of positions.
fn percent(v: f64) -> String {
    if v > 1e-4 { format!("{:.3} %", 100.0 * v) } else { format!("{v:.0e}") }
}

/// Tip error in metres, stretch, energy gained and energy remaining of the pendulum.
fn pendulum(settings: &SimulationSettings, truth: &[glam::DVec3], secs: u32) -> (f64, Stretch, f64, f64) {
    let mut simulation = chain();
    let (mut squares, mut stretch) = (0.0, Stretch::default());
    let energy = |s: &Simulation, kinetic: f32| {
        let guides = frame(s).guides;
        let height: f32 = (1..=LINKS).map(|i| guides.point(0, i).y).sum();
        f64::from(kinetic) + 9.81 * f64::from(height / LINKS as f32)
    };
    let start = energy(&simulation, 0.0);
    let (mut most, mut last) = (f64::MIN, 0.0);
    for step in 1..=secs * 60 {
        let input = head(f64::from(step) / 60.0, Affine3A::IDENTITY);
        let report = simulation.step(&input, settings, STEP_SECS);
        last = energy(&simulation, report.kinetic_energy);
        most = most.max(last);
        if let Some(truth) = truth.get(step as usize - 1) {
            let tip = frame(&simulation).guides.point(0, LINKS).as_dvec3();
            squares += (tip - *truth).length_squared();
            stretch.take(&simulation);
        }
    }
    ((squares / truth.len() as f64).sqrt(), stretch, most - start, last - start)
}

/// Stretch over 10 s of the dance, and the mean number of substeps.
fn dance(settings: &SimulationSettings) -> (Stretch, f64) {
    let mut simulation = chain();
    let (mut stretch, mut substeps) = (Stretch::default(), 0.0);
    for step in 1..=600 {
        let time = f64::from(step) / 60.0;
        let report = simulation.step(&head(time, common::violent(time)), settings, STEP_SECS);
        substeps += f64::from(report.substeps) / 600.0;
        stretch.take(&simulation);
    }
    (stretch, substeps)
}

/// Nanoseconds of one thread per point and substep.
fn cost(settings: &SimulationSettings, rounds: u32) -> f64 {
    let guides: Vec<_> = (0..402)
        .map(|g| {
            let turn = 2.4 * g as f32;
            let out = Vec3::new(turn.cos(), 0.3 - 0.002 * g as f32, turn.sin()).normalize_or(Vec3::Y);
            straight(out * 0.1, out, LINKS, LENGTH)
        })
        .collect();
    let style = style(&guides);
    let settings = SimulationSettings { wind: Wind::default(), ..*settings };
    let mut best = f64::INFINITY;
    for _ in 0..rounds {
        let mut simulation = Simulation::new(Arc::clone(&style));
        simulation.reset(&head(0.0, Affine3A::IDENTITY));
        let start = thread_time();
        let mut substeps = 0.0;
        for step in 1..=60 {
            let input = head(f64::from(step) / 60.0, Affine3A::IDENTITY);
            substeps += f64::from(simulation.step(&input, &settings, STEP_SECS).substeps);
        }
        let spent = thread_time().saturating_sub(start).as_secs_f64();
        best = best.min(1e9 * spent / (substeps * (402 * LINKS) as f64));
    }
    best
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    let reference = |hertz: u32| Chain::new(&level(), 9.81).tips(FRAMES, 1.0 / 60.0, hertz / 60);
    let truth = reference(12_000);
    let coarser = reference(6_000);
    let converged = truth.iter().zip(&coarser).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
    println!("The reference at 12 kHz and at 6 kHz differ by {converged:.1e} m.\n");
    println!(
        "| method | substeps | tip error, m | pendulum stretch rms / max | energy gained / after 10 s, J/kg | \
         dance stretch rms / max (substeps) | ns |"
    );
    println!("|---|---|---|---|---|---|---|");
    // One thread, so that its time is the total.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        for method in methods() {
            for substeps in [1, 4, 16] {
                let settings = SimulationSettings { substeps, ..method.settings };
                let (tip, stretch, gained, left) = pendulum(&settings, &truth, if quick { 1 } else { 10 });
                let (danced, taken) = dance(&settings);
                let ns = cost(&settings, if quick { 1 } else { 5 });
                println!(
                    "| {} | {substeps} | {tip:.4} | {} | {gained:+.3} / {left:+.2} | {} ({taken:.1}) | {ns:.1} |",
                    method.name,
                    stretch.text(),
                    danced.text()
                );
            }
        }
    });
    Ok(())
}
