//! Buffers of maps.

use lovelock_gpu::{Gpu, wgpu};

use crate::{ShadowError, ShadowMethod};

/// A buffer of words that grows, and shrinks when much less is needed.
#[derive(Debug)]
pub(crate) struct Buffer {
    label: &'static str,
    raw: wgpu::Buffer,
}

impl Buffer {
    pub fn new(gpu: &Gpu, label: &'static str) -> Self {
        Self { label, raw: make(gpu, label, 16) }
    }

    /// Makes room for `words` words. The content is lost if the buffer must be replaced.
    pub fn fit(&mut self, gpu: &Gpu, words: u64) {
        let size = (words * 4).next_multiple_of(16).max(16);
        if size > self.raw.size() || size < self.raw.size() / 4 {
            self.raw = make(gpu, self.label, size);
        }
    }

    pub fn bytes(&self) -> u64 {
        self.raw.size()
    }

    pub fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }
}

fn make(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// Returns an error if the device cannot create a buffer of this size.
pub(crate) fn fits_device(gpu: &Gpu, method: ShadowMethod, needed_bytes: u64) -> Result<(), ShadowError> {
    let limit_bytes = gpu.most_storage_bytes();
    if needed_bytes > limit_bytes {
        return Err(ShadowError::Device { method, needed_bytes, limit_bytes });
    }
    Ok(())
}
