//! Which axes of a file point up and forward, by what its strands show.
//!
//! Every direction along an axis gets a score from four observations, and the scores become probabilities:
//!
//! - **Dome.** The roots of a head cover the top and the back of a sphere.
//! - **Fall.** Hair bends away from its root's normal and ends downward. Hair that is short beside its head is combed rather than
//!   pulled by gravity, and so is the coat of a body that is no sphere: both count less.
//! - **Mirror.** Roots are alike on the left and on the right, and differ between front and back and between top and bottom. The
//!   axis of the mirror is therefore neither up nor forward.
//! - **Custom.** Most files of a format, or of the program that wrote them, have the same axis up.
//!
//! Where the dome and the fall contradict each other, the guess is in doubt.
//!
//! The weights were chosen by the shipped hairstyles and real files, each rotated in all 24 ways: `docs/file_formats.md` lists the
//! outcome.

use glam::{DVec3, Vec3};
use lovelock_base::statistics::upper_median_by;

use super::file::HairFile;
use super::root_shape::{RootShape, samples};
use super::units::{Facing, UpAxis, usual_facing};

/// Log-odds per unit of score.
const SHARPNESS: f32 = 8.0;
/// Roots that are this fraction of the radius away from their sphere, in the mean, do not lie on it.
const ROUND: f32 = 0.2;
/// Weight of the fall where the roots lie on no sphere, as on an animal.
const FALL_OF_BODY: f32 = 0.4;
/// Roots whose mean is farther than this from the middle of their sphere, in radii, are a patch of a head.
const PATCH: f32 = 0.6;
/// Half of the strands' count at which their fall has half its weight.
const FEW: f32 = 8.0;
/// An axis is that of the mirror if the roots fit their image this much better than that of the next axis.
const CLEARLY_ALIKE: f32 = 0.6;
/// Score of the axis of the mirror, which is neither up nor forward.
const ACROSS: f32 = -0.35;
/// A guess is contradicted by a dome or a fall that points away from it by this much.
const CONTRADICTED: f32 = 0.1;
/// The most that a guess is probable then.
const DOUBTFUL: f32 = 0.6;
/// Most roots that are compared with their mirror image.
const MIRRORED: usize = 384;

/// What the strands of a file show about its axes.
#[derive(Clone, Debug)]
pub(crate) struct StrandAxes {
    /// Mean normal of the roots on their sphere, weighted by how well it is known.
    dome: Vec3,
    /// Mean direction in which strands turn and end, weighted likewise.
    fall: Vec3,
    /// The axis across which the roots are mirrored, if one stands out.
    mirror: Option<usize>,
    /// The usual axis of the format.
    common: UpAxis,
    /// The usual axis of the program that wrote the file, if it is known.
    written: Option<UpAxis>,
}

/// A direction with its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Likely<T> {
    pub(crate) is: T,
    pub(crate) confidence: f32,
}

impl StrandAxes {
    pub(crate) fn of(file: &HairFile, roots: &RootShape) -> Self {
        let strands: Vec<&[Vec3]> = samples(file).collect();
        let starts: Vec<Vec3> = strands.iter().map(|strand| strand[0]).collect();
        let round = roots.sphere.map_or(0.0, |sphere| (1.0 - sphere.residual / ROUND).max(0.0));
        let normal = |root: Vec3| {
            roots
                .sphere
                .map_or(Vec3::ZERO, |sphere| ((root - sphere.centre) / sphere.radius).normalize_or_zero())
        };
        let dome = mean(starts.iter().map(|&root| normal(root)));
        let patch = (1.0 - 2.5 * (dome.length() - PATCH).max(0.0)).max(0.3);

        let fall = mean(strands.iter().map(|strand| {
            let (root, tip) = (strand[0], strand[strand.len() - 1]);
            let along = (tip - root).normalize_or_zero();
            let out = normal(root);
            let late = tip - strand[strand.len() - 1 - ((strand.len() - 1) / 4).max(1)];
            0.5 * (along - out * along.dot(out) + late.normalize_or_zero())
        }));
        let mut lengths: Vec<f32> = strands.iter().map(|strand| length(strand)).collect();
        let usual = upper_median_by(&mut lengths, f32::total_cmp).unwrap_or_default();
        let long = (usual / (0.5 * roots.span()).max(f32::MIN_POSITIVE)).min(1.0);
        let many = strands.len() as f32 / (strands.len() as f32 + FEW);
        // Roots in a plane have no sphere, and are no body either.
        let of_head =
            roots.sphere.map_or(1.0, |_| FALL_OF_BODY + (1.0 - FALL_OF_BODY) * (4.0 * round).min(1.0));
        Self {
            dome: round * patch * dome,
            fall: long * many * of_head * fall,
            mirror: mirror(&starts, roots),
            common: file.common_up,
            written: file.written_up,
        }
    }

    /// The axis that points up.
    pub(crate) fn up(&self) -> Likely<UpAxis> {
        let scores = UpAxis::AXES.map(|up| {
            let direction = up.direction();
            let custom = if self.written == Some(up) {
                5.0
            } else if up == self.common {
                1.0
            } else if matches!(up, UpAxis::Y | UpAxis::Z) {
                0.3
            } else {
                -0.5
            };
            (
                up,
                SHARPNESS * (self.dome - self.fall).dot(direction)
                    + SHARPNESS * self.across(direction)
                    + custom,
            )
        });
        let mut likely = likeliest(&scores);
        if self.contradicts(likely.is.direction()) {
            likely.confidence = likely.confidence.min(DOUBTFUL);
        }
        likely
    }

    /// Whether the dome or the fall contradicts this direction as up: hair that stands up or is blown, or a head that hangs. One of the two
    /// misleads then, and nothing says which.
    fn contradicts(&self, up: Vec3) -> bool {
        self.dome.dot(up) < -CONTRADICTED || self.fall.dot(up) > CONTRADICTED
    }

    /// The axis that the face looks along, where `up` points up: hair grows lower at the back and leans back.
    pub(crate) fn facing(&self, up: UpAxis) -> Likely<Facing> {
        let scores: Vec<_> = (Facing::AXES.into_iter().filter(|facing| facing.is_square_to(up)))
            .map(|facing| {
                let direction = facing.direction();
                // Heads that are rotated in their file are rarer than hair that is not alike on both sides.
                let custom = if facing == usual_facing(up) {
                    0.5
                } else if direction.dot(usual_facing(up).direction()) == 0.0 {
                    -1.0
                } else {
                    0.0
                };
                let shown = -(self.dome + self.fall).dot(direction) + self.across(direction);
                (facing, SHARPNESS * shown + custom)
            })
            .collect();
        likeliest(&scores)
    }

    fn across(&self, direction: Vec3) -> f32 {
        if self.mirror.is_some_and(|axis| direction[axis] != 0.0) { ACROSS } else { 0.0 }
    }
}

/// The largest of some log-odds, with its probability among them.
fn likeliest<T: Copy>(scores: &[(T, f32)]) -> Likely<T> {
    let mut best = scores[0];
    for &score in &scores[1..] {
        if score.1 > best.1 {
            best = score;
        }
    }
    let sum: f32 = scores.iter().map(|(_, score)| (score - best.1).exp()).sum();
    Likely { is: best.0, confidence: 1.0 / sum }
}

/// The axis across which the roots are most alike, if it stands out: by the mean distance from a mirrored root to the nearest one.
fn mirror(roots: &[Vec3], shape: &RootShape) -> Option<usize> {
    let size = shape.bounds.size().length();
    if roots.len() < 16 || size <= 0.0 {
        return None;
    }
    let few: Vec<Vec3> = roots.iter().step_by(roots.len().div_ceil(MIRRORED)).copied().collect();
    let mut axes: Vec<(usize, f32)> = (0..3)
        .map(|axis| {
            let middle = shape.bounds.centre()[axis];
            let gap = |root: &Vec3| {
                let mut image = *root;
                image[axis] = 2.0 * middle - image[axis];
                few.iter().map(|other| other.distance_squared(image)).fold(f32::INFINITY, f32::min).sqrt()
            };
            (axis, few.iter().map(gap).sum::<f32>() / few.len() as f32)
        })
        .collect();
    axes.sort_by(|a, b| a.1.total_cmp(&b.1));
    (axes[0].1 < CLEARLY_ALIKE * axes[1].1).then_some(axes[0].0)
}

fn length(points: &[Vec3]) -> f32 {
    points.array_windows().map(|[a, b]| a.distance(*b)).sum()
}

fn mean(vectors: impl Iterator<Item = Vec3>) -> Vec3 {
    let (sum, count) = vectors.fold((DVec3::ZERO, 0_u32), |(sum, n), v| (sum + v.as_dvec3(), n + 1));
    (sum / f64::from(count.max(1))).as_vec3()
}
