//! Light on layers as it was published: a matt part and two shifted highlights (Xu et al., "SATF", equations 8 to 11).

use glam::Vec3;
use lovelock_groom::{HairLook, Strands};
use lovelock_satf::ClusterHair;
use rayon::prelude::*;

use super::vertices::Vertex;
use crate::cpu::view::View;
use crate::{FrameInput, MAX_LIGHTS};

/// Replaces the light at the vertices. Ambient light, which the paper does not have, is neither shadowed nor reflected by records. `ribs` are their points, each with four packed transmittances.
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
            for (ring, result) in vertex.lit.iter_mut().enumerate() {
                let at = first + ring * of_cluster + k;
                let here = ribs.point(at);
                let along =
                    ribs.point(at - i + (i + 1).min(points - 1)) - ribs.point(at - usize::from(i > 0));
                let tangent = along.normalize_or_zero();
                let to_eye = (input.camera.eye - here).normalize_or_zero();
                result[0] = (ambient * color * 0.22).to_array();
                for (l, light) in view.lights.iter().enumerate().take(MAX_LIGHTS) {
                    let lit = (transmittance[at] >> (8 * l) & 0xff) as f32 / 255.0;
                    let place = here.to_array().map(|x| [x]);
                    let [body] = light.past_body(&place, None, 0.006, &view.strand_disc);
                    let (toward, [arriving]) = light.arriving(&place);
                    let toward = Vec3::from(toward.map(|[c]| c));
                    let parts = lighting.parts(tangent, vertex.normal, toward, to_eye);
                    let share = lit * (body * arriving);
                    result[1 + l] = (parts.color(color, light.radiance) * share).to_array();
                }
            }
        }
    });
}
