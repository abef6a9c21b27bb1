//! `cargo xtask soak`: drives the window with seeded random input on a virtual screen, and prints how much memory it takes.

use crate::latency::Closed;
use crate::latency::screen::{Input, KEY_C, KEY_SPACE, Screen};
use anyhow::Context as _;
use clap::Args;
use lovelock_base::clock::Stopwatch;
use lovelock_base::random::SplitMix64;
use lovelock_xtask::{system, tool};
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

const WINDOW: (u16, u16) = (1440, 900);

// Key codes of the screen.
const ESCAPE: u8 = 9;
const TAB: u8 = 23;
const CONTROL: u8 = 37;
const ALT: u8 = 64;
const KEY_N: u8 = 57;
const KEY_Z: u8 = 52;
/// The keys 1 to 5, with which shipped styles are applied.
const DIGITS: std::ops::Range<u8> = 10..15;
/// Keys that are pressed at random: those that open pages, tools and panels. Nothing is saved or recorded.
const KEYS: [u8; 14] = [KEY_SPACE, KEY_C, KEY_N, TAB, ESCAPE, ESCAPE, 43, 53, 41, 25, 46, 45, 42, 58];

/// Options of the chore.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Random inputs
    #[arg(long, default_value_t = 300)]
    events: usize,
    /// Another seed makes other inputs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seconds for which each page is shown
    #[arg(long, default_value_t = 8)]
    secs: u64,
    /// Another build of the program
    #[arg(long, value_name = "PROGRAM")]
    program: Option<PathBuf>,
}

/// A window that is driven, and the numbers for what is done with it.
struct Driven {
    screen: Screen,
    window: u32,
    program: Closed,
    since: Stopwatch,
    random: SplitMix64,
}

/// Opens the comparison and the wall several times, applies styles, presses and drags at random, and takes another project; prints the
/// resident memory after each of these.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    system::prepare()?;
    system::prepare_screen()?;
    let program = arguments.program.clone().unwrap_or_else(tool::program);
    let mut driven = Driven::start(&program, arguments.seed)?;
    let page = Duration::from_secs(arguments.secs);
    driven.rest("one image", page)?;
    for (key, what, times) in [(KEY_C, "comparison", 4), (KEY_N, "wall", 3)] {
        for time in 1..=times {
            driven.key(&[], key)?;
            driven.rest(&format!("{what} {time}"), page)?;
            driven.key(&[], key)?;
            driven.rest("  left", page)?;
        }
    }
    for digit in DIGITS {
        driven.key(&[ALT], digit)?;
        sleep(page / 2);
    }
    driven.rest("five styles", page)?;
    for event in 1..=arguments.events {
        driven.act()?;
        if event % 20 == 0 {
            driven.key(&[], ESCAPE)?;
        }
        if event % 100 == 0 || event == arguments.events {
            driven.rest(&format!("{event} random inputs"), page)?;
        }
    }
    // Back to the first project, so that no dialog opens about saving it.
    for _ in 0..3 {
        driven.key(&[], ESCAPE)?;
    }
    for _ in 0..arguments.events + 20 {
        driven.key(&[CONTROL], KEY_Z)?;
    }
    driven.rest("undone", page)?;
    driven.key(&[CONTROL], KEY_N)?;
    driven.rest("new project", 3 * page)
}

impl Driven {
    fn start(program: &std::path::Path, seed: u64) -> anyhow::Result<Self> {
        // An empty home folder: the window has the layout of a first start, and the user's own settings are not touched.
        let folder = tool::target().join("soak");
        if folder.exists() {
            fs::remove_dir_all(&folder).with_context(|| format!("could not empty {}", folder.display()))?;
        }
        fs::create_dir_all(&folder).with_context(|| format!("could not create {}", folder.display()))?;
        let screen = Screen::start(WINDOW.0 + 40, WINDOW.1 + 40)?;
        let child = Command::new(program)
            .env("DISPLAY", screen.name())
            .env_remove("WAYLAND_DISPLAY")
            .envs(["HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"].map(|name| (name, &folder)))
            .spawn()
            .with_context(|| format!("could not start {}", program.display()))?;
        let program = Closed(child);
        let window = screen.wait_for_window(Duration::from_mins(1))?;
        sleep(Duration::from_secs(4));
        screen.size(window, WINDOW)?;
        screen.point((WINDOW.0 as i16 / 2, WINDOW.1 as i16 / 2))?;
        Ok(Self { screen, window, program, since: Stopwatch::start(), random: SplitMix64::new(seed) })
    }

    /// Waits, and prints the resident memory.
    fn rest(&mut self, what: &str, wait: Duration) -> anyhow::Result<()> {
        sleep(wait);
        let ended = self.program.0.try_wait()?;
        anyhow::ensure!(ended.is_none(), "the program has ended: {ended:?}");
        let path = format!("/proc/{}/status", self.program.0.id());
        let status = fs::read_to_string(&path).with_context(|| path.clone())?;
        let mib = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name))?;
            Some(line.split_whitespace().next()?.parse::<u64>().ok()? >> 10)
        };
        let [now, most] = ["VmRSS:", "VmHWM:"].map(|name| mib(name).unwrap_or_default());
        println!("{:6.0} s  {what:<24}  {now:5} MiB, at most {most} MiB", self.since.secs());
        Ok(())
    }

    /// Presses and releases a key while others are held.
    fn key(&self, held: &[u8], code: u8) -> anyhow::Result<()> {
        for &held in held {
            self.screen.press(Input::Key(held), true)?;
        }
        self.screen.key(self.window, code)?;
        for &held in held {
            self.screen.press(Input::Key(held), false)?;
        }
        Ok(())
    }

    /// One input at random: a key, a click, a drag or the wheel.
    fn act(&mut self) -> anyhow::Result<()> {
        let kind = self.random.unit();
        let (width, height) = (f32::from(WINDOW.0), f32::from(WINDOW.1));
        let mut place = || {
            let [x, y] = [self.random.unit() * (width - 4.0), 40.0 + self.random.unit() * (height - 44.0)];
            (x as i16, y as i16)
        };
        let (from, to) = (place(), place());
        if kind < 0.3 {
            let keys = KEYS.len() + DIGITS.len();
            let chosen = (self.random.unit() * keys as f32) as usize % keys;
            return match KEYS.get(chosen) {
                Some(&key) => self.key(&[], key),
                None => self.key(&[ALT], DIGITS.start + (chosen - KEYS.len()) as u8),
            };
        }
        self.screen.point(from)?;
        let button = Input::Button(if kind < 0.92 { 1 } else { 5 });
        self.screen.press(button, true)?;
        if (0.7..0.92).contains(&kind) {
            for step in 1..=4 {
                let between = |a: i16, b: i16| a + ((i32::from(b) - i32::from(a)) * step / 4) as i16;
                sleep(Duration::from_millis(30));
                self.screen.point((between(from.0, to.0), between(from.1, to.1)))?;
            }
        }
        self.screen.press(button, false)?;
        sleep(Duration::from_millis(300));
        Ok(())
    }
}
