//! The whole window under random input.

use std::path::Path;
use std::process::Command as Process;

use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, TouchPhase, pos2, vec2};
use lovelock_base::random::SplitMix64;
use lovelock_project::Project;
use lovelock_project::project::load_project;

use super::whole::{CTRL, Whole, go, of, playing_window, project, wait};
use crate::window::Window;
use crate::window::command::Command;
use crate::window::page::Page;

/// Environment variable that makes the test be the program that is driven, in a home folder of its own.
const CHILD: &str = "LOVELOCK_TEST_MONKEY";
/// Inputs, and those before the memory is measured for the first time: every page and tool has been used by then.
const INPUTS: usize = 3000;
const WARM_UP: usize = 1000;
/// The file of the project: in a script that the fonts of the program lack, with a space.
const NAME: &str = "踊り 三つ編み.lovelock";
/// The factor by which memory may grow after that.
const GROWTH: f64 = 1.1;

/// Keys that open pages, tools, panels and dialogs, and edit.
const KEYS: [(Modifiers, Key); 30] = [
    (Modifiers::NONE, Key::Space),
    (Modifiers::NONE, Key::C),
    (Modifiers::NONE, Key::N),
    (Modifiers::NONE, Key::H),
    (Modifiers::NONE, Key::X),
    (Modifiers::NONE, Key::K),
    (Modifiers::SHIFT, Key::K),
    (Modifiers::NONE, Key::G),
    (Modifiers::NONE, Key::F),
    (Modifiers::NONE, Key::L),
    (Modifiers::NONE, Key::M),
    (Modifiers::NONE, Key::W),
    (Modifiers::NONE, Key::Tab),
    (Modifiers::NONE, Key::F6),
    (Modifiers::NONE, Key::F1),
    (Modifiers::NONE, Key::Escape),
    (Modifiers::NONE, Key::Escape),
    (Modifiers::NONE, Key::Delete),
    (Modifiers::NONE, Key::ArrowRight),
    (Modifiers::NONE, Key::ArrowDown),
    (Modifiers::NONE, Key::Home),
    (Modifiers::NONE, Key::OpenBracket),
    (CTRL, Key::Z),
    (CTRL, Key::Y),
    (CTRL, Key::K),
    (CTRL, Key::D),
    (Modifiers::ALT, Key::Num1),
    (Modifiers::ALT, Key::Num3),
    (Modifiers::ALT, Key::Num4),
    (Modifiers::SHIFT, Key::Questionmark),
];

fn with<T>(harness: &mut Whole, change: impl FnOnce(&mut Window) -> T) -> T {
    change(harness.state_mut().state.as_mut().expect("a window"))
}

/// One input at random.
fn act(harness: &mut Whole, random: &mut SplitMix64) {
    let place = |random: &mut SplitMix64| pos2(random.unit() * 1200.0, random.unit() * 900.0);
    let (from, to) = (place(random), place(random));
    let button = if random.unit() < 0.85 { PointerButton::Primary } else { PointerButton::Secondary };
    let press = |harness: &Whole, pos, pressed| {
        harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    };
    match random.unit() {
        kind if kind < 0.3 => {
            let (modifiers, key) = KEYS[(random.unit() * KEYS.len() as f32) as usize % KEYS.len()];
            harness.key_press_modifiers(modifiers, key);
        }
        kind if kind < 0.6 => {
            harness.hover_at(from);
            press(harness, from, true);
            press(harness, from, false);
        }
        kind if kind < 0.85 => {
            harness.hover_at(from);
            press(harness, from, true);
            for step in 1..=3 {
                harness.hover_at(from + (to - from) * (step as f32 / 3.0));
            }
            press(harness, to, false);
        }
        kind if kind < 0.93 => {
            harness.hover_at(from);
            let delta = vec2(0.0, 240.0 * (random.unit() - 0.5));
            let (unit, phase, source) = (MouseWheelUnit::Point, TouchPhase::Move, MouseWheelSource::Wheel);
            harness.event(Event::MouseWheel { unit, delta, phase, source, modifiers: Modifiers::NONE });
        }
        kind if kind < 0.97 => {
            harness.event(Event::Text(["7", "-1e9", "ü", "é", "0.25"][(from.x as usize) % 5].to_owned()));
            harness.key_press(Key::Tab);
        }
        _ => {
            // Another size of the window.
            harness.set_size(vec2(960.0 + random.unit() * 300.0, 540.0 + random.unit() * 400.0));
        }
    }
    harness.run_steps(2);
    // Nothing but the project is written, and the window stays.
    with(harness, |window| {
        window.files.dialog = None;
        window.files.quitting = false;
        window.media.recorder.cancel();
    });
}

/// Brings the window back to the same project with nothing open, saved in a file and opened again, and returns the resident memory, bytes.
fn rest(harness: &mut Whole, small: &Project, path: &Path) -> u64 {
    harness.set_size(vec2(1200.0, 900.0));
    for _ in 0..4 {
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
    let ctx = harness.ctx.clone();
    with(harness, |window| {
        window.files.pending = None;
        window.run(Command::ResetLayout, &ctx);
        window.layout.page = Page::Image;
        window.tools.active = crate::window::pointer_tool::PointerTool::Camera;
        window.replace_document(small.clone(), None);
        window.save_to(path).expect("the project is saved");
        window.open_project(path).expect("the project opens");
        window.session.set_playing(false);
    });
    go(harness);
    wait(harness, "the project", |window| {
        !window.session.worker().is_loading() && window.session.worker().settling().is_none()
    });
    harness.run_steps(60);
    let status = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: u64 = status.split(' ').nth(1).and_then(|pages| pages.parse().ok()).unwrap_or_default();
    pages * 4096
}

/// What the driven program does.
fn drive(inputs: usize, seed: u64) {
    let mut random = SplitMix64::new(seed);
    let mut harness = playing_window();
    // Pages of the manual show signs and names for which this system may have no font.
    harness.ctx.set_missing_glyph_policy(egui::MissingGlyphPolicy::Tofu);
    let small = (*project(&harness)).clone();
    let path = std::env::current_dir().expect("the home folder").join(NAME);
    with(&mut harness, |window| window.save_to(&path)).expect("the project is saved");
    let mut first = 0;
    for input in 0..inputs {
        act(&mut harness, &mut random);
        if input + 1 == WARM_UP {
            first = rest(&mut harness, &small, &path);
            println!("after {WARM_UP} inputs: {} MiB", first >> 20);
        }
    }
    let last = rest(&mut harness, &small, &path);
    println!("after {inputs} inputs: {} MiB", last >> 20);
    if first > 0 {
        assert!((last as f64) < first as f64 * GROWTH, "memory grew from {first} to {last} bytes");
    }
    assert_eq!(of(&harness).document.path(), Some(path.as_path()));
    let (saved, problems) = load_project(&path).expect("a project");
    assert!(problems.is_empty() && saved == small && *project(&harness) == small, "{problems:?}");
    // It answers.
    assert!(!of(&harness).session.playing);
    harness.key_press(Key::Space);
    go(&mut harness);
    assert!(of(&harness).session.playing, "Space plays");
    let before = of(&harness).session.frame.as_ref().expect("a frame").position_secs;
    wait(&mut harness, "the dance", |window| {
        window.session.frame.as_ref().is_some_and(|frame| frame.position_secs != before)
    });
    let before = project(&harness).camera.distance;
    with(&mut harness, |window| window.change("camera", |project| project.camera.distance = before + 0.5));
    go(&mut harness);
    harness.key_press_modifiers(CTRL, Key::Z);
    go(&mut harness);
    assert_eq!(project(&harness).camera.distance, before, "undo works");
}

/// Runs this test again in a process with a home folder of its own.
fn in_own_home(test: &str) {
    let home = tempfile::tempdir().expect("a folder");
    let output = Process::new(std::env::current_exe().expect("the program"))
        .args(["--exact", test, "--nocapture", "--include-ignored"])
        .env(CHILD, "1")
        .envs(
            ["HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"]
                .map(|name| (name, home.path())),
        )
        .current_dir(home.path())
        .output()
        .expect("it starts");
    let told = String::from_utf8_lossy(&output.stdout);
    println!("{told}");
    assert!(output.status.success(), "{told}\n{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn random_input_leaves_the_window_working() {
    if std::env::var_os(CHILD).is_some() {
        return drive(60, 7);
    }
    in_own_home("window::testing::monkey::random_input_leaves_the_window_working");
}

#[test]
fn three_thousand_random_inputs_long_suite() {
    if std::env::var_os(CHILD).is_some() {
        return drive(INPUTS, 1);
    }
    in_own_home("window::testing::monkey::three_thousand_random_inputs_long_suite");
}
