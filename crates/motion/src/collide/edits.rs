//! The user's edits of the fitted colliders.

use std::collections::BTreeMap;

use glam::{Affine3A, Vec3};
use lovelock_base::field;
use lovelock_base::settings::{Part, PartMut, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::{BodyField, Collider, ColliderShape};

/// Edits of the fitted colliders, by name, and of the field. Unknown names are kept and have no effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColliderEdits {
    /// The edited colliders.
    pub shapes: BTreeMap<String, ColliderEdit>,
    /// The field of head and shoulders.
    pub field: FieldEdit,
}

/// An edit of one collider.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColliderEdit {
    /// Whether hair collides with it.
    pub enabled: bool,
    /// Factor of its radii.
    pub scale: f32,
    /// Displacement in the rest pose along each axis, metres.
    pub offset: [f32; 3],
}

impl Default for ColliderEdit {
    fn default() -> Self {
        Self { enabled: true, scale: 1.0, offset: [0.0; 3] }
    }
}

/// An edit of the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FieldEdit {
    /// Whether hair collides with the field; if not, it collides with the colliders that the field replaces.
    pub enabled: bool,
    /// Outward displacement of its surface, metres.
    pub lift: f32,
}

impl Default for FieldEdit {
    fn default() -> Self {
        Self { enabled: true, lift: 0.0 }
    }
}

impl Settings for ColliderEdits {
    const TABLE: &'static [Setting<Self>] = &[];

    fn parts(&self) -> Vec<Part<'_>> {
        let shapes =
            self.shapes.iter().map(|(name, edit)| -> Part<'_> { (format!("shapes.{name}").into(), edit) });
        std::iter::once::<Part<'_>>(("field".into(), &self.field)).chain(shapes).collect()
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        let shapes = self
            .shapes
            .iter_mut()
            .map(|(name, edit)| -> PartMut<'_> { (format!("shapes.{name}").into(), edit) });
        std::iter::once::<PartMut<'_>>(("field".into(), &mut self.field)).chain(shapes).collect()
    }
}

impl Settings for ColliderEdit {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(field!(Self, enabled), "Enabled", "Makes hair collide with this shape."),
        Setting::number(
            field!(Self, scale),
            [0.2, 3.0],
            "Size",
            "Radii of the shape, relative to the fitted ones.",
        )
        .unit(Unit::FRACTION),
        Setting::vector(
            field!(Self, offset),
            [-0.5, 0.5],
            "Offset",
            ["Sideways", "Upward", "Forward"],
            "Moves the shape in the rest pose toward the body's left, up, or to the front.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl Settings for FieldEdit {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(
            field!(Self, enabled),
            "Skin",
            "Makes hair collide with the skin of head, neck and shoulders itself, instead of the round shapes that \
             approximate them.",
        ),
        Setting::number(
            field!(Self, lift),
            [-0.02, 0.02],
            "Lift",
            "Distance outside the skin at which hair is stopped.",
        )
        .unit(Unit::METRES_AS_MM),
    ];
}

impl ColliderEdit {
    /// The edited shape at rest, even if the collider is disabled.
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
    /// The lift limited to its range, metres.
    pub fn lift_m(&self) -> f32 {
        self.clamped().lift
    }
}

impl ColliderEdits {
    /// The colliders that hair collides with. Disabled ones are left out, and so are those that an enabled
    /// field replaces. An edited collider is always included.
    pub fn apply(&self, fitted: &[Collider], field: Option<&BodyField>) -> Vec<Collider> {
        let used = fitted.iter().filter_map(|collider| {
            let edit = self.of(&collider.name);
            (edit.enabled && !self.is_replaced(collider, field))
                .then(|| Collider { shape_at_rest: edit.apply(&collider.shape_at_rest), ..collider.clone() })
        });
        used.collect()
    }

    /// The shapes that the field replaces: hair does not collide with them, but they shelter it from the
    /// wind.
    pub fn replaced_by_field(&self, fitted: &[Collider], field: Option<&BodyField>) -> Vec<Collider> {
        fitted.iter().filter(|collider| self.is_replaced(collider, field)).cloned().collect()
    }

    /// The edit of the collider with that name.
    pub fn of(&self, name: &str) -> ColliderEdit {
        self.shapes.get(name).copied().unwrap_or_default()
    }

    /// Sets the edit of the collider with that name; an edit without effect is removed.
    pub fn set(&mut self, name: &str, edit: ColliderEdit) {
        if edit == ColliderEdit::default() {
            self.shapes.remove(name);
        } else {
            self.shapes.insert(name.to_owned(), edit);
        }
    }

    /// Whether an enabled field replaces a collider of unedited size and place. Hair then does not collide
    /// with it, whether or not it is enabled.
    pub fn is_replaced(&self, collider: &Collider, field: Option<&BodyField>) -> bool {
        let as_fitted = ColliderEdit { enabled: true, ..self.of(&collider.name) } == ColliderEdit::default();
        as_fitted && self.field.enabled && field.is_some_and(|field| field.covers(&collider.shape_at_rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(name: &str) -> Collider {
        let shape = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y, radius_a: 0.1, radius_b: 0.2 };
        Collider { name: name.into(), joint: 0, shape_at_rest: shape }
    }

    #[test]
    fn edits_apply_by_name_and_stay_in_their_ranges() {
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
