//! The drawing thread: takes the newest frame when it is free, and leaves its picture in a slot.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

use lovelock_render::{Backend, Camera, FrameStats, GpuError, Picture, RenderError, Renderer};

use crate::desk::Desk;
use crate::{FrameSnapshot, Project, Slot, StageTimes};

/// What to draw.
#[derive(Clone, Debug)]
pub struct PaintRequest {
    /// Settings of the picture, lights, look and camera.
    pub project: Arc<Project>,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

/// A finished picture with what it cost.
#[derive(Clone, Debug)]
pub struct Painted {
    /// The picture.
    pub picture: Picture,
    /// Where it was taken from.
    pub camera: Camera,
    /// What went into it.
    pub stats: FrameStats,
    /// Times of all stages of this frame but `encode`.
    pub times: StageTimes,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
    /// [`FrameSnapshot::position_secs`] of the instant.
    pub position_secs: f64,
}

/// What draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, as the driver gives it.
    pub name: String,
    /// Which backend it serves: the graphics card's or the processor's own.
    pub backend: Backend,
    /// Whether it runs on the processor.
    pub software: bool,
}

/// Why there is no newer picture.
#[derive(Debug)]
struct Failure {
    message: String,
    /// Pictures finished before it.
    pictures: u64,
}

/// Opens what draws on the backend that was chosen.
type Open = Box<dyn FnMut(Backend) -> Result<Renderer, RenderError> + Send>;

/// How often in a row a graphics device is opened anew by itself before it counts as broken.
const MOST_FAILURES: u32 = 3;

/// Draws on a thread of its own. Requests that come while it draws replace each other.
#[derive(Debug)]
pub struct Painter {
    desk: Desk<PaintRequest>,
    painted: Slot<Painted>,
    failures: Slot<Failure>,
    notices: Slot<String>,
    adapter: Slot<Adapter>,
    thread: Option<JoinHandle<()>>,
}

impl Painter {
    /// Starts the thread. `on_painted` is called there after each picture and each error.
    ///
    /// # Errors
    /// The system makes no thread.
    pub fn start(on_painted: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with(Box::new(Renderer::open), on_painted)
    }

    /// As [`Painter::start`], on what `open` opens.
    fn start_with(open: Open, on_painted: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let desk = Desk::default();
        let (painted, failures, notices) = (Slot::default(), Slot::default(), Slot::default());
        let adapter = Slot::default();
        let worker = Worker {
            desk: desk.clone(),
            painted: painted.clone(),
            failures: failures.clone(),
            notices: notices.clone(),
            adapter: adapter.clone(),
            on_painted: Box::new(on_painted),
            open,
            opened: None,
            failed: 0,
            card_given_up: false,
        };
        let thread = std::thread::Builder::new().name("draw".to_owned()).spawn(move || worker.run())?;
        Ok(Self { desk, painted, failures, notices, adapter, thread: Some(thread) })
    }

    /// Asks for a picture; a request that still waits is forgotten.
    pub fn request(&self, request: PaintRequest) {
        self.desk.put(request);
    }

    /// Where finished pictures are left.
    pub fn painted(&self) -> &Slot<Painted> {
        &self.painted
    }

    /// Why the last picture could not be drawn, in a sentence; none when one came since. The last good picture stays in
    /// its slot.
    pub fn error(&self) -> Option<String> {
        let failure = self.failures.latest()?;
        (failure.pictures == self.painted.number()).then(|| failure.message.clone())
    }

    /// Where sentences are left that stay true while pictures come: that another backend draws from now on.
    pub fn notices(&self) -> &Slot<String> {
        &self.notices
    }

    /// What draws; empty until the first picture.
    pub fn adapter(&self) -> Option<Arc<Adapter>> {
        self.adapter.latest()
    }

    /// Whether a picture is being drawn or waits: its end will call `on_painted`.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(self.desk.busy())
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        self.desk.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Worker {
    desk: Desk<PaintRequest>,
    painted: Slot<Painted>,
    failures: Slot<Failure>,
    notices: Slot<String>,
    adapter: Slot<Adapter>,
    on_painted: Box<dyn Fn() + Send>,
    open: Open,
    /// What draws, and what it was opened for.
    opened: Option<(Backend, Renderer)>,
    /// Failures of the device in a row.
    failed: u32,
    /// Whether [`Backend::Auto`] means the processor, since the graphics card fails again and again.
    card_given_up: bool,
}

impl Worker {
    fn run(mut self) {
        while let Some(request) = self.desk.next() {
            // A panic while drawing costs the device and one picture, not the window.
            let result = catch_unwind(AssertUnwindSafe(|| self.paint(&request)));
            let again = match result {
                Ok(Ok(painted)) => {
                    self.failed = 0;
                    self.painted.put(Arc::new(painted));
                    false
                }
                Ok(Err(error)) => {
                    let again = device_is_gone(&error) && self.try_again(request.project.picture.backend);
                    self.fail(error.to_string());
                    again
                }
                Err(_) => {
                    let again = self.try_again(request.project.picture.backend);
                    self.fail("drawing stopped unexpectedly; what draws is opened again".to_owned());
                    again
                }
            };
            self.desk.done(again.then_some(request));
            (self.on_painted)();
        }
    }

    fn fail(&self, message: String) {
        self.failures.put(Arc::new(Failure { message, pictures: self.painted.number() }));
    }

    /// Closes what draws after it failed; whether to draw the same picture again by itself.
    fn try_again(&mut self, choice: Backend) -> bool {
        let by_processor = self.opened.take().is_some_and(|(_, renderer)| renderer.backend() == Backend::Cpu);
        self.failed = self.failed.saturating_add(1);
        if self.failed < MOST_FAILURES {
            return true;
        }
        if choice != Backend::Auto || self.card_given_up || by_processor {
            return false;
        }
        self.card_given_up = true;
        self.notices.put(Arc::new(format!(
            "The graphics card failed {MOST_FAILURES} times in a row: the processor draws from now on. Choose \
             \"{}\" in Picture to try the card again.",
            Backend::Gpu.label()
        )));
        true
    }

    fn paint(&mut self, request: &PaintRequest) -> Result<Painted, RenderError> {
        let choice = request.project.picture.backend;
        // Who asks for the card by name wants it tried again.
        self.card_given_up &= choice != Backend::Gpu;
        let wanted = if choice == Backend::Auto && self.card_given_up { Backend::Cpu } else { choice };
        if self.opened.as_ref().is_some_and(|(opened_for, _)| *opened_for != wanted) {
            self.opened = None;
        }
        let renderer = match &mut self.opened {
            Some((_, renderer)) => renderer,
            none => {
                let renderer = (self.open)(wanted)?;
                let (name, backend) = (renderer.adapter().to_owned(), renderer.backend());
                self.adapter.put(Arc::new(Adapter { name, backend, software: renderer.is_software() }));
                &mut none.insert((wanted, renderer)).1
            }
        };
        let PaintRequest { project, snapshot, width, height } = request;
        let mut times = snapshot.times;
        let camera = snapshot.camera(&project.camera);
        let mut picture = Picture::default();
        let input = snapshot.frame_input(project, &camera);
        let stats = renderer.picture(&input, *width, *height, &mut picture)?;
        times.take_picture(&stats);
        let (step, position_secs) = (snapshot.step, snapshot.position_secs);
        let snapshot = Arc::clone(snapshot);
        Ok(Painted { picture, camera, stats, times, snapshot, step, position_secs })
    }
}

/// Whether what draws must be opened again. A shader that does not compile does so on every device alike, what does not
/// fit will not fit then, and there is no use in looking for an adapter again that is not there.
fn device_is_gone(error: &RenderError) -> bool {
    match error {
        RenderError::Gpu(error) => {
            !matches!(error, GpuError::Shader(_) | GpuError::NoAdapter(_) | GpuError::Input(_))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests;
