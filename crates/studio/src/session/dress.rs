//! What is done to a hairstyle after it was grown or read: it is gathered by ties.

use std::sync::Arc;

use lovelock_groom::{HairTie, Hairstyle, tied};

use super::parts::{BodyPart, HairPart};
use crate::HairSection;

/// The last hairstyle made so, and of what: another colour or motion need not make it again.
#[derive(Debug)]
pub(super) struct Dressed {
    base: Arc<HairPart>,
    ties: Vec<HairTie>,
    style: Arc<Hairstyle>,
}

impl Dressed {
    /// The style of `base` with the ties of `section`; the one that `kept` holds where it is of the same.
    pub(super) fn style(
        kept: &mut Option<Self>,
        base: &Arc<HairPart>,
        section: &HairSection,
        body: &BodyPart,
    ) -> Arc<Hairstyle> {
        if section.ties.is_empty() {
            *kept = None;
            return Arc::clone(&base.style);
        }
        if let Some(kept) = kept
            && Arc::ptr_eq(&kept.base, base)
            && kept.ties == section.ties
        {
            return Arc::clone(&kept.style);
        }
        let style = Arc::new(tied(&base.style, &section.ties, &*body.obstacle));
        let dressed = Self { base: Arc::clone(base), ties: section.ties.clone(), style };
        Arc::clone(&kept.insert(dressed).style)
    }
}
