//! Corrections of the fitted scalp.

use std::f32::consts::PI;

use glam::{Quat, Vec3};
use lovelock_base::direction_map::DirectionMap;
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// Where hair grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScalpArea {
    /// Within a hairline on the head.
    #[default]
    Head,
    /// On the whole skin, as fur; of a file with a mask, where that marks it.
    Skin,
}

impl Choices for ScalpArea {
    const ALL: &'static [Self] = &[Self::Head, Self::Skin];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Head => ("head", "Head"),
            Self::Skin => ("skin", "Whole skin"),
        }
    }
}

/// What a person changed about the scalp that was fitted to a head. The default is the automatic fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ScalpFit {
    /// Where hair grows.
    pub area: ScalpArea,
    /// Moves the scalp toward the face, as a fraction of half the skull.
    pub forward: f32,
    /// Moves the scalp up, in the same measure.
    pub up: f32,
    /// Turns the scalp toward the face, radians.
    pub nod: f32,
    /// Width of the scalp as a multiple of the fit.
    pub width: f32,
    /// Size of lengths, partings and ties as a multiple of the fit.
    pub size: f32,
    /// How far the hairline is raised at each of [`ScalpFit::PLACES`], radians; negative lowers it.
    pub raise: Raise,
    /// Where hair grows beyond the outline; directions from the middle of the skull.
    pub added: DirectionMap,
    /// Where none grows within it.
    pub removed: DirectionMap,
    /// Whether the skull is where [`ScalpFit::middle`] says, in place of where it was found.
    pub by_hand: bool,
    /// The middle of the skull of the body at rest, world space, metres.
    pub middle: Vec3,
    /// Height of the skull, metres.
    pub skull_height: f32,
}

impl Default for ScalpFit {
    fn default() -> Self {
        Self {
            area: ScalpArea::Head,
            forward: 0.0,
            up: 0.0,
            nod: 0.0,
            width: 1.0,
            size: 1.0,
            raise: Raise::default(),
            added: DirectionMap::default(),
            removed: DirectionMap::default(),
            by_hand: false,
            middle: Vec3::new(0.0, 1.5, 0.05),
            skull_height: 0.16,
        }
    }
}

/// How far the hairline is raised around the head, radians; negative lowers it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Raise {
    /// At the middle of the forehead.
    pub front: f32,
    /// At the corners of the forehead.
    pub corner: f32,
    /// At the temples.
    pub temple: f32,
    /// Before the ears.
    pub before_ear: f32,
    /// Above the ears.
    pub above_ear: f32,
    /// Behind the ears.
    pub behind_ear: f32,
    /// At the nape.
    pub nape: f32,
}

impl Raise {
    fn all(&self) -> [f32; 7] {
        [self.front, self.corner, self.temple, self.before_ear, self.above_ear, self.behind_ear, self.nape]
    }

    /// The value at place `i` of [`ScalpFit::PLACES`].
    pub fn at_mut(&mut self, i: usize) -> Option<&mut f32> {
        let all: [&mut f32; 7] = [
            &mut self.front,
            &mut self.corner,
            &mut self.temple,
            &mut self.before_ear,
            &mut self.above_ear,
            &mut self.behind_ear,
            &mut self.nape,
        ];
        all.into_iter().nth(i)
    }
}

/// Places of the skull, metres.
const PLACES: [f64; 2] = [-10.0, 10.0];
/// How far the hairline can be raised, radians.
const RAISE: [f64; 2] = [-0.7, 0.7];

impl ScalpFit {
    /// Names and angles from the front, degrees, of the places where the hairline can be raised. Both sides move alike.
    pub const PLACES: [(&'static str, f32); 7] = [
        ("front", 0.0),
        ("corner of the forehead", 28.0),
        ("temple", 52.0),
        ("before the ear", 78.0),
        ("above the ear", 100.0),
        ("behind the ear", 130.0),
        ("nape", 180.0),
    ];

    /// Whether nothing is changed.
    pub fn is_automatic(&self) -> bool {
        self.area == ScalpArea::Head
            && !self.moves_outline()
            && self.size == 1.0
            && !self.is_painted()
            && !self.by_hand
    }

    /// Whether the outline is moved, as opposed to painted.
    pub fn moves_outline(&self) -> bool {
        let plain = Self::default();
        (self.forward, self.up, self.nod, self.width, self.raise)
            != (plain.forward, plain.up, plain.nod, plain.width, plain.raise)
    }

    /// Whether something is painted.
    pub fn is_painted(&self) -> bool {
        !self.added.is_empty() || !self.removed.is_empty()
    }

    /// The fit with every number in its range.
    #[must_use]
    pub fn clamped(&self) -> Self {
        Settings::clamped(self)
    }

    /// Raises the hairline at place `i` of [`ScalpFit::PLACES`] by `by` radians.
    pub fn raise_at(&mut self, i: usize, by: f32) {
        if let Some(raise) = self.raise.at_mut(i) {
            let to = *raise + by;
            *raise = if to.is_finite() { to.clamp(RAISE[0] as f32, RAISE[1] as f32) } else { 0.0 };
        }
    }

    /// How far the hairline is raised at an angle from the front of 0 to π, radians.
    pub(super) fn raised(&self, azimuth: f32) -> f32 {
        let degrees = azimuth.to_degrees();
        let next = Self::PLACES.iter().position(|(_, at)| *at >= degrees).unwrap_or(6).max(1);
        let (from, to) = (Self::PLACES[next - 1].1, Self::PLACES[next].1);
        let t = ((degrees - from) / (to - from)).clamp(0.0, 1.0);
        // Level at each place, so that the outline has no corners.
        let t = 0.5 - 0.5 * (PI * t).cos();
        let raise = self.raise.all();
        raise[next - 1] + (raise[next] - raise[next - 1]) * t
    }

    /// The direction of the outline to which a direction from the skull's middle corresponds; both are relative to the skull.
    pub(super) fn to_outline(&self, direction: Vec3) -> Vec3 {
        let moved = direction - Vec3::new(0.0, self.up, self.forward);
        Quat::from_rotation_x(-self.nod) * (moved / Vec3::new(self.width, 1.0, 1.0))
    }

    /// The mask at a direction relative to the skull, from that of the outline.
    pub(super) fn painted(&self, direction: Vec3, outline: f32) -> f32 {
        outline.max(self.added.at(direction)) * (1.0 - self.removed.at(direction))
    }

    /// Paints hair, or removes it, in a cone around a direction relative to the skull. `radius` is the angle of the cone, and `amount`
    /// the strength in its middle, 0 to 1.
    pub fn paint(&mut self, direction: Vec3, radius: f32, amount: f32, removes: bool) {
        let Some(middle) = direction.try_normalize() else { return };
        let radius = radius.clamp(0.01, PI);
        let brush = |at: Vec3| {
            let away = at.dot(middle).clamp(-1.0, 1.0).acos() / radius;
            amount.clamp(0.0, 1.0) * (1.5 * (1.0 - away)).clamp(0.0, 1.0)
        };
        let (more, less) =
            if removes { (&mut self.removed, &mut self.added) } else { (&mut self.added, &mut self.removed) };
        more.paint(|at, old| old.max(brush(at)));
        if !less.is_empty() {
            less.paint(|at, old| old.min(1.0 - brush(at)));
        }
    }
}

impl Settings for ScalpFit {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<ScalpArea>(
            field!(Self, area),
            "Hair grows on",
            "Where hair grows: on the head, within the hairline, or on the whole skin, as fur. Fur moves rigidly with \
             the head joint, so it suits a body at rest.",
        ),
        Setting::number(
            field!(Self, forward),
            [-0.6, 0.6],
            "Forward",
            "Moves the scalp toward the face, as a fraction of half the skull.",
        ),
        Setting::number(
            field!(Self, up),
            [-0.6, 0.6],
            "Up",
            "Moves the scalp up, as a fraction of half the skull.",
        ),
        Setting::number(field!(Self, nod), [-1.6, 1.6], "Nod", "Turns the scalp down toward the face.")
            .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, width),
            [0.5, 2.0],
            "Width",
            "Width of the scalp. Wider lowers the hairline at the sides.",
        )
        .unit(Unit::FRACTION),
        Setting::switch(
            field!(Self, by_hand),
            "Place by hand",
            "Puts the scalp around a skull at a place of your choice, on bodies whose head is not found.",
        ),
        Setting::vector(
            field!(Self, middle),
            PLACES,
            "Place",
            ["Sideways", "Upward", "Forward"],
            "Middle of the skull around which the scalp is placed by hand, on the body at rest: to its left, up from its feet, and to \
             the front.",
        )
        .unit(Unit::METRES),
        Setting::number(
            field!(Self, skull_height),
            [0.02, 2.0],
            "Skull height",
            "Height of the skull around which the scalp is placed by hand. That of an adult is 16 cm.",
        )
        .unit(Unit::METRES)
        .logarithmic()
        .decimals(3),
        Setting::number(
            field!(Self, size),
            [0.2, 5.0],
            "Hair size",
            "Size of the hair on this head: lengths, partings, curls, ties and the width of strands. 100 % \
             gives the hair of an adult's head, in proportion.",
        )
        .unit(Unit::FRACTION)
        .logarithmic(),
        Setting::number(field!(Self, raise.front), RAISE, "Front", "Raises the hairline at the forehead.")
            .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, raise.corner),
            RAISE,
            "Corners",
            "Raises the hairline at the corners of the forehead.",
        )
        .unit(Unit::RADIANS),
        Setting::number(field!(Self, raise.temple), RAISE, "Temples", "Raises the hairline at the temples.")
            .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, raise.before_ear),
            RAISE,
            "Before the ears",
            "Raises the hairline before the ears.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, raise.above_ear),
            RAISE,
            "Above the ears",
            "Raises the hairline above the ears.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, raise.behind_ear),
            RAISE,
            "Behind the ears",
            "Raises the hairline behind the ears.",
        )
        .unit(Unit::RADIANS),
        Setting::number(field!(Self, raise.nape), RAISE, "Nape", "Raises the hairline at the nape.")
            .unit(Unit::RADIANS),
    ];
}
