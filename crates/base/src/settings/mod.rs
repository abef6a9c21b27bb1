//! Tables of settings: what each number, switch and choice of a struct is called, in which range it lies, and what it changes.
//!
//! A struct of settings implements [`Settings`] with a [`TABLE`](Settings::TABLE) of its fields. Clamping, the rows of the panels,
//! `--set` on the command line, tracks on the timeline and the tables of the documentation are all made from that table.
//!
//! ```
//! use lovelock_base::field;
//! use lovelock_base::settings::{Setting, Settings, Unit};
//!
//! #[derive(Clone, Default)]
//! struct Fog {
//!     distance: f32,
//! }
//!
//! impl Settings for Fog {
//!     const TABLE: &'static [Setting<Self>] =
//!         &[Setting::number(field!(Self, distance), [0.0, 50.0], "Distance", "Where fog begins.").unit(Unit::METRES)];
//! }
//!
//! assert_eq!(Fog { distance: 80.0 }.clamped().distance, 50.0);
//! assert_eq!(Fog { distance: f32::NAN }.clamped().distance, 0.0);
//! ```

mod info;
mod paths;
mod text;
mod unit;
mod value;

pub use info::{Counts, Info, Kind, Options, Range};
pub use paths::{Entry, SettingError, edits, entries, find, set, set_value};
pub use unit::Unit;
pub use value::{Choices, SettingValue, Value};

use std::borrow::Cow;

/// Access to one field of `S`, made by [`field!`](crate::field).
pub struct Field<S: 'static> {
    /// The field's name in files; dots lead into nested structs.
    pub name: &'static str,
    /// Reads the field.
    pub get: fn(&S) -> Value,
    /// Writes the field; a value of another type changes nothing.
    pub set: fn(&mut S, Value),
}

/// Access to a field: `field!(Struct, name)` or `field!(Struct, name.of.nested)`.
#[macro_export]
macro_rules! field {
    ($settings:ty, $first:ident $(. $rest:ident)*) => {
        $crate::settings::Field::<$settings> {
            name: concat!(stringify!($first) $(, ".", stringify!($rest))*),
            get: |settings| $crate::settings::SettingValue::to_value(&settings.$first $(. $rest)*),
            set: |settings, value| {
                $crate::settings::SettingValue::assign(&mut settings.$first $(. $rest)*, value);
            },
        }
    };
}

/// One setting of the struct `S`.
pub struct Setting<S: 'static> {
    /// What it is called and which values it takes.
    pub info: Info,
    get: fn(&S) -> Value,
    set: fn(&mut S, Value),
}

impl<S> Setting<S> {
    #[expect(
        clippy::needless_pass_by_value,
        reason = "tables read better with `field!(…)` than with a reference to it"
    )]
    const fn new(field: Field<S>, kind: Kind, label: &'static str, text: &'static str) -> Self {
        let info = Info { name: field.name, label, text, symbol: "", unit: Unit::NONE, kind, none: None };
        Self { info, get: field.get, set: field.set }
    }

    /// A number from `range[0]` to `range[1]`.
    pub const fn number(field: Field<S>, range: [f64; 2], label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Number(Range::new(range)), label, text)
    }

    /// A whole number from `range[0]` to `range[1]`.
    pub const fn count(field: Field<S>, range: [u64; 2], label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Count(Counts::new(range)), label, text)
    }

    /// A whole number out of `choices`, which rise.
    pub const fn one_of(
        field: Field<S>,
        choices: &'static [u64],
        label: &'static str,
        text: &'static str,
    ) -> Self {
        Self::new(field, Kind::Count(Counts::one_of(choices)), label, text)
    }

    /// Something that is on or off.
    pub const fn switch(field: Field<S>, label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Switch, label, text)
    }

    /// A choice out of the values of `T`.
    pub const fn choice<T: Choices>(field: Field<S>, label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Choice(Options::of::<T>()), label, text)
    }

    /// A colour, linear sRGB, each channel 0 to 4.
    pub const fn color(field: Field<S>, label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Color, label, text)
    }

    /// A direction: any vector but zero.
    pub const fn direction(field: Field<S>, label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Direction { zero: false }, label, text)
    }

    /// A direction that may also be zero, which switches off what it directs.
    pub const fn direction_or_zero(field: Field<S>, label: &'static str, text: &'static str) -> Self {
        Self::new(field, Kind::Direction { zero: true }, label, text)
    }

    /// Three numbers of one range. `axes` are the labels of their controls.
    pub const fn vector(
        field: Field<S>,
        range: [f64; 2],
        label: &'static str,
        axes: [&'static str; 3],
        text: &'static str,
    ) -> Self {
        Self::new(field, Kind::Vector { range: Range::new(range), axes }, label, text)
    }

    /// Measured in `unit`.
    #[must_use]
    pub const fn unit(mut self, unit: Unit) -> Self {
        self.info.unit = unit;
        self
    }

    /// The symbol of the equation or paper that it stands for.
    #[must_use]
    pub const fn symbol(mut self, symbol: &'static str) -> Self {
        self.info.symbol = symbol;
        self
    }

    /// The setting may be left out; `text` says what is used then.
    #[must_use]
    pub const fn or_none(mut self, text: &'static str) -> Self {
        self.info.none = Some(text);
        self
    }

    /// The range that sliders offer, narrower than the one that is allowed.
    #[must_use]
    pub const fn soft(mut self, range: [f64; 2]) -> Self {
        self.info.kind = match self.info.kind {
            Kind::Number(number) => Kind::Number(Range { soft: range, ..number }),
            Kind::Count(count) => Kind::Count(Counts { soft: [range[0] as u64, range[1] as u64], ..count }),
            Kind::Vector { range: of, axes } => Kind::Vector { range: Range { soft: range, ..of }, axes },
            kind => kind,
        };
        self
    }

    /// Even steps of the slider are even factors.
    #[must_use]
    pub const fn logarithmic(mut self) -> Self {
        self.info.kind = match self.info.kind {
            Kind::Number(number) => Kind::Number(Range { logarithmic: true, ..number }),
            Kind::Count(count) => Kind::Count(Counts { logarithmic: true, ..count }),
            kind => kind,
        };
        self
    }

    /// Digits that are shown after the point, where the unit's own are not right.
    #[must_use]
    pub const fn decimals(mut self, decimals: usize) -> Self {
        self.info.unit.decimals = decimals;
        self
    }

    /// An angle in radians that goes round: values beyond ±π are brought back by whole turns.
    #[must_use]
    pub const fn wraps(mut self) -> Self {
        if let Kind::Number(number) = self.info.kind {
            self.info.kind = Kind::Number(Range { wraps: true, ..number });
        }
        self
    }

    /// Whole numbers are multiples of `step`.
    #[must_use]
    pub const fn step(mut self, step: u64) -> Self {
        if let Kind::Count(count) = self.info.kind {
            self.info.kind = Kind::Count(Counts { step, ..count });
        }
        self
    }

    /// The whole numbers that a menu offers in place of a slider.
    #[must_use]
    pub const fn offered(mut self, offered: &'static [u64]) -> Self {
        if let Kind::Count(count) = self.info.kind {
            self.info.kind = Kind::Count(Counts { offered, ..count });
        }
        self
    }

    /// The whole numbers `stops`, which rise, through which a slider steps. Others can be typed.
    #[must_use]
    pub const fn stops(mut self, stops: &'static [u64]) -> Self {
        if let Kind::Count(count) = self.info.kind {
            self.info.kind = Kind::Count(Counts { offered: stops, slides: true, ..count });
        }
        self
    }

    /// Labels of the whole numbers that are offered.
    #[must_use]
    pub const fn named(mut self, names: &'static [&'static str]) -> Self {
        if let Kind::Count(count) = self.info.kind {
            self.info.kind = Kind::Count(Counts { names, ..count });
        }
        self
    }

    /// Zero is allowed below the range.
    #[must_use]
    pub const fn or_zero(mut self) -> Self {
        if let Kind::Count(count) = self.info.kind {
            self.info.kind = Kind::Count(Counts { zero: true, ..count });
        }
        self
    }

    /// The value in `settings`.
    pub fn get(&self, settings: &S) -> Value {
        (self.get)(settings)
    }

    /// Puts a value into `settings` as it is.
    pub fn set(&self, settings: &mut S, value: Value) {
        (self.set)(settings, value);
    }
}

/// A part of a struct of settings that is one itself, with its name in files.
pub type Part<'a> = (Cow<'static, str>, &'a dyn AnySettings);
/// The same, to be changed.
pub type PartMut<'a> = (Cow<'static, str>, &'a mut dyn AnySettings);

/// A struct of settings.
pub trait Settings: Clone + Default + 'static {
    /// Its own settings, in the order of documents.
    const TABLE: &'static [Setting<Self>];

    /// Parts that have tables of their own.
    fn parts(&self) -> Vec<Part<'_>> {
        Vec::new()
    }

    /// The same parts in the same order, to be changed.
    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        Vec::new()
    }

    /// Brings values that limit each other into agreement, after each of them has been brought into its own range.
    fn reconcile(&mut self) {}

    /// The same settings with every value inside its range. What is not a number becomes the default.
    #[must_use]
    fn clamped(&self) -> Self {
        let mut settings = self.clone();
        settings.clamp();
        settings
    }

    /// The setting of that name in the struct's own table.
    fn setting(name: &str) -> Option<&'static Setting<Self>> {
        Self::TABLE.iter().find(|setting| setting.info.name == name)
    }
}

/// Any struct of settings.
pub trait AnySettings {
    /// What its own settings are.
    fn infos(&self) -> Vec<&'static Info>;
    /// One of its own settings and its value.
    fn value(&self, name: &str) -> Option<(&'static Info, Value)>;
    /// Changes one of its own settings.
    fn assign(&mut self, name: &str, value: Value);
    /// Brings every value into its range, those of the parts included.
    fn clamp(&mut self);
    /// [`Settings::parts`].
    fn children(&self) -> Vec<Part<'_>>;
    /// [`Settings::parts_mut`].
    fn children_mut(&mut self) -> Vec<PartMut<'_>>;
}

impl<S: Settings> AnySettings for S {
    fn infos(&self) -> Vec<&'static Info> {
        S::TABLE.iter().map(|setting| &setting.info).collect()
    }

    fn value(&self, name: &str) -> Option<(&'static Info, Value)> {
        S::setting(name).map(|setting| (&setting.info, setting.get(self)))
    }

    fn assign(&mut self, name: &str, value: Value) {
        if let Some(setting) = S::setting(name) {
            setting.set(self, value);
        }
    }

    fn clamp(&mut self) {
        if !S::TABLE.is_empty() {
            let default = S::default();
            for setting in S::TABLE {
                let value = setting.get(self);
                let clamped = setting.info.clamp(value, setting.get(&default));
                setting.set(self, clamped);
            }
        }
        for (_, part) in self.parts_mut() {
            part.clamp();
        }
        self.reconcile();
    }

    fn children(&self) -> Vec<Part<'_>> {
        self.parts()
    }

    fn children_mut(&mut self) -> Vec<PartMut<'_>> {
        self.parts_mut()
    }
}

#[cfg(test)]
mod tests;
