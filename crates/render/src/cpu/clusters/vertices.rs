//! The points of the ribs on the screen, with the angles by which records are found.

use glam::{Vec2, Vec3};
use lovelock_groom::Strands;
use lovelock_satf::{ClusterHair, RibGrid};
use rayon::prelude::*;

use crate::cpu::strand_points::{LitParts, PARTS, ShadedPoint};

/// Where an outer and an inner rib cross a section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vertex {
    /// Pixels from the left and the top, and depth, on the inner and on the outer ring; see [`ShadedPoint`].
    pub at: [[f32; 3]; 2],
    /// Ambient light and the light of each light there.
    pub lit: [LitParts; 2],
    /// The outward normal of the cluster, world space.
    pub normal: Vec3,
    /// Cosine of the azimuth of the eye.
    pub cos_view: f32,
    /// Azimuths of the eye and of each light, from the outward normal.
    pub angles: [f32; PARTS],
    /// One over the length of the outer arc to the next rib, 1/metres.
    pub inverse_arc: f32,
    /// Sine of the angle between the eye and the hair; negative if the point must not be drawn.
    pub sin_view: f32,
}

/// Computes the vertices of all clusters, in the order of cluster, rib and section, from the shaded points of the ribs. `eye` is in world
/// space, and `to_lights` are directions.
pub(super) fn place(
    hair: &ClusterHair,
    ribs: &Strands,
    (shaded, lit): (&[ShadedPoint], &[LitParts]),
    (eye, to_lights): (Vec3, &[Vec3]),
    out: &mut Vec<Vertex>,
) {
    let RibGrid { around, .. } = hair.grid;
    let points = hair.grid.points();
    let of_cluster = around * points;
    out.resize(hair.clusters() * of_cluster, Vertex::default());
    out.par_chunks_mut(of_cluster).enumerate().for_each(|(cluster, out)| {
        let first = cluster * hair.grid.rib_points();
        let outer = first + of_cluster;
        let p = |rib: usize, i: usize| ribs.point(outer + rib % around * points + i);
        for rib in 0..around {
            for i in 0..points {
                let here = p(rib, i);
                let next = p(rib + 1, i);
                let across = next - p(rib + around - 1, i);
                let along = p(rib, (i + 1).min(points - 1)) - p(rib, i.saturating_sub(1));
                let tangent = along.normalize_or_zero();
                let side = (across - tangent * across.dot(tangent)).normalize_or_zero();
                let at = rib * points + i;
                // Outward, also where the guides have turned the wisp inside out.
                let normal = side.cross(tangent);
                let normal = normal * normal.dot(here - ribs.point(first + at)).signum();
                let to_eye = (eye - here).normalize_or_zero();
                let azimuth = |v: Vec3| v.dot(side).atan2(v.dot(normal));
                let rings = [&shaded[first + at], &shaded[outer + at]];
                let mut angles = [0.0; PARTS];
                angles[0] = azimuth(to_eye);
                for (angle, to_light) in angles[1..].iter_mut().zip(to_lights) {
                    *angle = azimuth(*to_light);
                }
                let drawn = rings.iter().all(|point| point.half_width >= 0.0) && normal != Vec3::ZERO;
                out[at] = Vertex {
                    at: rings.map(|point| [point.x, point.y, point.depth]),
                    lit: [lit[first + at], lit[outer + at]],
                    angles,
                    normal,
                    cos_view: angles[0].cos(),
                    inverse_arc: 1.0 / (next - here).cross(tangent).length().max(1e-6),
                    sin_view: if drawn { to_eye.cross(tangent).length() } else { -1.0 },
                };
            }
        }
    });
}

/// The four vertices of a column of hair shell volumes, from the inner to the outer ring: both ribs at its lower section, then at its
/// upper one.
pub(super) fn corners(grid: RibGrid, column: usize) -> [usize; 4] {
    let (rib, i) = (column / grid.along, column % grid.along);
    let cluster = rib / grid.around;
    let rib = rib % grid.around;
    let at = |rib: usize, i: usize| (cluster * grid.around + rib % grid.around) * grid.points() + i;
    [at(rib, i), at(rib + 1, i), at(rib, i + 1), at(rib + 1, i + 1)]
}

/// Left, top, right and bottom of a column, pixels; `None` if it is not drawn.
pub(super) fn bounds(vertices: &[Vertex], grid: RibGrid, column: usize) -> Option<[f32; 4]> {
    let corners = corners(grid, column).map(|v| &vertices[v]);
    if corners.iter().any(|v| v.sin_view < 0.0) {
        return None;
    }
    let points = corners.iter().flat_map(|v| v.at).map(|[x, y, _]| Vec2::new(x, y));
    let (low, high) =
        points.fold((Vec2::MAX, Vec2::MIN), |(low, high), point| (low.min(point), high.max(point)));
    Some([low.x, low.y, high.x, high.y])
}
