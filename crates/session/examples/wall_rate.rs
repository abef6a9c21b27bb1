//! How many rounds of nine images a second the wall of variants shows while the hair dances, beside the rate of the single image:
//! `cargo run --release -p lovelock-session --example wall_rate -- [STYLE] [SECONDS]`.
//!
//! All is drawn on the CPU: the single image with 640x480 pixels, and the nine images with as many together.

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::styles::{StyleParts, shipped};
use lovelock_project::variants::{Locks, vary};
use lovelock_render::Backend;
use lovelock_session::wall::{Wall, WallRequest};
use lovelock_session::window_device::WindowDevice;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "bob".to_owned());
    let seconds: f64 = arguments.next().map_or(Ok(10.0), |text| text.parse())?;
    let style = shipped().iter().find(|style| style.id == name).ok_or("no shipped style has this name")?;
    let mut project = Project::default();
    project.apply_style(&style.style, StyleParts::ALL);
    project.picture.backend = Backend::Cpu;
    let project = Arc::new(project);
    let nine: Vec<_> = (0..Wall::CELLS as u32)
        .map(|seed| match seed {
            0 => Arc::clone(&project),
            _ => Arc::new(vary(&project, seed, 0.5, &Locks::default())),
        })
        .collect();
    for (what, variants, size) in
        [("one image", &nine[..1], [640, 480]), ("nine images", &nine[..], [213, 160])]
    {
        let rate = rate(&project, variants, size, seconds)?;
        println!("{name}, {what} of {}x{}: {rate:.1} rounds per second", size[0], size[1]);
    }
    Ok(())
}

/// Rounds per second in step with the clock, after the first round.
fn rate(
    project: &Arc<Project>,
    variants: &[Arc<Project>],
    size: [u32; 2],
    seconds: f64,
) -> Result<f64, Box<dyn Error>> {
    let wall = Wall::start(WindowDevice::default(), || {})?;
    let request = |time_secs| WallRequest {
        project: Arc::clone(project),
        variants: variants.to_vec(),
        access: Access::new(),
        time_secs,
        playing: true,
        size,
    };
    let (mut seen, mut rounds, mut watch) = (0, 0, Stopwatch::start());
    wall.request(request(0.0));
    loop {
        if wall.rounds().newer_than(&mut seen).is_some() {
            // The first round loads the scenes.
            if rounds == 0 {
                watch = Stopwatch::start();
            }
            rounds += 1;
            let secs = watch.secs();
            if secs > seconds {
                return Ok(f64::from(rounds - 1) / secs);
            }
            wall.request(request(secs));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
