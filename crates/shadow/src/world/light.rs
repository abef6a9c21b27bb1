//! One light of a GPU method that follows rays through the world.

use lovelock_gpu::{Commands, Gpu, wgpu};

use super::ColumnViews;
use crate::ShadowReport;
use crate::gpu::{GpuColumns, PointLookup};

/// What a light needs beside the structure that all lights share.
#[derive(Debug)]
pub(crate) struct WorldLight {
    /// The constants of its queries.
    pub(crate) uniform: wgpu::Buffer,
    pub(crate) columns: ColumnViews,
    pub(crate) report: ShadowReport,
}

impl WorldLight {
    /// A light without the structure: everything is lit. `U` is the type of the constants.
    pub(crate) fn new<U>(gpu: &Gpu) -> Self {
        Self {
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("light in the world"),
                size: size_of::<U>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            columns: ColumnViews::default(),
            report: ShadowReport::default(),
        }
    }

    /// Writes the light at the end of the rays that leave the hair through one side. `resources` are the bindings of a query.
    ///
    /// Returns `None` if the light has no such side.
    pub(crate) fn write_columns<'a>(
        &'a self,
        side: usize,
        (lookup, mut resources): (&PointLookup, Vec<(u32, wgpu::BindingResource<'a>)>),
        (gpu, commands): (&Gpu, &mut Commands),
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let (view, uv_from_world) = self.columns.0.get(side).copied().flatten()?;
        let buffer = commands.constants("columns", &view);
        resources.push((6, buffer.as_entire_binding()));
        lookup.write_columns(gpu, commands, &resources, view.size, into);
        Some(GpuColumns { size: view.size, uv_from_world })
    }
}
