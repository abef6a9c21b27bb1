//! What the user changes about the colliders that were fitted.

use std::collections::BTreeMap;

use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};

use crate::{BodyField, Collider, ColliderShape};

/// Changes of the fitted colliders, by name, and of the field. Names that no collider has are kept and do nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColliderEdits {
    /// The changed colliders.
    pub shapes: BTreeMap<String, ColliderEdit>,
    /// The field of head and shoulders.
    pub field: FieldEdit,
}

/// A change of one collider.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColliderEdit {
    /// Whether hair meets it at all.
    pub enabled: bool,
    /// Factor of its radii: 0.2 to 3.
    pub scale: f32,
    /// Where it is moved in the rest pose, metres, along each axis: -0.5 to 0.5.
    pub offset: [f32; 3],
}

impl Default for ColliderEdit {
    fn default() -> Self {
        Self { enabled: true, scale: 1.0, offset: [0.0; 3] }
    }
}

/// A change of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FieldEdit {
    /// Whether hair meets the field; where not, it meets the colliders that the field stands for.
    pub enabled: bool,
    /// By how much its surface is moved outward, metres: -0.02 to 0.02.
    pub lift: f32,
}

impl Default for FieldEdit {
    fn default() -> Self {
        Self { enabled: true, lift: 0.0 }
    }
}

impl ColliderEdit {
    /// The same change inside its ranges; what is not a number changes nothing.
    #[must_use]
    pub fn clamped(&self) -> Self {
        Self {
            enabled: self.enabled,
            scale: within(self.scale, 0.2, 3.0, 1.0),
            offset: self.offset.map(|v| within(v, -0.5, 0.5, 0.0)),
        }
    }

    /// The shape at rest with its change, whether or not hair meets it.
    pub fn apply(&self, shape: &ColliderShape) -> ColliderShape {
        let Self { scale, offset, .. } = self.clamped();
        let offset = Vec3::from(offset);
        match *shape {
            ColliderShape::Capsule { a, b, radius_a, radius_b } => ColliderShape::Capsule {
                a: a + offset,
                b: b + offset,
                radius_a: radius_a * scale,
                radius_b: radius_b * scale,
            },
            ColliderShape::Ellipsoid { from_unit } => ColliderShape::Ellipsoid {
                from_unit: Affine3A {
                    matrix3: from_unit.matrix3 * scale,
                    translation: from_unit.translation + glam::Vec3A::from(offset),
                },
            },
        }
    }
}

impl FieldEdit {
    /// The lift inside its range, metres.
    pub fn lift_m(&self) -> f32 {
        within(self.lift, -0.02, 0.02, 0.0)
    }
}

impl ColliderEdits {
    /// The colliders that hair meets: without those that are switched off, and without those that the field, where
    /// there is one and it is on, stands for. A changed collider acts in any case.
    pub fn apply(&self, fitted: &[Collider], field: Option<&BodyField>) -> Vec<Collider> {
        let used = fitted.iter().filter_map(|collider| {
            let edit = self.of(&collider.name);
            (edit.enabled && !self.is_spared(collider, field))
                .then(|| Collider { shape_at_rest: edit.apply(&collider.shape_at_rest), ..collider.clone() })
        });
        used.collect()
    }

    /// The shapes that the field stands for: no hair meets them, but they keep the wind off.
    pub fn stood_for(&self, fitted: &[Collider], field: Option<&BodyField>) -> Vec<Collider> {
        fitted.iter().filter(|collider| self.is_spared(collider, field)).cloned().collect()
    }

    /// The change of the collider of that name.
    pub fn of(&self, name: &str) -> ColliderEdit {
        self.shapes.get(name).copied().unwrap_or_default()
    }

    /// Changes the collider of that name; an edit that changes nothing is not kept.
    pub fn set(&mut self, name: &str, edit: ColliderEdit) {
        if edit == ColliderEdit::default() {
            self.shapes.remove(name);
        } else {
            self.shapes.insert(name.to_owned(), edit);
        }
    }

    /// Whether the field, where there is one and it is on, stands for a collider whose size and place are as they were fitted: hair
    /// does not meet it then, be it enabled or not.
    pub fn is_spared(&self, collider: &Collider, field: Option<&BodyField>) -> bool {
        let as_fitted = ColliderEdit { enabled: true, ..self.of(&collider.name) } == ColliderEdit::default();
        as_fitted && self.field.enabled && field.is_some_and(|field| field.covers(&collider.shape_at_rest))
    }
}

fn within(value: f32, min: f32, max: f32, default: f32) -> f32 {
    if value.is_nan() { default } else { value.clamp(min, max) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(name: &str) -> Collider {
        let shape = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y, radius_a: 0.1, radius_b: 0.2 };
        Collider { name: name.into(), joint: 0, shape_at_rest: shape }
    }

    #[test]
    fn edits_go_by_name_and_stay_in_their_ranges() {
        let fitted = [ball("neck"), ball("skull"), ball("face")];
        let mut edits = ColliderEdits::default();
        assert_eq!(edits.apply(&fitted, None), fitted);
        edits.shapes.insert("neck".into(), ColliderEdit { enabled: false, ..ColliderEdit::default() });
        let wild = ColliderEdit { scale: 99.0, offset: [f32::NAN, 0.1, -7.0], ..ColliderEdit::default() };
        edits.shapes.insert("skull".into(), wild);
        let used = edits.apply(&fitted, None);
        assert_eq!(used.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["skull", "face"]);
        let moved = Vec3::new(0.0, 0.1, -0.5);
        let wanted =
            ColliderShape::Capsule { a: moved, b: Vec3::Y + moved, radius_a: 0.1 * 3.0, radius_b: 0.2 * 3.0 };
        assert_eq!(used[0].shape_at_rest, wanted);
        assert_eq!(used[1], fitted[2]);
    }

    #[test]
    fn edits_survive_json_and_missing_fields() {
        let text = r#"{"shapes":{"neck":{"scale":1.5}}}"#;
        let edits: ColliderEdits = serde_json::from_str(text).unwrap();
        assert_eq!(edits.shapes["neck"], ColliderEdit { scale: 1.5, ..ColliderEdit::default() });
        assert!(edits.field.enabled);
        let again: ColliderEdits = serde_json::from_str(&serde_json::to_string(&edits).unwrap()).unwrap();
        assert_eq!(again, edits);
    }
}
