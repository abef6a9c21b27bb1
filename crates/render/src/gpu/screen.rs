//! The final pixels of a picture: hair over the body over the background.

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, ShaderSource, wgpu};

use super::eye::Area;
use super::frame_resources::FrameResources;
use super::ground::cells;
use super::light_kernels::{LISTS, LightKernels};
use super::targets::Targets;
use crate::backdrop::LaidBackdrop;
use crate::uniform::PlainBackground;

/// Bytes of the workgroups of one kernel.
const GROUPS_BYTES: u64 = 12;

/// The kernels that classify pixels.
#[derive(Debug)]
pub(super) struct ScreenKernels {
    /// The plain background.
    plain_background: Kernel,
    list_cells: Kernel,
    list_pixels: Kernel,
    size_lists: Kernel,
}

impl ScreenKernels {
    pub fn new(gpu: &Gpu, source: &ShaderSource) -> Result<Self, GpuError> {
        Ok(Self {
            plain_background: Kernel::new(gpu, "plain background", source, "plain_background")?,
            list_cells: Kernel::new(gpu, "cells", source, "list_cells")?,
            list_pixels: Kernel::new(gpu, "pixels of the figure", source, "list_pixels")?,
            size_lists: Kernel::new(gpu, "sizes of lists", source, "size_lists")?,
        })
    }
}

/// The input of the last kernels.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenInput<'a> {
    /// The attributes of the body per sample.
    pub targets: &'a Targets,
    /// The light on the ground.
    pub corners: &'a wgpu::Buffer,
    /// The area that may contain hair, and the hair of each of its pixels.
    pub area: Area,
    pub hair: &'a wgpu::Buffer,
    /// The area that may contain hair or body, in whole cells.
    pub figure: Area,
    pub background: PlainBackground,
    /// The records of the materials of the body, if it has any.
    pub materials: Option<&'a wgpu::Buffer>,
    /// The picture behind the figure, if any.
    pub picture: Option<&'a LaidBackdrop>,
}

/// The bindings of what materials add to the samples of the body.
pub(super) fn material_bindings<'a>(
    targets: &'a Targets,
    materials: Option<&'a wgpu::Buffer>,
) -> Vec<(u32, wgpu::BindingResource<'a>)> {
    let Some((bound, [bumps, shades])) = materials.zip(targets.materials.as_ref()) else { return Vec::new() };
    vec![
        (27, wgpu::BindingResource::TextureView(bumps)),
        (25, wgpu::BindingResource::TextureView(shades)),
        (26, bound.as_entire_binding()),
    ]
}

/// The pixels, and the lists of those that are not plain background.
#[derive(Debug)]
pub(super) struct Screen {
    pixels: GrowBuffer<u32>,
    /// The plain background, and what it was computed from.
    plain: GrowBuffer<u32>,
    plain_of: Option<PlainBackground>,
    /// The pixels of the picture behind the figure, and its number.
    picture: GrowBuffer<u32>,
    picture_number: u64,
    cells: GrowBuffer<u32>,
    /// Lists of pixels. Two lists share a buffer of the size of the picture.
    listed: GrowBuffer<u32>,
    list_count: wgpu::Buffer,
    /// Workgroups of the kernels that draw each list, three words each.
    list_groups: wgpu::Buffer,
}

impl Screen {
    pub fn new(gpu: &Gpu) -> Self {
        let usage = wgpu::BufferUsages::STORAGE;
        Self {
            pixels: GrowBuffer::new(gpu, "screen", usage),
            plain: GrowBuffer::new(gpu, "plain background", usage),
            plain_of: None,
            picture: GrowBuffer::new(gpu, "picture behind the figure", usage),
            picture_number: 0,
            cells: GrowBuffer::new(gpu, "light of cells", usage),
            listed: GrowBuffer::new(gpu, "listed pixels", usage),
            list_count: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("numbers of listed pixels"),
                size: 4 * LISTS as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            list_groups: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("workgroups of lists"),
                size: GROUPS_BYTES * LISTS as u64,
                usage: usage | wgpu::BufferUsages::INDIRECT,
                mapped_at_creation: false,
            }),
        }
    }

    /// Resizes the buffers for a picture.
    pub fn fit(&mut self, gpu: &Gpu, width: u32, height: u32) {
        let pixels = width as usize * height as usize;
        self.pixels.reserve(gpu, pixels);
        self.plain.reserve(gpu, pixels);
        self.listed.reserve(gpu, LISTS / 2 * pixels);
        self.cells.reserve(gpu, cells(width, height));
    }

    /// Red, green, blue and alpha of each pixel, row after row.
    pub fn pixels(&self) -> &wgpu::Buffer {
        self.pixels.raw()
    }

    pub fn memory_bytes(&self) -> u64 {
        [&self.pixels, &self.plain, &self.picture, &self.cells, &self.listed]
            .iter()
            .map(|buffer| buffer.raw().size())
            .sum()
    }

    /// Runs a kernel with a thread for each pixel of a list of the last picture. The device knows how many these are.
    pub fn run_list(
        &self,
        pass: &mut wgpu::ComputePass,
        kernel: &Kernel,
        group: &wgpu::BindGroup,
        list: usize,
    ) {
        kernel.run_indirect(pass, group, &self.list_groups, GROUPS_BYTES * list as u64);
    }

    /// The buffers of the last picture that the kernels of layers read. `hair_area` is its area that may contain hair.
    pub fn bindings_of_last<'a>(
        &'a self,
        frame: &FrameResources<'a>,
        targets: &'a Targets,
        corners: &'a wgpu::Buffer,
        hair: &'a wgpu::Buffer,
        hair_area: &'a wgpu::Buffer,
    ) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        frame.with([
            (4, wgpu::BindingResource::TextureView(&targets.normals)),
            (5, wgpu::BindingResource::TextureView(&targets.colors)),
            (6, wgpu::BindingResource::TextureView(&targets.depth)),
            (7, corners.as_entire_binding()),
            (8, hair.as_entire_binding()),
            (10, self.cells.raw().as_entire_binding()),
            (11, hair_area.as_entire_binding()),
            (12, self.listed.raw().as_entire_binding()),
            (13, self.list_count.as_entire_binding()),
        ])
    }

    /// Encodes computing the pixels.
    ///
    /// # Errors
    /// A kernel that is needed for the first time does not compile.
    pub fn run(
        &mut self,
        gpu: &Gpu,
        kernels: &ScreenKernels,
        lit: &LightKernels,
        commands: &mut Commands,
        frame: &FrameResources,
        input: &ScreenInput,
    ) -> Result<(), GpuError> {
        let ScreenInput { targets, area, figure, picture, .. } = *input;
        // First, because a frame that fails encodes nothing and must not be remembered.
        let has_materials = input.materials.is_some();
        let lit_kernels = (0..LISTS)
            .map(|list| lit.picture_lit(gpu, list, has_materials))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some(picture) = picture.filter(|picture| picture.number != self.picture_number) {
            self.picture.write(gpu, &picture.pixels);
            self.picture_number = picture.number;
        }
        let area_of =
            |label, area: Area| commands.constants(label, &[area.left, area.top, area.columns, area.rows]);
        let (hair_area, figure_area) = (area_of("hair area", area), area_of("area of the figure", figure));
        let own = |screen| {
            frame.with([
                (4, wgpu::BindingResource::TextureView(&targets.normals)),
                (5, wgpu::BindingResource::TextureView(&targets.colors)),
                (6, wgpu::BindingResource::TextureView(&targets.depth)),
                (7, input.corners.as_entire_binding()),
                (8, input.hair.as_entire_binding()),
                (9, screen),
                (10, self.cells.raw().as_entire_binding()),
                (11, hair_area.as_entire_binding()),
                (12, self.listed.raw().as_entire_binding()),
                (13, self.list_count.as_entire_binding()),
                (14, figure_area.as_entire_binding()),
                (18, self.list_groups.as_entire_binding()),
                (21, self.picture.raw().as_entire_binding()),
            ])
        };
        let pixels = self.pixels.len() as u64;
        if self.plain_of != Some(input.background) {
            let kernel = &kernels.plain_background;
            let group = kernel.bind(gpu, &own(self.plain.raw().as_entire_binding()));
            commands.compute("draw/background", |pass| kernel.run(pass, &group, pixels));
            self.plain_of = Some(input.background);
        }
        let mut own = own(self.pixels.raw().as_entire_binding());
        own.extend(material_bindings(targets, input.materials));
        let encoder = commands.encoder();
        encoder.copy_buffer_to_buffer(self.plain.raw(), 0, self.pixels.raw(), 0, 4 * pixels);
        encoder.clear_buffer(&self.list_count, 0, None);
        let passes = [
            (&kernels.list_cells, self.cells.len() as u64),
            (&kernels.list_pixels, figure.pixels()),
            (&kernels.size_lists, 1),
        ];
        let groups = passes.map(|(kernel, _)| kernel.bind(gpu, &own));
        commands.compute("draw/picture", |pass| {
            for ((kernel, threads), group) in passes.iter().zip(&groups) {
                kernel.run(pass, group, *threads);
            }
        });
        let bound = lit_kernels.iter().map(|kernel| (kernel, kernel.bind(gpu, &own))).collect::<Vec<_>>();
        commands.compute("draw/lit", |pass| {
            for (list, (kernel, group)) in bound.iter().enumerate() {
                self.run_list(pass, kernel, group, list);
            }
        });
        Ok(())
    }
}
