//! Values of operations in files, and operations that this version does not know.

use std::collections::BTreeMap;
use std::fmt;

use lovelock_base::settings::{Info, Kind, Value};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::Ramp;

/// A value in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// A number.
    Number(f64),
    /// On or off.
    Switch(bool),
    /// The id of a choice.
    Choice(String),
    /// A vector or a list of numbers.
    Numbers(Vec<f32>),
    /// Left out.
    None,
}

impl Stored {
    /// The value of a setting.
    pub(crate) fn of(value: Value) -> Self {
        match value {
            Value::Number(v) => Self::Number(shortest(v)),
            Value::Count(v) => Self::Number(v as f64),
            Value::Switch(v) => Self::Switch(v),
            Value::Choice(v) => Self::Choice(v.to_owned()),
            Value::Vector(v) => Self::Numbers(v.to_vec()),
            Value::None => Self::None,
        }
    }

    /// The value of a setting; `None` if the setting does not take it.
    pub(crate) fn value(&self, info: &Info) -> Option<Value> {
        match (self, info.kind) {
            (Self::None, _) => info.none.map(|_| Value::None),
            (Self::Number(v), Kind::Count(_)) => Some(Value::Count(v.max(0.0) as u64)),
            (Self::Number(v), Kind::Number(_)) => Some(Value::Number(*v)),
            (Self::Switch(v), Kind::Switch) => Some(Value::Switch(*v)),
            (Self::Choice(id), Kind::Choice(options)) => {
                options.iter().find(|(known, _)| known == id).map(|(known, _)| Value::Choice(known))
            }
            (Self::Numbers(v), Kind::Vector { .. } | Kind::Direction { .. } | Kind::Color) => {
                Some(Value::Vector(v.as_slice().try_into().ok()?))
            }
            _ => None,
        }
    }
}

/// The number with the fewest digits that is the same in single precision; the number itself if it is not one of single precision.
fn shortest(v: f64) -> f64 {
    let single = v as f32;
    if f64::from(single) == v { single.to_string().parse().unwrap_or(v) } else { v }
}

impl Serialize for Stored {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(v) => serializer.serialize_f64(*v),
            Self::Switch(v) => serializer.serialize_bool(*v),
            Self::Choice(v) => serializer.serialize_str(v),
            Self::Numbers(v) => serializer.collect_seq(v),
            Self::None => serializer.serialize_unit(),
        }
    }
}

impl<'de> Deserialize<'de> for Stored {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;

        impl<'de> Visitor<'de> for Reader {
            type Value = Stored;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, true or false, a name or a list of numbers")
            }

            fn visit_f64<E>(self, v: f64) -> Result<Stored, E> {
                Ok(Stored::Number(v))
            }

            fn visit_u64<E>(self, v: u64) -> Result<Stored, E> {
                Ok(Stored::Number(v as f64))
            }

            fn visit_i64<E>(self, v: i64) -> Result<Stored, E> {
                Ok(Stored::Number(v as f64))
            }

            fn visit_bool<E>(self, v: bool) -> Result<Stored, E> {
                Ok(Stored::Switch(v))
            }

            fn visit_str<E>(self, v: &str) -> Result<Stored, E> {
                Ok(Stored::Choice(v.to_owned()))
            }

            fn visit_unit<E>(self) -> Result<Stored, E> {
                Ok(Stored::None)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Stored, A::Error> {
                let mut out = Vec::new();
                while let Some(v) = seq.next_element()? {
                    out.push(v);
                }
                Ok(Stored::Numbers(out))
            }
        }

        deserializer.deserialize_any(Reader)
    }
}

/// An operation of another version: its id and everything that was written about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnknownOperation {
    /// Its id.
    pub id: String,
    /// Its values by their names.
    pub values: BTreeMap<String, Stored>,
    /// Its curves by their names.
    pub ramps: BTreeMap<String, Ramp>,
}
