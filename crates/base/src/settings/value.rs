//! Values of settings, whatever their type.

use glam::Vec3;

/// The value of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number; one of single precision is widened and loses nothing.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// On or off.
    Switch(bool),
    /// The id of a choice.
    Choice(&'static str),
    /// Three numbers: a colour, a direction or a place.
    Vector([f32; 3]),
    /// Nothing, for a setting that may be left out.
    None,
}

impl Value {
    /// Its numbers: one, three of a vector, or none of what is not a number.
    pub fn numbers(&self) -> Vec<f64> {
        match *self {
            Self::Number(v) => vec![v],
            Self::Count(v) => vec![v as f64],
            Self::Vector(v) => v.map(f64::from).to_vec(),
            Self::Switch(_) | Self::Choice(_) | Self::None => Vec::new(),
        }
    }

    /// A value of the same type with these numbers. Whole numbers are rounded.
    pub fn with_numbers(&self, numbers: &[f64]) -> Option<Self> {
        if numbers.iter().any(|v| !v.is_finite()) {
            return None;
        }
        match (self, numbers) {
            (Self::Number(_), [v]) => Some(Self::Number(*v)),
            (Self::Count(_), [v]) => Some(Self::Count(v.round().max(0.0) as u64)),
            (Self::Vector(_), [x, y, z]) => Some(Self::Vector([*x as f32, *y as f32, *z as f32])),
            _ => None,
        }
    }

    /// The value between this and `other`, of the same type: numbers are mixed, and of what is not a number the nearer one is taken.
    #[must_use]
    pub fn between(&self, other: &Self, amount: f64) -> Self {
        let nearer = if amount < 0.5 { *self } else { *other };
        if amount <= 0.0 || amount >= 1.0 {
            return nearer;
        }
        let (a, b) = (self.numbers(), other.numbers());
        let mixed: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a * (1.0 - amount) + b * amount).collect();
        self.with_numbers(&mixed).filter(|_| a.len() == b.len()).unwrap_or(nearer)
    }
}

/// A type that a setting may have.
pub trait SettingValue {
    /// The value.
    fn to_value(&self) -> Value;
    /// Takes the value, unless it is of another type.
    fn assign(&mut self, value: Value);
}

impl SettingValue for f32 {
    fn to_value(&self) -> Value {
        Value::Number(f64::from(*self))
    }

    fn assign(&mut self, value: Value) {
        if let Value::Number(v) = value {
            *self = v as Self;
        }
    }
}

impl SettingValue for f64 {
    fn to_value(&self) -> Value {
        Value::Number(*self)
    }

    fn assign(&mut self, value: Value) {
        if let Value::Number(v) = value {
            *self = v;
        }
    }
}

impl SettingValue for u32 {
    fn to_value(&self) -> Value {
        Value::Count(u64::from(*self))
    }

    fn assign(&mut self, value: Value) {
        if let Value::Count(v) = value {
            *self = v.min(u64::from(Self::MAX)) as Self;
        }
    }
}

impl SettingValue for u64 {
    fn to_value(&self) -> Value {
        Value::Count(*self)
    }

    fn assign(&mut self, value: Value) {
        if let Value::Count(v) = value {
            *self = v;
        }
    }
}

impl SettingValue for bool {
    fn to_value(&self) -> Value {
        Value::Switch(*self)
    }

    fn assign(&mut self, value: Value) {
        if let Value::Switch(v) = value {
            *self = v;
        }
    }
}

impl SettingValue for [f32; 3] {
    fn to_value(&self) -> Value {
        Value::Vector(*self)
    }

    fn assign(&mut self, value: Value) {
        if let Value::Vector(v) = value {
            *self = v;
        }
    }
}

impl SettingValue for Vec3 {
    fn to_value(&self) -> Value {
        Value::Vector(self.to_array())
    }

    fn assign(&mut self, value: Value) {
        if let Value::Vector(v) = value {
            *self = Self::from_array(v);
        }
    }
}

impl<T: SettingValue + Default> SettingValue for Option<T> {
    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::None, T::to_value)
    }

    fn assign(&mut self, value: Value) {
        if value == Value::None {
            *self = None;
        } else {
            self.get_or_insert_default().assign(value);
        }
    }
}

/// A type with a few values, each with a stable id and a label.
pub trait Choices: Copy + PartialEq + 'static {
    /// Every value, in the order of menus.
    const ALL: &'static [Self];

    /// Values that became known while the program runs, after the others in menus.
    fn more() -> Vec<Self> {
        Vec::new()
    }

    /// The values that menus offer: all, and those that became known.
    fn offered() -> Vec<Self> {
        Self::ALL.iter().copied().chain(Self::more()).collect()
    }

    /// Its id in project files and on the command line, and its label in menus.
    fn names(self) -> (&'static str, &'static str);
}

impl<T: Choices> SettingValue for T {
    fn to_value(&self) -> Value {
        Value::Choice(self.names().0)
    }

    fn assign(&mut self, value: Value) {
        if let Value::Choice(id) = value
            && let Some(chosen) =
                T::ALL.iter().copied().chain(T::more()).find(|choice| choice.names().0 == id)
            && chosen.names() != self.names()
        {
            *self = chosen;
        }
    }
}
