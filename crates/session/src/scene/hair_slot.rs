//! One hairstyle of a scene with its layers, loaded again only where its sources change.

use std::sync::Arc;

use lovelock_base::settings::Choices;
use lovelock_groom::Hairstyle;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::HairSection;
use lovelock_style::StyleCache;

use super::control::LoadControl;
use super::hair_part::{HairFileCache, HairKey, HairPart};
use super::scalp_part::ScalpPart;

/// What is kept of a hairstyle between two loads.
#[derive(Debug, Default)]
pub(super) struct HairSlot {
    grown: Option<(HairKey, Arc<ScalpPart>, Arc<HairPart>)>,
    file: HairFileCache,
    cut_and_ties: StyleCache,
    layers: StyleCache,
}

/// A hairstyle in the size of the shipped dancer's head.
pub(super) struct LoadedHair {
    /// The hair below the layers: grown or imported, cut and tied.
    pub(super) base: Arc<Hairstyle>,
    /// The hair with its layers.
    pub(super) style: Arc<Hairstyle>,
    /// Notes of the loader about the file.
    pub(super) notes: Vec<Problem>,
}

impl HairSlot {
    /// The memory of the hairstyles that are kept after layers, bytes.
    pub(super) fn layer_bytes(&self) -> u64 {
        self.cut_and_ties.bytes() + self.layers.bytes()
    }

    /// Loads the hair of a section, which is the part `from` to `to` of the load. Hair that cannot be loaded is replaced by that of the last call, or by a grown one, with a problem.
    ///
    /// # Errors
    /// If the load is cancelled.
    pub(super) fn load(
        &mut self,
        section: &HairSection,
        access: &Access,
        scalp: &Arc<ScalpPart>,
        problems: &mut Vec<Problem>,
        control: &mut LoadControl<'_>,
        [from, to]: [f32; 2],
    ) -> Result<LoadedHair, ProjectError> {
        if section.file.is_none() {
            self.file = None;
        }
        let hair = self.part(section, access, scalp, problems, control)?;
        control.at("cutting and tying the hair", from + 0.6 * (to - from))?;
        let tied = self.cut_and_ties.apply(&hair.style, &section.cut_and_ties(), scalp.obstacle.clone());
        control.at("applying the layers", from + 0.8 * (to - from))?;
        let styled = self.layers.apply(&tied.style, &section.stack, scalp.obstacle.clone());
        let other_hair = tied.skipped.into_iter().chain(styled.skipped).map(|layer| {
            format!(
                "\"{layer}\" was made for other hair and has no effect here; it returns with its hairstyle"
            )
        });
        // The cut, if there is one, comes before the ties.
        let first_tie = usize::from(!section.cut.is_empty());
        let tie = |layer: usize| {
            let number = layer.checked_sub(first_tie)?;
            Some(format!("{} {}", section.ties.get(number)?.kind.names().1, number + 1))
        };
        let of_stack = |layer: usize| Some(section.stack.layers.get(layer)?.label().to_owned());
        let idle = tied.idle_ties.into_iter().filter_map(tie);
        let idle = idle.chain(styled.idle_ties.into_iter().filter_map(of_stack)).map(|tie| {
            format!("\"{tie}\" gathers no hair: what it reaches is too short for it, or is in another tie")
        });
        let other_version = section.stack.unknown().into_iter().map(|(layer, id)| {
            format!("the layer \"{layer}\" uses `{id}`, which this version does not know; it is kept and has no effect")
        });
        let ignored = |message| Problem::new(Place::Hair, ProblemKind::Ignored, message);
        problems.extend(other_hair.chain(idle).chain(other_version).map(ignored));
        Ok(LoadedHair { base: tied.style, style: styled.style, notes: hair.notes.clone() })
    }

    fn part(
        &mut self,
        section: &HairSection,
        access: &Access,
        scalp: &Arc<ScalpPart>,
        problems: &mut Vec<Problem>,
        control: &mut LoadControl<'_>,
    ) -> Result<Arc<HairPart>, ProjectError> {
        let wanted = HairKey::of(section, access);
        if let (Ok(key), Some((known, of, part))) = (&wanted, &self.grown)
            && known == key
            && Arc::ptr_eq(of, scalp)
        {
            return Ok(Arc::clone(part));
        }
        let loaded = match wanted {
            Ok(key) => {
                let read = key.read(&mut self.file, control)?;
                read.and_then(|()| key.load(scalp, &self.file)).map(|part| (key, part))
            }
            Err(problem) => Err(problem),
        };
        let (key, part) = match (loaded, &self.grown) {
            (Ok(loaded), _) => loaded,
            (Err(problem), Some((_, _, part))) => {
                problems.push(problem.with_fallback("the previous hair is kept"));
                return Ok(Arc::clone(part));
            }
            (Err(problem), None) => {
                let key = HairKey::grown(section);
                let grown = key.load(scalp, &None);
                let instead =
                    if grown.is_ok() { "the grown hairstyle is shown instead" } else { "no hair is shown" };
                problems.push(problem.with_fallback(instead));
                (key, grown.unwrap_or_else(|_| HairPart::bald(scalp)))
            }
        };
        let part = Arc::new(part);
        self.grown = Some((key, Arc::clone(scalp), Arc::clone(&part)));
        Ok(part)
    }
}
