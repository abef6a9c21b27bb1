//! Panes beside each other, live: a thread that draws each of them in turn on the newest instant.
//!
//! A round draws every pane that is asked for on one instant, whose strands are interpolated once. Panes are left in
//! their slots as they are finished, or together at the end of the round.

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
use lovelock_session::latest::{Desk, Slot};
use renderers::{Open, Renderers};
use thread::Left;

use crate::probe::LiveProbe;
use crate::request::{LivePane, LiveRequest};

/// Draws panes on a thread of its own. A request that comes while a round is drawn waits for its end; a later one
/// replaces it.
#[derive(Debug)]
pub struct Live {
    desk: Desk<LiveRequest>,
    left: Left,
    thread: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts the thread. `on_drawn` is called there after each pane and at the end of a round.
    ///
    /// # Errors
    /// The system makes no thread.
    pub fn start(on_drawn: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Self::start_with(Box::new(Renderer::open), on_drawn)
    }

    /// As [`Live::start`], on what `open` opens.
    fn start_with(open: Open, on_drawn: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let desk = Desk::default();
        let left = Left::default();
        let renderers = Renderers::new(open);
        let worker = thread::Worker::new(desk.clone(), left.clone(), Box::new(on_drawn), renderers);
        let thread = std::thread::Builder::new().name("compare".to_owned()).spawn(move || worker.run())?;
        Ok(Self { desk, left, thread: Some(thread) })
    }

    /// Asks for a round; a request that still waits is forgotten.
    pub fn request(&self, request: LiveRequest) {
        self.desk.put(request);
    }

    /// Where pane `index` is left; none past [`CompareSection::MOST_PANES`].
    pub fn pane(&self, index: usize) -> Option<&Slot<LivePane>> {
        self.left.panes.get(index)
    }

    /// Where the light along the ray through the chosen hair is left.
    pub fn probe(&self) -> &Slot<LiveProbe> {
        &self.left.probe
    }

    /// Where sentences are left that stay true while panes come: that another backend draws from now on.
    pub fn notices(&self) -> &Slot<String> {
        &self.left.notices
    }

    /// Whether a round is being drawn or waits: its end will call `on_drawn`.
    pub fn busy(&self) -> Arc<AtomicBool> {
        Arc::clone(self.desk.busy())
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.desk.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests;
