//! Projects as trees of names and values: differences between two trees, and unknown names.

use ron::Value;
use serde::Serialize;

/// The leaves whose values differ, as sentences such as `hair.groom.length was 5, out of range, and is now 1`.
pub(super) fn differences<T: Serialize>(before: &T, after: &T) -> Vec<String> {
    let (Ok(before), Ok(after)) = (serde_json::to_value(before), serde_json::to_value(after)) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    compare("", &before, &after, &mut out);
    out
}

fn compare(path: &str, before: &serde_json::Value, after: &serde_json::Value, out: &mut Vec<String>) {
    use serde_json::Value::{Array, Object};
    match (before, after) {
        (Object(a), Object(b)) => {
            for (key, a) in a {
                if let Some(b) = b.get(key) {
                    compare(&join(path, key), a, b, out);
                }
            }
        }
        (Array(a), Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&format!("{path}[{i}]"), a, b, out);
            }
        }
        (a, b) if a != b => {
            let name = if path.is_empty() { "the value" } else { path };
            out.push(format!("{name} was {}, out of range, and is now {}", text(a), text(b)));
        }
        _ => {}
    }
}

fn text(value: &serde_json::Value) -> String {
    match value {
        // JSON has no NaN and no infinity: serde_json writes null.
        serde_json::Value::Null => "not a finite number".to_owned(),
        // Single precision; otherwise 0.1 would be printed as 0.10000000149011612.
        serde_json::Value::Number(number) if number.is_f64() => {
            number.as_f64().map_or_else(|| number.to_string(), |v| (v as f32).to_string())
        }
        other => other.to_string(),
    }
}

/// The fields of `found` that `known` does not have, such as `hair.sparkle`.
pub(super) fn unknown_fields(found: &Value, known: &Value) -> Vec<String> {
    let mut out = Vec::new();
    collect_unknown("", found, known, &mut out);
    out
}

fn collect_unknown(path: &str, found: &Value, known: &Value, out: &mut Vec<String>) {
    match (found, known) {
        (Value::Map(found), Value::Map(known)) => {
            for (key, value) in found.iter() {
                let Value::String(name) = key else { continue };
                match known.iter().find(|(k, _)| *k == key) {
                    Some((_, known)) => collect_unknown(&join(path, name), value, known, out),
                    None => out.push(join(path, name)),
                }
            }
        }
        (Value::Seq(found), Value::Seq(known)) => {
            for (i, (a, b)) in found.iter().zip(known).enumerate() {
                collect_unknown(&format!("{path}[{i}]"), a, b, out);
            }
        }
        (Value::Option(Some(found)), Value::Option(Some(known))) => collect_unknown(path, found, known, out),
        _ => {}
    }
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}
