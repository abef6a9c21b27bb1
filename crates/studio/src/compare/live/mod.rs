//! Panes beside each other, live: a thread that draws each of them in turn on the newest instant.
//!
//! A round draws every pane that is asked for on one instant, whose strands are interpolated once. Panes are left in
//! their slots as they are finished, or together at the end of the round.

mod film;
mod heat;
mod label;
mod probe;
mod reference;
mod renderers;
mod request;
mod round;
mod sheet;
mod takes;
mod thread;
mod view;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::JoinHandle;

pub(crate) use film::FilmOfPanes;
pub use label::bytes_label;
use lovelock_render::Renderer;
pub use probe::{LiveProbe, ProbePlace, ProbedHair};
use renderers::{Open, Renderers};
pub use request::{LiveError, LivePane, LiveRequest, LiveTimes};
pub use sheet::{Sheet, SheetPane, pane_columns};
pub use view::{LiveShows, LiveView};

use crate::desk::Desk;
use crate::{CompareSection, Slot};

/// What the thread leaves.
#[derive(Clone, Debug, Default)]
struct Left {
    panes: [Slot<LivePane>; CompareSection::MOST_PANES],
    probe: Slot<LiveProbe>,
    notices: Slot<String>,
}

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
