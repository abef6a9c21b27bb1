//! Progress of long work.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};
use lovelock_session::clock::Pace;
use lovelock_session::progress::Progress;

/// Steps per frame from which the simulation takes longer than is obvious from the frame count: below 20 frames per second.
const MANY_STEPS: u32 = 4;

/// Progress on standard error: a bar on a terminal, plain lines elsewhere.
pub(super) struct Bar {
    drawn: Option<ProgressBar>,
    said: u64,
    pace: Pace,
    /// The part of a comparison that was printed last.
    part: String,
}

impl Bar {
    pub(super) fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}{prefix}")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(1).with_style(style)
        });
        Self { drawn: bar, said: 0, pace: Pace::default(), part: String::new() }
    }

    pub(super) fn show(&mut self, progress: &Progress) {
        let mut estimated = None;
        let (what, done, total) = match progress {
            Progress::Loading { what } => (what.as_str(), 0, 1),
            Progress::Loaded { problems } => {
                for problem in problems {
                    self.line(&format!("lovelock: {}", problem.message));
                }
                return;
            }
            Progress::Simulating { done, total } => ("simulating", *done, *total),
            Progress::Frame { done, total, .. } => ("frame", *done, *total),
            Progress::Kept { done, total } => ("kept", *done, *total),
            Progress::Comparing { what, done, total, left_secs } => {
                estimated = *left_secs;
                if self.drawn.is_none() && self.part != *what {
                    let left = estimated.map_or_else(String::new, about);
                    eprintln!("{what} ({} of {total}{left})", done + 1);
                    self.part.clone_from(what);
                }
                (what.as_str(), *done, *total)
            }
            Progress::Finishing => ("finishing", 1, 1),
        };
        // Estimated only from rendered frames, because frames that are kept take no time.
        let left = self.pace.left_secs(what, done, total);
        let left = left.map_or_else(String::new, |secs| format!(", {} left", Pace::in_words(secs)));
        let left = estimated.map_or(left, about);
        let left = format!("{}{left}", self.steps(progress));
        if let Some(bar) = &self.drawn {
            bar.set_prefix(left);
            bar.set_length(total.max(1));
            bar.set_position(done);
            bar.set_message(what.to_owned());
            return;
        }
        // About twenty lines per recording, whatever its length.
        let tenth = (20 * done).checked_div(total).unwrap_or(0);
        if matches!(progress, Progress::Frame { .. }) && tenth != self.said {
            self.said = tenth;
            eprintln!("{what} {done} of {total}{left}");
        }
    }

    /// For recordings with many simulation steps per frame: their number, and the simulated steps per second.
    fn steps(&self, progress: &Progress) -> String {
        match progress {
            Progress::Frame { done, steps_per_frame, .. } if *steps_per_frame >= MANY_STEPS => {
                let rate = self.pace.per_sec(*done).map(|frames| frames * f64::from(*steps_per_frame));
                let rate = rate.map_or_else(String::new, |rate| format!(", {rate:.0} steps per second"));
                format!(" ({steps_per_frame} simulated steps per frame{rate})")
            }
            _ => String::new(),
        }
    }

    fn line(&self, text: &str) {
        match &self.drawn {
            Some(bar) => bar.println(text),
            None => eprintln!("{text}"),
        }
    }

    pub(super) fn done(&self) {
        if let Some(bar) = &self.drawn {
            bar.finish_and_clear();
        }
    }
}

/// Estimated time left as the end of a line.
fn about(secs: f64) -> String {
    format!(", about {} left", Pace::in_words(secs))
}
