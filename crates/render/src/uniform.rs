//! The uniform of all passes: the twin of `frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};
use lovelock_appearance::fibre::LOBES;
use lovelock_base::settings::Settings;
use lovelock_groom::fine::Portion;

use crate::clusters::cluster_share;
use crate::scene_light::SceneLight;
use crate::standing::StandingUniform;
use crate::{FrameInput, MAX_LIGHTS};

/// The brightest colour of a strand point, the largest half float: the GPU keeps no brighter one. Twin of `MAX_LIGHT` in
/// `strand_points.wgsl`.
pub(crate) const MAX_LIGHT: f32 = 65_504.0;

/// From where on the edge of the body's shadow counts as wide and gets more taps: blur of a directional light in texels of its map.
pub(crate) const WIDE_BLUR: f32 = 12.0;
/// As [`WIDE_BLUR`], for a light that stands somewhere: its radius, metres.
pub(crate) const WIDE_LAMP: f32 = 0.25;

/// Twin of `LightUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LightUniform {
    pub direction: Vec3,
    pub specular: f32,
    pub radiance: Vec3,
    pub blur: f32,
    pub shadow_from_world: Mat4,
    pub columns_from_world: Mat4,
}

/// Twin of `LobeUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LobeUniform {
    pub sin_tilt: f32,
    pub cos_tilt: f32,
    pub variance: f32,
    unused: f32,
}

/// Twin of `FrameUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FrameUniform {
    pub clip_from_world: Mat4,
    pub world_from_clip: Mat4,
    pub eye: Vec3,
    pub light_count: u32,
    pub size: Vec2,
    pub pixels_per_metre: f32,
    pub exposure: f32,
    pub background_top: Vec3,
    pub shows_ground: u32,
    pub background_bottom: Vec3,
    pub shadow_texels: f32,
    pub absorption: Vec3,
    pub variation: f32,
    pub root_absorption: Vec3,
    pub strand_width: f32,
    pub mean_absorption: Vec3,
    pub opacity: f32,
    pub primary_strength: f32,
    pub secondary_strength: f32,
    pub primary_exponent: f32,
    pub secondary_exponent: f32,
    pub fade_end: f32,
    pub fade_slope: f32,
    pub points_per_strand: u32,
    pub drawn_points: u32,
    pub grey: f32,
    pub highlights: f32,
    pub lightening: f32,
    pub many_scattering: f32,
    pub tip_lightening: f32,
    pub background_form: u32,
    unused: [f32; 2],
    pub lobes: [LobeUniform; LOBES],
    pub grid_corner: Vec3,
    pub cells_per_metre: f32,
    pub surround: [Vec4; 9],
    pub lights: [LightUniform; MAX_LIGHTS],
    pub standing: [StandingUniform; MAX_LIGHTS],
}

/// The placement of the maps of one light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LightMaps {
    pub shadow_from_world: Mat4,
    pub columns_from_world: Mat4,
    pub metres_per_texel: f32,
    /// Those of a light that stands somewhere.
    pub standing: StandingUniform,
}

impl LightMaps {
    /// The views of the body: one, or one per side of a cube around the light.
    pub fn body_views(&self) -> &[Mat4] {
        if self.standing.is_standing() {
            &self.standing.shadow_from_world[..self.standing.body_sides as usize]
        } else {
            std::slice::from_ref(&self.shadow_from_world)
        }
    }
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
        let mut standing = [StandingUniform::default(); MAX_LIGHTS];
        let mut lit = 0;
        for (lamp, map) in input.lights.iter().filter(|lamp| lamp.enabled).take(MAX_LIGHTS).zip(maps) {
            let lamp = lamp.normalized();
            lights[lit] = LightUniform {
                direction: lamp.direction,
                specular: lamp.specular,
                radiance: lamp.color * lamp.intensity,
                // Lamps have a blur of their own: see `StandingUniform`.
                blur: if lamp.stands() { lamp.softness } else { lamp.softness_at(0.0) }
                    / map.metres_per_texel.max(1e-6),
                shadow_from_world: map.shadow_from_world,
                columns_from_world: map.columns_from_world,
            };
            standing[lit] = map.standing;
            lit += 1;
        }
        let [primary_exponent, secondary_exponent] = highlight_exponents(look.roughness);
        let count =
            drawn.map_or(input.style.strands.count().max(1) as f32, |(portion, _)| portion.sum().max(1.0));
        let [fade_end, fade_slope] = drawn.map_or([f32::MAX, 1.0], |(portion, _)| portion.ramp());
        let (points_per_strand, drawn_points) = drawn
            .map_or((1, input.style.strands.points()), |(portion, points)| (points, portion.drawn * points));
        Self {
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            eye: input.camera.eye,
            light_count: lit as u32,
            size: Vec2::new(width as f32, height as f32),
            pixels_per_metre: input.camera.pixels_per_metre_at_one_metre(height),
            exposure: picture.exposure_stops.exp2(),
            background_top: picture.background_top,
            shows_ground: u32::from(picture.ground),
            background_bottom: picture.background_bottom,
            shadow_texels: shadow_texels as f32,
            absorption: look.absorption(),
            variation: look.variation.clamp(0.0, 1.0),
            root_absorption: colours.roots().absorption(look.absorption()),
            strand_width: look.diameter * (look.real_hairs / count) * look.width_scale.clamp(0.01, 4.0),
            mean_absorption: colours.mean().absorption(look.absorption()),
            // The rest of the optical depth is that of clusters.
            opacity: picture.strand_opacity * (1.0 - cluster_share(input, height)).max(1e-3),
            primary_strength: look.primary_strength.clamp(0.0, 4.0),
            secondary_strength: look.secondary_strength.clamp(0.0, 4.0),
            primary_exponent,
            secondary_exponent,
            fade_end,
            fade_slope,
            points_per_strand: points_per_strand as u32,
            drawn_points: drawn_points as u32,
            grey: look.grey.clamp(0.0, 1.0),
            highlights: look.highlights.clamp(0.0, 1.0),
            lightening: look.highlight_lightening.clamp(0.0, 1.0),
            many_scattering: look.many_scattering.clamp(0.0, 1.0),
            tip_lightening: look.tip_lightening.clamp(0.0, 1.0),
            background_form: background_form::of(input),
            unused: [0.0; 2],
            lobes: std::array::from_fn(|p| {
                let [sin_tilt, cos_tilt] = light.tables.tilts[p];
                LobeUniform { sin_tilt, cos_tilt, variance: light.tables.variances[p], unused: 0.0 }
            }),
            grid_corner: light.grid.origin,
            cells_per_metre: 1.0 / light.grid.cell.max(1e-6),
            surround: light.surroundings.surround.uniform(),
            lights,
            standing,
        }
    }
}

/// What is behind the figure, as numbers. Twins of the constants in backdrop.wgsl and picture.wgsl.
pub(crate) mod background_form {
    use lovelock_picture::BackgroundForm;

    use crate::FrameInput;

    /// Two colours from top to bottom with a pool of light.
    pub const STUDIO: u32 = 0;
    /// One colour.
    pub const PLAIN: u32 = 1;
    /// Two colours from top to bottom.
    pub const VERTICAL: u32 = 2;
    /// Two colours from the corners to the middle.
    pub const RADIAL: u32 = 3;
    /// A picture.
    pub const PICTURE: u32 = 4;

    /// That of an image; while a picture is missing, its colour.
    pub fn of(input: &FrameInput) -> u32 {
        match input.picture.background {
            BackgroundForm::Studio => STUDIO,
            BackgroundForm::Vertical => VERTICAL,
            BackgroundForm::Radial => RADIAL,
            BackgroundForm::Picture if input.backdrop.is_some() => PICTURE,
            BackgroundForm::Plain | BackgroundForm::Picture => PLAIN,
        }
    }
}

/// What the plain background of an image depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlainBackground {
    size: Vec2,
    exposure: f32,
    form: u32,
    top: Vec3,
    bottom: Vec3,
    /// The picture behind the figure as it was laid into the image.
    picture: u64,
}

impl PlainBackground {
    /// That of an image.
    ///
    /// `picture` is the number of the picture behind the figure, which changes with its pixels.
    pub fn of(uniform: &FrameUniform, picture: u64) -> Self {
        Self {
            size: uniform.size,
            exposure: uniform.exposure,
            form: uniform.background_form,
            top: uniform.background_top,
            bottom: uniform.background_bottom,
            picture,
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
                offset_of!(LightUniform, direction),
                offset_of!(LightUniform, specular),
                offset_of!(LightUniform, radiance),
                offset_of!(LightUniform, blur),
                offset_of!(LightUniform, shadow_from_world),
                offset_of!(LightUniform, columns_from_world),
                size_of::<LightUniform>(),
            ]
        );
        assert_eq!(
            layout_of("StandingUniform"),
            [
                offset_of!(StandingUniform, position),
                offset_of!(StandingUniform, radius),
                offset_of!(StandingUniform, axes),
                offset_of!(StandingUniform, cone_axis),
                offset_of!(StandingUniform, cone_scale),
                offset_of!(StandingUniform, cone_offset),
                offset_of!(StandingUniform, texel),
                offset_of!(StandingUniform, body_sides),
                offset_of!(StandingUniform, column_sides),
                offset_of!(StandingUniform, shadow_from_world),
                offset_of!(StandingUniform, columns_from_world),
                size_of::<StandingUniform>(),
            ]
        );
        assert_eq!(
            layout_of("LobeUniform"),
            [
                offset_of!(LobeUniform, sin_tilt),
                offset_of!(LobeUniform, cos_tilt),
                offset_of!(LobeUniform, variance),
                offset_of!(LobeUniform, unused),
                size_of::<LobeUniform>(),
            ]
        );
        assert_eq!(
            layout_of("FrameUniform"),
            [
                offset_of!(FrameUniform, clip_from_world),
                offset_of!(FrameUniform, world_from_clip),
                offset_of!(FrameUniform, eye),
                offset_of!(FrameUniform, light_count),
                offset_of!(FrameUniform, size),
                offset_of!(FrameUniform, pixels_per_metre),
                offset_of!(FrameUniform, exposure),
                offset_of!(FrameUniform, background_top),
                offset_of!(FrameUniform, shows_ground),
                offset_of!(FrameUniform, background_bottom),
                offset_of!(FrameUniform, shadow_texels),
                offset_of!(FrameUniform, absorption),
                offset_of!(FrameUniform, variation),
                offset_of!(FrameUniform, root_absorption),
                offset_of!(FrameUniform, strand_width),
                offset_of!(FrameUniform, mean_absorption),
                offset_of!(FrameUniform, opacity),
                offset_of!(FrameUniform, primary_strength),
                offset_of!(FrameUniform, secondary_strength),
                offset_of!(FrameUniform, primary_exponent),
                offset_of!(FrameUniform, secondary_exponent),
                offset_of!(FrameUniform, fade_end),
                offset_of!(FrameUniform, fade_slope),
                offset_of!(FrameUniform, points_per_strand),
                offset_of!(FrameUniform, drawn_points),
                offset_of!(FrameUniform, grey),
                offset_of!(FrameUniform, highlights),
                offset_of!(FrameUniform, lightening),
                offset_of!(FrameUniform, many_scattering),
                offset_of!(FrameUniform, tip_lightening),
                offset_of!(FrameUniform, background_form),
                offset_of!(FrameUniform, lobes),
                offset_of!(FrameUniform, grid_corner),
                offset_of!(FrameUniform, cells_per_metre),
                offset_of!(FrameUniform, surround),
                offset_of!(FrameUniform, lights),
                offset_of!(FrameUniform, standing),
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
            ("MAX_LIGHT", MAX_LIGHT),
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
