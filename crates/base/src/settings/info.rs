//! What a setting is called and which values it takes.

use glam::Vec3;

use super::{Choices, Unit, Value};

/// What a setting is.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Its name in files; dots lead into nested structs.
    pub name: &'static str,
    /// Its name in the window: one to three words.
    pub label: &'static str,
    /// What it changes in the image or in the motion.
    pub text: &'static str,
    /// Its symbol in the equations or the paper; empty where it has none.
    pub symbol: &'static str,
    /// What it is measured in.
    pub unit: Unit,
    /// Which values it takes.
    pub kind: Kind,
    /// What is used where the setting is left out; `None` where it cannot be.
    pub none: Option<&'static str>,
}

/// Which values a setting takes.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A number.
    Number(Range),
    /// A whole number.
    Count(Counts),
    /// On or off.
    Switch,
    /// A choice by id.
    Choice(Options),
    /// A colour, linear sRGB, each channel 0 to [`Kind::BRIGHTEST`].
    Color,
    /// A direction of any length; `zero` where it may be zero.
    Direction {
        /// Whether it may be zero.
        zero: bool,
    },
    /// Three numbers of one range.
    Vector {
        /// The range of each.
        range: Range,
        /// The labels of their controls.
        axes: [&'static str; 3],
    },
}

impl Kind {
    /// The largest channel of a colour.
    pub const BRIGHTEST: f32 = 4.0;
}

/// A range of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// The lowest and the highest value.
    pub hard: [f64; 2],
    /// The range that a slider offers.
    pub soft: [f64; 2],
    /// Whether even steps of the slider are even factors.
    pub logarithmic: bool,
    /// Whether it is an angle that goes round.
    pub wraps: bool,
}

impl Range {
    pub(super) const fn new(hard: [f64; 2]) -> Self {
        Self { hard, soft: hard, logarithmic: false, wraps: false }
    }

    fn clamp(&self, value: f64, default: f64) -> f64 {
        use std::f32::consts::PI;
        if self.wraps {
            let angle = value as f32;
            return if !angle.is_finite() {
                default
            } else if angle.abs() > PI {
                f64::from((angle + PI).rem_euclid(2.0 * PI) - PI)
            } else {
                value
            };
        }
        if value.is_nan() { default } else { value.clamp(self.hard[0], self.hard[1]) }
    }
}

/// A range of whole numbers, or a list of them.
#[derive(Clone, Copy, Debug)]
pub struct Counts {
    /// The lowest and the highest value.
    pub hard: [u64; 2],
    /// The range that a slider offers.
    pub soft: [u64; 2],
    /// Values are multiples of this.
    pub step: u64,
    /// The only values; none where the range counts.
    pub choices: &'static [u64],
    /// What a menu offers, or at what a slider stops; where it is empty, a slider stops everywhere.
    pub offered: &'static [u64],
    /// Whether a slider steps through what is offered, so that other numbers can be typed. Otherwise a menu offers it.
    pub slides: bool,
    /// Labels of what is offered, in its order; the numbers themselves where it is empty.
    pub names: &'static [&'static str],
    /// Whether even steps of the slider are even factors.
    pub logarithmic: bool,
    /// Whether zero is allowed below the range.
    pub zero: bool,
}

impl Counts {
    pub(super) const fn new(hard: [u64; 2]) -> Self {
        Self {
            hard,
            soft: hard,
            step: 1,
            choices: &[],
            offered: &[],
            slides: false,
            names: &[],
            logarithmic: false,
            zero: false,
        }
    }

    pub(super) const fn one_of(choices: &'static [u64]) -> Self {
        let hard = [choices[0], choices[choices.len() - 1]];
        Self { choices, offered: choices, ..Self::new(hard) }
    }

    fn clamp(&self, value: u64) -> u64 {
        if !self.choices.is_empty() {
            return nearest(self.choices, value);
        }
        if self.zero && value == 0 {
            return 0;
        }
        (value.clamp(self.hard[0], self.hard[1]) + self.step / 2) / self.step * self.step
    }
}

/// The choice nearest to a number. Between two that are equally near it is the middle one of all, if that is one of them.
fn nearest(choices: &[u64], value: u64) -> u64 {
    let mut best = choices[choices.len() / 2];
    for &choice in choices {
        if choice.abs_diff(value) < best.abs_diff(value) {
            best = choice;
        }
    }
    best
}

/// The choices of a type.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    count: usize,
    names: fn(usize) -> (&'static str, &'static str),
    more: fn() -> Vec<(&'static str, &'static str)>,
}

impl Options {
    pub(super) const fn of<T: Choices>() -> Self {
        Self {
            count: T::ALL.len(),
            names: |i| T::ALL[i].names(),
            more: || T::more().into_iter().map(T::names).collect(),
        }
    }

    /// Id and label of each choice, in the order of menus.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        (0..self.count).map(self.names).chain((self.more)())
    }
}

impl Info {
    /// The nearest value that is allowed; `default` where there is none.
    pub fn clamp(&self, value: Value, default: Value) -> Value {
        let finite_default = |default| if let Value::Number(default) = default { default } else { 0.0 };
        match (self.kind, value) {
            (_, Value::None) if self.none.is_some() => value,
            (Kind::Number(_), Value::Number(v)) if v.is_nan() && self.none.is_some() => default,
            (Kind::Number(range), Value::Number(v)) => Value::Number(range.clamp(v, finite_default(default))),
            (Kind::Count(counts), Value::Count(v)) => Value::Count(counts.clamp(v)),
            (Kind::Color, Value::Vector(v)) if v.iter().all(|v| v.is_finite()) => {
                Value::Vector(v.map(|v| v.clamp(0.0, Kind::BRIGHTEST)))
            }
            (Kind::Direction { zero: true }, Value::Vector(v))
                if v.iter().all(|v| v.is_finite() && v.abs() < 1e9) =>
            {
                value
            }
            (Kind::Direction { zero: false }, Value::Vector(v))
                if Vec3::from_array(v).try_normalize().is_some() =>
            {
                value
            }
            (Kind::Vector { range, .. }, Value::Vector(v)) => {
                let default = if let Value::Vector(default) = default { default } else { [0.0; 3] };
                let clamp = |i: usize| range.clamp(f64::from(v[i]), f64::from(default[i])) as f32;
                Value::Vector([clamp(0), clamp(1), clamp(2)])
            }
            (Kind::Switch, Value::Switch(_)) | (Kind::Choice(_), Value::Choice(_)) => value,
            _ => default,
        }
    }
}
