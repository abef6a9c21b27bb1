//! The drawing thread: takes the newest frame when it is free, and leaves its picture in a slot.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_render::{Backend, Camera, FrameStats, Picture, RenderError, Renderer};

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
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
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

/// The request that waits; `None` in `Some` ends the thread.
type Mailbox = Arc<(Mutex<Option<Option<PaintRequest>>>, Condvar)>;

/// Draws on a thread of its own. Requests that come while it draws replace each other.
#[derive(Debug)]
pub struct Painter {
    mailbox: Mailbox,
    painted: Slot<Painted>,
    errors: Slot<String>,
    adapter: Slot<Adapter>,
    busy: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Painter {
    /// Starts the thread. `on_painted` is called there after each picture and each error.
    ///
    /// # Errors
    /// The system makes no thread.
    pub fn start(on_painted: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let mailbox = Mailbox::default();
        let (painted, errors, adapter) = (Slot::default(), Slot::default(), Slot::default());
        let busy = Arc::new(AtomicBool::new(false));
        let worker = Worker {
            busy: Arc::clone(&busy),
            mailbox: Arc::clone(&mailbox),
            painted: painted.clone(),
            errors: errors.clone(),
            adapter: adapter.clone(),
            on_painted: Box::new(on_painted),
            renderer: None,
        };
        let thread = std::thread::Builder::new().name("draw".to_owned()).spawn(move || worker.run())?;
        Ok(Self { mailbox, painted, errors, adapter, busy, thread: Some(thread) })
    }

    /// Asks for a picture; a request that still waits is forgotten.
    pub fn request(&self, request: PaintRequest) {
        self.busy.store(true, Ordering::Relaxed);
        self.post(Some(request));
    }

    /// Where finished pictures are left.
    pub fn painted(&self) -> &Slot<Painted> {
        &self.painted
    }

    /// Where sentences about pictures that could not be drawn are left; the last picture stays.
    pub fn errors(&self) -> &Slot<String> {
        &self.errors
    }

    /// What draws; empty until the first picture.
    pub fn adapter(&self) -> Option<Arc<Adapter>> {
        self.adapter.latest()
    }

    /// Whether a picture is being drawn or waits: its end will call `on_painted`.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.busy)
    }

    fn post(&self, request: Option<PaintRequest>) {
        let (waiting, wake) = &*self.mailbox;
        *waiting.lock().unwrap_or_else(PoisonError::into_inner) = Some(request);
        wake.notify_one();
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        self.post(None);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Worker {
    mailbox: Mailbox,
    busy: Arc<AtomicBool>,
    painted: Slot<Painted>,
    errors: Slot<String>,
    adapter: Slot<Adapter>,
    on_painted: Box<dyn Fn() + Send>,
    renderer: Option<Renderer>,
}

impl Worker {
    fn run(mut self) {
        while let Some(request) = self.next() {
            // A panic while drawing costs the device and one picture, not the window.
            let result = catch_unwind(AssertUnwindSafe(|| self.paint(&request)));
            match result {
                Ok(Ok(painted)) => self.painted.put(Arc::new(painted)),
                Ok(Err(error)) => {
                    if matches!(error, RenderError::Gpu(_)) {
                        self.renderer = None;
                    }
                    self.errors.put(Arc::new(error.to_string()));
                }
                Err(_) => {
                    self.renderer = None;
                    let text = "drawing stopped unexpectedly; the graphics device is opened again".to_owned();
                    self.errors.put(Arc::new(text));
                }
            }
            self.busy.store(false, Ordering::Relaxed);
            (self.on_painted)();
        }
    }

    /// Waits for a request.
    fn next(&self) -> Option<PaintRequest> {
        let (waiting, wake) = &*self.mailbox;
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(request) = waiting.take() {
                return request;
            }
            waiting = wake.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn paint(&mut self, request: &PaintRequest) -> Result<Painted, RenderError> {
        let choice = request.project.picture.backend;
        if self.renderer.as_ref().is_some_and(|renderer| renderer.choice() != choice) {
            self.renderer = None;
        }
        let renderer = match &mut self.renderer {
            Some(renderer) => renderer,
            none => {
                let renderer = Renderer::open(choice)?;
                let (name, backend) = (renderer.adapter().to_owned(), renderer.backend());
                self.adapter.put(Arc::new(Adapter { name, backend, software: renderer.is_software() }));
                none.insert(renderer)
            }
        };
        let PaintRequest { project, snapshot, width, height } = request;
        let mut times = snapshot.times;
        let camera = snapshot.camera(&project.camera);
        let mut picture = Picture::default();
        let input = snapshot.frame_input(project, &camera);
        let stats = renderer.picture(&input, *width, *height, &mut picture)?;
        times.take_picture(&stats);
        Ok(Painted { picture, camera, stats, times, step: snapshot.step })
    }
}
