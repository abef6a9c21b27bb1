//! The render thread: takes the newest request when it is free, renders it and publishes the image.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::project::backend_label;
use lovelock_render::{Backend, Camera, FrameStats, GpuError, Picture, RenderError, Renderer};

use crate::latest::{Latest, LatestJob};
use crate::snapshot::FrameSnapshot;
use crate::stats::StageTimes;

/// What to render.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    /// Settings of the image, lights, look and camera.
    pub project: Arc<Project>,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

/// A finished image with its cost.
#[derive(Clone, Debug)]
pub struct RenderedImage {
    /// The image.
    pub picture: Picture,
    /// The camera that it was rendered with.
    pub camera: Camera,
    /// Statistics of the render.
    pub stats: FrameStats,
    /// Times of all stages of this frame except `encode`.
    pub times: StageTimes,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
    /// [`FrameSnapshot::position_secs`] of the instant.
    pub position_secs: f64,
}

/// The device that renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, as reported by the driver.
    pub name: String,
    /// Its backend, GPU or CPU.
    pub backend: Backend,
    /// Whether it runs on the CPU.
    pub software: bool,
}

impl Adapter {
    /// The short name of its backend for labels: `CPU` or `GPU`.
    pub const fn backend_label(&self) -> &'static str {
        backend_label(self.backend)
    }
}

/// Why there is no newer image.
#[derive(Debug)]
struct Failure {
    message: String,
    /// Number of images finished before the failure.
    pictures: u64,
}

/// Opens a renderer on the chosen backend.
type Open = Box<dyn FnMut(Backend) -> Result<Renderer, RenderError> + Send>;

/// Number of consecutive failures after which a graphics device is no longer reopened automatically.
const MOST_FAILURES: u32 = 3;

/// Renders on a thread of its own. Requests that arrive while it renders replace each other.
#[derive(Debug)]
pub struct RenderThread {
    jobs: LatestJob<RenderRequest>,
    images: Latest<RenderedImage>,
    failures: Latest<Failure>,
    notices: Latest<String>,
    adapter: Latest<Adapter>,
    thread: Option<JoinHandle<()>>,
}

impl RenderThread {
    /// Starts the thread, which calls `on_rendered` after each image and each error.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(on_rendered: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with(Box::new(Renderer::open), on_rendered)
    }

    /// As [`RenderThread::start`], with renderers from `open`.
    fn start_with(open: Open, on_rendered: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let jobs = LatestJob::default();
        let (images, failures, notices) = (Latest::default(), Latest::default(), Latest::default());
        let adapter = Latest::default();
        let worker = Worker {
            jobs: jobs.clone(),
            images: images.clone(),
            failures: failures.clone(),
            notices: notices.clone(),
            adapter: adapter.clone(),
            on_rendered: Box::new(on_rendered),
            open,
            opened: None,
            failed: 0,
            card_given_up: false,
        };
        let thread = std::thread::Builder::new().name("draw".to_owned()).spawn(move || worker.run())?;
        Ok(Self { jobs, images, failures, notices, adapter, thread: Some(thread) })
    }

    /// Requests an image; a request that still waits is replaced.
    pub fn request(&self, request: RenderRequest) {
        self.jobs.put(request);
    }

    /// The latest finished image.
    pub fn images(&self) -> &Latest<RenderedImage> {
        &self.images
    }

    /// Why the last request failed, as a sentence; `None` once a later one succeeded. The last good image stays available.
    pub fn error(&self) -> Option<String> {
        let failure = self.failures.latest()?;
        (failure.pictures == self.images.number()).then(|| failure.message.clone())
    }

    /// Notices that stay valid while images follow, such as a switch to another backend.
    pub fn notices(&self) -> &Latest<String> {
        &self.notices
    }

    /// The device that renders; `None` until the first image.
    pub fn adapter(&self) -> Option<Arc<Adapter>> {
        self.adapter.latest()
    }

    /// Whether an image is being rendered or waits; `on_rendered` is called when it is done.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(self.jobs.busy())
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.jobs.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Worker {
    jobs: LatestJob<RenderRequest>,
    images: Latest<RenderedImage>,
    failures: Latest<Failure>,
    notices: Latest<String>,
    adapter: Latest<Adapter>,
    on_rendered: Box<dyn Fn() + Send>,
    open: Open,
    /// The renderer, and the backend that it was opened for.
    opened: Option<(Backend, Renderer)>,
    /// Number of consecutive failures of the device.
    failed: u32,
    /// Whether [`Backend::Auto`] means the CPU because the GPU failed repeatedly.
    card_given_up: bool,
}

impl Worker {
    fn run(mut self) {
        while let Some(request) = self.jobs.next() {
            // A panic while rendering costs the device and one image, but not the window.
            let result = catch_unwind(AssertUnwindSafe(|| self.render(&request)));
            let again = match result {
                Ok(Ok(images)) => {
                    self.failed = 0;
                    self.images.put(Arc::new(images));
                    false
                }
                Ok(Err(error)) => {
                    let again = device_is_gone(&error) && self.try_again(request.project.picture.backend);
                    self.fail(error.to_string());
                    again
                }
                Err(_) => {
                    let again = self.try_again(request.project.picture.backend);
                    self.fail("rendering stopped unexpectedly; the renderer is opened again".to_owned());
                    again
                }
            };
            self.jobs.done(again.then_some(request));
            (self.on_rendered)();
        }
    }

    fn fail(&self, message: String) {
        self.failures.put(Arc::new(Failure { message, pictures: self.images.number() }));
    }

    /// Closes the renderer after a failure. Returns whether to render the same request again.
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
            "The graphics card failed {MOST_FAILURES} times in a row: the processor renders from now on. Choose \
             \"{}\" in Picture to try the card again.",
            Backend::Gpu.label()
        )));
        true
    }

    fn render(&mut self, request: &RenderRequest) -> Result<RenderedImage, RenderError> {
        let choice = request.project.picture.backend;
        // An explicit choice of the GPU asks for another attempt.
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
        let RenderRequest { project, snapshot, width, height } = request;
        let mut times = snapshot.times;
        let camera = snapshot.camera(&project.camera);
        let mut picture = Picture::default();
        let input = snapshot.frame_input(project, &camera);
        let stats = renderer.picture(&input, *width, *height, &mut picture)?;
        times.take_picture(&stats);
        let (step, position_secs) = (snapshot.step, snapshot.position_secs);
        let snapshot = Arc::clone(snapshot);
        Ok(RenderedImage { picture, camera, stats, times, snapshot, step, position_secs })
    }
}

/// Whether the renderer must be opened again. Opening it again does not help if a shader does not compile, something does not
/// fit into memory, or there is no adapter.
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
