//! Lookup of textures on the CPU: the definition of what samplers of a graphics card do.

use glam::{Vec2, Vec4};
use lovelock_motion::Wrap;

use super::chain::{Chain, Level, texel};

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sampling {
    /// What is outside of the image, along rows and along columns.
    pub wrap: [Wrap; 2],
    /// Whether the nearest texel is taken where the image is magnified.
    pub is_nearest: bool,
}

/// The texture coordinates of a vertex; zero where there are none, or such that cannot be computed with.
#[inline]
pub(crate) fn coordinate(of: &[Vec2], vertex: usize) -> Vec2 {
    /// The largest that readers of files keep.
    const FARTHEST: f32 = 1e5;
    let at = of.get(vertex).copied().unwrap_or(Vec2::ZERO);
    // False for NaN.
    if at.abs().cmple(Vec2::splat(FARTHEST)).all() { at } else { Vec2::ZERO }
}

/// The opacity or occlusion of a vertex; 1 where there is none, or no number.
#[inline]
pub(crate) fn share(of: &[f32], vertex: usize) -> f32 {
    of.get(vertex).copied().filter(|share| share.is_finite()).unwrap_or(1.0)
}

/// The level of detail where the coordinates change by `dx` and `dy` from pixel to pixel, on an image of `size` texels: the logarithm
/// to base 2 of the longer step in texels. Twin of `level_of_detail` in `material_draw.wgsl`.
pub(crate) fn level_of_detail(dx: Vec2, dy: Vec2, size: [u32; 2]) -> f32 {
    let size = Vec2::new(size[0] as f32, size[1] as f32);
    let longest = (dx * size).length_squared().max((dy * size).length_squared());
    // Not for NaN.
    if longest > 1e-12 { 0.5 * longest.min(1e30).log2() } else { -20.0 }
}

impl Chain {
    /// Red, green, blue (linear) and alpha at `uv`, whose (0, 0) is the top left corner: interpolated linearly between texels and
    /// between the levels around `lod`. Coordinates that are not finite count as 0.
    pub fn at(&self, uv: Vec2, lod: f32, sampling: Sampling) -> Vec4 {
        let last = (self.levels.len() - 1) as f32;
        let lod = if lod > 0.0 { lod.min(last) } else { 0.0 };
        let finer = lod as usize;
        let part = lod - finer as f32;
        let Some(level) = self.levels.get(finer) else { return Vec4::ONE };
        if lod == 0.0 && sampling.is_nearest {
            return self.nearest(level, uv, sampling);
        }
        let fine = self.bilinear(level, uv, sampling);
        match self.levels.get(finer + 1) {
            Some(coarser) if part > 0.0 => fine + (self.bilinear(coarser, uv, sampling) - fine) * part,
            _ => fine,
        }
    }

    fn nearest(&self, level: &Level, uv: Vec2, sampling: Sampling) -> Vec4 {
        let place = |axis: usize| {
            let at = reduced(uv[axis], sampling.wrap[axis]) * level.size[axis] as f32;
            texel_of(at.floor() as i32, level.size[axis], sampling.wrap[axis])
        };
        decoded(self.content.table(), level, place(0), place(1))
    }

    fn bilinear(&self, level: &Level, uv: Vec2, sampling: Sampling) -> Vec4 {
        let place = |axis: usize| {
            let (size, wrap) = (level.size[axis], sampling.wrap[axis]);
            let at = reduced(uv[axis], wrap) * size as f32 - 0.5;
            let first = at.floor();
            let index = first as i32;
            (texel_of(index, size, wrap), texel_of(index + 1, size, wrap), at - first)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(0), place(1));
        let table = self.content.table();
        let upper = decoded(table, level, x0, y0).lerp(decoded(table, level, x1, y0), fx);
        let lower = decoded(table, level, x0, y1).lerp(decoded(table, level, x1, y1), fx);
        upper.lerp(lower, fy)
    }
}

fn decoded(table: &[f32; 256], level: &Level, x: usize, y: usize) -> Vec4 {
    let [r, g, b, a] = *texel(&level.texels, y * level.size[0] as usize + x);
    let of = |byte: u8| table[usize::from(byte)];
    Vec4::new(of(r), of(g), of(b), f32::from(a) * (1.0 / 255.0))
}

/// A coordinate with the same texels near 0, so that no precision is lost.
fn reduced(u: f32, wrap: Wrap) -> f32 {
    if !u.is_finite() {
        return 0.0;
    }
    match wrap {
        Wrap::Repeat => u - u.floor(),
        Wrap::Mirror => u - 2.0 * (0.5 * u).floor(),
        Wrap::Clamp => u.clamp(-1.0, 2.0),
    }
}

/// The texel at an index of [`reduced`] coordinates or beside it.
fn texel_of(index: i32, size: u32, wrap: Wrap) -> usize {
    let size = size as i32;
    let inside = match wrap {
        Wrap::Repeat if index < 0 => index + size,
        Wrap::Repeat if index >= size => index - size,
        Wrap::Mirror if index < 0 => -1 - index,
        Wrap::Mirror if index >= 2 * size => index - 2 * size,
        Wrap::Mirror if index >= size => 2 * size - 1 - index,
        Wrap::Repeat | Wrap::Mirror | Wrap::Clamp => index,
    };
    inside.clamp(0, size - 1) as usize
}

#[cfg(test)]
mod tests {
    use lovelock_motion::Image;

    use super::*;
    use crate::textures::chain::Content;

    /// Four texels in a row with the numbers 0, 0.2, 0.4 and 0.6 times 255.
    fn row() -> Chain {
        let pixels: Vec<u8> = [0, 51, 102, 153].iter().flat_map(|&v| [v, v, v, 255]).collect();
        Chain::new(&Image { name: String::new(), size: [4, 1], pixels: pixels.into() }, Content::Data)
    }

    fn at(u: f32, lod: f32, wrap: Wrap) -> f32 {
        row().at(Vec2::new(u, 0.5), lod, Sampling { wrap: [wrap; 2], is_nearest: false }).x
    }

    #[test]
    fn between_centres_values_change_linearly() {
        for (u, value) in [(0.125, 0.0), (0.25, 0.1), (0.375, 0.2), (0.5, 0.3), (0.875, 0.6)] {
            assert!((at(u, 0.0, Wrap::Clamp) - value).abs() < 1e-6, "{u}");
        }
        // The second level has 0.1 and 0.5, the third 0.3; halfway between levels is their mean.
        assert!((at(0.25, 1.0, Wrap::Clamp) - 26.0 / 255.0).abs() < 1e-6);
        assert!((at(0.25, 2.0, Wrap::Clamp) - 77.0 / 255.0).abs() < 2e-3);
        let (fine, coarse) = (at(0.25, 1.0, Wrap::Clamp), at(0.25, 2.0, Wrap::Clamp));
        assert!((at(0.25, 1.5, Wrap::Clamp) - 0.5 * (fine + coarse)).abs() < 1e-6);
        assert_eq!(at(0.25, 99.0, Wrap::Clamp), coarse);
    }

    #[test]
    fn outside_the_image_repeats_mirrors_or_stays() {
        for (wrap, u, value) in [
            (Wrap::Repeat, 1.375, 0.2),
            (Wrap::Repeat, -0.625, 0.2),
            (Wrap::Repeat, 0.0, 0.3),
            (Wrap::Mirror, 1.125, 0.6),
            (Wrap::Mirror, -0.375, 0.2),
            (Wrap::Mirror, 0.0, 0.0),
            (Wrap::Mirror, 2.375, 0.2),
            (Wrap::Clamp, 1.4, 0.6),
            (Wrap::Clamp, -7.0, 0.0),
        ] {
            assert!((at(u, 0.0, wrap) - value).abs() < 1e-5, "{wrap:?} at {u}: {}", at(u, 0.0, wrap));
        }
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f32::NAN, f32::INFINITY, 1e30, -1e30, f32::MIN_POSITIVE] {
                assert!((0.0..=1.0).contains(&at(u, 0.0, wrap)), "{wrap:?} at {u}");
            }
        }
    }

    #[test]
    fn the_nearest_texel_where_magnified_and_the_mean_where_not() {
        let sampling = Sampling { wrap: [Wrap::Clamp; 2], is_nearest: true };
        let near = |u: f32, lod: f32| row().at(Vec2::new(u, 0.5), lod, sampling).x;
        assert!((near(0.24, 0.0) - 0.0).abs() < 1e-6 && (near(0.26, -3.0) - 0.2).abs() < 1e-6);
        assert!((near(0.24, 1.0) - at(0.24, 1.0, Wrap::Clamp)).abs() < 1e-6);
    }

    #[test]
    fn coordinates_are_near_enough_to_compute_with() {
        let of = [Vec2::new(-3.0, 99.0), Vec2::new(1e30, 0.0), Vec2::new(0.5, f32::NAN)];
        assert_eq!([0, 1, 2, 3].map(|i| coordinate(&of, i)), [of[0], Vec2::ZERO, Vec2::ZERO, Vec2::ZERO]);
    }

    #[test]
    fn the_level_of_a_known_footprint() {
        // 256 texels over 64 pixels: four texels a pixel, level 2; of both directions the longer one counts.
        let step = Vec2::new(1.0 / 64.0, 0.0);
        assert_eq!(level_of_detail(step, Vec2::ZERO, [256, 256]), 2.0);
        assert_eq!(level_of_detail(step, Vec2::new(0.0, 1.0 / 32.0), [256, 256]), 3.0);
        assert_eq!(level_of_detail(step, Vec2::new(0.0, 1.0 / 32.0), [256, 32]), 2.0);
        assert!(level_of_detail(Vec2::NAN, Vec2::NAN, [4, 4]) < 0.0);
        assert!(level_of_detail(Vec2::MAX, Vec2::ZERO, [4, 4]) < 60.0);
    }
}
