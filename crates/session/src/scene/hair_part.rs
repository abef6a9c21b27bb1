//! The hair of a scene before its cuts, ties and layers.

use std::collections::BTreeMap;
use std::sync::Arc;

use lovelock_base::watch::Watch;
use lovelock_groom::{
    GroomSettings, Guides, HairFile, HairLook, Hairstyle, ImportSettings, StrandSet, grow, import_noted,
    load_hair_watched,
};
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::{HairSection, HairSource};

use super::control::LoadControl;
use super::parts::{Stamp, file_notes};
use super::scalp_part::ScalpPart;

/// The sources of a hairstyle, besides the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum HairKey {
    Grown(Box<GroomSettings>),
    File { stamp: Stamp, import: ImportSettings },
}

/// A hairstyle on one head.
#[derive(Debug)]
pub(super) struct HairPart {
    pub(super) style: Arc<Hairstyle>,
    pub(super) notes: Vec<Problem>,
}

impl HairPart {
    /// No hair, for heads on which none can grow.
    pub(super) fn bald(part: &ScalpPart) -> Self {
        let style = Hairstyle {
            name: "none".to_owned(),
            scalp: (*part.scalp).clone(),
            guides: Guides { points_per_guide: 2, ..Guides::default() },
            strands: StrandSet { first_point: vec![0], ..StrandSet::default() },
            ..Hairstyle::default()
        };
        Self { style: Arc::new(style), notes: Vec::new() }
    }
}

/// The hair file that was read last and whether with its hidden strands, so that changes of the other import settings do not read it again.
pub(super) type HairFileCache = Option<(Stamp, bool, Arc<HairFile>)>;

impl HairKey {
    pub(super) fn of(section: &HairSection, access: &Access) -> Result<Self, Problem> {
        match (section.source, &section.file) {
            (HairSource::Grown, _) => Ok(Self::grown(section)),
            (HairSource::File, Some(file)) => {
                Ok(Self::File { stamp: Stamp::of(&access.read(Place::Hair, file)?), import: section.import })
            }
            (HairSource::File, None) => {
                Err(Problem::not_loaded(Place::Hair, "no hair file is set; pick one"))
            }
        }
    }

    /// The grown style of a project, whatever its hair source is. The look does not affect growing.
    pub(super) fn grown(section: &HairSection) -> Self {
        Self::Grown(Box::new(GroomSettings { look: HairLook::default(), ..section.groom }))
    }

    /// Reads the file of the hair, if it has one that `cache` does not hold.
    ///
    /// # Errors
    /// If the load is cancelled. A file that cannot be read is a problem.
    pub(super) fn read(
        &self,
        cache: &mut HairFileCache,
        control: &mut LoadControl<'_>,
    ) -> Result<Result<(), Problem>, ProjectError> {
        let Self::File { stamp, import } = self else { return Ok(Ok(())) };
        let hidden = import.include_hidden;
        if cache.as_ref().is_some_and(|(kept, of_hidden, _)| kept == stamp && *of_hidden == hidden) {
            return Ok(Ok(()));
        }
        let path = stamp.path.clone();
        let read = control
            .read("reading the hair", [0.5, 0.6], move |watch| load_hair_watched(&path, hidden, watch))?;
        Ok(read
            .map(|file| *cache = Some((stamp.clone(), hidden, Arc::new(file))))
            .map_err(|error| Problem::not_loaded(Place::Hair, error)))
    }

    /// The hairstyle in the size of the shipped dancer's head. The file of the hair is that of `cache`.
    pub(super) fn load(&self, part: &ScalpPart, cache: &HairFileCache) -> Result<HairPart, Problem> {
        let refuse = |error: &dyn std::fmt::Display| Problem::not_loaded(Place::Hair, error);
        if part.scalp.triangles.is_empty() {
            let body = &part.body;
            let joint = body.skeleton.joints.get(body.head_joint).map_or("none", |joint| &joint.name);
            let message = format!(
                "the head joint (`{joint}`) moves no surface of {}, so no hair can grow there; pick another joint",
                body.name
            );
            return Err(refuse(&message));
        }
        let (style, notes) = match self {
            Self::Grown(settings) => {
                let style = grow(settings, &part.scalp, &*part.obstacle)
                    .map_err(|error| refuse(&format!("{}: {error}", part.body.name)))?;
                (style, Vec::new())
            }
            Self::File { stamp, import } => {
                let file = match cache {
                    Some((kept, hidden, file)) if kept == stamp && *hidden == import.include_hidden => {
                        Arc::clone(file)
                    }
                    _ => Arc::new(
                        load_hair_watched(&stamp.path, import.include_hidden, &Watch::default())
                            .map_err(|error| refuse(&error))?,
                    ),
                };
                // Files have a size of their own.
                let (style, moved) =
                    import_noted(&file, import, &part.placed_scalp, Some(&part.placed_obstacle()))
                        .map_err(|error| refuse(&error))?;
                let style = if part.scale == 1.0 { style } else { style.scaled(1.0 / part.scale) };
                // The file's notes describe what was ignored, those of the import what was moved.
                let on_up: Vec<String> = file.note_on_up(import).into_iter().collect();
                let notes = [&file.notes[..], &on_up, &moved].concat();
                (style, file_notes(Place::Hair, &BTreeMap::new(), &notes))
            }
        };
        // All later code relies on valid indices.
        style.check().map_err(|error| refuse(&error))?;
        Ok(HairPart { style: Arc::new(style), notes })
    }
}

#[cfg(test)]
mod tests {
    use lovelock_simulation::SimulationSettings;

    use super::super::parts::BodyKey;
    use super::*;
    use crate::engine::Engine;
    use crate::scene::Scene;
    use crate::testing::{scene, small_project};

    #[test]
    fn a_head_without_a_surface_stays_bald_and_says_why() {
        let body = BodyKey::dancer().load().expect("the dancer");
        let mut part = ScalpPart::new(&body, &lovelock_motion::ScalpFit::default());
        part.scalp = Arc::default();
        let key = HairKey::grown(&small_project().hair);
        let problem = key.load(&part, &None).expect_err("nothing to grow on");
        assert!(problem.message.contains("moves no surface"), "{problem}");
        let style = HairPart::bald(&part).style;
        style.check().expect("whole");
        let scene = Arc::new(Scene { style, ..(*scene()).clone() });
        let mut engine = Engine::new(scene, SimulationSettings::default());
        engine.advance_to_step(3);
        let mut strands = lovelock_groom::Strands::default();
        engine.snapshot().interpolate(&mut strands);
        assert_eq!((strands.count(), strands.points()), (0, 0));
    }
}
