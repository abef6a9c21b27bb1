//! `cargo xtask latency`: measures the time from an input to the screen, on a virtual screen, and from a change of a layer to its image.

pub(crate) mod screen;

use anyhow::{Context as _, ensure};
use lovelock_metrics::Spread;
use lovelock_xtask::{system, tool};
use screen::{Place, Screen};
use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

/// Size of the window. With six panes in two columns each pane has at least 640 × 360 pixels.
const WINDOW: (u16, u16) = (1960, 1240);
/// The menu "File", and an empty part of the menu bar.
const MENU: Place = Place { x: 6, y: 2, width: 30, height: 14 };
const BESIDE: (i16, i16) = (1000, 9);

/// What the window shows while it is measured.
struct Case {
    what: &'static str,
    backend: &'static str,
    panes: bool,
    paused: bool,
}

const CASES: [Case; 4] = [
    Case { what: "one view by the processor, playing", backend: "cpu", panes: false, paused: false },
    Case { what: "one view by the graphics device, playing", backend: "gpu", panes: false, paused: false },
    Case { what: "six panes, playing", backend: "cpu", panes: true, paused: false },
    Case { what: "six panes, paused", backend: "cpu", panes: true, paused: true },
];

/// Opens the window for each case, moves the pointer on and off a menu at irregular times, and prints the time until the menu
/// changes. With `beside`, another build of the program, both are measured twice in turn. Then changes layers of two styles as often, and
/// prints the time until an image shows each change.
pub(crate) fn run(inputs: usize, beside: Option<&Path>) -> anyhow::Result<()> {
    ensure!(inputs > 0, "--inputs: found 0; must be at least 1");
    if let Some(beside) = beside {
        ensure!(beside.is_file(), "--beside: {} is not a program", beside.display());
    }
    system::prepare()?;
    system::prepare_screen()?;
    let folder = tool::root().join("target/latency");
    let own = tool::program();
    for case in CASES {
        let rounds = if beside.is_some() { 2 } else { 1 };
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..rounds {
            for (program, times) in [Some(own.as_path()), beside].into_iter().zip(&mut times) {
                let Some(program) = program else { continue };
                let found = window(program, &case, inputs.div_ceil(rounds), &folder);
                times.extend(found.with_context(|| case.what.to_owned())?);
            }
        }
        for (name, times) in ["", " (beside)"].into_iter().zip(&mut times) {
            times.sort_unstable_by(f64::total_cmp);
            let Some(spread) = Spread::of(times) else { continue };
            println!(
                "{}{name}: {:.0} ms median, {:.0} to {:.0} for the middle 80 %, {:.0} at most, {} inputs",
                case.what,
                spread.median,
                spread.low,
                spread.high,
                times.last().copied().unwrap_or_default(),
                spread.count
            );
        }
    }
    // From a change of a layer to the image that shows it, without a window.
    let example = ["run", "--release", "--package", "lovelock-session", "--example", "layer_latency", "--"];
    tool::run(tool::cargo(&example).arg(inputs.to_string()))
}

/// Time from each input to the screen, in milliseconds.
fn window(program: &Path, case: &Case, inputs: usize, folder: &Path) -> anyhow::Result<Vec<f64>> {
    // An empty home folder: the window has the layout of a first start, and the user's own settings are not touched.
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("could not empty {}", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("could not create {}", folder.display()))?;
    let project = folder.join("six.lovelock");
    fs::write(&project, include_str!("six.lovelock"))?;
    let screen = Screen::start(WINDOW.0 + 40, WINDOW.1 + 40)?;
    let child = Command::new(program)
        .arg(&project)
        .args(["--set", &format!("picture.backend={}", case.backend)])
        .env("DISPLAY", screen.name())
        .env_remove("WAYLAND_DISPLAY")
        .env("HOME", folder)
        .env("XDG_DATA_HOME", folder)
        .spawn()
        .with_context(|| format!("could not start {}", program.display()))?;
    let _closed = Closed(child);
    let window = screen.wait_for_window(Duration::from_mins(1))?;
    sleep(Duration::from_secs(4));
    screen.size(window, WINDOW)?;
    sleep(Duration::from_secs(2));
    if case.panes {
        screen.key(window, screen::KEY_C)?;
        sleep(Duration::from_secs(6));
    }
    if case.paused {
        screen.key(window, screen::KEY_SPACE)?;
        sleep(Duration::from_secs(3));
    }
    screen.point(BESIDE)?;
    sleep(Duration::from_secs(1));
    let mut times = Vec::with_capacity(inputs);
    for input in 0..inputs {
        let to = if input % 2 == 0 { MENU.middle() } else { BESIDE };
        times.push(screen.time_to_change(to, MENU)?.as_secs_f64() * 1e3);
        // Irregular, so that inputs do not synchronise with the window's frames.
        sleep(Duration::from_millis(250 + (input as u64 * 97) % 300));
    }
    Ok(times)
}

/// A process that is ended when the measurement ends.
pub(crate) struct Closed(pub(crate) Child);

impl Drop for Closed {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
