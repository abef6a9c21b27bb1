//! Buffers that grow and whose whole content is written at once.

use bytemuck::Pod;

use crate::Gpu;

/// A buffer of `T` whose whole content is written at once. It grows when more is written than it holds.
#[derive(Debug)]
pub struct GrowBuffer<T> {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
    len: usize,
    _of: std::marker::PhantomData<T>,
}

impl<T: Pod> GrowBuffer<T> {
    /// An empty buffer with the given `usage`, to which `COPY_DST` and `COPY_SRC` are added.
    pub fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let buffer = make(gpu, label, usage, size_of::<T>().max(16) as u64);
        Self { label, usage, buffer, len: 0, _of: std::marker::PhantomData }
    }

    /// Makes room for `len` items without writing any. Returns whether the buffer was replaced: then bind groups that use
    /// it must be made again.
    pub fn reserve(&mut self, gpu: &Gpu, len: usize) -> bool {
        self.len = len;
        let size = ((len * size_of::<T>()).max(16) as u64).next_multiple_of(16);
        if size <= self.buffer.size() {
            return false;
        }
        // Half as much again, so that dragging a slider does not replace the buffer at every step; but no more than can be
        // bound, because buffers are bound whole.
        let limits = gpu.device.limits();
        let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        let grown = (size + size / 2).next_multiple_of(16).min(limit).max(size);
        self.buffer = make(gpu, self.label, self.usage, grown);
        true
    }

    /// Replaces the content by `items`. Returns what [`Self::reserve`] returns.
    pub fn write(&mut self, gpu: &Gpu, items: &[T]) -> bool {
        let new = self.reserve(gpu, items.len());
        gpu.upload(&self.buffer, 0, items);
        new
    }

    /// The wgpu buffer.
    pub fn raw(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// The number of items that were last written or reserved.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the buffer holds no items.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

fn make(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    gpu.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}
