//! The render thread: takes the newest request when it is free, renders it and publishes the image.

mod failing;
mod inputs;
mod mask_view;
mod messages;
mod patience;
mod samples;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;
use std::time::Duration;

use lovelock_project::Project;
use lovelock_render::{
    Backend, DeviceImages, FrameInput, Gpu, GpuError, HairDrawing, Image, Interrupt, Picture,
    PictureSettings, RenderError, Renderer, Transparency,
};

use crate::latest::{Job, Latest, LatestJob};
use crate::memory::Held;
use crate::window_device::WindowDevice;
use failing::MAX_FAILURES;
pub use inputs::Inputs;
use mask_view::MaskView;
pub use mask_view::ShownMask;
pub use messages::{Adapter, ImageQuality, RenderRequest, RenderedImage};
use patience::{Part, Patience};
use samples::{Samples, jitter};

/// Why there is no newer image.
#[derive(Debug)]
struct Failure {
    message: String,
    /// Number of images finished before the failure.
    pictures: u64,
}

/// Opens a renderer on the chosen backend, on the window's device if that is one.
type Open = Box<dyn FnMut(Backend, Option<&Arc<Gpu>>) -> Result<Renderer, RenderError> + Send>;

/// How long the thread waits for the device or for a request before it looks at the other one.
const PATIENCE: Duration = Duration::from_millis(1);

/// Renders on a thread of its own. Requests that arrive while it renders replace each other.
#[derive(Debug)]
pub struct RenderThread {
    jobs: LatestJob<RenderRequest>,
    images: Latest<RenderedImage>,
    failures: Latest<Failure>,
    notices: Latest<String>,
    adapter: Latest<Adapter>,
    held: Held,
    thread: Option<JoinHandle<()>>,
}

impl RenderThread {
    /// Starts the thread, which calls `on_rendered` after each image and each error. Images are textures of `window`.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(window: WindowDevice, on_rendered: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with(Box::new(Renderer::open_for), window, Patience::default(), on_rendered)
    }

    /// As [`RenderThread::start`], with renderers from `open`.
    fn start_with(
        open: Open,
        window: WindowDevice,
        patience: Patience,
        on_rendered: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let jobs = LatestJob::default();
        let (images, failures, notices) = (Latest::default(), Latest::default(), Latest::default());
        let (adapter, held) = (Latest::default(), Held::default());
        let worker = Worker {
            jobs: jobs.clone(),
            images: images.clone(),
            failures: failures.clone(),
            notices: notices.clone(),
            adapter: adapter.clone(),
            held: held.clone(),
            on_rendered: Box::new(on_rendered),
            open,
            window,
            opened: None,
            textures: None,
            last: None,
            samples: Samples::default(),
            partial: None,
            mask: MaskView::default(),
            patience,
            picture: Picture::default(),
            cost: None,
            transmittance: 1.0,
            fallbacks: 0,
            refused: None,
            lost: None,
            failed: 0,
            card_given_up: false,
        };
        let thread = std::thread::Builder::new().name("draw".to_owned()).spawn(move || worker.run())?;
        Ok(Self { jobs, images, failures, notices, adapter, held, thread: Some(thread) })
    }

    /// Requests an image; a request that still waits is replaced.
    pub fn request(&self, request: RenderRequest) {
        self.jobs.put(request);
    }

    /// Closes the renderer, and frees what is kept for further requests, including the latest image. The next request opens it again.
    pub fn rest(&self) {
        self.jobs.rest();
    }

    /// The memory that is kept for further requests, bytes: the renderer, its images, and the samples of the one at rest.
    pub fn held_bytes(&self) -> u64 {
        self.held.bytes()
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

    /// Whether an image is being rendered or waits; `on_rendered` is called when it is done. What completes an image that is shown already
    /// does not count.
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

/// An open renderer.
struct Opened {
    /// The backend that it was opened for, and the window's device at that time.
    backend: Backend,
    window: Option<Arc<Gpu>>,
    renderer: Renderer,
}

struct Worker {
    jobs: LatestJob<RenderRequest>,
    images: Latest<RenderedImage>,
    failures: Latest<Failure>,
    notices: Latest<String>,
    adapter: Latest<Adapter>,
    held: Held,
    on_rendered: Box<dyn Fn() + Send>,
    open: Open,
    window: WindowDevice,
    opened: Option<Opened>,
    /// The textures of the images.
    textures: Option<DeviceImages>,
    /// The request that was rendered last, and its samples so far.
    last: Option<RenderRequest>,
    samples: Samples,
    /// The request whose image shows only what has moved so far.
    partial: Option<RenderRequest>,
    mask: MaskView,
    patience: Patience,
    picture: Picture,
    /// The image that a device finished last: its size, and its time in milliseconds.
    cost: Option<([u32; 2], f64)>,
    /// The mean transmittance that was measured last.
    transmittance: f32,
    /// Records of the shadow maps of the last finished image that were read in a simpler way.
    fallbacks: u64,
    /// The project with which the window's device was lost too often.
    refused: Option<Arc<Project>>,
    /// The window's device that was lost last.
    lost: Option<Arc<Gpu>>,
    /// Number of consecutive failures of the device.
    failed: u32,
    /// Whether [`Backend::Auto`] means the CPU because the GPU failed repeatedly.
    card_given_up: bool,
}

/// What the thread does next.
enum Work {
    Image(RenderRequest),
    /// The whole of an image that shows only what has moved.
    Whole(RenderRequest),
    /// Another sample of the last image, which stands still.
    Sample(RenderRequest),
    /// To free what is kept.
    Rest,
}

impl Work {
    fn of(job: Job<RenderRequest>) -> Self {
        match job {
            Job::Do(request) => Self::Image(request),
            Job::Rest => Self::Rest,
        }
    }
}

impl Worker {
    fn run(mut self) {
        while let Some(work) = self.next() {
            let (request, part) = match work {
                Work::Image(request) => (request, Part::Image),
                Work::Whole(request) => (request, Part::Whole),
                Work::Sample(request) => (request, Part::Sample),
                Work::Rest => {
                    self.rest();
                    continue;
                }
            };
            self.partial = None;
            // A panic while rendering costs the device and one image, but not the window.
            let result = catch_unwind(AssertUnwindSafe(|| self.render(&request, part)));
            let again = match result {
                Ok(Ok(image)) => {
                    if self.in_flight() == 0 {
                        self.failed = 0;
                    }
                    self.partial = image.stats.redrawn.map(|_| request.clone());
                    self.images.put(Arc::new(image));
                    self.last = Some(request.clone());
                    false
                }
                // The request that ended it waits, or none is of use any more.
                Ok(Err(RenderError::Interrupted)) => {
                    self.samples.forget();
                    self.jobs.done(None);
                    continue;
                }
                Ok(Err(error)) => {
                    self.samples.forget();
                    self.take_error(&error, &request)
                }
                Err(_) => {
                    self.samples.forget();
                    let again = self.try_again(request.project.picture.backend);
                    self.fail("rendering stopped unexpectedly; the renderer is opened again".to_owned());
                    again
                }
            };
            self.held.set(self.bytes());
            if again || part == Part::Image {
                self.jobs.done(again.then_some(request));
            }
            (self.on_rendered)();
        }
    }

    /// Frees what is kept for further requests.
    fn rest(&mut self) {
        (self.opened, self.textures, self.last, self.partial) = (None, None, None, None);
        (self.samples, self.mask, self.picture) =
            (Samples::default(), MaskView::default(), Picture::default());
        self.images.clear();
        self.held.set(0);
        self.jobs.done(None);
    }

    /// The memory that is kept for further requests.
    fn bytes(&self) -> u64 {
        self.opened.as_ref().map_or(0, |opened| opened.renderer.bytes())
            + self.textures.as_ref().map_or(0, DeviceImages::bytes)
            + self.samples.bytes()
            + self.picture.bytes()
    }

    /// Waits for the next work, and meanwhile takes what the device reports of finished images.
    fn next(&mut self) -> Option<Work> {
        loop {
            if self.jobs.is_closed() {
                return None;
            }
            self.take_finished();
            let opened = self.opened.as_ref().map(|opened| &opened.renderer);
            if let Some(renderer) = opened.filter(|renderer| renderer.is_full()) {
                renderer.wait_for_oldest(PATIENCE);
                continue;
            }
            let in_flight = opened.map_or(0, Renderer::in_flight);
            let further = self.further();
            if in_flight == 0 && further.is_none() {
                return self.jobs.next().map(Work::of);
            }
            let most = if in_flight > 0 { PATIENCE } else { Duration::ZERO };
            if let Some(job) = self.jobs.next_within(most) {
                return Some(Work::of(job));
            }
            if in_flight == 0 {
                return further;
            }
        }
    }

    /// What is drawn while nothing else is wanted.
    fn further(&self) -> Option<Work> {
        if let Some(partial) = &self.partial {
            return Some(Work::Whole(partial.clone()));
        }
        self.last.as_ref().filter(|last| self.samples.wants_more(last)).cloned().map(Work::Sample)
    }

    /// Takes the reports of finished images.
    fn take_finished(&mut self) {
        let mut again = false;
        while let Some(opened) = &mut self.opened {
            match opened.renderer.finished() {
                Ok(None) => break,
                Ok(Some(done)) => {
                    self.failed = 0;
                    self.cost = Some((done.size, done.ms));
                    self.transmittance = done.mean_transmittance.unwrap_or(self.transmittance);
                    self.fallbacks = done.shadow_fallbacks;
                    again |= done.again;
                }
                Err(error) => {
                    let Some(last) = self.last.clone() else { break };
                    again |= self.take_error(&error, &last);
                    (self.on_rendered)();
                    break;
                }
            }
        }
        if again && let Some(last) = &self.last {
            self.jobs.done(Some(last.clone()));
        }
    }

    fn in_flight(&self) -> usize {
        self.opened.as_ref().map_or(0, |opened| opened.renderer.in_flight())
    }

    fn render(&mut self, request: &RenderRequest, part: Part) -> Result<RenderedImage, RenderError> {
        let choice = request.project.picture.backend;
        if self.refused.as_ref().is_some_and(|refused| Arc::ptr_eq(refused, &request.project)) {
            let why = format!(
                "the graphics card was lost {MAX_FAILURES} times in a row with these settings: change one to try again"
            );
            return Err(GpuError::Input(why).into());
        }
        self.refused = None;
        // An explicit choice of the GPU asks for another attempt.
        self.card_given_up &= choice != Backend::Gpu;
        let backend = if choice == Backend::Auto && self.card_given_up { Backend::Cpu } else { choice };
        let window = self.window.get();
        self.opened.take_if(|opened| {
            opened.backend != backend || !same_device(opened.window.as_ref(), window.as_ref())
        });
        let renderer = match &mut self.opened {
            Some(opened) => &mut opened.renderer,
            none => {
                // A lost device stays lost: do not open it again.
                if backend != Backend::Cpu
                    && let Some(gpu) = window.as_ref().filter(|gpu| gpu.is_lost())
                {
                    gpu.check()?;
                }
                let renderer = (self.open)(backend, window.as_ref())?;
                let (name, backend_in_use) = (renderer.adapter().to_owned(), renderer.backend());
                let software = renderer.is_software();
                self.adapter.put(Arc::new(Adapter { name, backend: backend_in_use, software }));
                &mut none.insert(Opened { backend, window, renderer }).renderer
            }
        };
        let jobs = self.jobs.clone();
        let waiting = move || jobs.peek(|waiting| waiting.input);
        let for_newer = self.patience.interrupt((request.input, part), waiting);
        let jobs = self.jobs.clone();
        renderer.set_interrupt(Some(Interrupt::new(move || {
            jobs.is_dropped() || for_newer.as_ref().is_some_and(Interrupt::is_due)
        })));
        let moves = part == Part::Image && request.quality == ImageQuality::Draft;
        renderer.set_hurrying(moves && self.patience.hurries(request.input));
        let RenderRequest { project, snapshot, size, measured, .. } = request;
        let mut times = snapshot.times;
        let camera = snapshot.camera(&project.camera);
        let textures = self.window.images(&mut self.textures);
        let (image, mut stats) = if let Some(shown) = &request.mask {
            self.samples.forget();
            let body = self.mask.follow(shown, &snapshot.scene);
            // Values belong to strands, and those in front show theirs.
            let picture = PictureSettings {
                draw: HairDrawing::Strands,
                transparency: Transparency::Sorted,
                ..project.picture
            };
            let input = FrameInput {
                body: Some((&body, &snapshot.skin)),
                picture: &picture,
                is_draft: request.quality == ImageQuality::Draft,
                ..snapshot.frame_input(project, &camera)
            };
            renderer.strand_colors(&input, *size, (&self.mask.values, &shown.scale), textures)?
        } else if request.quality == ImageQuality::Refined
            && (renderer.backend() == Backend::Cpu || project.camera.lens.enabled)
        {
            let index = if part == Part::Sample { self.samples.taken() } else { 0 };
            let lens = snapshot.lens(&project.camera, &camera);
            let jittered = camera.moved_by_pixels(jitter(index, lens.is_some()), size[1]);
            let jittered = lens.map_or(jittered, |lens| lens.camera(&jittered, index));
            let picture = &mut self.picture;
            let input = snapshot.frame_input(project, &jittered);
            let stats = renderer.picture(&input, size[0], size[1], picture)?;
            self.samples.add(request, index, picture);
            (Image::on(textures, picture), stats)
        } else {
            self.samples.forget();
            let input = FrameInput {
                is_draft: request.quality == ImageQuality::Draft,
                ..snapshot.frame_input(project, &camera)
            };
            renderer.image(&input, *size, *measured, textures)?
        };
        if renderer.backend() == Backend::Gpu && renderer.in_flight() > 0 {
            // Its own time is not known yet: that of the last finished one stands for it.
            let ms = self.cost.map_or(0.0, |(_, ms)| ms);
            stats.draw_ms = (ms - stats.interpolate_ms - stats.shadow_ms).max(0.0);
            stats.mean_transmittance = self.transmittance;
            stats.shadow_fallbacks = self.fallbacks;
        } else if stats.redrawn.is_none() {
            self.cost = Some((*size, stats.interpolate_ms + stats.shadow_ms + stats.draw_ms));
        }
        self.patience.finished(request.input, stats.redrawn.is_some());
        times.take_picture(&stats);
        let (step, position_secs) = (snapshot.step, snapshot.position_secs);
        let (samples, snapshot) = (self.samples.taken().max(1), Arc::clone(snapshot));
        // Of a part nobody can tell what the whole would take.
        let cost = self.cost.filter(|_| stats.redrawn.is_none());
        let mask = request.mask.clone();
        let project = Arc::clone(project);
        Ok(RenderedImage {
            image,
            camera,
            stats,
            times,
            cost,
            snapshot,
            step,
            position_secs,
            input: request.input,
            samples,
            project,
            mask,
        })
    }
}

/// Whether both are the same device, or none.
fn same_device(a: Option<&Arc<Gpu>>, b: Option<&Arc<Gpu>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.is_same_device(b),
        (a, b) => a.is_none() && b.is_none(),
    }
}

#[cfg(test)]
mod tests;
