//! A slot where the latest value wins.

use std::sync::{Arc, Mutex, PoisonError};

/// A slot where the latest value wins: the writer never waits for a reader, and a reader never for the writer.
///
/// Clones share the slot. Values are numbered from 1 in the order in which they were put.
#[derive(Debug)]
pub struct Slot<T> {
    shared: Arc<Mutex<Held<T>>>,
}

#[derive(Debug)]
struct Held<T> {
    number: u64,
    value: Option<Arc<T>>,
}

impl<T> Default for Slot<T> {
    fn default() -> Self {
        Self { shared: Arc::new(Mutex::new(Held { number: 0, value: None })) }
    }
}

impl<T> Clone for Slot<T> {
    fn clone(&self) -> Self {
        Self { shared: Arc::clone(&self.shared) }
    }
}

impl<T> Slot<T> {
    /// Puts a value, replacing the one that is there.
    pub fn put(&self, value: Arc<T>) {
        let replaced = {
            let mut held = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
            held.number += 1;
            held.value.replace(value)
        };
        // Dropped outside the lock: a reader must not wait while large buffers are freed.
        drop(replaced);
    }

    /// The latest value, which stays in the slot.
    pub fn latest(&self) -> Option<Arc<T>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).value.clone()
    }

    /// The latest value if it is newer than number `seen`, which is then moved on.
    pub fn newer_than(&self, seen: &mut u64) -> Option<Arc<T>> {
        let held = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        (held.number > *seen).then(|| {
            *seen = held.number;
            held.value.clone()
        })?
    }

    /// How many values have been put.
    pub fn number(&self) -> u64 {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_wins_and_stays() {
        let slot = Slot::default();
        assert!(slot.latest().is_none());
        for i in 0..5 {
            slot.put(Arc::new(i));
        }
        assert_eq!(slot.latest().as_deref(), Some(&4));
        assert_eq!(slot.latest().as_deref(), Some(&4));
        assert_eq!(slot.number(), 5);
    }

    #[test]
    fn a_reader_sees_each_value_at_most_once() {
        let slot = Slot::default();
        let mut seen = 0;
        assert!(slot.newer_than(&mut seen).is_none());
        slot.put(Arc::new('a'));
        slot.put(Arc::new('b'));
        assert_eq!(slot.newer_than(&mut seen).as_deref(), Some(&'b'));
        assert!(slot.newer_than(&mut seen).is_none(), "nothing new");
        slot.put(Arc::new('c'));
        assert_eq!(slot.newer_than(&mut seen).as_deref(), Some(&'c'));
    }

    #[test]
    fn numbers_only_rise_across_threads() {
        let slot = Slot::default();
        let writer = slot.clone();
        let handle = std::thread::Builder::new()
            .name("slot writer".to_owned())
            .spawn(move || (0..2000_u32).for_each(|i| writer.put(Arc::new(i))))
            .expect("a thread");
        let (mut seen, mut last) = (0, None);
        while last != Some(1999) {
            if let Some(value) = slot.newer_than(&mut seen) {
                assert!(last < Some(*value), "values come in order");
                last = Some(*value);
            }
        }
        handle.join().expect("the writer ends");
    }

    #[test]
    fn replaced_values_are_freed() {
        let slot = Slot::default();
        let first = Arc::new(1);
        slot.put(Arc::clone(&first));
        slot.put(Arc::new(2));
        assert_eq!(Arc::strong_count(&first), 1);
    }
}
