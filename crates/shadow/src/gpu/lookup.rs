//! Looking up many points in a map of any method.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Constant, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, wgpu};

use super::{EXP, GpuTargets, wgsl};
use crate::cube;

const LOOKUP: ShaderPart = wgsl!("gpu/", "lookup.wgsl");
const COLUMNS: ShaderPart = wgsl!("gpu/", "columns.wgsl");

/// Twin of `Lookup` in lookup.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct LookupUniform {
    count: u32,
    stride: u32,
    slot: u32,
    sums: u32,
    anchor: Vec3,
    sides: u32,
    axis: Vec3,
    side: u32,
    across: Vec3,
    lit: u32,
    more: Vec3,
    plane: f32,
    offset: Vec3,
    unused: u32,
}

impl LookupUniform {
    fn new(slot: usize, targets: &GpuTargets, sums: bool) -> Self {
        let own = Self {
            count: targets.count,
            stride: targets.stride,
            slot: targets.byte.unwrap_or(slot as u32),
            sums: u32::from(sums),
            ..Self::default()
        };
        let Some(projected) = targets.projected else { return own };
        let [axis, across, more] = projected.axes;
        Self {
            slot: projected.slot,
            anchor: projected.anchor,
            sides: projected.sides,
            axis,
            side: projected.side,
            across,
            lit: projected.lit,
            more,
            plane: projected.plane,
            offset: projected.offset,
            ..own
        }
    }
}

/// The two kernels that read the map of a method: at points, and behind the whole hair.
#[derive(Debug)]
pub(crate) struct PointLookup {
    points: Kernel,
    columns: Option<Kernel>,
    /// Bound where no sum is wanted.
    no_sum: wgpu::Buffer,
}

/// The value of `PROJECTED` in shaders: whether they are for projected strands.
pub(crate) fn projected_constant(projected: bool) -> Constant {
    ("PROJECTED", f64::from(u8::from(projected)))
}

/// The source of a shader of [`PointLookup`], composed from the query of a method.
fn source(query: &[ShaderPart], last: ShaderPart) -> ShaderSource {
    let parts: Vec<_> = [EXP, cube::SHADER].iter().chain(query).copied().chain([last]).collect();
    ShaderSource::new(&parts)
}

impl PointLookup {
    /// `query` defines `hair_transmittance` and, if `columns` is set, `behind_column` and `column_count`. `constants` are the
    /// values of its `override`s.
    pub fn new(
        gpu: &Gpu,
        query: &[ShaderPart],
        columns: bool,
        constants: &[Constant],
    ) -> Result<Self, GpuError> {
        let points = Kernel::specialised(gpu, "lookup", &source(query, LOOKUP), "look_up_points", constants)?;
        let write =
            || Kernel::specialised(gpu, "columns", &source(query, COLUMNS), "write_columns", constants);
        let columns = columns.then(write).transpose()?;
        let no_sum = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("no sum"),
            size: 16,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        Ok(Self { points, columns, no_sum })
    }

    /// The composed shaders with their labels.
    pub fn shaders(query: &[ShaderPart], columns: bool) -> Vec<(String, ShaderSource)> {
        let mut all = vec![("lookup".to_owned(), source(query, LOOKUP))];
        if columns {
            all.push(("columns".to_owned(), source(query, COLUMNS)));
        }
        all
    }

    /// Encodes looking up the targets. `map` holds the bindings of the query.
    pub fn run(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        slot: usize,
        map: &[(u32, wgpu::BindingResource)],
        targets: &GpuTargets,
    ) {
        let first = targets.projected.map_or(slot == 0, |projected| projected.slot == 0);
        let sum = targets.sum.filter(|_| first);
        let uniform = LookupUniform::new(slot, targets, sum.is_some());
        let buffer = commands.constants("lookup", &uniform);
        let mut resources = map.to_vec();
        resources.extend([
            (10, buffer.as_entire_binding()),
            (11, targets.points.as_entire_binding()),
            (12, targets.out.as_entire_binding()),
            (13, sum.unwrap_or(&self.no_sum).as_entire_binding()),
        ]);
        let group = self.points.bind(gpu, &resources);
        commands.compute("shadow/ask", |pass| self.points.run(pass, &group, u64::from(targets.count)));
    }

    /// Encodes writing the transmittance behind all hair into `size` by `size` texels of a texture.
    pub fn write_columns(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        map: &[(u32, wgpu::BindingResource)],
        size: u32,
        into: &wgpu::TextureView,
    ) {
        let Some(kernel) = &self.columns else { return };
        let mut resources = map.to_vec();
        resources.push((14, wgpu::BindingResource::TextureView(into)));
        let group = kernel.bind(gpu, &resources);
        commands.compute("shadow/columns", |pass| kernel.run(pass, &group, u64::from(size).pow(2)));
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use crate::all_shaders;
    use crate::gpu::wgsl;
    use lovelock_gpu::layout_in_shader;

    #[test]
    fn the_uniform_has_the_layout_of_every_shader() {
        let expected = [
            offset_of!(LookupUniform, count),
            offset_of!(LookupUniform, stride),
            offset_of!(LookupUniform, slot),
            offset_of!(LookupUniform, sums),
            offset_of!(LookupUniform, anchor),
            offset_of!(LookupUniform, sides),
            offset_of!(LookupUniform, axis),
            offset_of!(LookupUniform, side),
            offset_of!(LookupUniform, across),
            offset_of!(LookupUniform, lit),
            offset_of!(LookupUniform, more),
            offset_of!(LookupUniform, plane),
            offset_of!(LookupUniform, offset),
            size_of::<LookupUniform>(),
        ];
        for (label, source) in all_shaders().iter().filter(|(label, _)| label.ends_with("lookup")) {
            assert_eq!(layout_in_shader(source, "Lookup"), expected, "{label}");
        }
    }

    #[test]
    fn another_layout_is_found_out() {
        let part = |text| ShaderPart { name: "", text };
        let right = wgsl!("gpu/", "lookup.wgsl").text;
        let wrong = right.replacen(
            "    slot: u32,\n    sums: u32,",
            "    sums: u32,\n    other: u32,\n    slot: u32,",
            1,
        );
        let query =
            part("override PROJECTED: bool = false; fn hair_transmittance(p: vec3f) -> f32 { return 1.0; }");
        let layout =
            |text| layout_in_shader(&ShaderSource::new(&[cube::SHADER, query, part(text)]), "Lookup");
        assert_ne!(layout(Box::leak(wrong.into_boxed_str())), layout(right));
    }
}
