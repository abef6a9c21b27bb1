//! The transmittance behind all hair, as points behind it see the light.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lovelock_gpu::ShaderPart;
use rayon::prelude::*;

use crate::gpu::wgsl;
use crate::methods::texels::{TEXEL_RESOLUTIONS, TexelFrame};
use crate::perspective::{Face, PARALLEL, Perspective, margin};
use crate::{Bounds, ColumnMap, LightFrame};

/// `behind_column` and `column_count` in shaders, of a query that defines `hair_transmittance`.
pub(crate) const COLUMNS: ShaderPart = wgsl!("world/", "columns.wgsl");

/// One map of points behind all hair. Twin of `ColumnView` in columns.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ColumnView {
    /// The corner of the map: a point of the world, or a vector from the light.
    pub origin: Vec3,
    /// Texels along each edge.
    pub size: u32,
    /// The step from column to column, and from row to row.
    pub across: Vec3,
    /// How far behind a light that stands somewhere the points are, metres; 0 for a directional light.
    pub far: f32,
    pub more: Vec3,
    pub unused: u32,
    /// Where the light stands.
    pub position: Vec3,
    pub unused_too: u32,
}

/// The maps of a light: one, or one per side of a cube around it, of which those without hair are absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ColumnViews(pub Vec<Option<(ColumnView, Mat4)>>);

impl ColumnViews {
    /// The maps of at most `size` texels along each edge, of hair within `bounds` along the axes of the light around `anchor`, whose shadow
    /// is complete `reach` metres behind it.
    pub fn new(light: &LightFrame, anchor: Vec3, (size, reach): (u32, f32), bounds: &Bounds) -> Self {
        let size = size.clamp(*TEXEL_RESOLUTIONS.start(), *TEXEL_RESOLUTIONS.end());
        match Perspective::new(light, anchor, bounds, margin(*TEXEL_RESOLUTIONS.start())) {
            None => Self(vec![Some(parallel(light, anchor, (size, reach), bounds))]),
            Some(seen) => {
                let view =
                    |face: &Option<Face>| face.as_ref().map(|face| standing(light, face, (size, reach)));
                Self(seen.faces().iter().map(view).collect())
            }
        }
    }

    /// The most texels along an edge.
    pub fn size(&self) -> u32 {
        self.0.iter().flatten().map(|(view, _)| view.size).max().unwrap_or(0)
    }
}

/// The view of a directional light.
fn parallel(
    light: &LightFrame,
    anchor: Vec3,
    (size, reach): (u32, f32),
    bounds: &Bounds,
) -> (ColumnView, Mat4) {
    let frame = TexelFrame::place((*light, anchor), 0.0, size, bounds);
    let view = ColumnView {
        origin: frame.world_from_texel(Vec3::Z) + reach * light.x,
        size: frame.resolution,
        across: light.y * frame.texel_size,
        more: light.z * frame.texel_size,
        ..ColumnView::default()
    };
    (view, frame.uv_from_world())
}

/// The view of one plane of a light that stands somewhere.
fn standing(light: &LightFrame, face: &Face, (size, reach): (u32, f32)) -> (ColumnView, Mat4) {
    let frame = TexelFrame::place((PARALLEL, Vec3::ZERO), 0.0, size, &face.bounds);
    let [axis, across, more] = face.axes;
    let corner = frame.world_from_texel(Vec3::ZERO);
    let view = ColumnView {
        origin: face.plane * axis + corner.y * across + corner.z * more,
        size: frame.resolution,
        across: frame.texel_size * across,
        more: frame.texel_size * more,
        // The bounds end at the farthest hair, relative to the distance of the anchor.
        far: (face.bounds.max.x + face.offset.length()).max(face.radius) + reach,
        position: light.source.map_or(Vec3::ZERO, |source| source.position),
        ..ColumnView::default()
    };
    (view, face.uv_from_world(frame.uv_from_world()))
}

impl ColumnView {
    /// The point behind the middle of a texel.
    pub fn point(&self, column: u32, row: u32) -> Vec3 {
        let (u, v) = (column as f32 + 0.5, row as f32 + 0.5);
        let at = self.origin + u * self.across + v * self.more;
        if self.far > 0.0 { self.position + self.far * at.normalize_or_zero() } else { at }
    }

    /// Whether a texel lies at the border, where everything is lit.
    fn is_border(&self, column: u32, row: u32) -> bool {
        column == 0 || row == 0 || column + 1 == self.size || row + 1 == self.size
    }
}

/// The map of a view, by the transmittance of points behind the hair.
pub(crate) fn column_map(
    (view, uv_from_world): &(ColumnView, Mat4),
    transmittance: impl Fn(Vec3) -> f32 + Sync,
) -> ColumnMap {
    let size = view.size;
    let mut values = vec![1.0; (size * size) as usize];
    values.par_iter_mut().enumerate().with_min_len(64).for_each(|(texel, out)| {
        let (column, row) = (texel as u32 % size, texel as u32 / size);
        if !view.is_border(column, row) {
            *out = transmittance(view.point(column, row));
        }
    });
    ColumnMap { size, transmittance: values, uv_from_world: *uv_from_world }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;
    use crate::{LightSource, all_shaders};

    #[test]
    fn the_uniform_has_the_layout_of_every_shader() {
        let expected = [
            offset_of!(ColumnView, origin),
            offset_of!(ColumnView, size),
            offset_of!(ColumnView, across),
            offset_of!(ColumnView, far),
            offset_of!(ColumnView, more),
            offset_of!(ColumnView, position),
            size_of::<ColumnView>(),
        ];
        let shaders = all_shaders();
        let these: Vec<_> =
            shaders.iter().filter(|(_, source)| source.text().contains("ColumnView")).collect();
        assert!(these.len() >= 2, "each method that is in the world has some");
        for (label, source) in these {
            assert_eq!(layout_in_shader(source, "ColumnView"), expected, "{label}");
        }
    }

    #[test]
    fn points_lie_behind_the_hair_and_in_their_texels() {
        let anchor = Vec3::new(0.1, 1.6, 0.0);
        let bounds = Bounds { min: Vec3::splat(-0.2), max: Vec3::splat(0.3), ignored: 0 };
        let way = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        for distance in [None, Some(2.0), Some(0.1)] {
            let light = distance.map_or(way, |distance: f32| {
                let position = anchor - distance * way.x;
                way.standing(LightSource { position, radius: 0.01 }, anchor)
            });
            let views = ColumnViews::new(&light, anchor, (64, 0.01), &bounds);
            assert_eq!(views.0.len(), if distance == Some(0.1) { 6 } else { 1 });
            for (view, uv_from_world) in views.0.iter().flatten() {
                for (column, row) in [(1, 1), (20, 50), (view.size - 2, 9)] {
                    let p = view.point(column, row);
                    let uv = *uv_from_world * p.extend(1.0);
                    let found = uv.truncate().truncate() / uv.w * view.size as f32;
                    let wanted = glam::Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                    assert!((found - wanted).length() < 0.01, "{distance:?}: {found} for {wanted}");
                    let from_light = light.light_from_world(p - anchor);
                    let is_behind = match light.source {
                        None => from_light.x > bounds.max.x,
                        // Outside of the hair along any of the axes: nothing of it is farther from the light on this way.
                        Some(_) => from_light.cmplt(bounds.min).any() || from_light.cmpgt(bounds.max).any(),
                    };
                    assert!(is_behind, "{distance:?}: {from_light}");
                }
            }
        }
    }
}
