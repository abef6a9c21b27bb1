//! Uniform buffers with the constants of a pass, reused from frame to frame.

use std::sync::PoisonError;

use crate::Gpu;

/// The most buffers that are kept. More passes in one frame get buffers of their own, which are not kept.
const MOST_KEPT: usize = 256;

/// Buffers in the order in which a frame asks for them: the same pass gets the same buffer in each frame, so its bind group
/// stays valid too.
#[derive(Debug, Default)]
pub(crate) struct ConstantPool {
    kept: Vec<Kept>,
    next: usize,
}

#[derive(Debug)]
struct Kept {
    buffer: wgpu::Buffer,
    content: Vec<u8>,
}

impl ConstantPool {
    /// Starts a frame: its first pass gets the first buffer again.
    pub fn begin(&mut self) {
        self.next = 0;
    }
}

/// A uniform buffer of `gpu` that holds `bytes` until the next frame begins.
pub(crate) fn constants(gpu: &Gpu, label: &str, bytes: &[u8]) -> wgpu::Buffer {
    let make = || {
        gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: (bytes.len() as u64).next_multiple_of(16),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let mut pool = gpu.constants.lock().unwrap_or_else(PoisonError::into_inner);
    let place = pool.next;
    pool.next += 1;
    if place >= MOST_KEPT {
        let buffer = make();
        gpu.upload(&buffer, 0, bytes);
        return buffer;
    }
    if place == pool.kept.len() {
        pool.kept.push(Kept { buffer: make(), content: Vec::new() });
    }
    let kept = &mut pool.kept[place];
    if !kept.content.is_empty() && kept.content.len() != bytes.len() {
        // The passes of this frame are others than those of the last one.
        kept.buffer = make();
        kept.content.clear();
    }
    if kept.content != bytes {
        gpu.upload(&kept.buffer, 0, bytes);
        kept.content.clear();
        kept.content.extend_from_slice(bytes);
    }
    kept.buffer.clone()
}
