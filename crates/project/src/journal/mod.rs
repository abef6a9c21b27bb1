//! Unsaved changes on disk, so that a crash costs at most the last second of edits.
//!
//! A [`Journal`] follows a document. Its thread appends every change to a file: each new state of the project as what differs from the state
//! before it, and how the undo history changed. The file lies beside the project as `.NAME.lovelock.journal`, or in the folder of [`Journals`]
//! for a project without a file and where the folder of the project cannot be written. It is locked while the program runs, so that a second
//! program on the same project is noticed; that one leaves a note beside it, so that the first is told, too. It is removed when the project is
//! closed. [`Journals::unsaved`] finds those that a crash left.

mod encoder;
mod folder;
mod note;
mod owner;
mod patch;
mod reader;
mod record;
mod shape;
mod writer;

pub use folder::{Journals, Unsaved};
pub use owner::Owner;
pub use writer::{Event, Picture};

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;

use crate::document::Document;
use crate::error::ProjectError;
use writer::{Marked, Message, Writer};

/// How often changes are written.
const EVERY: Duration = Duration::from_millis(200);
/// Messages that may wait for a slow disk. More are kept back.
const QUEUE: usize = 16;
/// How long closing waits for a slow disk.
const PATIENCE: Duration = Duration::from_secs(3);

/// The journal of the document that is edited. Dropping it leaves its file; [`Journal::close`] removes it.
#[derive(Debug)]
pub struct Journal {
    to: Option<SyncSender<Message>>,
    thread: Option<JoinHandle<()>>,
    events: Receiver<Event>,
    sent: Option<(Arc<Marked>, Stopwatch)>,
}

impl Journal {
    /// A journal that has no file until a document is followed.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn new(journals: Journals) -> Result<Self, ProjectError> {
        Self::waking(journals, || ())
    }

    /// As [`Journal::new`]. Its thread calls `wake` when [`Journal::events`] has something new.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn waking(journals: Journals, wake: impl Fn() + Send + 'static) -> Result<Self, ProjectError> {
        let (to, messages) = sync_channel(QUEUE);
        let (told, events) = sync_channel(QUEUE);
        let writer = Writer::new(journals, told, Box::new(wake));
        let thread = std::thread::Builder::new()
            .name("lovelock-journal".to_owned())
            .spawn(move || writer.run(&messages))
            .map_err(|error| {
                ProjectError::work(format!("could not start the thread that keeps changes: {error}"))
            })?;
        Ok(Self { to: Some(to), thread: Some(thread), events, sent: None })
    }

    /// Hands on what has changed. Call it after every change: it costs nothing if there was none. Returns after which time to call it again
    /// if changes are still to be written.
    pub fn follow(&mut self, document: &Document) -> Option<Duration> {
        self.follow_after(document, EVERY)
    }

    fn follow_after(&mut self, document: &Document, every: Duration) -> Option<Duration> {
        if let Some((sent, since)) = &self.sent {
            if document.history().is_at(&sent.history) && document.path() == sent.project.as_deref() {
                return None;
            }
            if let Some(left) = every.checked_sub(since.elapsed()).filter(|left| !left.is_zero()) {
                return Some(left);
            }
        }
        let project =
            document.path().map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
        let marked = Arc::new(Marked { history: document.history().mark(), project });
        match self.to.as_ref()?.try_send(Message::Mark(Arc::clone(&marked))) {
            Ok(()) => {
                self.sent = Some((marked, Stopwatch::start()));
                None
            }
            Err(TrySendError::Full(_)) => Some(EVERY),
            Err(TrySendError::Disconnected(_)) => None,
        }
    }

    /// Keeps a small picture of the document beside its journal.
    pub fn keep_picture(&self, picture: Picture) {
        if let Some(to) = &self.to {
            let _ = to.try_send(Message::Picture(picture));
        }
    }

    /// The document that is followed from now on is `unsaved`, which is discarded once its changes are in this journal.
    pub fn replaces(&mut self, unsaved: Unsaved) {
        if let Some(to) = &self.to {
            // Kept back only if the disk is stuck; then it is offered again.
            let _ = to.try_send(Message::Replaces(Box::new(unsaved)));
        }
    }

    /// Writes everything and waits until it has reached the disk, at most `within`. Returns whether it has.
    pub fn flush(&mut self, document: &Document, within: Duration) -> bool {
        // What is kept back because the disk is slow is not written.
        let is_handed_on = self.follow_after(document, Duration::ZERO).is_none();
        let (answer, answered) = sync_channel(1);
        let asked = self.to.as_ref().is_some_and(|to| to.try_send(Message::Flush(answer)).is_ok());
        is_handed_on && asked && answered.recv_timeout(within).unwrap_or(false)
    }

    /// What happened since the last call.
    pub fn events(&self) -> Vec<Event> {
        self.events.try_iter().collect()
    }

    /// Ends the journal and removes its file: the project was saved, or its changes were given up.
    pub fn close(mut self) {
        let since = Stopwatch::start();
        while let Some(to) = &self.to {
            match to.try_send(Message::Close) {
                Err(TrySendError::Full(_)) if since.elapsed() < PATIENCE => {
                    std::thread::sleep(Duration::from_millis(2));
                }
                _ => break,
            }
        }
        self.end();
    }

    fn end(&mut self) {
        self.to = None;
        let Some(thread) = self.thread.take() else { return };
        let since = Stopwatch::start();
        while !thread.is_finished() && since.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(2));
        }
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.end();
    }
}

#[cfg(test)]
mod tests;
