//! The brows and lashes of a scene.

use std::sync::Arc;

use lovelock_groom::carried::{
    BROWS, LOWER_LASHES, SkinGroom, SkinHair, SkinSurface, UPPER_LASHES, is_mask_of_hair,
};
use lovelock_motion::Body;
use lovelock_project::error::{Place, Problem, ProblemKind};

/// What grows on the skin of a body, kept until the body or its grooms change.
#[derive(Debug, Default)]
pub(super) struct SkinHairPart(Option<Kept>);

#[derive(Debug)]
struct Kept {
    body: Arc<Body>,
    grooms: Vec<SkinGroom>,
    scale: f32,
    hair: Option<Arc<SkinHair>>,
}

impl SkinHairPart {
    /// The hair of `grooms` on a body whose head is `scale` times as large as the shipped dancer's; `None` if its file says nowhere that
    /// any grows.
    pub(super) fn of(
        &mut self,
        body: &Arc<Body>,
        grooms: Vec<SkinGroom>,
        scale: f32,
    ) -> Option<Arc<SkinHair>> {
        let is_known = |kept: &&Kept| {
            Arc::ptr_eq(&kept.body, body) && kept.grooms == grooms && kept.scale.to_bits() == scale.to_bits()
        };
        if let Some(kept) = self.0.as_ref().filter(is_known) {
            return kept.hair.clone();
        }
        let mesh = &body.mesh;
        let surface =
            SkinSurface { positions: &mesh.positions, normals: &mesh.normals, triangles: &mesh.triangles };
        let mask = |name: &str| mesh.masks.get(name).map(Vec::as_slice);
        let hair = SkinHair::grow(&surface, &grooms, mask, scale).map(Arc::new);
        self.0 = Some(Kept { body: Arc::clone(body), grooms, scale, hair: hair.clone() });
        hair
    }
}

/// Which masks of brows and lashes of a body are ignored.
pub(super) fn mask_notes(body: &Body) -> Vec<Problem> {
    let masks = [BROWS.mask, UPPER_LASHES.mask, LOWER_LASHES.mask];
    let wrong = |name: &&str| body.mesh.masks.get(*name).is_some_and(|mask| !is_mask_of_hair(mask));
    let told = |name| {
        let text = format!("the vertex attribute {name} marks more than a part of the face; it is ignored");
        Problem::new(Place::Body, ProblemKind::Note, text)
    };
    masks.into_iter().filter(wrong).map(told).collect()
}
