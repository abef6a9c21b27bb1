//! The thread: takes the newest request when it is free, and renders its panes in turn.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use lovelock_project::project::CompareSection;
use lovelock_session::latest::{Latest, LatestJob};
use lovelock_session::threads::lower_priority;

use super::renderers::{Broken, Renderers};
use super::round::Rounds;
use crate::probe::LiveProbe;
use crate::request::{LivePane, LiveRequest};

/// The results that the thread publishes.
#[derive(Clone, Debug, Default)]
pub(super) struct Outputs {
    pub(super) panes: [Latest<LivePane>; CompareSection::MOST_PANES],
    pub(super) probe: Latest<LiveProbe>,
    pub(super) notices: Latest<String>,
}

pub(super) struct Worker {
    jobs: LatestJob<LiveRequest>,
    outputs: Outputs,
    on_drawn: Box<dyn Fn() + Send>,
    rounds: Rounds,
}

impl Worker {
    pub(super) fn new(
        jobs: LatestJob<LiveRequest>,
        outputs: Outputs,
        on_drawn: Box<dyn Fn() + Send>,
        renderers: Renderers,
    ) -> Self {
        Self { jobs, outputs, on_drawn, rounds: Rounds::new(renderers) }
    }

    /// Renders until the window is closed, on background workers of low priority, so that the window and its simulation keep
    /// running while six panes are rendered.
    pub(super) fn run(self) {
        lower_priority();
        let workers = rayon::ThreadPoolBuilder::new()
            .thread_name(|i| format!("pane worker {i}"))
            .start_handler(|_| lower_priority())
            .build();
        match workers {
            Ok(workers) => workers.install(|| self.draw()),
            Err(error) => {
                tracing::warn!(%error, "panes share the global workers");
                self.draw();
            }
        }
    }

    fn draw(mut self) {
        while let Some(request) = self.jobs.next() {
            // Panics while rendering a pane are caught there; any other panic costs a round, but not the window.
            let again = catch_unwind(AssertUnwindSafe(|| self.round(&request))).unwrap_or_else(|_| {
                let message = "The comparison failed and was restarted; save your project.";
                self.outputs.notices.put(Arc::new(message.to_owned()));
                false
            });
            self.jobs.done(again.then_some(request));
            (self.on_drawn)();
        }
    }

    /// Renders the panes. Returns whether to render the request again because a device was lost.
    fn round(&mut self, request: &LiveRequest) -> bool {
        let mut again = false;
        self.rounds.begin(request);
        let mut finished = Vec::new();
        for &index in request.panes.iter().take(CompareSection::MOST_PANES) {
            let Some(slot) =
                self.outputs.panes.get(index).filter(|_| index < request.project.compare.panes.len())
            else {
                continue;
            };
            // Closing the window does not wait for the other panes.
            if self.jobs.is_closed() {
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
            let (Some((ms, short)), Some(pane)) = (self.rounds.finish(index), slot.latest()) else {
                continue;
            };
            again |= short;
            let mut pane = LivePane::clone(&pane);
            pane.times = pane.times.with_whole(ms);
            slot.put(Arc::new(pane));
        }
        again
    }
}
