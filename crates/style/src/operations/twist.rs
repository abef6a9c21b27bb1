//! Twists locks around their centre line.

use crate::guides::{Lengths, reshape, wisp_means};
use glam::{Quat, Vec3};
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};
use lovelock_groom::Hairstyle;
use std::f32::consts::TAU;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Twists locks around their centre line.
#[derive(Clone, Debug, PartialEq)]
pub struct Twist {
    /// Turns from the root to the tip.
    pub turns: f32,
}

impl Default for Twist {
    fn default() -> Self {
        Self { turns: 1.5 }
    }
}

impl Settings for Twist {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, turns),
        [-10.0, 10.0],
        "Turns",
        "Turns of a lock from the root to the tip.",
    )];
}

impl Operate for Twist {
    const KIND: Kind = Kind {
        id: "twist",
        label: "Twist",
        text: "Twists locks around their centre line.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let means = wisp_means(style);
        reshape(style, scope, Lengths::Keep, |shape| {
            let Some(mean) = shape.wisp.map(|wisp| &means[wisp]) else { return };
            for i in 1..shape.points.len() {
                let (a, b) = (mean[i - 1], mean[(i + 1).min(mean.len() - 1)]);
                let axis = (b - a).normalize_or(Vec3::NEG_Y);
                let angle = TAU * self.turns * shape.place(i) * shape.strength * scope.along(shape.place(i));
                shape.points[i] = mean[i] + Quat::from_axis_angle(axis, angle) * (shape.points[i] - mean[i]);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn half_a_turn_brings_tips_to_the_other_side_of_their_lock() {
        let before = straight(Vec3::NEG_Y);
        let after = acted(Twist { turns: 0.5 }, &before);
        let last = before.guides.points_per_guide - 1;
        for (w, mean) in wisp_means(&before).iter().enumerate() {
            for g in before.wisps[w].guides {
                let side = |style: &Hairstyle| {
                    (style.guides.point(g as usize, last) - mean[last]) * Vec3::new(1.0, 0.0, 1.0)
                };
                let (old, new) = (side(&before), side(&after));
                assert!(old.length() < 1e-3 || new.dot(old) < -0.5 * old.length_squared(), "{old} {new}");
            }
        }
    }
}
