//! Buffers whose contents are handed out, and that are written again when nobody holds them any more.

use std::sync::Arc;

use crate::Gpu;

/// A buffer of a [`BufferPool`]. While it is held, its content stays as it is.
#[derive(Clone, Debug)]
pub struct PooledBuffer {
    gpu: Arc<Gpu>,
    buffer: Arc<wgpu::Buffer>,
}

impl PooledBuffer {
    /// The buffer.
    pub fn raw(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Whether the device of `gpu` has the buffer.
    pub fn is_on(&self, gpu: &Gpu) -> bool {
        self.gpu.is_same_device(gpu)
    }
}

/// Buffers of one kind, of which a few are held at a time.
///
/// Writers and readers use the queue of one device: commands that read a buffer are submitted while it is held, so later ones may write it.
#[derive(Debug)]
pub struct BufferPool {
    label: &'static str,
    usage: wgpu::BufferUsages,
    all: Vec<PooledBuffer>,
}

impl BufferPool {
    /// A pool without buffers; `usage` is that of each.
    pub fn new(label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { label, usage, all: Vec::new() }
    }

    /// A buffer of `size` bytes that nobody holds. Free buffers of other sizes are dropped.
    pub fn take(&mut self, gpu: &Arc<Gpu>, size: u64) -> PooledBuffer {
        let is_free = |held: &PooledBuffer| Arc::strong_count(&held.buffer) == 1;
        self.all.retain(|held| !is_free(held) || (held.buffer.size() == size && held.is_on(gpu)));
        if let Some(free) = self.all.iter().find(|held| is_free(held)) {
            return free.clone();
        }
        let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some(self.label),
            size,
            usage: self.usage,
            mapped_at_creation: false,
        });
        let made = PooledBuffer { gpu: Arc::clone(gpu), buffer: Arc::new(buffer) };
        self.all.push(made.clone());
        made
    }
}
