//! The newest request for a background thread.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What the worker does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Job<T> {
    /// It processes the newest request.
    Do(T),
    /// It gives back everything that it keeps for further requests.
    Rest,
}

/// The request that waits.
#[derive(Debug)]
struct Pending<T> {
    request: Option<T>,
    rest: bool,
    closed: bool,
}

/// A queue that holds only the newest request, shared by the requesting threads and the one worker. A later request replaces one
/// that still waits.
#[derive(Debug)]
pub struct LatestJob<T> {
    pending: Arc<(Mutex<Pending<T>>, Condvar)>,
    busy: Arc<AtomicBool>,
}

impl<T> Clone for LatestJob<T> {
    fn clone(&self) -> Self {
        Self { pending: Arc::clone(&self.pending), busy: Arc::clone(&self.busy) }
    }
}

impl<T> Default for LatestJob<T> {
    fn default() -> Self {
        let pending = Pending { request: None, rest: false, closed: false };
        Self { pending: Arc::new((Mutex::new(pending), Condvar::new())), busy: Arc::default() }
    }
}

impl<T> LatestJob<T> {
    /// Adds a request and replaces one that still waits.
    pub fn put(&self, request: T) {
        let mut pending = self.lock();
        pending.request = Some(request);
        // Under the lock, because `done` clears it under the lock.
        self.busy.store(true, Ordering::Relaxed);
        self.pending.1.notify_one();
    }

    /// Drops a request that waits, and makes the worker free what it keeps ([`Job::Rest`]) before it takes a later request.
    pub fn rest(&self) {
        let mut pending = self.lock();
        (pending.request, pending.rest) = (None, true);
        self.busy.store(true, Ordering::Relaxed);
        self.pending.1.notify_one();
    }

    /// Makes the worker end when it finishes the current request.
    pub fn close(&self) {
        self.lock().closed = true;
        self.pending.1.notify_one();
    }

    /// Whether a request waits that is newer than the current one, or the current one is of no use any more.
    pub fn has_newer(&self) -> bool {
        let pending = self.lock();
        pending.request.is_some() || pending.rest
    }

    /// What `of` returns for the request that waits, if any.
    pub fn peek<R>(&self, of: impl FnOnce(&T) -> R) -> Option<R> {
        self.lock().request.as_ref().map(of)
    }

    /// Whether the current request is obsolete: the worker must end, or free what it keeps.
    pub fn is_dropped(&self) -> bool {
        let pending = self.lock();
        pending.closed || pending.rest
    }

    /// Whether the worker must end.
    pub fn is_closed(&self) -> bool {
        self.lock().closed
    }

    /// Whether a request is being processed or waits.
    pub fn busy(&self) -> &Arc<AtomicBool> {
        &self.busy
    }

    /// Waits for work; `None` once the queue is closed.
    pub fn next(&self) -> Option<Job<T>> {
        let mut pending = self.lock();
        loop {
            if pending.closed {
                return None;
            }
            if std::mem::take(&mut pending.rest) {
                return Some(Job::Rest);
            }
            if let Some(request) = pending.request.take() {
                return Some(Job::Do(request));
            }
            pending = self.pending.1.wait(pending).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Work that waits, or that arrives within `most`.
    pub fn next_within(&self, most: Duration) -> Option<Job<T>> {
        let mut pending = self.lock();
        if pending.request.is_none() && !pending.rest && !pending.closed && !most.is_zero() {
            pending = self.pending.1.wait_timeout(pending, most).unwrap_or_else(PoisonError::into_inner).0;
        }
        if std::mem::take(&mut pending.rest) {
            return Some(Job::Rest);
        }
        pending.request.take().map(Job::Do)
    }

    /// Ends the current work. The request `again` is queued again unless a newer one waits or it is of no use any more.
    pub fn done(&self, again: Option<T>) {
        let mut pending = self.lock();
        if !pending.rest {
            pending.request = pending.request.take().or(again);
        }
        self.busy.store(pending.request.is_some() || pending.rest, Ordering::Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Pending<T>> {
        self.pending.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_request_is_processed_and_an_old_one_is_repeated_only_if_none_is_newer() {
        let jobs = LatestJob::default();
        let busy = |jobs: &LatestJob<u32>| jobs.busy().load(Ordering::Relaxed);
        assert!(!busy(&jobs));
        (1..=3).for_each(|request| jobs.put(request));
        assert_eq!(jobs.next(), Some(Job::Do(3)));
        assert!(busy(&jobs), "it is being processed");
        jobs.done(Some(3));
        assert!(busy(&jobs), "it waits again");
        assert_eq!(jobs.next(), Some(Job::Do(3)));
        jobs.put(4);
        jobs.done(Some(3));
        assert_eq!(jobs.next(), Some(Job::Do(4)));
        jobs.done(None);
        assert!(!busy(&jobs));
        assert_eq!(jobs.next_within(Duration::from_millis(1)), None);
        assert_eq!(jobs.peek(|request| *request), None);
        jobs.put(5);
        assert_eq!(jobs.peek(|request| *request), Some(5), "it still waits");
        assert_eq!(jobs.next_within(Duration::ZERO), Some(Job::Do(5)));
    }

    #[test]
    fn a_rest_drops_what_waits_and_comes_before_later_requests() {
        let jobs = LatestJob::default();
        let busy = |jobs: &LatestJob<u32>| jobs.busy().load(Ordering::Relaxed);
        jobs.put(1);
        assert_eq!(jobs.next(), Some(Job::Do(1)));
        jobs.put(2);
        jobs.rest();
        assert!(jobs.is_dropped() && jobs.has_newer());
        jobs.done(Some(1));
        assert!(busy(&jobs), "the rest waits");
        jobs.put(3);
        assert_eq!(jobs.next(), Some(Job::Rest), "2 is dropped and 1 is not repeated");
        jobs.done(None);
        assert!(!jobs.is_dropped());
        assert_eq!(jobs.next(), Some(Job::Do(3)));
        jobs.done(None);
        assert!(!busy(&jobs));
        jobs.rest();
        assert_eq!(jobs.next_within(Duration::ZERO), Some(Job::Rest));
        jobs.done(None);
        assert!(!busy(&jobs));
    }

    #[test]
    fn closing_ends_a_waiting_thread() {
        let jobs = LatestJob::<u32>::default();
        let waits = jobs.clone();
        let thread = std::thread::Builder::new().spawn(move || waits.next()).expect("a thread");
        jobs.close();
        assert_eq!(thread.join().expect("no panic"), None);
        jobs.put(1);
        assert_eq!((jobs.next(), jobs.is_closed()), (None, true), "nothing starts after closing");
    }
}
