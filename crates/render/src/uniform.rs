//! The uniform of all passes: the twin of `frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4};
use lovelock_appearance::fibre::LOBES;
use lovelock_base::settings::Settings;
use lovelock_groom::fine::Portion;

use crate::clusters::cluster_share;
use crate::scene_light::SceneLight;
use crate::{FrameInput, MAX_LIGHTS};

/// Twin of `LightUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightUniform {
    pub direction_specular: Vec4,
    pub radiance_blur: Vec4,
    pub shadow_from_world: Mat4,
    pub columns_from_world: Mat4,
}

/// Twin of `FrameUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FrameUniform {
    pub clip_from_world: Mat4,
    pub world_from_clip: Mat4,
    pub eye_lights: Vec4,
    pub size_scale_exposure: Vec4,
    pub ground_texels: Vec4,
    pub background_top: Vec4,
    pub background_bottom: Vec4,
    pub absorption_variation: Vec4,
    pub root_absorption: Vec4,
    pub mean_absorption: Vec4,
    pub width_opacity_tip: Vec4,
    pub highlights: Vec4,
    pub fading: Vec4,
    pub colors: Vec4,
    pub lobes: [Vec4; LOBES],
    pub ambient_grid: Vec4,
    pub surround: [Vec4; 9],
    pub lights: [LightUniform; MAX_LIGHTS],
}

/// The placement of the maps of one light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LightMaps {
    pub shadow_from_world: Mat4,
    pub columns_from_world: Mat4,
    pub metres_per_texel: f32,
}

impl FrameUniform {
    /// The uniform of `input`, drawn with the stored strands or with a part of the fine ones and the points of each. `maps` are those of
    /// its lights, in order.
    pub fn new(
        input: &FrameInput,
        drawn: Option<(Portion, usize)>,
        light: &SceneLight,
        (width, height): (u32, u32),
        maps: &[LightMaps],
        shadow_texels: u32,
    ) -> Self {
        let picture = input.picture.clamped();
        let (look, colours) = (input.look, &input.style.strands.colours);
        let clip_from_world = input.camera.clip_from_world(width as f32 / height as f32);
        let mut lights = [LightUniform::default(); MAX_LIGHTS];
        let mut lit = 0;
        for (lamp, map) in input.lights.iter().filter(|lamp| lamp.enabled).take(MAX_LIGHTS).zip(maps) {
            let lamp = lamp.normalized();
            lights[lit] = LightUniform {
                direction_specular: lamp.direction.extend(lamp.specular),
                radiance_blur: (lamp.color * lamp.intensity)
                    .extend(lamp.softness / map.metres_per_texel.max(1e-6)),
                shadow_from_world: map.shadow_from_world,
                columns_from_world: map.columns_from_world,
            };
            lit += 1;
        }
        let scale = input.camera.pixels_per_metre_at_one_metre(height);
        let exponents = highlight_exponents(look.roughness);
        // The rest of the optical depth is that of clusters.
        let opacity = picture.strand_opacity * (1.0 - cluster_share(input, height)).max(1e-3);
        let count =
            drawn.map_or(input.style.strands.count().max(1) as f32, |(portion, _)| portion.sum().max(1.0));
        let strand_width = look.diameter * (look.real_hairs / count) * look.width_scale.clamp(0.01, 4.0);
        let fading = drawn.map_or(
            Vec4::new(f32::MAX, 1.0, 1.0, input.style.strands.points() as f32),
            |(portion, points)| {
                let [end, inverse] = portion.ramp();
                Vec4::new(end, inverse, points as f32, (portion.drawn * points) as f32)
            },
        );
        Self {
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            eye_lights: input.camera.eye.extend(lit as f32),
            size_scale_exposure: Vec4::new(width as f32, height as f32, scale, picture.exposure_stops.exp2()),
            ground_texels: Vec4::new(f32::from(u8::from(picture.ground)), shadow_texels as f32, 0.0, 0.0),
            background_top: picture.background_top.extend(1.0),
            background_bottom: picture.background_bottom.extend(1.0),
            root_absorption: colours.roots().absorption(look.absorption()).extend(0.0),
            mean_absorption: colours.mean().absorption(look.absorption()).extend(0.0),
            absorption_variation: look.absorption().extend(look.variation.clamp(0.0, 1.0)),
            width_opacity_tip: Vec4::new(strand_width, opacity, look.tip_lightening.clamp(0.0, 1.0), 0.0),
            highlights: Vec4::new(
                look.primary_strength.clamp(0.0, 4.0),
                look.secondary_strength.clamp(0.0, 4.0),
                exponents[0],
                exponents[1],
            ),
            fading,
            colors: Vec4::new(
                look.grey.clamp(0.0, 1.0),
                look.highlights.clamp(0.0, 1.0),
                look.highlight_lightening.clamp(0.0, 1.0),
                look.many_scattering.clamp(0.0, 1.0),
            ),
            lobes: std::array::from_fn(|p| {
                let [sin, cos] = light.tables.tilts[p];
                Vec4::new(sin, cos, light.tables.variances[p], 0.0)
            }),
            ambient_grid: light.grid.origin.extend(1.0 / light.grid.cell.max(1e-6)),
            surround: light.surroundings.surround.uniform(),
            lights,
        }
    }
}

/// Exponents of the two highlights: 80 and 20 (Xu et al.) at a roughness of 0.3, falling with its square.
fn highlight_exponents(roughness: f32) -> [f32; 2] {
    let r = roughness.clamp(0.05, 1.0) / 0.3;
    [80.0, 20.0].map(|k: f32| (k / (r * r)).clamp(1.0, 2000.0))
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;
    use lovelock_groom::HairLook;
    use lovelock_groom::fine::FineStrand;

    use super::*;
    use crate::{all_shaders, fibre};

    /// The layout of a structure that all these shaders have.
    fn layout_of(name: &str) -> Vec<usize> {
        let (_, source) = all_shaders().into_iter().next().expect("a shader");
        layout_in_shader(&source, name)
    }

    #[test]
    fn structures_have_the_layout_of_the_shader() {
        assert_eq!(
            layout_of("LightUniform"),
            [
                offset_of!(LightUniform, direction_specular),
                offset_of!(LightUniform, radiance_blur),
                offset_of!(LightUniform, shadow_from_world),
                offset_of!(LightUniform, columns_from_world),
                size_of::<LightUniform>(),
            ]
        );
        assert_eq!(
            layout_of("FrameUniform"),
            [
                offset_of!(FrameUniform, clip_from_world),
                offset_of!(FrameUniform, world_from_clip),
                offset_of!(FrameUniform, eye_lights),
                offset_of!(FrameUniform, size_scale_exposure),
                offset_of!(FrameUniform, ground_texels),
                offset_of!(FrameUniform, background_top),
                offset_of!(FrameUniform, background_bottom),
                offset_of!(FrameUniform, absorption_variation),
                offset_of!(FrameUniform, root_absorption),
                offset_of!(FrameUniform, mean_absorption),
                offset_of!(FrameUniform, width_opacity_tip),
                offset_of!(FrameUniform, highlights),
                offset_of!(FrameUniform, fading),
                offset_of!(FrameUniform, colors),
                offset_of!(FrameUniform, lobes),
                offset_of!(FrameUniform, ambient_grid),
                offset_of!(FrameUniform, surround),
                offset_of!(FrameUniform, lights),
                size_of::<FrameUniform>(),
            ]
        );
        // Only shaders access it, but Rust allocates it.
        assert_eq!(layout_of("ShadedPoint").last(), Some(&32));
    }

    #[test]
    fn constants_in_shaders_are_those_of_the_cpu() {
        let texts = [
            include_str!("gpu/shaders/frame.wgsl"),
            include_str!("gpu/shaders/fibre.wgsl"),
            include_str!("gpu/shaders/strand_points.wgsl"),
            include_str!("gpu/fine/grow.wgsl"),
        ];
        for (name, value) in [
            ("BODY_PATH", HairLook::BODY_PATH),
            ("STRETCH", HairLook::STRETCH),
            ("SURFACE_SHARE", HairLook::SURFACE_SHARE),
            ("WHITENING", lovelock_groom::WHITENING),
            ("UNPIGMENTED", lovelock_groom::UNPIGMENTED),
            ("PAINTED_FROM", lovelock_groom::PAINTED_FROM),
            ("SHORT_METRES", FineStrand::SHORT_METRES),
            ("MAX_LIGHT", crate::light::MAX_LIGHT),
            ("OWN_FIBRES", fibre::OWN_FIBRES),
            ("FACING_FIBRES", fibre::FACING_FIBRES),
            ("MAX_INCLINED", fibre::MAX_INCLINED),
            ("LARGEST_SOURCE", fibre::LARGEST_SOURCE),
        ] {
            let begin = format!("const {name}: f32 = ");
            let found: Vec<f32> = texts
                .iter()
                .flat_map(|text| text.lines().filter_map(|line| line.strip_prefix(&begin)))
                .map(|rest| rest.trim_end_matches(';').parse().expect("a number"))
                .collect();
            assert_eq!(found, [value], "{name}");
        }
    }
}
