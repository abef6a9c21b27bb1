//! The sound of the project in the window: loading on a thread, and playing in step with the dance.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::SystemTime;

use lovelock_base::clock::Stopwatch;
use lovelock_project::error::{Place, Problem};
use lovelock_project::files::{Access, FileRef};
use lovelock_project::project::SoundSection;
use lovelock_sound::{Beats, Player, Sound, SoundError, Source, Target, Waveform, find_beats, read_sound};

/// A sound that was read.
#[derive(Debug, Default)]
pub(crate) struct Loaded {
    pub(crate) sound: Arc<Sound>,
    pub(crate) source: Option<Source>,
    pub(crate) waveform: Waveform,
    pub(crate) beats: Beats,
}

impl Loaded {
    /// A sound with its outline and its beats.
    pub(crate) fn of(sound: Sound, source: Option<Source>) -> Self {
        let (waveform, beats) = (Waveform::of(&sound), find_beats(&sound));
        Self { sound: Arc::new(sound), source, waveform, beats }
    }
}

/// A file at a time: one that has changed is read again.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    path: PathBuf,
    of: Option<(u64, SystemTime)>,
}

impl Stamp {
    fn of(path: PathBuf) -> Self {
        let data = std::fs::metadata(&path).ok();
        let of = data.and_then(|data| Some((data.len(), data.modified().ok()?)));
        Self { path, of }
    }
}

/// Files are checked for changes this often, seconds.
const CHECKED_SECS: f64 = 1.0;

/// What was checked last, and when.
struct Checked {
    file: Option<FileRef>,
    access: Access,
    since: Stopwatch,
}

/// A file that is being read.
struct Loading {
    result: Receiver<Result<Loaded, SoundError>>,
    /// Thousandths of the file.
    progress: Arc<AtomicU32>,
    cancelled: Arc<AtomicBool>,
    since: Stopwatch,
}

impl Drop for Loading {
    fn drop(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

/// How far a file is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LoadingView {
    /// 0 to 1.
    pub(crate) fraction: f32,
    /// Since when, seconds.
    pub(crate) taken_secs: f64,
}

/// The sound of the project in the window.
#[derive(Default)]
pub(crate) struct Soundtrack {
    checked: Option<Checked>,
    /// The file that was read last, or is being read.
    stamp: Option<Stamp>,
    loading: Option<Loading>,
    loaded: Option<Arc<Loaded>>,
    /// Why the file of the project does not play.
    problem: Option<String>,
    player: Option<Player>,
}

impl Soundtrack {
    /// Reads the sound of the project if it is another one. Returns messages for the user.
    pub(crate) fn update(
        &mut self,
        section: &SoundSection,
        access: &Access,
        ctx: &egui::Context,
    ) -> Vec<String> {
        let mut said = Vec::new();
        let is_checked = self.checked.as_ref().is_some_and(|checked| {
            checked.file == section.file && checked.access == *access && checked.since.secs() < CHECKED_SECS
        });
        if !is_checked {
            let wanted = section.file.as_ref().map(|file| access.read(Place::Sound, file));
            said.extend(self.check(wanted, ctx));
            self.checked = Some(Checked {
                file: section.file.clone(),
                access: access.clone(),
                since: Stopwatch::start(),
            });
        }
        said.extend(self.take_result());
        said
    }

    /// Starts to read the wanted file if it is another one or has changed.
    fn check(&mut self, wanted: Option<Result<PathBuf, Problem>>, ctx: &egui::Context) -> Option<String> {
        let path = match wanted {
            None => {
                self.forget();
                return None;
            }
            Some(Err(problem)) => {
                let known = self.problem.as_ref() == Some(&problem.message);
                self.forget();
                self.problem = Some(problem.message.clone());
                return (!known).then_some(problem.message);
            }
            Some(Ok(path)) => path,
        };
        let stamp = Stamp::of(path);
        if self.stamp.as_ref() == Some(&stamp) {
            return None;
        }
        self.forget();
        let loading = load(stamp.path.clone(), ctx);
        self.stamp = Some(stamp);
        match loading {
            Ok(loading) => self.loading = Some(loading),
            Err(error) => self.problem = Some(format!("The sound could not be loaded: {error}.")),
        }
        None
    }

    /// Forgets the file. The device stays open.
    fn forget(&mut self) {
        *self = Self { player: self.player.take(), checked: self.checked.take(), ..Self::default() };
    }

    /// Takes the result of the thread that reads. Returns messages for the user.
    fn take_result(&mut self) -> Vec<String> {
        let result = match self.loading.as_ref().map(|loading| loading.result.try_recv()) {
            None | Some(Err(TryRecvError::Empty)) => return Vec::new(),
            Some(Err(TryRecvError::Disconnected)) => None,
            Some(Ok(result)) => Some(result),
        };
        self.loading = None;
        match result {
            Some(Ok(loaded)) => {
                match &mut self.player {
                    Some(player) => player.set_sound(Arc::clone(&loaded.sound)),
                    None => self.player = Some(Player::open(Arc::clone(&loaded.sound))),
                }
                let notes = loaded.source.iter().flat_map(|source| source.notes.clone()).collect();
                self.loaded = Some(Arc::new(loaded));
                notes
            }
            Some(Err(SoundError::Cancelled)) => {
                self.problem = Some("Reading the sound was cancelled. The dance is silent.".to_owned());
                Vec::new()
            }
            Some(Err(error)) => {
                let problem = Problem::not_loaded(Place::Sound, error).with_fallback("the dance is silent");
                self.problem = Some(problem.message.clone());
                vec![problem.message]
            }
            None => {
                self.problem = Some("Reading the sound stopped because of an internal error.".to_owned());
                Vec::new()
            }
        }
    }

    /// Plays what belongs to the time `secs` of the timeline, at `rate` seconds of the dance per second, or pauses.
    pub(crate) fn follow(&mut self, section: &SoundSection, secs: f64, playing: bool, rate: f64) {
        let Some(player) = &mut self.player else { return };
        let playing = playing && self.loaded.is_some() && section.is_heard();
        player.follow(Target { secs: secs - section.offset_secs, playing, rate, gain: section.gain });
    }

    /// The sound that was read.
    pub(crate) fn loaded(&self) -> Option<&Arc<Loaded>> {
        self.loaded.as_ref()
    }

    /// How far the file is read, while it is read.
    pub(crate) fn loading(&self) -> Option<LoadingView> {
        self.loading.as_ref().map(|loading| LoadingView {
            fraction: loading.progress.load(Ordering::Relaxed) as f32 * 1e-3,
            taken_secs: loading.since.secs(),
        })
    }

    /// Stops reading the file.
    pub(crate) fn cancel(&mut self) {
        if let Some(loading) = &self.loading {
            loading.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Why no sound plays, as a sentence: a problem of the file, or of the computer.
    pub(crate) fn problem(&self) -> Option<String> {
        self.problem.clone().or_else(|| self.player.as_ref().and_then(Player::failure))
    }
}

/// Reads a file on a thread of its own.
fn load(path: PathBuf, ctx: &egui::Context) -> std::io::Result<Loading> {
    let (sender, result) = sync_channel(1);
    let (progress, cancelled) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicBool::new(false)));
    let (done, stopped, ctx) = (Arc::clone(&progress), Arc::clone(&cancelled), ctx.clone());
    std::thread::Builder::new().name("lovelock sound file".to_owned()).spawn(move || {
        let read = read_sound(&path, &mut |part| {
            let thousandths = (part * 1e3) as u32;
            if done.swap(thousandths, Ordering::Relaxed) / 20 != thousandths / 20 {
                ctx.request_repaint();
            }
            if stopped.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        // The window may be closed already.
        let _ = sender.send(read.map(|(sound, source)| Loaded::of(sound, Some(source))));
        ctx.request_repaint();
    })?;
    Ok(Loading { result, progress, cancelled, since: Stopwatch::start() })
}
