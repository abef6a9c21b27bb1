//! A brush that paints masks.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use super::{HeadBox, MaskMap};

/// What a brush does to the mask under it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BrushMode {
    /// Raises it toward 1.
    #[default]
    Add,
    /// Lowers it toward 0.
    Erase,
    /// Brings it closer to its surroundings.
    Smooth,
}

/// A brush that paints masks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MaskBrush {
    /// Radius on the head, metres.
    pub radius: f32,
    /// How much one stroke changes the mask: 1 is completely.
    pub strength: f32,
    /// The outer part of the radius over which the strength falls to 0.
    pub falloff: f32,
    /// Whether the other side of the head is painted as well.
    pub mirror: bool,
}

impl Default for MaskBrush {
    fn default() -> Self {
        Self { radius: 0.025, strength: 0.8, falloff: 0.6, mirror: false }
    }
}

impl Settings for MaskBrush {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, radius),
            [0.002, 0.2],
            "Brush radius",
            "Radius of the brush on the head. The keys [ and ] make it smaller and larger.",
        )
        .unit(Unit::METRES_AS_CM)
        .logarithmic(),
        Setting::number(
            field!(Self, strength),
            [0.0, 1.0],
            "Strength",
            "How much one stroke raises the mask. 100 % paints it white.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, falloff),
            [0.0, 1.0],
            "Falloff",
            "The outer part of the brush over which its strength fades. 0 % has a sharp edge.",
        )
        .unit(Unit::FRACTION),
        Setting::switch(field!(Self, mirror), "Mirror", "Paints the same on the other side of the head."),
    ];
}

/// Directions in which the surroundings of a texel are read for smoothing: 1.5 texels of a map away, radians.
const AROUND: f32 = 1.5 * std::f32::consts::PI / MaskMap::SIDE as f32;

impl MaskBrush {
    /// Steps of a stroke: the distance between two dabs as a fraction of the radius.
    const SPACING: f32 = 0.25;
    /// The most dabs of one movement; a longer one spreads them.
    const MAX_DABS: usize = 64;

    /// Puts the brush down once at `place`, head space. A place or a radius that is not finite paints nothing.
    pub fn dab(&self, map: &mut MaskMap, head: &HeadBox, place: Vec3, mode: BrushMode) {
        let at = head.relative(place);
        let reach = at.length();
        if !(reach.is_finite() && reach > 1e-3 && self.radius > 0.0 && self.radius.is_finite()) {
            return;
        }
        let mirrored = Vec3::new(-at.x, at.y, at.z);
        let core = self.radius * (1.0 - self.falloff.clamp(0.0, 1.0));
        let strength_at = |direction: Vec3, centre: Vec3| {
            // The head is about as far from its middle here as at the brush.
            let metres = (head.half * (direction * reach - centre)).length();
            if metres <= core { 1.0 } else { 1.0 - smoothstep(core, self.radius, metres) }
        };
        let before = map.clone();
        map.paint(|direction, value| {
            // Directions from the middle are those of places relative to the box.
            let own = strength_at(direction, at);
            let both = if self.mirror { own.max(strength_at(direction, mirrored)) } else { own };
            let amount = both * self.strength.clamp(0.0, 1.0);
            if amount <= 0.0 {
                return value;
            }
            let target = match mode {
                BrushMode::Add => 1.0,
                BrushMode::Erase => 0.0,
                BrushMode::Smooth => {
                    let u = direction.any_orthonormal_vector() * AROUND;
                    let v = direction.cross(u);
                    0.25 * [u, -u, v, -v].map(|by| before.at(direction + by)).iter().sum::<f32>()
                }
            };
            value + (target - value) * amount
        });
    }

    /// Moves the brush from where it was put down last to `to`, head space, and puts it down on the way at equal distances. Returns where
    /// it was put down last.
    pub fn stroke(&self, map: &mut MaskMap, head: &HeadBox, [from, to]: [Vec3; 2], mode: BrushMode) -> Vec3 {
        let distance = from.distance(to);
        let spacing = (Self::SPACING * self.radius).max(0.001);
        if !(distance.is_finite() && distance >= spacing) {
            return from;
        }
        let steps = (distance / spacing) as usize;
        let (steps, spacing) = if steps > Self::MAX_DABS {
            (Self::MAX_DABS, distance / Self::MAX_DABS as f32)
        } else {
            (steps, spacing)
        };
        let along = (to - from) / distance;
        for step in 1..=steps {
            self.dab(map, head, from + along * (spacing * step as f32), mode);
        }
        from + along * (spacing * steps as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: HeadBox = HeadBox { middle: Vec3::new(0.0, 0.1, 0.0), half: Vec3::new(0.08, 0.1, 0.1) };

    fn brush() -> MaskBrush {
        MaskBrush { radius: 0.02, strength: 1.0, falloff: 0.5, mirror: false }
    }

    /// The map at a place of head space.
    fn at(map: &MaskMap, place: Vec3) -> f32 {
        map.at(HEAD.relative(place))
    }

    /// A place on the head's left, above its middle by some metres along the surface.
    fn side(up: f32) -> Vec3 {
        let angle = up / 0.1;
        HEAD.middle + Vec3::new(0.08 * angle.cos(), 0.1 * angle.sin(), 0.0)
    }

    #[test]
    fn a_dab_paints_its_circle_and_fades_toward_its_edge() {
        let mut map = MaskMap::default();
        brush().dab(&mut map, &HEAD, side(0.0), BrushMode::Add);
        assert!(at(&map, side(0.0)) > 0.99 && at(&map, side(0.007)) > 0.95);
        let half = at(&map, side(0.015));
        assert!((0.3..0.7).contains(&half), "half of the falloff: {half}");
        assert_eq!(at(&map, side(0.028)), 0.0);
        assert_eq!(at(&map, HEAD.middle - Vec3::X * 0.08), 0.0, "the other side");
        brush().dab(&mut map, &HEAD, side(0.0), BrushMode::Erase);
        assert!(at(&map, side(0.0)) < 0.01);
        let mut mirrored = MaskMap::default();
        let both = MaskBrush { mirror: true, ..brush() };
        both.dab(&mut mirrored, &HEAD, side(0.0), BrushMode::Add);
        for x in [-0.08, 0.08] {
            assert!(at(&mirrored, HEAD.middle + Vec3::X * x) > 0.99);
        }
        // On the middle line both circles are one: it is painted once.
        let [mut once, mut twice] = [MaskMap::default(), MaskMap::default()];
        let weak = MaskBrush { strength: 0.5, ..brush() };
        weak.dab(&mut once, &HEAD, HEAD.middle + Vec3::Y * 0.1, BrushMode::Add);
        MaskBrush { mirror: true, ..weak }.dab(
            &mut twice,
            &HEAD,
            HEAD.middle + Vec3::Y * 0.1,
            BrushMode::Add,
        );
        assert_eq!(once, twice);
    }

    #[test]
    fn smoothing_levels_an_edge_and_leaves_even_places() {
        let mut map = MaskMap::default();
        map.paint(|direction, _| f32::from(direction.y > 0.0));
        let edge = |map: &MaskMap| at(map, side(0.004)) - at(map, side(-0.004));
        let before = edge(&map);
        for _ in 0..8 {
            brush().dab(&mut map, &HEAD, side(0.0), BrushMode::Smooth);
        }
        assert!(before > 0.9 && edge(&map) < 0.7 * before, "{before} {}", edge(&map));
        let even = map.clone();
        brush().dab(&mut map, &HEAD, HEAD.middle + Vec3::Y * 0.1, BrushMode::Smooth);
        assert_eq!(map, even);
    }

    #[test]
    fn a_stroke_does_not_depend_on_how_often_the_pointer_is_read() {
        let weak = MaskBrush { strength: 0.2, ..brush() };
        let [from, to] = [side(-0.05), side(0.05)];
        let [mut fine, mut coarse] = [MaskMap::default(), MaskMap::default()];
        weak.stroke(&mut coarse, &HEAD, [from, to], BrushMode::Add);
        let mut last = from;
        for i in 1..=100 {
            last = weak.stroke(&mut fine, &HEAD, [last, from.lerp(to, i as f32 / 100.0)], BrushMode::Add);
        }
        let off = |up: f32| (at(&fine, side(up)) - at(&coarse, side(up))).abs();
        for up in [-0.03, 0.0, 0.03] {
            assert!(at(&coarse, side(up)) > 0.3 && off(up) < 0.03, "{up}: {}", off(up));
        }
    }

    #[test]
    fn strange_brushes_paint_nothing_or_everything_and_do_not_hang() {
        let mut map = MaskMap::default();
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let strange = MaskBrush { radius, ..brush() };
            strange.dab(&mut map, &HEAD, side(0.0), BrushMode::Add);
            strange.stroke(&mut map, &HEAD, [side(0.0), side(0.01)], BrushMode::Add);
        }
        brush().dab(&mut map, &HEAD, HEAD.middle, BrushMode::Add);
        brush().dab(&mut map, &HEAD, Vec3::NAN, BrushMode::Add);
        brush().stroke(&mut map, &HEAD, [Vec3::NAN, side(0.0)], BrushMode::Add);
        assert!(map.is_empty());
        let huge = MaskBrush { radius: 1e6, falloff: 0.0, ..brush() };
        huge.dab(&mut map, &HEAD, side(0.0), BrushMode::Add);
        assert_eq!(at(&map, HEAD.middle - Vec3::Y * 0.1), 1.0);
        // A movement across the world is not a million dabs.
        brush().stroke(&mut map, &HEAD, [side(0.0), Vec3::X * 1e6], BrushMode::Add);
    }
}
