//! What a renderer moves between memory and its device, how often it waits for it, and what it creates there.

use std::sync::atomic::{AtomicU64, Ordering};

/// Totals since a handle of the device was made, or the difference between two of them: see [`Traffic::since`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bytes copied from memory to the device.
    pub bytes_up: u64,
    /// Bytes copied from the device to memory.
    pub bytes_back: u64,
    /// How often a thread waited for the device to finish.
    pub waits: u64,
    /// Buffers, textures and bind groups that were created.
    pub created: u64,
}

impl Traffic {
    /// Both together.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self {
            bytes_up: self.bytes_up + other.bytes_up,
            bytes_back: self.bytes_back + other.bytes_back,
            waits: self.waits + other.waits,
            created: self.created + other.created,
        }
    }

    /// What has happened since `earlier`.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Self {
        Self {
            bytes_up: self.bytes_up - earlier.bytes_up,
            bytes_back: self.bytes_back - earlier.bytes_back,
            waits: self.waits - earlier.waits,
            created: self.created - earlier.created,
        }
    }
}

/// The running totals of a handle.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    up: AtomicU64,
    back: AtomicU64,
    waits: AtomicU64,
    created: AtomicU64,
}

impl Counters {
    pub fn up(&self, bytes: u64) {
        self.up.fetch_add(bytes, Ordering::Relaxed);
    }

    pub fn back(&self, bytes: u64) {
        self.back.fetch_add(bytes, Ordering::Relaxed);
    }

    pub fn wait(&self) {
        self.waits.fetch_add(1, Ordering::Relaxed);
    }

    pub fn created(&self) {
        self.created.fetch_add(1, Ordering::Relaxed);
    }

    pub fn totals(&self) -> Traffic {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Traffic {
            bytes_up: of(&self.up),
            bytes_back: of(&self.back),
            waits: of(&self.waits),
            created: of(&self.created),
        }
    }
}
