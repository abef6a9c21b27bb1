//! Operations as files keep them: an id, and values by their names.
//!
//! The values come from the operations' tables of settings, so an operation has no code of its own for files, and what another version
//! knows is kept as it was written.

use std::collections::BTreeMap;

use lovelock_base::settings::{entries, find, set_value};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Operation;
use crate::Ramp;
use crate::operate::AnyOperation;
use crate::stored::{Stored, UnknownOperation};

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
        let texts = known.texts().into_iter();
        file.values.extend(texts.map(|(name, text)| (name.to_owned(), Stored::Choice(text))));
        let ramps = known.ramps().iter().enumerate();
        file.ramps.extend(ramps.map(|(i, info)| (info.name.to_owned(), known.ramp(i).clone())));
        file
    }

    fn named(kind: &str) -> Self {
        Self { kind: kind.to_owned(), values: BTreeMap::new(), ramps: BTreeMap::new() }
    }

    fn operation(self) -> Result<Operation, String> {
        let Some(mut operation) = Operation::new(&self.kind) else {
            let Self { kind: id, values, ramps } = self;
            return Ok(Operation::Unknown(UnknownOperation { id, values, ramps }));
        };
        if let Some(known) = operation.known_mut() {
            self.fill(known)?;
        }
        Ok(operation)
    }

    /// Takes the settings that the operation has; the others keep their defaults.
    fn fill(self, operation: &mut dyn AnyOperation) -> Result<(), String> {
        let lists: Vec<&str> = operation.lists().into_iter().map(|(name, _)| name).collect();
        let texts: Vec<&str> = operation.texts().into_iter().map(|(name, _)| name).collect();
        for (name, stored) in self.values {
            if let Some((info, _)) = find(operation.settings(), &name) {
                if let Some(value) = stored.value(info) {
                    set_value(operation.settings_mut(), &name, value);
                }
                continue;
            }
            match stored {
                Stored::Numbers(numbers) if lists.contains(&name.as_str()) => {
                    operation.set_list(&name, numbers);
                }
                Stored::Choice(text) if texts.contains(&name.as_str()) => operation.set_text(&name, &text)?,
                _ => {}
            }
        }
        for (i, info) in operation.ramps().iter().enumerate() {
            if let Some(ramp) = self.ramps.get(info.name) {
                *operation.ramp_mut(i) = ramp.clone();
            }
        }
        Ok(())
    }
}

impl Serialize for Operation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        File::of(self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Operation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        File::deserialize(deserializer)?.operation().map_err(D::Error::custom)
    }
}
