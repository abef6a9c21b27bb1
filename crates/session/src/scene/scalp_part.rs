//! The scalp of a body, with the corrections of the project.

use std::sync::Arc;

use lovelock_groom::{Hairstyle, Scalp};
use lovelock_motion::{Body, RestDistance, ScalpArea, ScalpFit, Skull, fitted_scalp};
use lovelock_project::error::{Place, Problem, ProblemKind};

use super::BodyObstacle;
use super::parts::BodyPart;

/// A scalp, and everything that hair needs of a body.
#[derive(Debug)]
pub(super) struct ScalpPart {
    /// The body, with the mask of the scalp on its vertices.
    pub(super) body: Arc<Body>,
    /// The scalp in head space, metres.
    pub(super) placed_scalp: Arc<Scalp>,
    /// The scalp in the size of the shipped dancer's head: hair grows and is styled on this one.
    pub(super) scalp: Arc<Scalp>,
    /// The body around it, in the same size.
    pub(super) obstacle: Arc<BodyObstacle>,
    /// Size of the head as a multiple of the dancer's.
    pub(super) scale: f32,
    pub(super) skull: Option<Skull>,
    pub(super) notes: Vec<Problem>,
    rest: Arc<RestDistance>,
}

impl ScalpPart {
    /// Fits the scalp to a body.
    pub(super) fn new(part: &BodyPart, fit: &ScalpFit) -> Self {
        let fitted = fitted_scalp(&part.body, &part.rest, fit);
        let mut notes = Vec::new();
        if fitted.head.scalp_is_guessed && !fitted.head.triangles.is_empty() {
            let message = if fitted.is_a_cap {
                "the skin encloses no skull; the scalp is a cap around the head's box"
            } else {
                "the file contains no hairline; the scalp was fitted to the shape of the head"
            };
            notes.push(Problem::new(Place::Body, ProblemKind::Note, message));
        }
        if part.body.is_without_head && fit.area == ScalpArea::Head && !fit.by_hand {
            let message = "the file has no joints, and neither neck nor shoulders show a head: all of it is taken for a head; place the \
                           scalp by hand if it is none";
            notes.push(Problem::new(Place::Body, ProblemKind::Note, message));
        }
        if fit.area == ScalpArea::Skin && part.body.skeleton.joints.len() > 1 && !part.body.is_without_head {
            let message = "hair grows on the whole skin and moves rigidly with the head joint: it follows the skin while the body rests";
            notes.push(Problem::new(Place::Body, ProblemKind::Note, message));
        }
        let body = if fitted.body_mask.is_empty() {
            Arc::clone(&part.body)
        } else {
            let mut body = (*part.body).clone();
            body.mesh.scalp.clone_from(&fitted.body_mask);
            Arc::new(body)
        };
        let head = fitted.head;
        let placed_scalp = Arc::new(Scalp {
            positions: head.positions,
            normals: head.normals,
            triangles: head.triangles,
            mask: head.scalp,
        });
        let scale = fitted.scale;
        let scalp = match scale {
            1.0 => Arc::clone(&placed_scalp),
            _ => Arc::new(placed_scalp.scaled(1.0 / scale)),
        };
        let obstacle = Arc::new(BodyObstacle { rest: Arc::clone(&part.rest), scale });
        let rest = Arc::clone(&part.rest);
        Self { body, placed_scalp, scalp, obstacle, scale, skull: fitted.skull, notes, rest }
    }

    /// The body around the scalp in head space.
    pub(super) fn placed_obstacle(&self) -> BodyObstacle {
        BodyObstacle { rest: Arc::clone(&self.rest), scale: 1.0 }
    }
}

/// A style in the size of the head that wears it, kept until the style changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Enlarged(Option<(Arc<Hairstyle>, f32, Arc<Hairstyle>)>);

impl Enlarged {
    /// The style on a head that is `scale` times as large as the dancer's; the style itself for 1.
    pub(crate) fn of(&mut self, style: &Arc<Hairstyle>, scale: f32) -> Arc<Hairstyle> {
        if scale == 1.0 {
            self.0 = None;
            return Arc::clone(style);
        }
        if let Some((of, by, large)) = &self.0
            && Arc::ptr_eq(of, style)
            && *by == scale
        {
            return Arc::clone(large);
        }
        let large = Arc::new(style.scaled(scale));
        self.0 = Some((Arc::clone(style), scale, Arc::clone(&large)));
        large
    }
}
