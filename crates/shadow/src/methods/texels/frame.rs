//! The placement of the texels of a map in the world.
//!
//! Texels are a window of `N × N` on an infinite lattice across the light, one corner of which is the anchor, so that hair
//! that moves with the head stays in its texels. Depth along the light is divided by the depth range of the hair, so that it
//! lies between 0 and 1.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::{IVec2, Mat4, Vec3, Vec4};

use crate::bounds::{Bounds, SMALLEST_CELL, round_up_to_step};
use crate::{LightFrame, ShadowInput};

/// Texels along each edge that hair cannot use: an empty one on each side, and one because the bounds of the hair may start
/// between two corners of the lattice.
const SPARE_TEXELS: u32 = 3;

/// Texels along each edge of the smallest map.
const LEAST_RESOLUTION: u32 = *super::TEXEL_RESOLUTIONS.start();

/// The depth range starts at a multiple of its length divided by this, so that it stays the same while the extent of the hair
/// changes little.
const DEPTH_STEPS: f32 = 64.0;

/// The window of texels, the depth range, and the transform from world space into both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelFrame {
    /// Texels along each edge.
    pub resolution: u32,
    /// Edge of a texel, metres.
    pub texel_size: f32,
    /// Length of the depth range, metres.
    pub depth_range: f32,
    /// The fixed corner of the lattice, world space.
    pub anchor: Vec3,
    /// The light's axes; columns run along `y`, rows along `z`.
    pub light: LightFrame,
    /// Lattice coordinates of the first texel of the window: column, row.
    pub first: IVec2,
    /// Depth of the anchor, as a fraction of the range.
    pub anchor_depth: f32,
}

impl TexelFrame {
    /// The window for hair within `bounds` with at most `resolution` texels along each edge.
    ///
    /// Texels are at least as wide as a strand, as long as there are [`LEAST_RESOLUTION`] of them: strands are drawn one texel
    /// wide, and in narrower texels they would be too thin and too dark.
    pub(crate) fn new(input: &ShadowInput, resolution: u32, bounds: &Bounds) -> Self {
        Self::place((input.light, input.anchor), input.strand_width, resolution, bounds)
    }

    /// [`TexelFrame::new`] for strands in GPU memory.
    pub(crate) fn place(
        locked_to: (LightFrame, Vec3),
        strand_width: f32,
        resolution: u32,
        bounds: &Bounds,
    ) -> Self {
        let (min, max) = extent(bounds);
        let across = (max - min).truncate_along().max_element();
        let size_for = |resolution: u32| across / (resolution - SPARE_TEXELS) as f32;
        let strand = if strand_width > 0.0 { strand_width } else { 0.0 };
        let size = size_for(resolution).max(strand.min(size_for(LEAST_RESOLUTION)));
        // Lattice coordinates stay below 2^16, where f32 still resolves a hundredth of a texel.
        let farthest = min.abs().max(max.abs()).max_element();
        let texel_size = round_up_to_step(size.max(SMALLEST_CELL).max(farthest / 65_536.0));
        let needed = (across / texel_size).ceil() as u32 + SPARE_TEXELS;
        let resolution = needed.next_multiple_of(16).clamp(LEAST_RESOLUTION, resolution);
        Self::with_texel_size(locked_to, resolution, texel_size, bounds)
    }

    /// The window with texels of a given size, which must be large enough.
    pub(crate) fn with_texel_size(
        (light, anchor): (LightFrame, Vec3),
        resolution: u32,
        texel_size: f32,
        bounds: &Bounds,
    ) -> Self {
        let (min, max) = extent(bounds);
        let per_texel = 1.0 / texel_size;
        let (low, high) = (
            (min.truncate_along() * per_texel).floor().as_ivec2(),
            (max.truncate_along() * per_texel).floor().as_ivec2(),
        );
        // Texels that the hair does not need are split evenly between both sides.
        let spare = (IVec2::splat(resolution as i32) - (high - low + 1)).max(IVec2::ZERO);
        // One step for the rounded start, and a margin for rounding errors.
        let depth_range = round_up_to_step(((max.x - min.x) * (1.0 + 2.0 / DEPTH_STEPS)).max(SMALLEST_CELL));
        let start_steps = (min.x / depth_range * DEPTH_STEPS).floor();
        Self {
            resolution,
            texel_size,
            depth_range,
            anchor,
            light,
            first: low - spare / 2,
            anchor_depth: -start_steps / DEPTH_STEPS,
        }
    }

    /// Column and row in texels (the integer part is the texel, whose centre is at 0.5), and depth along the light as a fraction
    /// of the range, 0 to 1 for hair.
    pub fn texel_from_world(&self, p: Vec3) -> Vec3 {
        self.axes().transform(p)
    }

    /// The world position of a column, row and depth.
    pub fn world_from_texel(&self, p: Vec3) -> Vec3 {
        let first = self.first.as_vec2();
        let along = (p.z - self.anchor_depth) * self.depth_range;
        let across = Vec3::new(along, (p.x + first.x) * self.texel_size, (p.y + first.y) * self.texel_size);
        self.anchor + self.light.world_from_light(across)
    }

    /// World position to `(u, v, depth)` of a [`ColumnMap`](crate::ColumnMap).
    pub(crate) fn uv_from_world(&self) -> Mat4 {
        let axes = self.axes();
        let n = self.resolution as f32;
        let row = |axis: Vec3, offset: f32, scale: f32| {
            let axis = axis * scale;
            axis.extend(offset * scale - axis.dot(self.anchor))
        };
        Mat4::from_cols(
            row(axes.column, axes.offset.x, 1.0 / n),
            row(axes.row, axes.offset.y, 1.0 / n),
            row(axes.depth, axes.offset.z, 1.0),
            Vec4::W,
        )
        .transpose()
    }

    /// The axes, scaled for dot products.
    pub(crate) fn axes(&self) -> TexelAxes {
        let first = self.first.as_vec2();
        TexelAxes {
            anchor: self.anchor,
            column: self.light.y / self.texel_size,
            row: self.light.z / self.texel_size,
            depth: self.light.x / self.depth_range,
            offset: Vec3::new(-first.x, -first.y, self.anchor_depth),
        }
    }

    /// Whether a point in texel coordinates was included in the bounds of the window: it is finite and not too far away.
    pub(crate) fn holds(&self, p: Vec3) -> bool {
        let far = 2.0 * self.resolution as f32;
        p.x.abs() <= far && p.y.abs() <= far && p.z.abs() <= 2.0
    }

    /// Clamps a point of the hair to the window: rounding must not move it into the empty texels at the border.
    pub(crate) fn held(&self, p: Vec3) -> Vec3 {
        let highest = (self.resolution - 1) as f32 * (1.0 - f32::EPSILON);
        Vec3::new(p.x.clamp(1.0, highest), p.y.clamp(1.0, highest), p.z.clamp(0.0, 1.0))
    }
}

/// The affine transform into texels, prepared for many points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TexelAxes {
    pub anchor: Vec3,
    pub column: Vec3,
    pub row: Vec3,
    pub depth: Vec3,
    pub offset: Vec3,
}

impl TexelAxes {
    #[inline(always)]
    pub(crate) fn transform(&self, p: Vec3) -> Vec3 {
        let d = p - self.anchor;
        Vec3::new(d.dot(self.column), d.dot(self.row), d.dot(self.depth)) + self.offset
    }
}

/// Corners of the bounds; both 0 where the bounds are empty.
fn extent(bounds: &Bounds) -> (Vec3, Vec3) {
    if bounds.min.x <= bounds.max.x { (bounds.min, bounds.max) } else { (Vec3::ZERO, Vec3::ZERO) }
}

/// The components across the light of a vector in the light's axes.
trait AcrossTheLight {
    fn truncate_along(self) -> glam::Vec2;
}

impl AcrossTheLight for Vec3 {
    fn truncate_along(self) -> glam::Vec2 {
        glam::Vec2::new(self.y, self.z)
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::Strands;

    use super::*;

    fn frame(points: &[Vec3], anchor: Vec3) -> TexelFrame {
        let strands = Strands {
            x: points.iter().map(|p| p.x).collect(),
            y: points.iter().map(|p| p.y).collect(),
            z: points.iter().map(|p| p.z).collect(),
            ..Strands::default()
        };
        let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        let input = ShadowInput {
            strands: &strands,
            strand_width: 1e-3,
            extinction_scale: 0.15,
            light,
            anchor,
            maps: 1,
            projected: None,
        };
        TexelFrame::new(&input, 64, &Bounds::of_strands(&input))
    }

    fn cloud(at: Vec3) -> Vec<Vec3> {
        (0..200)
            .map(|i| {
                let i = i as f32;
                at + 0.2 * Vec3::new((1.3 * i).sin(), (0.7 * i).cos(), (2.1 * i).sin())
            })
            .collect()
    }

    #[test]
    fn hair_lies_inside_with_a_texel_to_spare() {
        for at in [Vec3::ZERO, Vec3::new(0.0, 1.6, 0.0), Vec3::new(-300.0, 20.0, 7.0)] {
            let points = cloud(at);
            let frame = frame(&points, at + 0.01);
            for p in &points {
                let t = frame.texel_from_world(*p);
                // Rounding of positions of some metres, in texels of 6 mm.
                assert!(t.x > 0.99 && t.x < 63.01 && t.y > 0.99 && t.y < 63.01, "{t}");
                assert!((-1e-3..1.001).contains(&t.z), "{t}");
                assert!(frame.holds(t) && frame.held(t).distance(t) < 0.01);
                // f32 resolves 3e-5 at 300 m.
                assert!(frame.world_from_texel(t).distance(*p) < 1e-6 * (1.0 + at.length() * 50.0));
            }
        }
    }

    #[test]
    fn hair_that_moves_with_the_anchor_keeps_its_texels() {
        let step = Vec3::new(0.5, 0.25, -1.0);
        let (a, b) = (frame(&cloud(Vec3::ZERO), Vec3::ZERO), frame(&cloud(step), step));
        assert_eq!((a.first, a.texel_size, a.anchor_depth), (b.first, b.texel_size, b.anchor_depth));
        // Control: with the anchor left behind, it does not.
        let c = frame(&cloud(step), Vec3::ZERO);
        assert_ne!(a.first, c.first);
    }

    #[test]
    fn the_matrix_is_the_same_map() {
        let frame = frame(&cloud(Vec3::Y), Vec3::new(0.1, 0.9, 0.0));
        for p in cloud(Vec3::Y) {
            let t = frame.texel_from_world(p);
            let uv = frame.uv_from_world().transform_point3(p);
            assert!((uv - Vec3::new(t.x / 64.0, t.y / 64.0, t.z)).length() < 1e-5);
        }
    }

    #[test]
    fn texels_are_as_wide_as_strands_or_as_fine_as_asked() {
        let points = cloud(Vec3::ZERO);
        let strands = Strands {
            x: points.iter().map(|p| p.x).collect(),
            y: points.iter().map(|p| p.y).collect(),
            z: points.iter().map(|p| p.z).collect(),
            ..Strands::default()
        };
        let light = LightFrame::new(Vec3::NEG_Y);
        let frame = |strand_width: f32| {
            let input = ShadowInput {
                strands: &strands,
                strand_width,
                extinction_scale: 0.15,
                light,
                anchor: Vec3::ZERO,
                maps: 1,
                projected: None,
            };
            TexelFrame::new(&input, 512, &Bounds::of_strands(&input))
        };
        // 0.4 m across: 0.8 mm at 512. Sizes are rounded up to a sixteenth of an octave.
        for fine in [0.0, 1e-4, -1.0, f32::NAN] {
            assert_eq!(frame(fine).resolution, 512);
            assert!((0.4 / 509.0..0.4 / 509.0 * 1.05).contains(&frame(fine).texel_size));
        }
        for wide in [2e-3, 4e-3] {
            let frame = frame(wide);
            assert!((wide..1.05 * wide).contains(&frame.texel_size));
            assert!(frame.resolution.is_multiple_of(16) && frame.resolution < 256);
            for p in &points {
                let t = frame.texel_from_world(*p);
                assert!(frame.held(t).distance(t) < 1e-3, "{t} of {}", frame.resolution);
            }
        }
        for huge in [1.0, 1e30, f32::INFINITY] {
            assert_eq!(frame(huge).resolution, 64);
            assert!(frame(huge).texel_size < 0.4 / 61.0 * 1.05);
        }
    }

    #[test]
    fn nothing_and_a_point_make_a_frame_of_finite_size() {
        for points in [vec![], vec![Vec3::ONE], vec![Vec3::NAN; 3]] {
            let frame = frame(&points, Vec3::ONE);
            assert!(frame.texel_size > 0.0 && frame.depth_range > 0.0);
            assert!(frame.texel_from_world(Vec3::ONE).is_finite());
        }
    }
}
