//! The strands on the GPU: their buffers and bind groups.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Gpu, GrowBuffer, wgpu};
use rayon::prelude::*;

use super::pipelines::Pipelines;
use crate::sort::DepthSort;
use crate::strand_details::StrandDetails;
use crate::{FrameInput, Transparency};

/// A position and, in the bits of `w`, four 8-bit transmittances.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct Point([f32; 4]);

/// Twin of `ShadedPoint` in the strand shaders; never read on the processor.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct ShadedPoint([u32; 8]);

/// The strands' buffers. What belongs to the hairstyle is written when it changes, the rest every frame.
#[derive(Debug)]
pub(super) struct HairBuffers {
    style: StrandDetails,
    points: GrowBuffer<Point>,
    details: GrowBuffer<u32>,
    shaded: GrowBuffer<ShadedPoint>,
    order: GrowBuffer<u32>,
    staging: Vec<Point>,
    sort: DepthSort,
    points_group: Option<wgpu::BindGroup>,
    ribbons_group: Option<wgpu::BindGroup>,
}

impl HairBuffers {
    pub fn new(gpu: &Gpu) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            style: StrandDetails::default(),
            points: GrowBuffer::new(&gpu.device, "strand points", storage),
            details: GrowBuffer::new(&gpu.device, "strand details", storage),
            shaded: GrowBuffer::new(&gpu.device, "shaded points", storage),
            order: GrowBuffer::new(&gpu.device, "segment order", storage),
            staging: Vec::new(),
            sort: DepthSort::default(),
            points_group: None,
            ribbons_group: None,
        }
    }

    /// Writes one frame. `transmittance` holds one packed word a point.
    pub fn write(&mut self, gpu: &Gpu, pipelines: &Pipelines, input: &FrameInput, transmittance: &[u32]) {
        let FrameInput { style, strands, camera, .. } = *input;
        let transparency = input.picture.transparency;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let mut remade = false;
        let style_is_new = self.style.follow(style);
        if style_is_new {
            remade |= self.details.write(device, queue, &self.style.words);
        }
        strands
            .x
            .par_iter()
            .zip(&strands.y)
            .zip(&strands.z)
            .zip(transmittance)
            .map(|(((&x, &y), &z), &t)| Point([x, y, z, f32::from_bits(t)]))
            .collect_into_vec(&mut self.staging);
        remade |= self.points.write(device, queue, &self.staging);
        remade |= self.shaded.reserve(device, strands.points());
        match transparency {
            Transparency::Opaque => remade |= self.order.write(device, queue, &self.style.segments),
            // What the graphics card does not draw, its renderer refuses before it comes here.
            Transparency::Sorted
            | Transparency::WeightedAverage
            | Transparency::OccupancyOrder
            | Transparency::Exact => {
                let forward = (camera.target - camera.eye).normalize_or_zero();
                let staging = &self.staging;
                let order = self.sort.sort(&self.style.segments, |i| {
                    let [x, y, z, _] = staging[i].0;
                    x * forward.x + y * forward.y + z * forward.z
                });
                remade |= self.order.write(device, queue, order);
            }
        }
        // `arrayLength` of the details is the number of points, so the groups follow every new style too.
        if remade || style_is_new || self.points_group.is_none() {
            self.bind(device, pipelines);
        }
    }

    fn bind(&mut self, device: &wgpu::Device, pipelines: &Pipelines) {
        let details = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.details.raw(),
            offset: 0,
            size: std::num::NonZeroU64::new((self.details.len() as u64 * 4).max(4)),
        });
        let group = |label, layout, resources: Vec<wgpu::BindingResource>| {
            let entries: Vec<_> = resources
                .into_iter()
                .enumerate()
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding: binding as u32, resource })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            })
        };
        let order = self.order.raw().as_entire_binding();
        let (points, shaded) = (self.points.raw().as_entire_binding(), self.shaded.raw().as_entire_binding());
        self.points_group =
            Some(group("strand points", &pipelines.points_layout, vec![points, details, shaded.clone()]));
        self.ribbons_group = Some(group("strand ribbons", &pipelines.ribbons_layout, vec![shaded, order]));
    }

    /// Segments of the last frame.
    pub fn segment_count(&self) -> u32 {
        self.order.len() as u32
    }

    /// Projects and shades every point. The frame's bind group is group 0.
    pub fn shade(&self, pipelines: &Pipelines, pass: &mut wgpu::ComputePass, frame: &wgpu::BindGroup) {
        /// Workgroups along one axis of a dispatch: WebGPU's limit.
        const MOST_GROUPS: u32 = 65_535;
        let (Some(group), points) = (&self.points_group, self.details.len() as u32) else {
            return;
        };
        if points == 0 {
            return;
        }
        let groups = points.div_ceil(64);
        pass.set_pipeline(&pipelines.shade_points);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, group, &[]);
        pass.dispatch_workgroups(groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1);
    }

    /// Draws every segment.
    pub fn draw(
        &self,
        pipelines: &Pipelines,
        pass: &mut wgpu::RenderPass,
        frame: &wgpu::BindGroup,
        transparency: Transparency,
    ) {
        let Some(group) = &self.ribbons_group else { return };
        if self.segment_count() == 0 {
            return;
        }
        pass.set_pipeline(pipelines.ribbons(transparency));
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, group, &[]);
        pass.draw(0..self.segment_count() * 6, 0..1);
    }
}
