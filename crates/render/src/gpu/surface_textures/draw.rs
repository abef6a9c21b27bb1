//! What the passes that draw the triangles of one material bind.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use lovelock_gpu::{Gpu, wgpu};
use lovelock_motion::{Alpha, Shading};

use super::upload::Uploaded;
use crate::surface_material::SurfaceMaterial;
use crate::textures::{BodyTextures, MaterialTextures, USES};

/// Twin of `MaterialDraw` in `material_draw.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct MaterialDraw {
    axes: [Vec4; USES],
    moves: [Vec4; USES],
    tint: Vec3,
    index: u32,
    emissive: Vec3,
    model: u32,
    shade: Vec3,
    slope: f32,
    cutoff: f32,
    unused: [f32; 3],
}

impl MaterialDraw {
    /// That of a material.
    pub fn new(textures: &BodyTextures, index: usize, record: &SurfaceMaterial) -> Self {
        let (material, of) = (&textures.materials[index], &textures.of[index]);
        let mut draw = Self {
            tint: record.tint,
            index: index as u32,
            emissive: material.emissive,
            model: record.model,
            shade: if let Shading::Toon(toon) = material.shading { toon.shade } else { Vec3::ZERO },
            slope: of.normal.map_or(0.0, |(_, slope)| slope),
            cutoff: match material.alpha {
                Alpha::Opaque => 0.0,
                Alpha::Mask(cutoff) => cutoff.max(0.0),
                Alpha::Blend => -1.0,
            },
            ..Self::default()
        };
        for (k, texture) in of.uses().into_iter().enumerate() {
            let Some(texture) = texture else { continue };
            let [x, y] = [texture.transform.matrix2.x_axis, texture.transform.matrix2.y_axis];
            let by = texture.transform.translation;
            draw.axes[k] = Vec4::new(x.x, x.y, y.x, y.y);
            draw.moves[k] = Vec4::new(by.x, by.y, texture.set as f32, 1.0);
        }
        draw
    }
}

/// The layout of the bind group: the uniform, then textures, then samplers.
pub(super) fn layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry = |binding: usize, ty| wgpu::BindGroupLayoutEntry {
        binding: binding as u32,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let mut entries = vec![entry(0, uniform)];
    entries.extend((0..USES).map(|k| entry(1 + k, texture)));
    entries.extend((0..USES).map(|k| entry(1 + USES + k, sampler)));
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("material"),
        entries: &entries,
    })
}

/// The bind group of a material.
pub(super) fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    draw: &MaterialDraw,
    (of, uploaded): (&MaterialTextures, &Uploaded),
) -> wgpu::BindGroup {
    let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("material"),
        size: size_of::<MaterialDraw>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.upload(&buffer, 0, &[*draw]);
    let entry = |binding: usize, resource| wgpu::BindGroupEntry { binding: binding as u32, resource };
    let mut entries = vec![entry(0, buffer.as_entire_binding())];
    for (k, texture) in of.uses().into_iter().enumerate() {
        let (view, sampler) = uploaded.of(texture);
        entries.push(entry(1 + k, wgpu::BindingResource::TextureView(view)));
        entries.push(entry(1 + USES + k, wgpu::BindingResource::Sampler(sampler)));
    }
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("material"),
        layout,
        entries: &entries,
    })
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;
    use crate::gpu::surface_textures::shaders;

    #[test]
    fn the_uniform_has_the_layout_of_the_shader() {
        let [(_, source), _] = shaders();
        assert_eq!(
            layout_in_shader(&source, "MaterialDraw"),
            [
                offset_of!(MaterialDraw, axes),
                offset_of!(MaterialDraw, moves),
                offset_of!(MaterialDraw, tint),
                offset_of!(MaterialDraw, index),
                offset_of!(MaterialDraw, emissive),
                offset_of!(MaterialDraw, model),
                offset_of!(MaterialDraw, shade),
                offset_of!(MaterialDraw, slope),
                offset_of!(MaterialDraw, cutoff),
                size_of::<MaterialDraw>(),
            ]
        );
    }
}
