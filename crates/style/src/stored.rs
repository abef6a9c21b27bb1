//! Operations as files keep them: an id, and values by their names.
//!
//! The values come from the operations' tables of settings, so an operation has no code of its own for files, and what another version
//! knows is kept as it was written.

use std::collections::BTreeMap;
use std::fmt;

use lovelock_base::settings::{Info, Kind as ValueKind, Value, entries, find, set_value};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::Ramp;
use crate::operation::{AnyOperation, Operation, UnknownOperation};

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
    fn of(value: Value) -> Self {
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
    fn value(&self, info: &Info) -> Option<Value> {
        match (self, info.kind) {
            (Self::None, _) => info.none.map(|_| Value::None),
            (Self::Number(v), ValueKind::Count(_)) => Some(Value::Count(v.max(0.0) as u64)),
            (Self::Number(v), ValueKind::Number(_)) => Some(Value::Number(*v)),
            (Self::Switch(v), ValueKind::Switch) => Some(Value::Switch(*v)),
            (Self::Choice(id), ValueKind::Choice(options)) => {
                options.iter().find(|(known, _)| known == id).map(|(known, _)| Value::Choice(known))
            }
            (Self::Numbers(v), ValueKind::Vector { .. } | ValueKind::Direction { .. } | ValueKind::Color) => {
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

#[derive(Serialize, Deserialize)]
struct File {
    kind: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    values: BTreeMap<String, Stored>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    ramps: BTreeMap<String, Ramp>,
}

impl File {
    fn of(operation: &Operation) -> Self {
        let Some(known) = operation.known() else {
            let Operation::Unknown(unknown) = operation else { return Self::named(operation.id()) };
            let UnknownOperation { id, values, ramps } = unknown.clone();
            return Self { kind: id, values, ramps };
        };
        let mut file = Self::named(operation.id());
        file.values
            .extend(entries(known.settings()).into_iter().map(|entry| (entry.path, Stored::of(entry.value))));
        let lists = known.lists().into_iter();
        file.values.extend(lists.map(|(name, numbers)| (name.to_owned(), Stored::Numbers(numbers))));
        let ramps = known.ramps().iter().enumerate();
        file.ramps.extend(ramps.map(|(i, info)| (info.name.to_owned(), known.ramp(i).clone())));
        file
    }

    fn named(kind: &str) -> Self {
        Self { kind: kind.to_owned(), values: BTreeMap::new(), ramps: BTreeMap::new() }
    }

    fn operation(self) -> Operation {
        let Some(mut operation) = Operation::new(&self.kind) else {
            return Operation::Unknown(UnknownOperation {
                id: self.kind,
                values: self.values,
                ramps: self.ramps,
            });
        };
        if let Some(known) = operation.known_mut() {
            self.fill(known);
        }
        operation
    }

    /// Takes what the operation knows; the rest keeps its defaults.
    fn fill(self, operation: &mut dyn AnyOperation) {
        let lists: Vec<&str> = operation.lists().into_iter().map(|(name, _)| name).collect();
        for (name, stored) in self.values {
            if let Some((info, _)) = find(operation.settings(), &name) {
                if let Some(value) = stored.value(info) {
                    set_value(operation.settings_mut(), &name, value);
                }
            } else if let Stored::Numbers(numbers) = stored
                && lists.contains(&name.as_str())
            {
                operation.set_list(&name, numbers);
            }
        }
        for (i, info) in operation.ramps().iter().enumerate() {
            if let Some(ramp) = self.ramps.get(info.name) {
                *operation.ramp_mut(i) = ramp.clone();
            }
        }
    }
}

impl Serialize for Operation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        File::of(self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Operation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        File::deserialize(deserializer).map(File::operation)
    }
}
