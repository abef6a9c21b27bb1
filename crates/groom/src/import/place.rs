//! Places a groom on a head: unit and axes, fit, manual placement, roots onto the skin, strands out of the body.

use glam::{EulerRot, Quat, Vec3};
use lovelock_base::settings::Settings;
use rayon::prelude::*;

use super::fit::{Fit, fit};
use super::orientation::Orientation;
use super::snap::{Skin, shifts};
use super::surface::Surface;
use super::{ImportError, ImportSettings};
use crate::io::fit_sphere;
use crate::{Bounds, HairFile, Obstacle, Scalp};

/// The strands of a file at rest on the head.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedGroom {
    /// Index of the first point of each strand, then the number of points (strands + 1 entries).
    pub first_point: Vec<u32>,
    /// Points of all strands, root first, in the order of the file; head space, metres.
    pub points: Vec<Vec3>,
    /// Length of one unit of the file before the fit, metres.
    pub metres_per_unit: f32,
    /// Scale that the fit applied.
    pub fitted_scale: f32,
    /// Mean distance by which roots were moved onto the skin, metres; 0 if they were not moved.
    pub mean_root_gap_m: f32,
    /// Number of roots that were inside the head, and the depth of the deepest, metres.
    pub inside: (usize, f32),
}

impl PlacedGroom {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.first_point.len() - 1
    }

    /// The points of strand `strand`, root first, head space, metres.
    pub fn strand(&self, strand: usize) -> &[Vec3] {
        &self.points[self.first_point[strand] as usize..self.first_point[strand + 1] as usize]
    }
}

/// Places the strands of a file on a scalp. Each keeps its shape, except where it would touch or enter `body`.
///
/// # Errors
/// The scalp is empty, or the unit makes the groom implausibly small or large.
pub fn place(
    file: &HairFile,
    settings: &ImportSettings,
    scalp: &Scalp,
    body: Option<&dyn Obstacle>,
) -> Result<PlacedGroom, ImportError> {
    let settings = settings.clamped();
    let no_scalp = || ImportError::NoScalp { name: file.name.clone() };
    let skin = Skin {
        grows: Surface::where_hair_grows(scalp).ok_or_else(no_scalp)?,
        whole: Surface::whole(scalp).ok_or_else(no_scalp)?,
    };
    let orientation = Orientation::resolve(file, &settings);
    let in_head_axes = |p: Vec3| orientation.head_axes_from_file(p);
    check_size(file, orientation.metres_per_unit)?;
    let roots: Vec<Vec3> = file.roots().map(in_head_axes).collect();
    let Fit { scale, shift } = fit(&roots, &skin.grows, settings.fit_scale);
    check_size(file, orientation.metres_per_unit * scale)?;

    let middle = middle_of(&skin.grows);
    let own = settings.placement;
    let turn = Quat::from_euler(EulerRot::XYZ, own.turn.x, own.turn.y, own.turn.z);
    let place =
        |p: Vec3| middle + own.offset_m + own.scale * (turn * (scale * in_head_axes(p) + shift - middle));
    let mut groom = PlacedGroom {
        first_point: file.first_point.clone(),
        points: file.points.par_iter().with_min_len(4096).map(|&p| place(p)).collect(),
        metres_per_unit: orientation.metres_per_unit,
        fitted_scale: scale,
        mean_root_gap_m: 0.0,
        inside: (0, 0.0),
    };
    if settings.snap_roots {
        let strands = groom.strands();
        let roots: Vec<Vec3> = (0..strands).map(|strand| groom.strand(strand)[0]).collect();
        let shifts = shifts(&roots, &skin);
        groom.inside = inside(&roots, &shifts, body, middle);
        groom.mean_root_gap_m = shifts.iter().map(|shift| shift.length()).sum::<f32>() / strands as f32;
        for (strand, shift) in shifts.into_iter().enumerate() {
            let span = groom.first_point[strand] as usize..groom.first_point[strand + 1] as usize;
            for point in &mut groom.points[span] {
                *point += shift;
            }
        }
    }
    if let Some(body) = body {
        push_out(&mut groom, body);
    }
    Ok(groom)
}

/// A root this far inside the head is counted, metres; less is within the error of a fit.
const INSIDE: f32 = 0.003;

/// How many roots are inside the head, and the depth of the deepest. `shifts` move them onto the skin; without a body, those that move them away
/// from the middle of the head start inside.
fn inside(roots: &[Vec3], shifts: &[Vec3], body: Option<&dyn Obstacle>, middle: Vec3) -> (usize, f32) {
    let depths = roots.par_iter().zip(shifts).with_min_len(256).map(|(&root, &shift)| {
        let depth = match body {
            Some(body) => -body.distance(root).0,
            None => shift.dot((root + shift - middle).normalize_or_zero()),
        };
        // The distance to a body is approximate deep inside; the root moves by its shift.
        depth.min(shift.length())
    });
    let deep = depths.filter(|depth| *depth > INSIDE);
    deep.fold(|| (0, 0.0_f32), |(count, most), depth| (count + 1, most.max(depth)))
        .reduce(|| (0, 0.0), |a, b| (a.0 + b.0, a.1.max(b.1)))
}

/// The centre of the sphere that approximates a scalp.
fn middle_of(skin: &Surface) -> Vec3 {
    let corners: Vec<Vec3> = skin.corners().collect();
    fit_sphere(&corners).map_or_else(
        || {
            let mut bounds = Bounds::EMPTY;
            for &corner in &corners {
                bounds.include(corner);
            }
            bounds.centre()
        },
        |sphere| sphere.centre,
    )
}

fn check_size(file: &HairFile, metres_per_unit: f32) -> Result<(), ImportError> {
    let size_m = file.bounds.size().max_element() * metres_per_unit;
    let far_m = file.bounds.min.abs().max(file.bounds.max.abs()).max_element() * metres_per_unit;
    // Far from the file's origin, single precision is coarse: 1e-5 of the size at a distance of 100 sizes.
    if (1e-5..=100.0).contains(&size_m) && far_m.is_finite() {
        Ok(())
    } else {
        Err(ImportError::Size { name: file.name.clone(), size_m })
    }
}

/// Clearance between a strand and the body, metres; near the root, a fraction of the distance from it.
const CLEARANCE: f32 = 0.002;
const RISE: f32 = 0.25;
/// The largest assumed rate of change of the distance along a strand.
const SLOPE: f32 = 1.5;
/// Deep inside, the distance to a body's surface is approximate; this many pushes are enough.
const PUSHES: usize = 4;

/// Moves points that are inside the body, or too close to it, away from it; roots stay in place.
fn push_out(groom: &mut PlacedGroom, body: &dyn Obstacle) {
    let distances: Vec<f32> =
        groom.points.par_iter().with_min_len(1024).map(|&point| body.distance(point).0).collect();
    let mut clearance = vec![0.0; groom.points.len()];
    for &[start, end] in groom.first_point.array_windows() {
        let (start, end) = (start as usize, end as usize);
        let step = |i: usize| groom.points[i].distance(groom.points[i - 1]);
        let (mut run, mut least) = (0.0, distances[start]);
        for i in start + 1..end {
            run += step(i);
            // A distance changes no faster than the position, apart from being approximate. A point that is suddenly
            // deep inside has a wrong sign, as open meshes can have, and stays in place.
            least -= SLOPE * step(i);
            let after = if i + 1 < end { distances[i + 1] - SLOPE * step(i + 1) } else { least };
            if distances[i] >= least.max(after) - CLEARANCE {
                least = distances[i];
                clearance[i] = CLEARANCE.min(RISE * run);
            }
        }
    }
    let wanting = groom.points.par_iter_mut().zip(clearance).zip(distances).with_min_len(1024);
    wanting.filter(|((_, clearance), distance)| distance < clearance).for_each(|((point, clearance), _)| {
        for _ in 0..PUSHES {
            let (distance, outward) = body.distance(*point);
            let push = (clearance - distance) * outward;
            if clearance == 0.0 || distance >= clearance || !push.is_finite() {
                break;
            }
            *point += push;
        }
    });
}
