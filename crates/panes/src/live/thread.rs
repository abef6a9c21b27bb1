//! The thread: takes the newest request when it is free, and draws its panes in turn.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use lovelock_project::project::CompareSection;
use lovelock_session::latest::{Desk, Slot};
use lovelock_session::threads::lower_priority;

use super::renderers::{Broken, Renderers};
use super::round::Rounds;
use crate::probe::LiveProbe;
use crate::request::{LivePane, LiveRequest};

/// What the thread leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Left {
    pub(super) panes: [Slot<LivePane>; CompareSection::MOST_PANES],
    pub(super) probe: Slot<LiveProbe>,
    pub(super) notices: Slot<String>,
}

pub(super) struct Worker {
    desk: Desk<LiveRequest>,
    left: Left,
    on_drawn: Box<dyn Fn() + Send>,
    rounds: Rounds,
}

impl Worker {
    pub(super) fn new(
        desk: Desk<LiveRequest>,
        left: Left,
        on_drawn: Box<dyn Fn() + Send>,
        renderers: Renderers,
    ) -> Self {
        Self { desk, left, on_drawn, rounds: Rounds::new(renderers) }
    }

    /// Draws until the window is closed, on workers of its own that give way to everybody else's: the window and its
    /// simulation go on while six panes are drawn.
    pub(super) fn run(self) {
        lower_priority();
        let workers = rayon::ThreadPoolBuilder::new()
            .thread_name(|i| format!("pane worker {i}"))
            .start_handler(|_| lower_priority())
            .build();
        match workers {
            Ok(workers) => workers.install(|| self.draw()),
            Err(error) => {
                tracing::warn!(%error, "panes share the workers of the rest");
                self.draw();
            }
        }
    }

    fn draw(mut self) {
        while let Some(request) = self.desk.next() {
            // A panic beside the drawing of a pane, which catches its own, costs a round and not the window.
            let again = catch_unwind(AssertUnwindSafe(|| self.round(&request))).unwrap_or_else(|_| {
                let message = "Comparing met an error and went on; save your project.";
                self.left.notices.put(Arc::new(message.to_owned()));
                false
            });
            self.desk.done(again.then_some(request));
            (self.on_drawn)();
        }
    }

    /// Draws the panes. Returns whether to draw the same again by itself, since a device was lost.
    fn round(&mut self, request: &LiveRequest) -> bool {
        let mut again = false;
        self.rounds.begin(request);
        let mut finished = Vec::new();
        for &index in request.panes.iter().take(CompareSection::MOST_PANES) {
            let Some(slot) =
                self.left.panes.get(index).filter(|_| index < request.project.compare.panes.len())
            else {
                continue;
            };
            // Whoever closes the window does not wait for the other panes.
            if self.desk.is_closed() {
                return false;
            }
            let (pane, broken) = self.rounds.pane(request, index);
            if let Some(Broken { try_again, notice }) = broken {
                again |= try_again;
                if let Some(notice) = notice {
                    self.left.notices.put(Arc::new(notice));
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
        if let Some(probe) = self.rounds.probe(request) {
            self.left.probe.put(Arc::new(probe));
        }
        again
    }
}
