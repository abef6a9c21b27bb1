//! The keys of one bone over time.

use glam::{Quat, Vec3};

use super::parse::Key;

/// The value of a bone at a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Value {
    /// Displacement from the rest position.
    pub(super) position: Vec3,
    pub(super) rotation: Quat,
}

/// The value between keys (sorted by frame); at rest without keys, and constant before the first and after the last.
pub(super) fn value(keys: &[Key], frame: u32) -> Value {
    let after = keys.partition_point(|key| key.frame <= frame);
    let at = |key: &Key| Value { position: key.position, rotation: key.rotation };
    match (after.checked_sub(1).and_then(|before| keys.get(before)), keys.get(after)) {
        (None, None) => Value::default(),
        (Some(key), None) | (None, Some(key)) => at(key),
        (Some(a), Some(b)) => {
            let u = (frame - a.frame) as f32 / (b.frame - a.frame) as f32;
            // The later key describes the way to it.
            let share = b.curves.map(|curve| ease(curve, u));
            let along = Vec3::new(share[0], share[1], share[2]);
            Value {
                position: a.position + (b.position - a.position) * along,
                rotation: a.rotation.slerp(b.rotation, share[3]),
            }
        }
    }
}

/// The height at `u` of the Bézier curve from (0, 0) to (1, 1) with the control points (x1, y1) and (x2, y2).
fn ease([x1, y1, x2, y2]: [f32; 4], u: f32) -> f32 {
    let along = |a: f32, b: f32, t: f32| {
        let s = 1.0 - t;
        3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t
    };
    if x1 == y1 && x2 == y2 {
        return u;
    }
    // x grows with t, so that halving finds it.
    let (mut low, mut high) = (0.0_f32, 1.0_f32);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if along(x1, x2, middle) < u {
            low = middle;
        } else {
            high = middle;
        }
    }
    along(y1, y2, 0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_pass_through_known_points() {
        // x(t) = t for control points at thirds, and y(t) = 3 s t^2 + t^3 for y1 = 0, y2 = 1: 0.5 in the middle.
        let s_curve = [1.0 / 3.0, 0.0, 2.0 / 3.0, 1.0];
        assert!((ease(s_curve, 0.5) - 0.5).abs() < 1e-5);
        assert!((ease(s_curve, 0.25) - (3.0 * 0.75 * 0.0625 + 0.015_625)).abs() < 1e-5);
        assert_eq!(ease([0.2, 0.2, 0.8, 0.8], 0.3), 0.3);
        assert!(ease([0.0, 1.0, 0.0, 1.0], 0.125) > 0.8, "quick at first");
        assert_eq!(
            (ease(s_curve, 0.0), ease(s_curve, 1.0)),
            (ease(s_curve, 0.0).min(1e-5), 1.0_f32.min(ease(s_curve, 1.0)))
        );
    }

    #[test]
    fn values_hold_before_and_after_the_keys() {
        let straight = [[0.2, 0.2, 0.8, 0.8]; 4];
        let key = |frame, y| Key {
            frame,
            position: Vec3::new(0.0, y, 0.0),
            rotation: Quat::from_rotation_x(y),
            curves: straight,
        };
        let keys = [key(10, 0.0), key(20, 1.0)];
        assert_eq!(value(&keys, 0).position.y, 0.0);
        assert_eq!(value(&keys, 99).position.y, 1.0);
        let half = value(&keys, 15);
        assert!((half.position.y - 0.5).abs() < 1e-6);
        assert!(half.rotation.angle_between(Quat::from_rotation_x(0.5)) < 1e-3);
        assert_eq!(value(&[], 5), Value::default());
    }
}
