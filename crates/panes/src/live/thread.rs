//! The thread: takes the newest request when it is free, and renders its panes in turn.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use lovelock_project::project::CompareSection;
use lovelock_session::latest::{Job, Latest, LatestJob};
use lovelock_session::memory::Held;
use lovelock_session::threads::{background_workers, lower_priority};

use super::renderers::{Broken, Renderers};
use super::round::Rounds;
use crate::probe::LiveProbe;
use crate::request::{LivePane, LiveRequest};

/// The results that the thread publishes.
#[derive(Clone, Debug, Default)]
pub(super) struct Outputs {
    pub(super) panes: [Latest<LivePane>; CompareSection::MAX_PANES],
    pub(super) probe: Latest<LiveProbe>,
    pub(super) notices: Latest<String>,
}

impl Outputs {
    /// Drops the images and what was probed.
    fn clear(&self) {
        self.panes.iter().for_each(Latest::clear);
        self.probe.clear();
    }
}

pub(super) struct Worker {
    jobs: LatestJob<LiveRequest>,
    outputs: Outputs,
    on_drawn: Box<dyn Fn() + Send>,
    rounds: Rounds,
    held: Held,
}

impl Worker {
    pub(super) fn new(
        (jobs, outputs, held): (LatestJob<LiveRequest>, Outputs, Held),
        on_drawn: Box<dyn Fn() + Send>,
        renderers: Renderers,
    ) -> Self {
        Self { jobs, outputs, on_drawn, rounds: Rounds::new(renderers), held }
    }

    /// Renders until the window is closed, on background workers of low priority, so that the window and its simulation keep
    /// running while nine panes are rendered. The workers end with what is kept, when the page is left: their memory as well.
    pub(super) fn run(mut self) {
        lower_priority();
        let mut workers = None;
        while let Some(job) = self.jobs.next() {
            let Job::Do(request) = job else {
                workers = None;
                self.rounds.rest();
                self.outputs.clear();
                self.held.set(0);
                self.jobs.done(None);
                (self.on_drawn)();
                continue;
            };
            let workers = workers.get_or_insert_with(|| background_workers("pane"));
            let again = match workers {
                Some(workers) => workers.install(|| self.draw(&request)),
                None => self.draw(&request),
            };
            self.held.set(self.rounds.bytes());
            self.jobs.done(again.then_some(request));
            (self.on_drawn)();
        }
    }

    /// Renders a request. Returns whether to render it again.
    fn draw(&mut self, request: &LiveRequest) -> bool {
        // Panics while rendering a pane are caught there; any other panic costs a round, but not the window.
        catch_unwind(AssertUnwindSafe(|| self.round(request))).unwrap_or_else(|_| {
            let message = "The comparison failed and was restarted; save your project.";
            self.outputs.notices.put(Arc::new(message.to_owned()));
            false
        })
    }

    /// Renders the panes. Returns whether to render the request again because a device was lost.
    fn round(&mut self, request: &LiveRequest) -> bool {
        let mut again = false;
        self.rounds.begin(request);
        let mut finished = Vec::new();
        for &index in request.panes.iter().take(CompareSection::MAX_PANES) {
            let Some(slot) =
                self.outputs.panes.get(index).filter(|_| index < request.project.compare.panes.len())
            else {
                continue;
            };
            // Closing the window or the page does not wait for the other panes.
            if self.jobs.is_dropped() {
                return false;
            }
            let (pane, broken) = self.rounds.pane(request, index);
            if let Some(Broken { try_again, notice }) = broken {
                again |= try_again;
                if let Some(notice) = notice {
                    self.outputs.notices.put(Arc::new(notice));
                }
            }
            if request.together {
                finished.push((slot, pane));
            } else {
                slot.put(Arc::new(pane));
                (self.on_drawn)();
            }
        }
        for (slot, pane) in finished {
            slot.put(Arc::new(pane));
        }
        again |= self.take_times(request);
        if let Some(probe) = self.rounds.probe(request) {
            self.outputs.probe.put(Arc::new(probe));
        }
        again
    }

    /// Waits for the panes whose images are still drawn by a device, and publishes them again with their times. Returns whether one must
    /// be rendered again.
    fn take_times(&mut self, request: &LiveRequest) -> bool {
        let mut again = false;
        for &index in &request.panes {
            let Some(slot) = self.outputs.panes.get(index) else { continue };
            let (Some(done), Some(pane)) = (self.rounds.finish(index), slot.latest()) else {
                continue;
            };
            again |= done.again;
            let mut pane = LivePane::clone(&pane);
            pane.times = pane.times.with_whole(done.ms);
            pane.shadow_fallbacks = done.shadow_fallbacks;
            slot.put(Arc::new(pane));
        }
        again
    }
}
