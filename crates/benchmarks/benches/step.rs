//! The cost of a step: the published hairstyle on the dancer, every strand simulated by itself, and scaling.
//!
//! Wall time as criterion measures it. With `LOVELOCK_BENCH_CLOCK=process` it is the CPU time of all threads,
//! which does not include other work on the machine: on two cores that share the work evenly, half of it is
//! the wall time.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{BenchmarkGroup, Criterion, Throughput};
use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::Preset;
use lovelock_motion::{BodyField, FieldPose, PlacedCollider};
use lovelock_simulation::{Integrator, PlacedField, Simulation, SimulationSettings, StepInput, Wind};
use lovelock_testkit::clock::process_time;

#[path = "../../simulation/tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage, straight, style};

/// A body at one instant.
struct Moment {
    world_from_head: Affine3A,
    colliders: Vec<PlacedCollider>,
    field: FieldPose,
}

/// Instants of a motion, 1/60 s apart, and the field that is placed in them.
struct Poses {
    moments: Vec<Moment>,
    field: Option<Arc<BodyField>>,
}

impl Poses {
    /// Two seconds of the dance at a fraction of its speed, computed in advance, so that only the hair is
    /// measured. At a quarter of the speed four substeps are nearly always enough; at full speed quick turns
    /// need up to sixteen.
    fn of(stage: &mut Stage, speed: f64) -> Self {
        let moment = |i: u32| {
            let input = stage.at(Some(f64::from(i) / 60.0 * speed));
            Moment {
                world_from_head: input.world_from_head,
                colliders: input.colliders.to_vec(),
                field: input.field.map_or_else(FieldPose::default, |field| field.pose.clone()),
            }
        };
        Self { moments: (0..120).map(moment).collect(), field: stage.field.clone() }
    }
}

/// Steps through `poses` repeatedly, back and forth, so that the clock never jumps far.
fn bench_steps<M: Measurement>(
    group: &mut BenchmarkGroup<M>,
    name: &str,
    mut simulation: Simulation,
    settings: &SimulationSettings,
    poses: &Poses,
) {
    let (mut next, mut clock, count) = (0, 0.0, poses.moments.len());
    group.bench_function(name, |b| {
        b.iter(|| {
            next = (next + 1) % (2 * count);
            clock += f64::from(STEP_SECS);
            let moment = &poses.moments[next.min(2 * count - 1 - next)];
            let field = poses.field.as_ref().map(|field| PlacedField { field, pose: &moment.field });
            let input =
                StepInput { field, ..StepInput::new(clock, moment.world_from_head, &moment.colliders) };
            black_box(simulation.step(&input, settings, STEP_SECS))
        });
    });
}

/// The published hairstyle on the dancer, with every integrator: on all her fitted colliders, like the
/// paper's spheres for the whole body, and on the program's body, whose field replaces head and shoulders.
fn published<M: Measurement>(c: &mut Criterion<M>) {
    let calm = SimulationSettings::default();
    let windy = SimulationSettings { wind: Wind { speed: 4.0, ..Wind::default() }, ..calm };
    let relaxed = SimulationSettings { integrator: Integrator::Relaxation, ..calm };
    let follows = SimulationSettings { integrator: Integrator::FollowTheLeader, ..calm };
    for (preset, field) in [(Preset::Smooth, false), (Preset::Smooth, true), (Preset::Long, false)] {
        let mut stage = Stage::new(preset);
        if !field {
            stage = stage.without_field();
        }
        let (slow, quick) = (Poses::of(&mut stage, 0.25), Poses::of(&mut stage, 1.0));
        let guides = &stage.style.guides;
        let mut group = c.benchmark_group(format!(
            "step of {} guides x {} links, {} colliders{}",
            guides.count(),
            guides.points_per_guide - 1,
            stage.colliders.len(),
            if field { " and the field" } else { "" }
        ));
        for (what, settings, poses) in [
            ("slow", calm, &slow),
            ("slow, relaxation with 20 sweeps", relaxed, &slow),
            ("slow, follow the leader", follows, &slow),
            ("quick", calm, &quick),
            ("quick, wind", windy, &quick),
        ] {
            bench_steps(&mut group, what, stage.simulation(Some(0.0)), &settings, poses);
        }
        group.finish();
    }
}

/// Guides of 30 links on a rotating sphere of 9 cm, four substeps, without a body.
fn strands<M: Measurement>(c: &mut Criterion<M>) {
    let mut group = c.benchmark_group("strands of 30 links, no body");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    let moment = |i: u32| {
        let time = f64::from(i) / 60.0;
        let world_from_head = Affine3A::from_quat(Quat::from_rotation_y(0.3 * (3.0 * time).sin() as f32));
        Moment { world_from_head, colliders: Vec::new(), field: FieldPose::default() }
    };
    let poses = Poses { moments: (0..60).map(moment).collect(), field: None };
    for count in [402, 1_000, 3_350, 10_000, 20_000, 50_000, 100_000] {
        let guides: Vec<_> = (0..count)
            .map(|g| {
                // A spiral over the sphere (Fibonacci lattice).
                let y = 1.0 - 1.6 * g as f32 / count as f32;
                let (r, turn) = ((1.0 - y * y).sqrt(), 2.399_963_2 * g as f32);
                let out = Vec3::new(r * turn.cos(), y, r * turn.sin());
                straight(out * 0.09, out, 30, 0.25)
            })
            .collect();
        let mut simulation = Simulation::new(Arc::clone(&style(&guides)));
        simulation.reset(&StepInput::new(0.0, Affine3A::IDENTITY, &[]));
        group.throughput(Throughput::Elements(count));
        let defaults = SimulationSettings::default();
        if count == 20_000 {
            let (half, two) = (simulation.clone(), SimulationSettings { substeps: 2, ..defaults });
            bench_steps(&mut group, "20000, two substeps", half, &two, &poses);
            let (lead, follows) = (simulation.clone(), Integrator::FollowTheLeader);
            let follows = SimulationSettings { integrator: follows, ..defaults };
            bench_steps(&mut group, "20000, follow the leader", lead, &follows, &poses);
        }
        bench_steps(&mut group, &format!("{count}"), simulation, &defaults, &poses);
    }
    group.finish();
}

/// CPU time of all threads of this process.
struct ProcessTime;

impl Measurement for ProcessTime {
    type Intermediate = Duration;
    type Value = Duration;

    fn start(&self) -> Duration {
        process_time()
    }

    fn end(&self, start: Duration) -> Duration {
        process_time().saturating_sub(start)
    }

    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }

    fn zero(&self) -> Duration {
        Duration::ZERO
    }

    fn to_f64(&self, value: &Duration) -> f64 {
        WallTime.to_f64(value)
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        WallTime.formatter()
    }
}

fn main() {
    if std::env::var_os("LOVELOCK_BENCH_CLOCK").is_some_and(|clock| clock == "process") {
        let mut c = Criterion::default().with_measurement(ProcessTime).configure_from_args();
        published(&mut c);
        strands(&mut c);
        c.final_summary();
    } else {
        let mut c = Criterion::default().configure_from_args();
        published(&mut c);
        strands(&mut c);
        c.final_summary();
    }
}
