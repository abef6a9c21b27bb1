//! Brings front hair forward over the forehead and shortens it.

use crate::guides::{Lengths, reshape, shorten, turn_links, wisp_of_guide};
use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Bounded, Hairstyle, Obstacle};

use crate::operate::{Kind, Operate, Subject};
use crate::scope::{Scope, wisp_roots};

/// Brings front hair forward over the forehead and shortens it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fringe {
    /// Length of the fringe, metres.
    pub length: f32,
    /// Distance from the foremost hair within which hair belongs to the fringe, metres.
    pub depth: f32,
    /// Width of the fringe, metres.
    pub width: f32,
    /// Angle toward the wearer's left, radians.
    pub lean: f32,
}

impl Default for Fringe {
    fn default() -> Self {
        Self { length: 0.09, depth: 0.05, width: 0.12, lean: 0.0 }
    }
}

impl Settings for Fringe {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, length), [0.01, 0.4], "Length", "Length of the fringe.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, depth),
            [0.005, 0.2],
            "Depth",
            "How far behind the foremost hair the fringe begins.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(field!(Self, width), [0.01, 0.3], "Width", "Width of the fringe on the scalp.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, lean),
            [-1.2, 1.2],
            "Lean",
            "Angle of the fringe. Positive values sweep it to the wearer's left.",
        )
        .unit(Unit::RADIANS),
    ];
}

impl Operate for Fringe {
    const KIND: Kind = Kind {
        id: "fringe",
        label: "Fringe",
        text: "Brings front hair forward over the forehead and shortens it.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let head = &scope.head;
        let part = |root: Vec3| {
            let back = head.middle.z + head.half.z - root.z;
            let aside = (root.x - head.middle.x).abs();
            let half = 0.5 * self.width;
            (1.0 - smoothstep(0.8 * self.depth, self.depth, back))
                * (1.0 - smoothstep(0.9 * half, half, aside))
        };
        // A wisp belongs to the fringe as a whole; its strands would hang between two courses.
        let of_wisp: Vec<f32> = wisp_roots(style).into_iter().map(part).collect();
        let wisp_of = wisp_of_guide(style);
        let belongs =
            |guide: usize, root: Vec3| wisp_of[guide].map_or_else(|| part(root), |wisp| of_wisp[wisp]);
        reshape(style, scope, Lengths::Keep, |shape| {
            let belongs = belongs(shape.index, shape.points[0]);
            if belongs == 0.0 {
                return;
            }
            let (link, strength, count) = (shape.link, shape.strength, shape.points.len());
            let body = Bounded(scope.obstacle);
            let forward = Vec3::new(self.lean.sin(), 0.0, self.lean.cos());
            turn_links(shape, |i, at, direction| {
                // Forward over the top of the head, then down over the forehead.
                let (distance, normal) = body.distance(at);
                let fall = smoothstep(0.0, 0.7 * self.length, i as f32 * link);
                let wanted = (forward * (1.0 - 0.7 * fall) + Vec3::NEG_Y * (0.3 + 0.7 * fall))
                    .normalize_or(Vec3::NEG_Y);
                let near = 1.0 - (distance / 0.03).clamp(0.0, 1.0);
                let target = (wanted - normal * (wanted.dot(normal).min(0.0) * near)).normalize_or(wanted);
                let amount = belongs * strength * scope.along(i as f32 / (count - 1) as f32);
                direction.lerp(target, amount.clamp(0.0, 1.0))
            });
        });
        shorten(style, scope, |shape| {
            let amount = (belongs(shape.index, shape.points[0]) * shape.strength).clamp(0.0, 1.0);
            1.0 + ((self.length / shape.length()).min(1.0) - 1.0) * amount
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guides::shape_of;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn front_hair_goes_forward_and_becomes_short_and_the_rest_stays() {
        let before = straight(Vec3::NEG_Z);
        let fringe = Fringe { depth: 0.1, width: 0.3, ..Fringe::default() };
        let after = acted(fringe.clone(), &before);
        let head = crate::HeadBox::of(&before.scalp);
        let (mut front, mut rest) = (0, 0);
        let last = before.guides.points_per_guide - 1;
        for wisp in &before.wisps {
            let roots = wisp.guides.map(|g| before.guides.point(g as usize, 0));
            let back = roots.map(|root| head.middle.z + head.half.z - root.z);
            let within = back.iter().all(|back| *back < 0.08)
                && roots.iter().all(|root| (root.x - head.middle.x).abs() < 0.13);
            for (g, root) in wisp.guides.map(|g| g as usize).into_iter().zip(roots) {
                let tip = after.guides.point(g, last);
                if within {
                    front += 1;
                    // Guides end with the last point of the strands that follow them.
                    let length = shape_of(&after.guides, g, 1.0, None).expect("hair").length();
                    assert!((0.08..0.125).contains(&length), "{length}");
                    assert!(tip.z > root.z && tip.y < root.y, "{tip} {root}");
                } else if back.iter().all(|back| *back > fringe.depth) {
                    rest += 1;
                    assert_eq!(tip, before.guides.point(g, last));
                }
            }
        }
        assert!(front > 0 && rest > 0);
    }

    #[test]
    fn a_wisp_belongs_to_the_fringe_as_a_whole() {
        let before = straight(Vec3::NEG_Z);
        let after = acted(Fringe { depth: 0.08, width: 0.14, ..Fringe::default() }, &before);
        let last = before.guides.points_per_guide - 1;
        let mut changed = 0;
        for wisp in &before.wisps {
            let moved =
                |g: u32| after.guides.point(g as usize, last) != before.guides.point(g as usize, last);
            let of_wisp = wisp.guides.map(moved);
            assert!(of_wisp == [true; 3] || of_wisp == [false; 3], "{of_wisp:?}");
            changed += usize::from(of_wisp[0]);
        }
        assert!(changed > 0 && changed < before.wisps.len());
    }
}
