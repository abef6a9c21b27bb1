//! A pool of scratch memory for threads.

use std::sync::{Mutex, PoisonError};

/// Scratch memory that is not in use.
#[derive(Debug)]
pub(super) struct Pool<T>(Mutex<Vec<Box<T>>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Pool<T> {
    /// The memory of what is not in use, by that of an item, bytes.
    pub fn bytes(&self, of_item: impl Fn(&T) -> u64) -> u64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|item| of_item(item)).sum()
    }

    /// Takes an item, if there is any.
    pub fn take(&self) -> Lease<'_, T> {
        let scratch = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Lease { pool: self, scratch }
    }
}

/// Scratch memory that returns to the pool when dropped.
#[derive(Debug)]
pub(super) struct Lease<'a, T> {
    pool: &'a Pool<T>,
    scratch: Option<Box<T>>,
}

impl<T: Default> Lease<'_, T> {
    /// An item of the pool, or a new one.
    pub fn get(&mut self) -> &mut T {
        self.scratch.get_or_insert_default()
    }
}

impl<T> Drop for Lease<'_, T> {
    fn drop(&mut self) {
        if let Some(scratch) = self.scratch.take() {
            self.pool.0.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
        }
    }
}
