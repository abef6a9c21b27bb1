//! The wall: variants of a hairstyle, each simulated and rendered beside the others at the instant of the window.
//!
//! A thread simulates all variants and renders them side by side. It takes the newest request when it is free, so the window never waits for it.

mod cell;
mod thread;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_render::Image;

use crate::latest::{Latest, LatestJob};
use crate::memory::Held;
use crate::window_device::WindowDevice;

/// What the wall shows.
#[derive(Clone, Debug)]
pub struct WallRequest {
    /// The project at the instant: body, motion, lights, camera and settings of images.
    pub project: Arc<Project>,
    /// The variants, at most [`Wall::CELLS`]: the hairstyle and colours of each are used.
    pub variants: Vec<Arc<Project>>,
    /// The files that the projects may read.
    pub access: Access,
    /// Time of the scene, seconds, as in [`FrameSnapshot::time_secs`](crate::snapshot::FrameSnapshot::time_secs).
    pub time_secs: f64,
    /// Whether time passes; hair that stands still is settled first.
    pub playing: bool,
    /// Width and height of each image, pixels.
    pub size: [u32; 2],
}

/// The newest image of one variant.
#[derive(Clone, Debug)]
pub struct WallCell {
    /// The variant that it shows.
    pub variant: Arc<Project>,
    /// The image; without pixels if `problem` says why.
    pub image: Image,
    /// Time of the scene, seconds.
    pub time_secs: f64,
    /// Why there is no image.
    pub problem: Option<String>,
}

/// Simulates and renders variants on a thread of its own.
#[derive(Debug)]
pub struct Wall {
    jobs: LatestJob<WallRequest>,
    cells: [Latest<WallCell>; Self::CELLS],
    rounds: Latest<f64>,
    held: Held,
    thread: Option<JoinHandle<()>>,
}

impl Wall {
    /// The most variants.
    pub const CELLS: usize = 9;

    /// Starts the thread, which calls `on_drawn` after each round of images.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(window: WindowDevice, on_drawn: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (jobs, cells, rounds) =
            (LatestJob::default(), std::array::from_fn(|_| Latest::default()), Latest::default());
        let held = Held::default();
        let parts = (jobs.clone(), (cells.clone(), rounds.clone()), held.clone());
        let worker = thread::Worker::new(parts, Box::new(on_drawn), window);
        let thread = std::thread::Builder::new().name("wall".to_owned()).spawn(move || worker.run())?;
        Ok(Self { jobs, cells, rounds, held, thread: Some(thread) })
    }

    /// Requests a round and replaces a request that still waits.
    pub fn request(&self, request: WallRequest) {
        self.jobs.put(request);
    }

    /// Frees the simulations, renderers and images of all variants, because they are hidden. They start again with the next request.
    pub fn rest(&self) {
        self.jobs.rest();
    }

    /// The memory that is kept for further requests, bytes: renderers, images, and the hair of simulations.
    pub fn held_bytes(&self) -> u64 {
        self.held.bytes()
    }

    /// The latest image of variant `index`; `None` past [`Wall::CELLS`].
    pub fn cell(&self, index: usize) -> Option<&Latest<WallCell>> {
        self.cells.get(index)
    }

    /// The time that the last round took, milliseconds; its number grows with every round.
    pub fn rounds(&self) -> &Latest<f64> {
        &self.rounds
    }

    /// Whether a round is being rendered or waits; `on_drawn` is called when it is done.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(self.jobs.busy())
    }
}

impl Drop for Wall {
    fn drop(&mut self) {
        self.jobs.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests;
