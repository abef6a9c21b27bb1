//! Live panes: a thread that renders each pane in turn at the newest instant.
//!
//! A round renders all requested panes at one instant, whose strands are interpolated once. Panes are published when each is
//! finished, or together at the end of the round.

mod colors;
mod film;
mod probes;
mod reference;
mod renderers;
mod round;
mod takes;
mod thread;

pub use film::FilmOfPanes;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

use lovelock_render::Renderer;
use lovelock_session::latest::{Latest, LatestJob};
use lovelock_session::memory::Held;
use lovelock_session::window_device::WindowDevice;
use renderers::{Open, Renderers};
use thread::Outputs;

use crate::probe::LiveProbe;
use crate::request::{LivePane, LiveRequest};

/// Renders panes on a thread of its own. A request that arrives during a round waits for its end; a later request replaces it.
#[derive(Debug)]
pub struct Live {
    jobs: LatestJob<LiveRequest>,
    outputs: Outputs,
    held: Held,
    thread: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts the thread, which calls `on_drawn` after each pane and at the end of a round. Images are textures of `window`.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(window: WindowDevice, on_drawn: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with(Box::new(Renderer::open_for), window, on_drawn)
    }

    /// As [`Live::start`], with renderers from `open`.
    fn start_with(
        open: Open,
        window: WindowDevice,
        on_drawn: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let jobs = LatestJob::default();
        let outputs = Outputs::default();
        let renderers = Renderers::new(open, window);
        let held = Held::default();
        let parts = (jobs.clone(), outputs.clone(), held.clone());
        let worker = thread::Worker::new(parts, Box::new(on_drawn), renderers);
        let thread = std::thread::Builder::new().name("compare".to_owned()).spawn(move || worker.run())?;
        Ok(Self { jobs, outputs, held, thread: Some(thread) })
    }

    /// Requests a round and replaces a request that still waits.
    pub fn request(&self, request: LiveRequest) {
        self.jobs.put(request);
    }

    /// Frees everything that is kept for further requests, and drops the images, because the panes are hidden. They are drawn again
    /// from the next request on.
    pub fn rest(&self) {
        self.jobs.rest();
    }

    /// The memory that is kept for further requests, bytes: renderers, strands and images.
    pub fn held_bytes(&self) -> u64 {
        self.held.bytes()
    }

    /// The latest image of pane `index`; `None` past [`MAX_PANES`](lovelock_project::project::CompareSection::MAX_PANES).
    pub fn pane(&self, index: usize) -> Option<&Latest<LivePane>> {
        self.outputs.panes.get(index)
    }

    /// The latest light along the ray through the chosen hair.
    pub fn probe(&self) -> &Latest<LiveProbe> {
        &self.outputs.probe
    }

    /// Notices that stay valid while panes follow, such as a switch to another backend.
    pub fn notices(&self) -> &Latest<String> {
        &self.outputs.notices
    }

    /// Whether a round is being rendered or waits; `on_drawn` is called when it is done.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(self.jobs.busy())
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.jobs.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests;
