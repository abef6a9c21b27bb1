//! Unit and axes of a hair file, which no hair format states: settings for them, and a guess.
//!
//! The guess rests on what all heads share: a scalp is about 0.15 m across, hair hangs down and back, and
//! there is none on the face.

use glam::{DMat4, DVec3, DVec4, Mat3, Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::{Bounds, HairFile, HairFormat};

/// The unit of a file's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Unit {
    /// As [`guess_units`] says.
    #[default]
    Auto,
    /// 1 m.
    Metre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
    /// 0.0254 m.
    Inch,
    /// Metres a unit, 1e-12 to 1e12.
    Custom(f32),
}

impl Unit {
    /// The units that have a name, in the order in which they are tried.
    pub const NAMED: [Self; 4] = [Self::Metre, Self::Centimetre, Self::Millimetre, Self::Inch];

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
            Self::Custom(_) => "custom",
        }
    }

    /// The word for it in sentences.
    fn word(self) -> &'static str {
        match self {
            Self::Metre => "metre",
            Self::Centimetre => "centimetre",
            Self::Millimetre => "millimetre",
            Self::Inch => "inch",
            Self::Auto | Self::Custom(_) => "unit of its own",
        }
    }

    /// The unit of that [`Self::id`], except for custom ones.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::NAMED.into_iter().chain([Self::Auto]).find(|unit| unit.id() == id)
    }

    /// Metres a unit; none for [`Self::Auto`] and for custom units that are no positive number.
    pub fn metres(self) -> Option<f32> {
        match self {
            Self::Auto => None,
            Self::Metre => Some(1.0),
            Self::Centimetre => Some(0.01),
            Self::Millimetre => Some(0.001),
            Self::Inch => Some(0.0254),
            Self::Custom(metres) => (1e-12..=1e12).contains(&metres).then_some(metres),
        }
    }
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// As [`guess_units`] says.
    #[default]
    Auto,
    /// +Y, as in TressFX.
    Y,
    /// +Z, as in the known `.hair` files.
    Z,
}

impl UpAxis {
    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    /// The axis of that [`Self::id`].
    pub fn from_id(id: &str) -> Option<Self> {
        [Self::Auto, Self::Y, Self::Z].into_iter().find(|up| up.id() == id)
    }

    fn direction(self) -> Vec3 {
        if self == Self::Z { Vec3::Z } else { Vec3::Y }
    }
}

/// Toward which axis of a file the face looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Facing {
    /// As [`guess_units`] says.
    #[default]
    Auto,
    /// +X.
    PlusX,
    /// -X.
    MinusX,
    /// +Y, of files with Z up.
    PlusY,
    /// -Y, of files with Z up.
    MinusY,
    /// +Z, of files with Y up.
    PlusZ,
    /// -Z, of files with Y up.
    MinusZ,
}

impl Facing {
    /// Every way to face, after `Auto`.
    pub const AXES: [Self; 6] =
        [Self::PlusX, Self::MinusX, Self::PlusY, Self::MinusY, Self::PlusZ, Self::MinusZ];

    /// Stable name for command lines and reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
            Self::PlusZ => "+z",
            Self::MinusZ => "-z",
        }
    }

    /// The axis of that [`Self::id`].
    pub fn from_id(id: &str) -> Option<Self> {
        Self::AXES.into_iter().chain([Self::Auto]).find(|facing| facing.id() == id)
    }

    pub(crate) fn is_square_to(self, up: UpAxis) -> bool {
        self.direction().dot(up.direction()) == 0.0
    }

    fn direction(self) -> Vec3 {
        match self {
            Self::PlusX => Vec3::X,
            Self::MinusX => Vec3::NEG_X,
            Self::PlusY => Vec3::Y,
            Self::MinusY => Vec3::NEG_Y,
            Self::Auto | Self::PlusZ => Vec3::Z,
            Self::MinusZ => Vec3::NEG_Z,
        }
    }
}

/// What [`guess_units`] makes of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitGuess {
    /// Length of one unit of the file, metres.
    pub metres_per_unit: f32,
    /// The named unit that this is; none where the groom was scaled to the size of a head.
    pub unit: Option<Unit>,
    /// Which axis points up: `Y` or `Z`.
    pub up: UpAxis,
    /// Where the face looks, in the axes of the file; never `Auto`.
    pub facing: Facing,
    /// Size of the groom's box in that unit, file axes, metres.
    pub size_m: Vec3,
    /// Why, in a sentence for people.
    pub reason: String,
}

/// Guesses the unit, the up axis and the direction of the face.
///
/// The unit: the first of metre, centimetre, millimetre and inch that makes the roots span 0.09 to 0.30 m;
/// where none does, the roots are scaled to span 0.15 m, the width of an adult scalp. The span is the
/// middle one of the root box's three sides, so that neither a mohawk's length nor a fringe's height counts.
///
/// USD says both, and its points are in metres with Y up already.
///
/// Up: Z for `.hair` and Y for TressFX, unless the strands clearly hang along the other axis.
///
/// The face: hair leans away from it, and grows lower at the back of a head than at its front.
pub fn guess_units(file: &HairFile) -> UnitGuess {
    let roots = RootShape::of(file);
    let up = guess_up(file, &roots);
    let facing = guess_facing(file, up);
    let span = roots.span();
    let across = "0.09 to 0.30 m across";
    let (metres_per_unit, unit, reason) = if file.format == HairFormat::Usd {
        (1.0, Some(Unit::Metre), "The file says its unit.".to_owned())
    } else if span > 0.0 {
        let named = Unit::NAMED
            .into_iter()
            .find(|unit| unit.metres().is_some_and(|metres| (0.09..=0.30).contains(&(metres * span))));
        match named.and_then(|unit| Some((unit, unit.metres()?))) {
            Some((unit, metres)) => (
                metres,
                Some(unit),
                format!(
                    "The roots span {span:.3} units; at one {} a unit that is a scalp, {across}.",
                    unit.word()
                ),
            ),
            None => (
                0.15 / span,
                None,
                format!("The roots span {span:.3} units, in no usual unit {across}: scaled to 0.15 m."),
            ),
        }
    } else {
        // All roots in one place: the length of the hair is all there is to go by.
        let length = file.bounds.size().max_element();
        let named = Unit::NAMED
            .into_iter()
            .find(|unit| unit.metres().is_some_and(|m| (0.05..=1.5).contains(&(m * length))));
        match named.and_then(|unit| Some((unit, unit.metres()?))) {
            Some((unit, metres)) => {
                (metres, Some(unit), format!("One root; the hair is {length:.3} {} long.", unit.id()))
            }
            None => {
                (0.25 / length, None, format!("One root, and hair {length:.3} units long: scaled to 0.25 m."))
            }
        }
    };
    UnitGuess { metres_per_unit, unit, up, facing, size_m: file.bounds.size() * metres_per_unit, reason }
}

/// The rotation that carries file axes to head axes: `up` to +Y, `facing` to +Z. A facing along `up` counts
/// as the usual one.
pub(crate) fn rotation_to_head_axes(up: UpAxis, facing: Facing) -> Quat {
    let up_direction = up.direction();
    let mut forward = facing.direction();
    if facing == Facing::Auto || !facing.is_square_to(up) {
        forward = usual_facing(up).direction();
    }
    let file_from_head = Mat3::from_cols(up_direction.cross(forward), up_direction, forward);
    Quat::from_mat3(&file_from_head.transpose())
}

/// +Y where Z is up, +Z where Y is.
fn usual_facing(up: UpAxis) -> Facing {
    if up == UpAxis::Z { Facing::PlusY } else { Facing::PlusZ }
}

/// The strands to judge a groom by: at most this many, evenly spaced.
const SAMPLES: usize = 4096;

fn samples(file: &HairFile) -> impl Iterator<Item = &[Vec3]> {
    (0..file.strands()).step_by(file.strands().div_ceil(SAMPLES)).map(|strand| file.strand(strand))
}

/// Z or Y: the axis that the strands hang along and the roots dome toward, where that is clear.
fn guess_up(file: &HairFile, roots: &RootShape) -> UpAxis {
    if file.format == HairFormat::Usd {
        return UpAxis::Y;
    }
    let usual = match file.format {
        HairFormat::Yuksel => UpAxis::Z,
        HairFormat::TressFx3(_) | HairFormat::TressFx4(_) | HairFormat::Usd => UpAxis::Y,
    };
    let hang = mean(samples(file).map(|strand| (strand[strand.len() - 1] - strand[0]).normalize_or_zero()));
    let dome = roots.sphere.map_or(Vec3::ZERO, |sphere| {
        (mean(samples(file).map(|strand| strand[0])) - sphere.centre) / sphere.radius
    });
    let score = dome - hang;
    // Half a strand's length more is clear; the known grooms that hang at all differ by 0.7 or more.
    match (usual, score.z - score.y) {
        (UpAxis::Z, margin) if margin < -0.5 => UpAxis::Y,
        (UpAxis::Y, margin) if margin > 0.5 => UpAxis::Z,
        _ => usual,
    }
}

/// The horizontal axis that hair leans away from and that the higher roots lie toward.
pub(crate) fn guess_facing(file: &HairFile, up: UpAxis) -> Facing {
    let up = if up == UpAxis::Auto { guess_up(file, &RootShape::of(file)) } else { up };
    let up_direction = up.direction();
    let mut strands: Vec<&[Vec3]> = samples(file).collect();
    let lean = mean(strands.iter().map(|strand| strand[strand.len() - 1] - strand[0]));
    strands.sort_by(|a, b| a[0].dot(up_direction).total_cmp(&b[0].dot(up_direction)));
    let quarter = (strands.len() / 4).max(1);
    let lower = mean(strands[..quarter].iter().map(|strand| strand[0]));
    let upper = mean(strands[strands.len() - quarter..].iter().map(|strand| strand[0]));
    // The lean counts four times as much: a fringe alone has its lower roots in front, but still leans back.
    let toward_face = (upper - lower) - 4.0 * lean;
    let usual = usual_facing(up);
    let horizontal = Facing::AXES.into_iter().filter(|facing| facing.is_square_to(up));
    // Sideways only where that is much clearer: asymmetric hair is more common than a head turned in its file.
    let score = |facing: Facing| {
        let along = facing.direction().dot(toward_face);
        if facing.direction().dot(usual.direction()) == 0.0 { along / 3.0 } else { along }
    };
    let best = horizontal.fold(usual, |best, facing| if score(facing) > score(best) { facing } else { best });
    // Hair that leans nowhere tells nothing.
    let clear =
        0.02 * RootShape::of_points(&strands.iter().map(|strand| strand[0]).collect::<Vec<_>>()).span();
    if score(best) > clear { best } else { usual }
}

fn mean(points: impl Iterator<Item = Vec3>) -> Vec3 {
    let (sum, count) = points.fold((DVec3::ZERO, 0_u32), |(sum, n), p| (sum + p.as_dvec3(), n + 1));
    (sum / f64::from(count.max(1))).as_vec3()
}

/// A sphere fitted to points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f32,
    /// Root mean square distance of the points from it, as a fraction of the radius.
    pub(crate) residual: f32,
}

/// Where the roots of a groom lie, robust to a few strays.
#[derive(Clone, Debug)]
pub(crate) struct RootShape {
    /// Box of the roots without the outermost 1 in 1000 on either side of each axis.
    pub(crate) bounds: Bounds,
    pub(crate) sphere: Option<Sphere>,
}

impl RootShape {
    pub(crate) fn of(file: &HairFile) -> Self {
        Self::of_points(&samples(file).map(|strand| strand[0]).collect::<Vec<_>>())
    }

    pub(crate) fn of_points(points: &[Vec3]) -> Self {
        let mut bounds = Bounds::EMPTY;
        let strays = points.len() / 1000;
        for axis in 0..3 {
            let mut values: Vec<f32> = points.iter().map(|p| p[axis]).collect();
            values.sort_unstable_by(f32::total_cmp);
            if let Some(last) = values.len().checked_sub(1) {
                bounds.min[axis] = values[strays];
                bounds.max[axis] = values[last - strays];
            }
        }
        Self { bounds, sphere: fit_sphere(points) }
    }

    /// The middle side of the box, or the longest where the roots lie along a line.
    pub(crate) fn span(&self) -> f32 {
        let size = self.bounds.size();
        let longest = size.max_element();
        let middle = size.element_sum() - longest - size.min_element();
        if middle > 0.2 * longest { middle } else { longest }
    }
}

/// The sphere of least algebraic distance: |p|² = 2 c·p + (r² - |c|²) is linear in c and the bracket.
/// None for fewer than four points, or points in a plane.
pub(crate) fn fit_sphere(points: &[Vec3]) -> Option<Sphere> {
    let n = points.len() as f64;
    let middle = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / n;
    let size = points.iter().map(|p| (p.as_dvec3() - middle).abs().max_element()).fold(0.0, f64::max);
    if points.len() < 4 || size <= 0.0 {
        return None;
    }
    let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for p in points {
        let q = (p.as_dvec3() - middle) / size;
        let row = q.extend(1.0);
        normal += DMat4::from_cols(row * row.x, row * row.y, row * row.z, row);
        right += row * q.length_squared();
    }
    let (normal, right) = (normal * (1.0 / n), right / n);
    // Points within a hundredth of a plane leave a determinant of about 1e-5 of a ball's.
    if normal.determinant().abs() < 1e-7 {
        return None;
    }
    let solution = normal.inverse() * right;
    let centre = solution.truncate() / 2.0;
    let radius = (solution.w + centre.length_squared()).sqrt();
    let sum: f64 =
        points.iter().map(|p| (((p.as_dvec3() - middle) / size).distance(centre) - radius).powi(2)).sum();
    let residual = ((sum / n).sqrt() / radius) as f32;
    (radius.is_finite() && radius > 0.0).then(|| Sphere {
        centre: (middle + centre * size).as_vec3(),
        radius: (radius * size) as f32,
        residual,
    })
}
