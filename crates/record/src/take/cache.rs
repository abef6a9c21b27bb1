//! A cache of decoded chunks.

use std::sync::Arc;

use super::codec::DecodedChunk;

/// Decoded chunks, up to a bound in bytes. The most recently used one is last.
pub(super) struct Cache {
    chunks: Vec<(usize, Arc<DecodedChunk>)>,
    bound: usize,
}

impl Cache {
    pub(super) fn new(bound: usize) -> Self {
        Self { chunks: Vec::new(), bound }
    }

    pub(super) fn set_bound(&mut self, bound: usize) {
        self.bound = bound;
        self.trim();
    }

    pub(super) fn get(&mut self, chunk: usize) -> Option<Arc<DecodedChunk>> {
        let place = self.chunks.iter().position(|(held, _)| *held == chunk)?;
        self.chunks[place..].rotate_left(1);
        self.chunks.last().map(|(_, decoded)| Arc::clone(decoded))
    }

    pub(super) fn put(&mut self, chunk: usize, decoded: &Arc<DecodedChunk>) {
        self.chunks.push((chunk, Arc::clone(decoded)));
        self.trim();
    }

    pub(super) fn bytes(&self) -> usize {
        self.chunks.iter().map(|(_, decoded)| decoded.bytes()).sum()
    }

    fn trim(&mut self) {
        let mut bytes = self.bytes();
        while bytes > self.bound && self.chunks.len() > 1 {
            bytes -= self.chunks.remove(0).1.bytes();
        }
    }
}
