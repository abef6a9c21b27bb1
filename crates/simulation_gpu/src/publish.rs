//! The guides of a step for renderers on the same device, which draw them from there.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{BufferPool, Commands, Gpu, GrowBuffer, PooledBuffer, wgpu};
use lovelock_simulation::device::{DeviceStep, SLOTS, Stamp};

use crate::kernels::GuideKernels;

/// Twin of `Publish` in publish.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Publish {
    place: [f32; 3],
    slots: u32,
    points: u32,
    guide_points: u32,
    unused: [u32; 2],
}

/// Writes the guides of each step into a buffer of their own.
#[derive(Debug)]
pub(crate) struct Publisher {
    pool: BufferPool,
    /// The guide in each slot, with the guides for which it was written.
    guide_in: GrowBuffer<u32>,
    known: Option<Stamp>,
    /// Number of guides in those slots.
    guides: u32,
    /// The guides of the last step, and the state that they belong to.
    last: Option<(Stamp, PooledBuffer)>,
    words: Vec<u32>,
}

impl Publisher {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            pool: BufferPool::new("guides of a step", storage | wgpu::BufferUsages::COPY_SRC),
            guide_in: GrowBuffer::new(gpu, "guides in slots", storage),
            known: None,
            guides: 0,
            last: None,
            words: Vec::new(),
        }
    }

    /// Encodes writing the guides of the state after `step`.
    pub(crate) fn run(
        &mut self,
        gpu: &Arc<Gpu>,
        kernels: &GuideKernels,
        commands: &mut Commands,
        step: &DeviceStep,
        state: &wgpu::Buffer,
    ) {
        if self.known != Some(step.guides_stamp()) {
            step.write_guide_numbers(&mut self.words);
            self.guides = self.words.iter().filter(|guide| **guide != u32::MAX).count() as u32;
            self.guide_in.write(gpu, &self.words);
            self.known = Some(step.guides_stamp());
        }
        let (slots, points) = ((step.blocks() * SLOTS) as u32, step.points() as u32);
        let guide_points = self.guides * points;
        let uniform = Publish { place: step.place().to_array(), slots, points, guide_points, unused: [0; 2] };
        let uniform = commands.constants("publish", &uniform);
        let into = self.pool.take(gpu, (12 * u64::from(guide_points)).max(12));
        let bound = kernels.publish.bind(
            gpu,
            &[
                (0, uniform.as_entire_binding()),
                (1, state.as_entire_binding()),
                (2, self.guide_in.raw().as_entire_binding()),
                (3, into.raw().as_entire_binding()),
            ],
        );
        let threads = u64::from(slots) * u64::from(points);
        commands.compute("publish", |pass| kernels.publish.run(pass, &bound, threads));
        self.last = Some((step.state_after(), into));
    }

    /// The guides of `state`, if they are those of the last step.
    pub(crate) fn guides(&self, state: Stamp) -> Option<PooledBuffer> {
        self.last.as_ref().filter(|(of, _)| *of == state).map(|(_, guides)| guides.clone())
    }

    /// Drops the guides of the last step.
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;

    #[test]
    fn the_constants_lie_where_the_shader_reads_them() {
        let found = crate::shaders().into_iter().find(|(name, _)| *name == "publish");
        let (_, source) = found.expect("the shader");
        let fields = [offset_of!(Publish, place), offset_of!(Publish, slots), offset_of!(Publish, points)];
        let ends = [offset_of!(Publish, guide_points), size_of::<Publish>()];
        assert_eq!(layout_in_shader(&source, "Publish"), [&fields[..], &ends].concat());
        assert!(source.text().contains(&format!("const SLOTS = {SLOTS}u;")), "slots of a block");
    }
}
