//! The grid of all lights: an index of the window, and a list of bricks.

use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, read_buffer, wgpu};

use super::super::cpu::bytes;
use super::super::grid::BRICK_WORDS;
use super::FRAME;
use crate::gpu::{Buffer, GpuList, GpuShadowInput, fits_device, wgsl};
use crate::{ShadowError, ShadowMethod};

const SAMPLES: ShaderPart = wgsl!("methods/voxel_march/gpu/", "samples.wgsl");
const MARK: ShaderPart = wgsl!("methods/voxel_march/gpu/", "mark.wgsl");
const PLACE: ShaderPart = wgsl!("methods/voxel_march/gpu/", "place.wgsl");
const DENSITY: ShaderPart = wgsl!("methods/voxel_march/gpu/", "density.wgsl");

/// The names of the passes in statistics, their parts and their entry points.
const PASSES: [(&str, &[ShaderPart], &str); 3] = [
    ("shadow/mark", &[FRAME, MARK, SAMPLES], "each_segment"),
    ("shadow/place", &[FRAME, PLACE], "place_bricks"),
    ("shadow/density", &[FRAME, DENSITY, SAMPLES], "each_segment"),
];

/// Bytes before the first brick of the list, and of a brick.
const HEAD_BYTES: u64 = 16;
const BRICK_BYTES: u64 = 4 * BRICK_WORDS as u64;
/// Bricks of the first guess.
const LEAST_ROOM: u64 = 256;

/// The memory budget of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    /// The most bytes of all lights together, who share the grid.
    pub limit_bytes: u64,
    pub bricks_of_window: u64,
}

impl Share {
    /// Returns an error if so many bricks do not fit.
    fn check(&self, gpu: &Gpu, bricks: u64) -> Result<u64, ShadowError> {
        let (method, limit_bytes) = (ShadowMethod::VoxelMarch, self.limit_bytes);
        let needed_bytes = bytes(self.bricks_of_window, bricks);
        if needed_bytes > limit_bytes {
            return Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps: 1 });
        }
        fits_device(gpu, method, HEAD_BYTES + bricks * BRICK_BYTES)?;
        Ok(needed_bytes)
    }

    /// The most bricks that fit.
    fn most(&self, gpu: &Gpu) -> u64 {
        let bytes = self.limit_bytes.saturating_sub(4 * self.bricks_of_window).min(gpu.most_storage_bytes());
        bytes.saturating_sub(HEAD_BYTES) / BRICK_BYTES
    }
}

/// Density in the memory of the GPU.
#[derive(Debug)]
pub(super) struct GpuGrid {
    kernels: [Kernel; 3],
    index: Buffer,
    list: Buffer,
    share: Option<Share>,
    /// Bricks of the last build that was counted.
    found: u64,
}

impl GpuGrid {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let [mark, place, density] =
            PASSES.map(|(name, parts, entry)| Kernel::new(gpu, name, &ShaderSource::new(parts), entry));
        Ok(Self {
            kernels: [mark?, place?, density?],
            index: Buffer::new(gpu, "bricks of the window"),
            list: Buffer::new(gpu, "bricks"),
            share: None,
            found: 0,
        })
    }

    pub fn shaders() -> Vec<(String, ShaderSource)> {
        PASSES.iter().map(|(name, parts, _)| ((*name).to_owned(), ShaderSource::new(parts))).collect()
    }

    /// Bricks that the list has room for.
    pub fn room(&self) -> u64 {
        (self.list.bytes().saturating_sub(HEAD_BYTES)) / BRICK_BYTES
    }

    pub fn memory_bytes(&self) -> u64 {
        self.index.bytes() + self.list.bytes()
    }

    /// The bindings of index and list.
    pub fn resources(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(3, self.index.raw().as_entire_binding()), (5, self.list.raw().as_entire_binding())]
    }

    /// Makes room for a little more than the last build needed, within the budget, and encodes clearing it.
    pub fn begin(&mut self, gpu: &Gpu, commands: &mut Commands, share: Share) -> Result<(), ShadowError> {
        share.check(gpu, 0)?;
        let wanted = (self.found + self.found / 8).max(LEAST_ROOM).min(share.most(gpu));
        self.list.fit(gpu, (HEAD_BYTES + wanted * BRICK_BYTES) / 4);
        self.index.fit(gpu, share.bricks_of_window);
        let encoder = commands.encoder();
        encoder.clear_buffer(self.list.raw(), 0, None);
        encoder.clear_buffer(self.index.raw(), 0, None);
        self.share = Some(share);
        Ok(())
    }

    /// Encodes filling the grid.
    pub fn build(&self, gpu: &Gpu, commands: &mut Commands, uniform: &wgpu::Buffer, input: &GpuShadowInput) {
        let mut resources = self.resources().to_vec();
        resources.extend([
            (0, uniform.as_entire_binding()),
            (1, input.strands.points.as_entire_binding()),
            (2, input.strands.segments.as_entire_binding()),
        ]);
        let segments = u64::from(input.strands.segment_count);
        for (at, kernel) in self.kernels.iter().enumerate() {
            let group = kernel.bind(gpu, &resources);
            // One workgroup numbers the bricks.
            let threads = if at == 1 { 64 } else { segments };
            commands.compute(PASSES[at].0, |pass| kernel.run(pass, &group, threads));
        }
    }

    pub fn list(&self) -> GpuList<'_> {
        GpuList { buffer: self.list.raw(), at: 0, room: self.room() }
    }

    /// Takes the head of a finished build. Returns the bytes that the grid needs, and whether the list was too short and has been enlarged.
    pub fn settle(&mut self, gpu: &Gpu, head: [u32; 2]) -> Result<(u64, bool), ShadowError> {
        let Some(share) = self.share else { return Ok((0, false)) };
        self.found = GpuList::fragments(head);
        let needed_bytes = share.check(gpu, self.found)?;
        let short = self.found > self.room();
        if short {
            let wanted = (self.found + self.found / 8).min(share.most(gpu)).max(self.found);
            self.list.fit(gpu, (HEAD_BYTES + wanted * BRICK_BYTES) / 4);
        }
        Ok((needed_bytes, short))
    }

    /// Frees its memory.
    pub fn free(&mut self, gpu: &Gpu) {
        self.index.fit(gpu, 0);
        self.list.fit(gpu, 0);
        (self.share, self.found) = (None, 0);
    }

    /// The words of the index and of the list.
    pub fn words(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(share) = self.share else { return Ok(Vec::new()) };
        let list = (HEAD_BYTES + self.found * BRICK_BYTES).min(self.list.bytes()) / 4;
        let mut words = vec![0; share.bricks_of_window as usize];
        read_buffer(gpu, self.index.raw(), &mut words)?;
        let mut bricks = vec![0; list as usize];
        read_buffer(gpu, self.list.raw(), &mut bricks)?;
        words.extend(bricks);
        Ok(words)
    }
}
