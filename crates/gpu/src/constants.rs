//! Uniform buffers with the constants of a pass, reused from frame to frame.

/// The most buffers that are kept. More passes in one frame get buffers of their own, which are not kept.
const MAX_KEPT: usize = 256;

/// Buffers in the order in which a frame uses them: the same pass gets the same buffer in each frame, so its bind group
/// stays valid too.
#[derive(Debug, Default)]
pub(crate) struct ConstantPool {
    kept: Vec<KeptConstant>,
    next: usize,
}

#[derive(Debug)]
struct KeptConstant {
    buffer: wgpu::Buffer,
    content: Vec<u8>,
}

impl ConstantPool {
    /// Starts a frame: its first pass gets the first buffer again.
    pub fn begin(&mut self) {
        self.next = 0;
    }

    /// The buffer of the next pass, and whether `bytes` must be written to it. `make` creates a buffer of this size.
    pub fn take(&mut self, bytes: &[u8], make: impl FnOnce() -> wgpu::Buffer) -> (wgpu::Buffer, bool) {
        let place = self.next;
        self.next += 1;
        if place >= MAX_KEPT {
            return (make(), true);
        }
        match self.kept.get_mut(place) {
            // With another size the passes of this frame are others than those of the last one.
            Some(kept) if kept.content.len() == bytes.len() => {
                let changed = kept.content != bytes;
                if changed {
                    kept.content.copy_from_slice(bytes);
                }
                (kept.buffer.clone(), changed)
            }
            _ => {
                let buffer = make();
                self.kept.truncate(place);
                self.kept.push(KeptConstant { buffer: buffer.clone(), content: bytes.to_vec() });
                (buffer, true)
            }
        }
    }
}
