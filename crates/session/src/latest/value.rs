//! The latest value from another thread.

use std::sync::{Arc, Mutex, PoisonError};

/// A cell that keeps only the latest value. Writer and readers do not wait for each other.
///
/// Clones share the cell. Values are numbered from 1 in the order in which they were put.
#[derive(Debug)]
pub struct Latest<T> {
    shared: Arc<Mutex<Numbered<T>>>,
}

#[derive(Debug)]
struct Numbered<T> {
    number: u64,
    value: Option<Arc<T>>,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Self { shared: Arc::new(Mutex::new(Numbered { number: 0, value: None })) }
    }
}

impl<T> Clone for Latest<T> {
    fn clone(&self) -> Self {
        Self { shared: Arc::clone(&self.shared) }
    }
}

impl<T> Latest<T> {
    /// Stores a value and replaces the previous one.
    pub fn put(&self, value: Arc<T>) {
        let replaced = {
            let mut held = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
            held.number += 1;
            held.value.replace(value)
        };
        // Drop outside the lock, so that readers do not wait while large buffers are freed.
        drop(replaced);
    }

    /// Drops the value. The number stays.
    pub fn clear(&self) {
        let dropped = self.shared.lock().unwrap_or_else(PoisonError::into_inner).value.take();
        drop(dropped);
    }

    /// The latest value, which stays in the cell.
    pub fn latest(&self) -> Option<Arc<T>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).value.clone()
    }

    /// The latest value if it is newer than number `seen`, which is then updated.
    pub fn newer_than(&self, seen: &mut u64) -> Option<Arc<T>> {
        let held = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        (held.number > *seen).then(|| {
            *seen = held.number;
            held.value.clone()
        })?
    }

    /// Number of values stored so far.
    pub fn number(&self) -> u64 {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_value_wins_and_stays() {
        let latest = Latest::default();
        assert!(latest.latest().is_none());
        for i in 0..5 {
            latest.put(Arc::new(i));
        }
        assert_eq!(latest.latest().as_deref(), Some(&4));
        assert_eq!(latest.latest().as_deref(), Some(&4));
        assert_eq!(latest.number(), 5);
    }

    #[test]
    fn a_reader_sees_each_value_at_most_once() {
        let latest = Latest::default();
        let mut seen = 0;
        assert!(latest.newer_than(&mut seen).is_none());
        latest.put(Arc::new('a'));
        latest.put(Arc::new('b'));
        assert_eq!(latest.newer_than(&mut seen).as_deref(), Some(&'b'));
        assert!(latest.newer_than(&mut seen).is_none(), "nothing new");
        latest.put(Arc::new('c'));
        assert_eq!(latest.newer_than(&mut seen).as_deref(), Some(&'c'));
    }

    #[test]
    fn numbers_only_rise_across_threads() {
        let latest = Latest::default();
        let writer = latest.clone();
        let handle = std::thread::Builder::new()
            .name("latest writer".to_owned())
            .spawn(move || (0..2000_u32).for_each(|i| writer.put(Arc::new(i))))
            .expect("a thread");
        let (mut seen, mut last) = (0, None);
        while last != Some(1999) {
            if let Some(value) = latest.newer_than(&mut seen) {
                assert!(last < Some(*value), "values come in order");
                last = Some(*value);
            }
        }
        handle.join().expect("the writer ends");
    }

    #[test]
    fn replaced_values_are_freed() {
        let latest = Latest::default();
        let first = Arc::new(1);
        latest.put(Arc::clone(&first));
        latest.put(Arc::new(2));
        assert_eq!(Arc::strong_count(&first), 1);
        let second = latest.latest().expect("a value");
        latest.clear();
        assert_eq!((latest.latest(), latest.number(), Arc::strong_count(&second)), (None, 2, 1));
        assert_eq!(latest.newer_than(&mut 0), None, "a number without a value");
    }
}
