//! Shortens and lengthens hair.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::guides::{self, GuideShape, Lengths, lengthen, reshape, shorten};
use crate::operate::{Kind, Operate, Subject};

/// The length to which hair can be lengthened, metres.
const LONGEST: f32 = 1.5;

/// How the new length is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthBy {
    /// A factor on its own length.
    #[default]
    Factor,
    /// A length that none exceeds.
    Limit,
    /// A plane below which nothing is left.
    Plane,
}

impl Choices for LengthBy {
    const ALL: &'static [Self] = &[Self::Factor, Self::Limit, Self::Plane];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Factor => ("factor", "By a factor"),
            Self::Limit => ("limit", "To a length"),
            Self::Plane => ("plane", "To a plane"),
        }
    }
}

/// Shortens hair, or lengthens it by a factor above 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Length {
    /// What decides the length.
    pub by: LengthBy,
    /// Factor on the length of hair.
    pub factor: f32,
    /// The longest hair, metres.
    pub limit: f32,
    /// Height of the plane over the middle of the head, metres.
    pub height: f32,
    /// How the plane rises toward the wearer's left, radians.
    pub tilt: f32,
    /// How the plane rises toward the face, radians.
    pub slope: f32,
    /// How much shorter the hair at the top of the head is, as a fraction.
    pub layers: f32,
    /// How much shorter a wisp may be by chance, as a fraction.
    pub variation: f32,
}

impl Default for Length {
    fn default() -> Self {
        Self {
            by: LengthBy::Factor,
            factor: 0.8,
            limit: 0.2,
            height: -0.15,
            tilt: 0.0,
            slope: 0.0,
            layers: 0.0,
            variation: 0.0,
        }
    }
}

impl Settings for Length {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<LengthBy>(field!(Self, by), "Cut", "How the new length is given."),
        Setting::number(
            field!(Self, factor),
            [0.0, 4.0],
            "Factor",
            "New length relative to the present one. Above 100 % hair becomes longer.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 2.0]),
        Setting::number(field!(Self, limit), [0.0, 1.5], "Longest", "Maximum length. Longer hair is cut to it.")
            .unit(Unit::METRES_AS_CM)
            .soft([0.0, 0.7]),
        Setting::number(
            field!(Self, height),
            [-1.5, 0.5],
            "Height",
            "Height of the cutting plane above the centre of the head. Hair ends where it first crosses the plane.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([-0.6, 0.1]),
        Setting::number(
            field!(Self, tilt),
            [-1.2, 1.2],
            "Tilt",
            "Sideways slope of the plane. Positive values rise toward the wearer's left.",
        )
        .unit(Unit::RADIANS),
        Setting::number(field!(Self, slope), [-1.2, 1.2], "Slope", "Slope of the plane. Positive values rise toward the face.")
            .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, layers),
            [0.0, 1.0],
            "Layers",
            "How much shorter hair at the top of the head is cut. 0 % is a blunt cut.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Variation",
            "Random shortening of locks. Higher values make the ends thinner.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Length {
    /// The part of a guide that remains where the layer acts; above 1 it is lengthened.
    fn part(&self, shape: &GuideShape, scope: &Scope<'_>) -> f32 {
        let mut part = match self.by {
            LengthBy::Factor => self.factor,
            LengthBy::Limit => (self.limit / shape.length()).min(1.0),
            LengthBy::Plane => {
                let (left, front) = (self.tilt.tan(), self.slope.tan());
                let over = |p: Vec3| {
                    let p = p - scope.head.middle;
                    p.y - (self.height + left * p.x + front * p.z)
                };
                let links = shape.points.windows(2).enumerate();
                let mut crossing = links.filter_map(|(i, pair)| {
                    let (a, b) = (over(pair[0]), over(pair[1]));
                    (b < 0.0).then(|| i as f32 + if a > 0.0 { a / (a - b) } else { 0.0 })
                });
                crossing.next().map_or(1.0, |at| at / (shape.points.len() - 1) as f32)
            }
        };
        let rank = 0.5 + 0.5 * scope.head.relative(shape.points[0]).y.clamp(-1.0, 1.0);
        part *= 1.0 - self.layers * rank * rank;
        let chance = scope.random(0, shape.index).unit();
        part *= 1.0 - self.variation * chance;
        let part = 1.0 + (part - 1.0) * shape.strength;
        // However many layers lengthen hair, it ends somewhere.
        if part > 1.0 { part.min((LONGEST / shape.length()).max(1.0)) } else { part.max(0.0) }
    }
}

impl Operate for Length {
    const KIND: Kind = Kind {
        id: "length",
        label: "Length",
        text: "Shortens or lengthens hair: by a factor, to a length or to a plane, blunt or in layers.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        // Parts are those of the hair as it was.
        let part = |shape: &GuideShape| self.part(shape, scope);
        let strengths = scope.guides(style);
        let wisps = guides::wisp_of_guide(style);
        let parts: Vec<f32> = (0..style.guides.count())
            .map(|guide| {
                let shape = guides::shape_of(&style.guides, guide, strengths[guide], wisps[guide]);
                shape.filter(|shape| shape.strength != 0.0).map_or(1.0, |shape| part(&shape))
            })
            .collect();
        if parts.iter().any(|part| *part > 1.0) {
            reshape(style, scope, Lengths::Change, |shape| {
                if parts[shape.index] > 1.0 {
                    lengthen(&mut shape.points, parts[shape.index]);
                }
            });
        }
        shorten(style, scope, |shape| parts[shape.index]);
    }
}
