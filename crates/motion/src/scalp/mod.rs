//! The scalp of any head: the outline of the shipped dancer's scalp, fitted to the skull within the head and laid on its skin.
//!
//! 1. [`Skull`]: the largest ball within the head, and the ellipsoid around the skin above its middle. Noses, ears, horns and snouts
//!    have no part in it.
//! 2. [`outline`]: the hairline as an elevation for every direction around the skull, relative to its size.
//! 3. [`mesh`]: a net of directions, laid on the skin along rays from the skull's middle. The mask is 0 on what stands out of the
//!    head, such as ears, where the body goes on, and on skin that another joint moves.
//! 4. [`ScalpFit`]: what a person corrects.
//!
//! For fur the scalp is the whole skin ([`ScalpArea::Skin`]), and hair has the size that its settings say.
//!
//! Where the skin encloses no skull, an ellipsoid around the head's box takes its place.

mod fit;
mod mesh;
mod outline;
mod skull;
#[cfg(test)]
mod tests;

use glam::Vec3;

pub use fit::{Raise, ScalpArea, ScalpFit};
pub use skull::Skull;

use crate::head::skin_mesh;
use crate::{Body, HeadMesh, RestDistance, head_mesh};

/// The surface on which hair grows, and the skull to which it was fitted.
#[derive(Clone, Debug, Default)]
pub struct FittedScalp {
    /// The surface in head space with the mask; `vertex` is empty where it was fitted to the skin.
    pub head: HeadMesh,
    /// The skull; `None` for a body without a surface.
    pub skull: Option<Skull>,
    /// Size of the hair as a multiple of that on the shipped dancer's head.
    pub scale: f32,
    /// The mask of each vertex of the body's mesh, if it is another than that of the file; empty otherwise.
    pub body_mask: Vec<f32>,
    /// Whether the skin encloses no skull, so that the scalp is an ellipsoid around the head's box.
    pub is_a_cap: bool,
}

/// Sizes of heads that differ by less than this fraction grow hair of the same size.
const SAME_SIZE: f32 = 0.03;

/// The scalp of a body: that of its file where it has one that `fit` leaves in place, and else the fitted outline.
pub fn fitted_scalp(body: &Body, rest: &RestDistance, fit: &ScalpFit) -> FittedScalp {
    let fit = fit.clamped();
    let mut head = head_mesh(body);
    if head.triangles.is_empty() {
        return FittedScalp { head, scale: 1.0, ..FittedScalp::default() };
    }
    let distance = |p: Vec3| rest.distance(p).0;
    let alone = body.skeleton.joints.len() == 1 || head.positions.len() == body.mesh.positions.len();
    let found = if fit.by_hand {
        let origin =
            body.skeleton.world_at_rest.get(body.head_joint).map_or(Vec3::ZERO, |at| at.translation.into());
        Some(Skull::of_height(fit.middle - origin, fit.skull_height))
    } else {
        Skull::find(&head.positions, alone, &distance)
    };
    if fit.area == ScalpArea::Skin {
        return whole_skin(body, found, &fit);
    }
    let is_a_cap = found.is_none();
    let Some(skull) = found.or_else(|| mesh::cap_around(&head.positions)) else {
        return FittedScalp { head, scale: 1.0, is_a_cap, ..FittedScalp::default() };
    };
    let mut scale = skull.scale();
    if (scale - 1.0).abs() < SAME_SIZE {
        scale = 1.0;
    }
    let mut body_mask = Vec::new();
    if head.scalp_is_guessed || fit.moves_outline() || fit.by_hand {
        head = mesh::fitted(body, &skull, &fit, (!is_a_cap).then_some(&distance as skull::Distance<'_>));
        body_mask = mesh::on_body(body, &skull, &head);
    } else if fit.is_painted() {
        for (p, mask) in head.positions.iter().zip(&mut head.scalp) {
            *mask = fit.painted(skull.relative(*p), *mask);
        }
        body_mask.clone_from(&body.mesh.scalp);
        for (v, mask) in head.vertex.iter().zip(&head.scalp) {
            body_mask[*v as usize] = *mask;
        }
    }
    FittedScalp { head, skull: Some(skull), scale: scale * fit.size, body_mask, is_a_cap }
}

/// The whole skin as a scalp, with what is painted as seen from the middle of the skull.
fn whole_skin(body: &Body, skull: Option<Skull>, fit: &ScalpFit) -> FittedScalp {
    let mut head = skin_mesh(body);
    if let Some(skull) = skull.as_ref().filter(|_| fit.is_painted()) {
        for (p, mask) in head.positions.iter().zip(&mut head.scalp) {
            *mask = fit.painted(skull.relative(*p), *mask);
        }
    }
    let body_mask = if head.scalp == body.mesh.scalp { Vec::new() } else { head.scalp.clone() };
    FittedScalp { head, skull, scale: fit.size, body_mask, is_a_cap: false }
}

/// A point of the hairline: its place on the ellipsoid of the skull, head space, metres. `azimuth` is the angle from the front toward
/// the wearer's left, radians.
pub fn hairline_place(skull: &Skull, fit: &ScalpFit, azimuth: f32) -> Vec3 {
    skull.place(mesh::hairline_direction(fit, azimuth))
}

/// Raises or lowers the hairline at place `i` of [`ScalpFit::PLACES`], so that it passes at the height of a place in head space.
pub fn raise_hairline(skull: &Skull, fit: &mut ScalpFit, i: usize, place: Vec3) {
    let Some((_, degrees)) = ScalpFit::PLACES.get(i) else { return };
    let (_, elevation) = outline::angles(fit.to_outline(skull.relative(place)));
    fit.raise_at(i, elevation - outline::hairline(degrees.to_radians(), fit));
}
