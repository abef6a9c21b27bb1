//! Growing a hairstyle: cells of roots, combed paths, guides, strands.
//!
//! 1. [`comb`]: the parting, the whorl, and the direction of the hair at each point of the head.
//! 2. [`cells`]: the scalp divided among wisps, and the roots of each wisp's strands.
//! 3. [`path`]: how a wisp leaves the scalp, follows the head, falls and drapes.
//! 4. [`cut`]: the length of each wisp.
//! 5. [`guides`]: three guides of equal links around each path, outside the body.
//! 6. [`strands`]: curl, waves, frizz, locks, strays and tips, as offsets from the guides.

mod cells;
mod comb;
mod cut;
mod guides;
mod path;
mod strands;

use lovelock_base::settings::Settings;
use rayon::prelude::*;
use thiserror::Error;

use crate::frame::widest_radii;

use crate::{
    Bounded, GroomSettings, Guides, Hairstyle, MotionFactors, Obstacle, Preset, Scalp, ScalpError,
    ScalpIndex, StrandSet, Wisp,
};

/// Points of each grown guide: 30 links, as in Bertails et al. 2005.
pub const GUIDE_POINTS: usize = 31;

/// Why a hairstyle could not be grown.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GrowError {
    /// The scalp is unusable.
    #[error(transparent)]
    Scalp(#[from] ScalpError),
}

/// Grows a hairstyle on `scalp`, around `obstacle` (the body without hair), both in head space.
///
/// `settings` are clamped to their ranges first. The result depends only on the arguments, not on the number of
/// threads.
///
/// # Errors
/// The scalp is malformed, or has no area above the hairline.
pub fn grow(
    settings: &GroomSettings,
    scalp: &Scalp,
    obstacle: &dyn Obstacle,
) -> Result<Hairstyle, GrowError> {
    scalp.check()?;
    let settings = settings.clamped();
    let index = ScalpIndex::new(scalp);
    let obstacle = &Bounded(obstacle);
    let comb = comb::Comb::new(&settings, &index).ok_or(ScalpError::Bare)?;
    let cells = cells::divide(&settings, &index, &comb);
    if cells.is_empty() {
        return Err(ScalpError::Bare.into());
    }
    let paths: Vec<path::Path> =
        cells.par_iter().map(|cell| path::trace(&settings, &comb, obstacle, cell)).collect();
    let lengths = cut::lengths(&settings, &comb, &cells, &paths);

    let grown: Vec<_> = (0..cells.len())
        .into_par_iter()
        .map(|w| {
            let guides = guides::around(&settings, &index, &comb, obstacle, &cells[w], &paths[w], lengths[w]);
            let strands = strands::of_wisp(&settings, &comb, obstacle, &cells[w], &guides);
            (guides, strands)
        })
        .collect();

    let mut guides = Guides { points_per_guide: GUIDE_POINTS, ..Guides::default() };
    let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut wisps = Vec::with_capacity(cells.len());
    for (w, (of_wisp, strands)) in grown.into_iter().enumerate() {
        let first_guide = guides.count() as u32;
        let first_strand = set.count() as u32;
        for guide in &of_wisp {
            guides.push(guide);
        }
        strands.append_to(&mut set, w as u32);
        wisps.push(Wisp {
            guides: [first_guide, first_guide + 1, first_guide + 2],
            first_strand,
            strand_count: set.count() as u32 - first_strand,
        });
    }
    let name = Preset::ALL.into_iter().find(|&p| GroomSettings::preset(p) == settings);
    Ok(Hairstyle {
        name: name.map_or("Custom", Preset::label).to_owned(),
        scalp: scalp.clone(),
        widest: widest_radii(&guides, &wisps),
        wisps,
        guides,
        held: Vec::new(),
        ropes: Vec::new(),
        motion: MotionFactors::default(),
        strands: set,
        look: settings.look,
    })
}
