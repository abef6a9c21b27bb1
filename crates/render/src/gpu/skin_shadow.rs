//! Softens the shadow of hair on the body, on the GPU: the twin of [`Neighbours::soften`].

use std::sync::Arc;

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, wgpu};
use lovelock_motion::Body;

use super::pipelines::skin_shadow_source;
use super::shadow::Vertices;
use crate::skin::{Neighbours, ROUNDS};

/// The neighbours of the body's vertices.
#[derive(Debug)]
pub(super) struct SkinShadow {
    kernel: Kernel,
    uniform: wgpu::Buffer,
    neighbours: Neighbours,
    first: GrowBuffer<u32>,
    list: GrowBuffer<u32>,
    other: GrowBuffer<u32>,
}

impl SkinShadow {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            kernel: Kernel::new(gpu, "skin shadow", &skin_shadow_source(), "soften")?,
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("skin shadow"),
                size: 16,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            neighbours: Neighbours::default(),
            first: GrowBuffer::new(gpu, "first neighbours", storage),
            list: GrowBuffer::new(gpu, "neighbours", storage),
            other: GrowBuffer::new(gpu, "softer shadow", storage),
        })
    }

    /// Encodes softening the shadow of hair on the `vertices` of `body`.
    pub fn run(&mut self, gpu: &Gpu, commands: &mut Commands, body: &Arc<Body>, vertices: &Vertices) {
        if self.neighbours.follow(body) {
            self.first.write(gpu, &self.neighbours.first);
            self.list.write(gpu, &self.neighbours.list);
            gpu.upload(&self.uniform, 0, &[[self.neighbours.first.len() as u32 - 1, 0, 0, 0]]);
        }
        if vertices.count as usize + 1 != self.neighbours.first.len() {
            return;
        }
        self.other.reserve(gpu, vertices.count as usize);
        let groups =
            [(vertices.hair, self.other.raw()), (self.other.raw(), vertices.hair)].map(|(from, to)| {
                let resources = [
                    (0, self.first.raw().as_entire_binding()),
                    (1, self.list.raw().as_entire_binding()),
                    (2, from.as_entire_binding()),
                    (3, to.as_entire_binding()),
                    (4, self.uniform.as_entire_binding()),
                ];
                self.kernel.bind(gpu, &resources)
            });
        commands.compute("shadow/skin", |pass| {
            for round in 0..ROUNDS {
                self.kernel.run(pass, &groups[round % 2], u64::from(vertices.count));
            }
        });
    }
}
