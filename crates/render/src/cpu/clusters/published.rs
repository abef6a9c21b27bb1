//! Light on layers as it was published: a matt part and two shifted highlights (Xu et al., "SATF", equations 8 to 11).

use glam::Vec3;
use lovelock_groom::{HairLook, Strands};
use lovelock_satf::ClusterHair;
use rayon::prelude::*;

use super::vertices::Vertex;
use crate::FrameInput;
use crate::cpu::view::View;

/// Replaces the light at the vertices. `ribs` are their points, each with four packed transmittances.
pub(super) fn light(
    hair: &ClusterHair,
    view: &View,
    (ribs, transmittance): (&Strands, &[u32]),
    input: &FrameInput,
    out: &mut [Vertex],
) {
    let lighting = input.picture.clusters.lighting();
    let color = HairLook::body_color(view.uniform.mean_absorption);
    let ambient = Vec3::from(view.ambient([0.0, 0.3, 0.0]));
    let points = hair.grid.points();
    let of_cluster = hair.grid.around * points;
    out.par_chunks_mut(of_cluster).enumerate().for_each(|(cluster, out)| {
        let first = cluster * hair.grid.rib_points();
        for (k, vertex) in out.iter_mut().enumerate() {
            let i = k % points;
            for (ring, result) in vertex.color.iter_mut().enumerate() {
                let at = first + ring * of_cluster + k;
                let here = ribs.point(at);
                let along =
                    ribs.point(at - i + (i + 1).min(points - 1)) - ribs.point(at - usize::from(i > 0));
                let tangent = along.normalize_or_zero();
                let to_eye = (input.camera.eye - here).normalize_or_zero();
                let mut sum = ambient * color * 0.22;
                for (l, light) in view.lights.iter().enumerate() {
                    let lit = (transmittance[at] >> (8 * l) & 0xff) as f32 / 255.0;
                    let [body] = light.body_light(
                        &here.to_array().map(|x| [x]),
                        &[[0.0]; 3],
                        0.006,
                        &view.strand_disc,
                    );
                    let parts = lighting.parts(tangent, vertex.normal, -light.direction, to_eye);
                    sum += parts.color(color, light.radiance) * (lit * body);
                }
                *result = sum.to_array();
            }
        }
    });
}
