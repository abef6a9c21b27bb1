//! What is done to a hairstyle after it was grown or read: it is cut, and gathered by ties.

use std::sync::Arc;

use lovelock_groom::{HairTie, Haircut, Hairstyle, tied, trimmed};
use lovelock_project::error::{Place, Problem, ProblemKind};
use lovelock_project::project::HairSection;

use super::parts::{BodyPart, HairPart};

/// The last hairstyle made so, and of what: another colour or motion need not make it again.
#[derive(Debug)]
pub(super) struct Dressed {
    base: Arc<HairPart>,
    cut: Haircut,
    ties: Vec<HairTie>,
    style: Arc<Hairstyle>,
}

impl Dressed {
    /// The style of `base` with the cut and the ties of `section`; the one of `kept` where that is the same.
    pub(super) fn style(
        kept: &mut Option<Self>,
        base: &Arc<HairPart>,
        section: &HairSection,
        body: &BodyPart,
        problems: &mut Vec<Problem>,
    ) -> Arc<Hairstyle> {
        let HairSection { cut, ties, .. } = section;
        let cuts = !cut.is_empty() && cut.fits(&base.style.guides);
        if !cut.is_empty() && !cuts {
            let message =
                "the cut is one of other hair and does nothing here; it comes back with its hairstyle";
            problems.push(Problem::new(Place::Hair, ProblemKind::Ignored, message));
        }
        if !cuts && ties.is_empty() {
            *kept = None;
            return Arc::clone(&base.style);
        }
        if let Some(kept) = kept
            && Arc::ptr_eq(&kept.base, base)
            && (&kept.cut, &kept.ties) == (cut, ties)
        {
            return Arc::clone(&kept.style);
        }
        let mut style = Arc::clone(&base.style);
        if cuts {
            style = Arc::new(trimmed(&style, cut));
        }
        if !ties.is_empty() {
            style = Arc::new(tied(&style, ties, &*body.obstacle));
        }
        let dressed = Self { base: Arc::clone(base), cut: cut.clone(), ties: ties.clone(), style };
        Arc::clone(&kept.insert(dressed).style)
    }
}

#[cfg(test)]
mod tests;
