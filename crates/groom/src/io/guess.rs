//! Estimates the unit and axes of a hair file, which few hair formats state.
//!
//! The unit uses what all heads have in common: a scalp is about 0.15 m across. The axes are found by [`StrandAxes`].

use glam::Vec3;

use super::file::HairFile;
use super::root_shape::RootShape;
use super::strand_axes::StrandAxes;
use super::units::{Facing, Unit, UpAxis};

/// A guess whose probability is lower than this is in doubt.
pub const SURE: f32 = 0.9;
/// Strands contradict an axis that a file states if they show another one with this probability.
const CONTRADICTION: f32 = 0.99;

/// The estimate of [`guess_units`].
#[derive(Clone, Debug, PartialEq)]
pub struct UnitGuess {
    /// Length of one unit of the file, metres.
    pub metres_per_unit: f32,
    /// The named unit of this length; `None` if the groom was scaled to the size of a head.
    pub unit: Option<Unit>,
    /// How sure the unit is, 0 to 1; 1 where the file states it.
    pub unit_confidence: f32,
    /// The axis that points up; never `Auto`.
    pub up: UpAxis,
    /// Probability that it does, 0 to 1; 1 where the file states it.
    pub up_confidence: f32,
    /// The axis that the strands show instead, if they clearly contradict the file.
    pub contradicting_up: Option<UpAxis>,
    /// The axis of the file along which the face looks; never `Auto`.
    pub facing: Facing,
    /// Probability that it does, 0 to 1. No format states it.
    pub facing_confidence: f32,
    /// Size of the groom's box in that unit, file axes, metres.
    pub size_m: Vec3,
    /// The reason for the unit, as a sentence.
    pub reason: String,
}

impl UnitGuess {
    /// Whether the up axis should be asked for.
    pub fn is_up_in_doubt(&self) -> bool {
        self.up_confidence < SURE
    }

    /// What a person should know about the up axis, as a sentence.
    pub fn note_on_up(&self) -> Option<String> {
        let axes = "`--up` or the setting *Up axis* changes it";
        if let Some(shown) = self.contradicting_up {
            return Some(format!(
                "The file states that {} points up, but its strands hang as if {} did; {axes}.",
                self.up.label(),
                shown.label()
            ));
        }
        self.is_up_in_doubt().then(|| {
            format!(
                "The up axis is in doubt: {} is a guess of {:.0} %; {axes}.",
                self.up.label(),
                100.0 * self.up_confidence
            )
        })
    }
}

/// Estimates the unit, the up axis and the direction of the face.
///
/// Unit: that of the program that wrote the file, then the first of metre, centimetre, millimetre and inch, that makes the roots span
/// 0.09 to 0.30 m. If none does, the roots are scaled to span 0.15 m, the width of an adult scalp. The span is the middle one of the
/// three sides of the roots' box, so that neither the length of a mohawk nor the height of a fringe counts.
///
/// Axes: `StrandAxes`. A file that states its unit and axes is in metres with Y up already.
pub fn guess_units(file: &HairFile) -> UnitGuess {
    let roots = RootShape::of(file);
    let axes = StrandAxes::of(file, &roots);
    let shown = axes.up();
    let (up, up_confidence) = if file.is_in_metres { (UpAxis::Y, 1.0) } else { (shown.is, shown.confidence) };
    let facing = axes.facing(up);
    let (metres_per_unit, unit, unit_confidence, reason) = unit_of(file, &roots);
    UnitGuess {
        metres_per_unit,
        unit,
        unit_confidence,
        up,
        up_confidence,
        contradicting_up: (shown.is != up && shown.confidence > CONTRADICTION).then_some(shown.is),
        facing: facing.is,
        facing_confidence: facing.confidence,
        size_m: file.bounds.size() * metres_per_unit,
        reason,
    }
}

/// The axis that the face looks along if `up` points up, and its probability.
pub(crate) fn guess_facing(file: &HairFile, up: UpAxis) -> (Facing, f32) {
    let facing = StrandAxes::of(file, &RootShape::of(file)).facing(up);
    (facing.is, facing.confidence)
}

/// Metres per unit, the unit's name, how sure it is, and the reason.
fn unit_of(file: &HairFile, roots: &RootShape) -> (f32, Option<Unit>, f32, String) {
    if file.is_in_metres {
        return (1.0, Some(Unit::Metre), 1.0, "The file states its unit.".to_owned());
    }
    let units = || file.written_unit.into_iter().chain(Unit::NAMED);
    let fitting = |size: f32, range: std::ops::RangeInclusive<f32>| {
        let mut fitting = units().filter_map(|unit| Some((unit, unit.metres()?)));
        let fits = |(_, metres): &(Unit, f32)| range.contains(&(metres * size));
        let first = fitting.find(fits);
        let others = fitting.filter(fits).any(|(unit, _)| first.is_some_and(|(first, _)| first != unit));
        let sure = match first {
            Some((unit, _)) if file.written_unit == Some(unit) => 0.98,
            _ if others => 0.6,
            _ => 0.95,
        };
        first.map(|(unit, metres)| (unit, metres, sure))
    };
    let span = roots.span();
    // Roots closer together than the rounding of the hair's coordinates are in one place.
    if span > 1e-6 * file.bounds.size().max_element() {
        let across = "0.09 to 0.30 m across";
        if let Some((unit, metres, sure)) = fitting(span, 0.09..=0.30) {
            let word = unit.word();
            let reason =
                format!("The roots span {span:.3} units; at one {word} per unit that is a scalp, {across}.");
            return (metres, Some(unit), sure, reason);
        }
        let reason = format!(
            "The roots span {span:.3} units, which is not {across} in any usual unit: scaled to 0.15 m."
        );
        return (0.15 / span, None, 0.3, reason);
    }
    // All roots are in one place, so only the length of the hair can be used.
    let length = file.bounds.size().max_element();
    match fitting(length, 0.05..=1.5) {
        Some((unit, metres, _)) => {
            (metres, Some(unit), 0.5, format!("One root; the hair is {length:.3} {} long.", unit.id()))
        }
        None => (
            0.25 / length,
            None,
            0.2,
            format!("One root, and hair {length:.3} units long: scaled to 0.25 m."),
        ),
    }
}
