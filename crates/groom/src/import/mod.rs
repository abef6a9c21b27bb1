//! Imports a hair file as a hairstyle that can be simulated.
//!
//! 1. [`orientation`]: unit and axes, as set or guessed.
//! 2. [`place`](mod@place): the groom is fitted to the scalp, and its roots are moved onto the skin.
//! 3. [`cluster`]: strands are grouped into wisps by root and shape.
//! 4. [`guides`]: three members of each wisp become its guides.
//! 5. [`express`]: every strand becomes a blend of its wisp's guides plus its own offsets, without loss.

mod cluster;
mod colour;
mod express;
mod fit;
mod guides;
mod info;
mod orientation;
mod place;
mod settings;
mod snap;
mod surface;

use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_base::words::counted;
use thiserror::Error;

use crate::frame::widest_radii;
use crate::{Guides, HairFile, HairLook, Hairstyle, MotionFactors, Obstacle, Scalp, Wisp};

pub use info::{HairInfo, hair_info};
pub use place::{PlacedGroom, place};
pub use settings::{ImportSettings, Placement};

/// Why a groom could not be placed on a scalp.
#[derive(Debug, Error)]
pub enum ImportError {
    /// The scalp has no triangles.
    #[error("{name}: there is no scalp to place the hair on: found a scalp without triangles")]
    NoScalp {
        /// The hair file.
        name: String,
    },
    /// In the chosen unit, the groom is too small or too large to be hair.
    #[error("{name}: the hair would be {size_m:e} m across in this unit; must be 1e-5 to 100 m")]
    Size {
        /// The hair file.
        name: String,
        /// Longest side of its box, metres.
        size_m: f32,
    },
}

/// Makes a hairstyle of a hair file, on a scalp in head space.
///
/// At rest, every strand has the shape and position given by [`place`]. The result depends only on the arguments.
///
/// # Errors
/// The scalp is empty, or the unit makes the groom implausibly small or large.
pub fn import(file: &HairFile, settings: &ImportSettings, scalp: &Scalp) -> Result<Hairstyle, ImportError> {
    import_around(file, settings, scalp, None)
}

/// As [`import`], and moves parts of strands that would touch or enter `body` away from its surface.
///
/// # Errors
/// As [`import`].
pub fn import_around(
    file: &HairFile,
    settings: &ImportSettings,
    scalp: &Scalp,
    body: Option<&dyn Obstacle>,
) -> Result<Hairstyle, ImportError> {
    Ok(import_noted(file, settings, scalp, body)?.0)
}

/// As [`import_around`], with notes on what was moved, as sentences.
///
/// # Errors
/// As [`import`].
pub fn import_noted(
    file: &HairFile,
    settings: &ImportSettings,
    scalp: &Scalp,
    body: Option<&dyn Obstacle>,
) -> Result<(Hairstyle, Vec<String>), ImportError> {
    let groom = place(file, settings, scalp, body)?;
    let mut notes = Vec::new();
    let (inside, depth) = groom.inside;
    if inside > 0 {
        let begin = counted(inside, "strand began", "strands began");
        let millimetres = 1000.0 * depth;
        notes.push(format!(
            "{begin} inside of the head, up to {millimetres:.0} mm deep, and moved out to the skin."
        ));
    }
    Ok((hairstyle_of(file, settings, scalp, &groom).0, notes))
}

/// A hairstyle whose strands are moved by others than its guides: see [`import_in_place`].
#[derive(Clone, Debug)]
pub struct ImportedInPlace {
    /// The hairstyle. Its look is that of the file.
    pub style: Hairstyle,
    /// The strand of the file that each of its strands is.
    pub strands: Vec<u32>,
    /// The strand of the file that each of its guides follows.
    pub guides: Vec<u32>,
}

impl ImportedInPlace {
    /// Lets the guides follow the strands of the file, whose points are given.
    pub fn follow(&self, first_point: &[u32], points: &[Vec3], guides: &mut Guides) {
        let per = self.style.guides.points_per_guide;
        for (guide, &strand) in self.guides.iter().enumerate() {
            let span = first_point[strand as usize] as usize..first_point[strand as usize + 1] as usize;
            for (i, point) in guides::spaced_along(&points[span], per).into_iter().enumerate() {
                let at = guide * per + i;
                (guides.x[at], guides.y[at], guides.z[at]) = (point.x, point.y, point.z);
            }
        }
    }
}

/// Makes a hairstyle of a hair file in metres whose points are where the head is at rest already: nothing is fitted or moved.
///
/// # Errors
/// The groom is implausibly small or large.
pub fn import_in_place(
    file: &HairFile,
    settings: &ImportSettings,
    scalp: &Scalp,
    points: Vec<Vec3>,
) -> Result<ImportedInPlace, ImportError> {
    let size_m = file.bounds.size().max_element();
    if !(1e-5..=1e3).contains(&size_m) {
        return Err(ImportError::Size { name: file.name.clone(), size_m });
    }
    let groom = PlacedGroom {
        first_point: file.first_point.clone(),
        points,
        metres_per_unit: 1.0,
        fitted_scale: 1.0,
        mean_root_gap_m: 0.0,
        inside: (0, 0.0),
    };
    let (style, strands, guides) = hairstyle_of(file, settings, scalp, &groom);
    Ok(ImportedInPlace { style, strands, guides })
}

/// The hairstyle of a placed groom, and the index in the groom of each of its strands and of each of its guides.
fn hairstyle_of(
    file: &HairFile,
    settings: &ImportSettings,
    scalp: &Scalp,
    groom: &PlacedGroom,
) -> (Hairstyle, Vec<u32>, Vec<u32>) {
    let settings = settings.clamped();
    let wisps = cluster::cluster(groom, settings.wisps_for(groom.strands()), settings.seed);
    let points_per_guide = settings.points_per_guide_for(&groom.first_point);
    let (guides, followed) = guides::choose(groom, &wisps, points_per_guide);
    let order: Vec<u32> = wisps.iter().flatten().copied().collect();
    let mut first_strand = 0;
    let mut guide = 0;
    let wisps: Vec<Wisp> = wisps
        .iter()
        .map(|members| {
            let wisp = Wisp {
                guides: [guide, guide + 1, guide + 2],
                first_strand,
                strand_count: members.len() as u32,
            };
            first_strand += wisp.strand_count;
            guide += 3;
            wisp
        })
        .collect();
    let mut strands = express::express(groom, &order, &wisps, &guides);
    strands.taper = colour::taper(file, groom, &order);
    strands.shade = colour::shade(file, &order, settings.seed);
    strands.marks = file.marks.selected(order.iter().map(|&strand| strand as usize));
    let style = Hairstyle {
        name: std::path::Path::new(&file.name)
            .file_stem()
            .map_or_else(|| file.name.clone(), |stem| stem.to_string_lossy().into_owned()),
        scalp: scalp.clone(),
        widest: widest_radii(&guides, &wisps),
        wisps,
        guides,
        held: Vec::new(),
        ropes: Vec::new(),
        motion: MotionFactors::default(),
        strands,
        look: colour::look(file),
    };
    (style, order, followed)
}

/// The look of a file's hair: melanin from its colour, if it has one.
pub fn hair_look(file: &HairFile) -> HairLook {
    colour::look(file)
}

/// Length of a polyline, metres.
fn length(points: &[Vec3]) -> f32 {
    points.array_windows().map(|[a, b]| a.distance(*b)).sum()
}

#[cfg(test)]
mod tests;
