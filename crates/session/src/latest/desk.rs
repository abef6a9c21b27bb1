//! A desk with one place: where the newest request lies until a thread is free for it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What lies on the desk.
#[derive(Debug)]
struct Place<T> {
    request: Option<T>,
    closed: bool,
}

/// A desk, shared by those who ask and the one thread that works. Later requests replace those that still wait.
#[derive(Debug)]
pub struct Desk<T> {
    place: Arc<(Mutex<Place<T>>, Condvar)>,
    busy: Arc<AtomicBool>,
}

impl<T> Clone for Desk<T> {
    fn clone(&self) -> Self {
        Self { place: Arc::clone(&self.place), busy: Arc::clone(&self.busy) }
    }
}

impl<T> Default for Desk<T> {
    fn default() -> Self {
        let place = Place { request: None, closed: false };
        Self { place: Arc::new((Mutex::new(place), Condvar::new())), busy: Arc::default() }
    }
}

impl<T> Desk<T> {
    /// Asks for something; what still waits is forgotten.
    pub fn put(&self, request: T) {
        let mut place = self.lock();
        place.request = Some(request);
        // Under the lock, as the thread takes it back.
        self.busy.store(true, Ordering::Relaxed);
        self.place.1.notify_one();
    }

    /// Lets the thread end as soon as it is free.
    pub fn close(&self) {
        self.lock().closed = true;
        self.place.1.notify_one();
    }

    /// Whether something newer waits than what is worked on.
    pub fn has_newer(&self) -> bool {
        self.lock().request.is_some()
    }

    /// Whether the thread is to end.
    pub fn is_closed(&self) -> bool {
        self.lock().closed
    }

    /// Whether something is worked on or waits.
    pub fn busy(&self) -> &Arc<AtomicBool> {
        &self.busy
    }

    /// Waits for a request; none where the desk is closed.
    pub fn next(&self) -> Option<T> {
        let mut place = self.lock();
        loop {
            if place.closed {
                return None;
            }
            if let Some(request) = place.request.take() {
                return Some(request);
            }
            place = self.place.1.wait(place).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The thread is free. `again` is worked on once more, unless something newer waits.
    pub fn done(&self, again: Option<T>) {
        let mut place = self.lock();
        place.request = place.request.take().or(again);
        self.busy.store(place.request.is_some(), Ordering::Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Place<T>> {
        self.place.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_request_is_worked_on_and_an_old_one_only_where_none_is_newer() {
        let desk = Desk::default();
        let busy = |desk: &Desk<u32>| desk.busy().load(Ordering::Relaxed);
        assert!(!busy(&desk));
        (1..=3).for_each(|request| desk.put(request));
        assert_eq!(desk.next(), Some(3));
        assert!(busy(&desk), "it is being worked on");
        desk.done(Some(3));
        assert!(busy(&desk), "it waits again");
        assert_eq!(desk.next(), Some(3));
        desk.put(4);
        desk.done(Some(3));
        assert_eq!(desk.next(), Some(4));
        desk.done(None);
        assert!(!busy(&desk));
    }

    #[test]
    fn a_closed_desk_ends_a_thread_that_waits() {
        let desk = Desk::<u32>::default();
        let waits = desk.clone();
        let thread = std::thread::Builder::new().spawn(move || waits.next()).expect("a thread");
        desk.close();
        assert_eq!(thread.join().expect("no panic"), None);
        desk.put(1);
        assert_eq!((desk.next(), desk.is_closed()), (None, true), "nothing is begun after the end");
    }
}
