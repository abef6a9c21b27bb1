//! Milliseconds per step of layers that follow the timeline: `cargo run --release -p lovelock-session --example keyed_layers`.
//!
//! Times are those of all threads, from `/proc/self/stat`, so that other work on the machine does not count; elsewhere wall time.

use lovelock_base::clock::Stopwatch;
use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::tracks::{Key, Track};
use lovelock_session::engine::Engine;
use lovelock_session::scene::SceneLoader;
use lovelock_style::operations::{Curl, Stiffness, Wave};
use lovelock_style::{Layer, Operation};

/// Steps of a measurement.
const STEPS: u64 = 240;

fn main() {
    for preset in [Preset::Smooth, Preset::Long] {
        let mut plain = Project::default();
        plain.set_preset(preset);
        let with = |operation: Operation, keyed: bool| {
            let mut project = plain.clone();
            project.hair.stack.push(Layer::of(operation));
            if keyed {
                // Another weight at each step.
                let key = |i: u32| Key { secs: f64::from(i), value: vec![f64::from(i % 2)] };
                let track = Track { keys: (0..60).map(key).collect(), ..Track::new("hair/stack/1/weight") };
                project.timeline.tracks.push(track);
            }
            project
        };
        let curl = Operation::from(Curl { radius: 0.004, ..Curl::default() });
        let cases = [
            ("no layer", plain.clone()),
            ("stiffness", with(Stiffness::default().into(), false)),
            ("stiffness, keyed", with(Stiffness::default().into(), true)),
            ("curl", with(curl.clone(), false)),
            ("curl, keyed", with(curl, true)),
            ("wave", with(Wave::default().into(), false)),
            ("wave, keyed", with(Wave::default().into(), true)),
        ];
        for (name, project) in cases {
            let (scene, _) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
            let mut engine = Engine::new(scene, project.simulation);
            engine.follow(&project);
            engine.advance_to_step(10);
            let (cpu, wall) = (cpu_ms(), Stopwatch::start());
            engine.advance_to_step(10 + STEPS);
            let wall_ms = wall.ms();
            let ms = cpu_ms().zip(cpu).map_or(wall_ms, |(end, start)| end - start);
            println!("{preset:?}, {name}: {:.2} ms a step", ms / STEPS as f64);
        }
    }
}

/// Time that all threads of this process have computed, milliseconds.
fn cpu_ms() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, numbers) = stat.rsplit_once(')')?;
    let ticks: Vec<f64> =
        numbers.split_whitespace().skip(11).take(2).filter_map(|v| v.parse().ok()).collect();
    // A hundred ticks a second.
    Some(ticks.iter().sum::<f64>() * 10.0)
}
