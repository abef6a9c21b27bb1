//! What an artist sets about a tie.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Scalp, ScalpIndex};
use lovelock_base::numbers::within;

/// What becomes of the hair beyond a tie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieKind {
    /// It hangs and swings.
    #[default]
    Ponytail,
    /// It is wound around the tie's axis and pinned.
    Bun,
}

/// Which hair a tie gathers, by its roots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieReach {
    /// All that is long enough.
    #[default]
    All,
    /// What grows behind the ears.
    BehindEars,
    /// What grows above a plane: [`HairTie::plane_point`] and [`HairTie::plane_normal`].
    AbovePlane,
    /// What grows inside a sphere: [`HairTie::sphere_centre`] and [`HairTie::sphere_radius`].
    InSphere,
}

/// A hair tie: a ring that gathers hair. Head space; values that another kind or reach uses are kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairTie {
    /// What becomes of the hair beyond it.
    pub kind: TieKind,
    /// Centre of the ring, metres, each coordinate -0.6 to 0.6. A ring inside the head is moved out of it.
    pub at: Vec3,
    /// Direction in which hair leaves the ring: any vector but zero.
    pub axis: Vec3,
    /// Radius of the opening, metres, 0.004 to 0.05.
    pub radius: f32,
    /// How firmly hair lies on the head before the tie: 0 loose, 1 combed tight.
    pub tightness: f32,
    /// Outer radius of a bun, metres, 0.015 to 0.12.
    pub bun_radius: f32,
    /// How often the hair of a bun goes around the axis while its lock turns once about itself, 0.5 to 8.
    pub bun_coils: f32,
    /// Which hair it gathers.
    pub reach: TieReach,
    /// A point of the plane of [`TieReach::AbovePlane`], metres, each coordinate -0.6 to 0.6.
    pub plane_point: Vec3,
    /// The side of that plane on which hair is gathered: any vector but zero.
    pub plane_normal: Vec3,
    /// Whether the sphere of [`TieReach::InSphere`] is around the ring, wherever that is; `sphere_centre` says nothing then. Off in
    /// files that do not tell.
    #[serde(default)]
    pub sphere_at_ring: bool,
    /// Centre of that sphere, metres, each coordinate -0.6 to 0.6.
    pub sphere_centre: Vec3,
    /// Its radius, metres, 0.005 to 0.6.
    pub sphere_radius: f32,
}

impl Default for HairTie {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl HairTie {
    /// The most ties of one hairstyle.
    pub const MOST: usize = 8;

    /// A ponytail at the back of an adult's head.
    pub const DEFAULT: Self = Self {
        kind: TieKind::Ponytail,
        at: Vec3::new(0.0, 0.14, -0.09),
        axis: Vec3::new(0.0, 0.3, -1.0),
        radius: 0.014,
        tightness: 0.7,
        bun_radius: 0.05,
        bun_coils: 3.0,
        reach: TieReach::All,
        plane_point: Vec3::new(0.0, 0.12, 0.0),
        plane_normal: Vec3::Y,
        sphere_at_ring: true,
        sphere_centre: Vec3::new(0.0, 0.18, -0.06),
        sphere_radius: 0.08,
    };

    /// A tie of that kind on a head, where a ray from the middle of its hair along `direction` leaves it; the
    /// default place on a scalp without hair.
    #[must_use]
    pub fn on(scalp: &Scalp, direction: Vec3, kind: TieKind) -> Self {
        let tie = Self { kind, ..Self::default() };
        let (Some((centre, half)), Some(out)) = (hairy_box(scalp), direction.try_normalize()) else {
            return tie;
        };
        let Some(hit) = ScalpIndex::new(scalp).closest(centre + out * (2.0 * half.max_element())) else {
            return tie;
        };
        Self { at: hit.position + hit.normal * 0.012, axis: Self::axis_over(hit.normal), ..tie }
    }

    /// Where a tie aims that is new on a head whose outward normal there is `normal`, a unit vector: off the head, and a little up.
    #[must_use]
    pub fn axis_over(normal: Vec3) -> Vec3 {
        (normal + Vec3::Y * 0.25).normalize_or(normal)
    }

    /// Where the middle of the sphere of [`TieReach::InSphere`] is, head space, metres.
    pub fn sphere_middle(&self) -> Vec3 {
        if self.sphere_at_ring { self.at } else { self.sphere_centre }
    }

    /// The same tie on the other side of the head.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let [at, axis, plane_point, plane_normal, sphere_centre] =
            [self.at, self.axis, self.plane_point, self.plane_normal, self.sphere_centre]
                .map(|v| Vec3::new(0.0 - v.x, v.y, v.z));
        Self { at, axis, plane_point, plane_normal, sphere_centre, ..*self }
    }

    /// The tie with every value inside its range; what is not a number becomes the default.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let d = Self::default();
        Self {
            kind: self.kind,
            at: place(self.at, d.at),
            axis: direction(self.axis, d.axis),
            radius: within(self.radius, 0.004, 0.05, d.radius),
            tightness: within(self.tightness, 0.0, 1.0, d.tightness),
            bun_radius: within(self.bun_radius, 0.015, 0.12, d.bun_radius),
            bun_coils: within(self.bun_coils, 0.5, 8.0, d.bun_coils),
            reach: self.reach,
            plane_point: place(self.plane_point, d.plane_point),
            plane_normal: direction(self.plane_normal, d.plane_normal),
            sphere_at_ring: self.sphere_at_ring,
            sphere_centre: place(self.sphere_centre, d.sphere_centre),
            sphere_radius: within(self.sphere_radius, 0.005, 0.6, d.sphere_radius),
        }
    }

    /// Whether hair rooted at `root` is to be gathered; `ears` is how far forward the ears are.
    pub(super) fn includes(&self, root: Vec3, ears: f32) -> bool {
        match self.reach {
            TieReach::All => true,
            TieReach::BehindEars => root.z < ears,
            TieReach::AbovePlane => (root - self.plane_point).dot(self.plane_normal) > 0.0,
            TieReach::InSphere => root.distance(self.sphere_middle()) < self.sphere_radius,
        }
    }
}

/// Middle and half of the box of the hairy scalp; `None` where no hair may grow.
pub(super) fn hairy_box(scalp: &Scalp) -> Option<(Vec3, Vec3)> {
    let hairy = scalp.positions.iter().zip(&scalp.mask).filter(|(p, mask)| **mask >= 0.5 && p.is_finite());
    let (low, high) =
        hairy.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), (p, _)| (l.min(*p), h.max(*p)));
    low.cmple(high).all().then(|| (0.5 * (low + high), 0.5 * (high - low)))
}

fn place(p: Vec3, fallback: Vec3) -> Vec3 {
    if p.is_nan() { fallback } else { p.clamp(Vec3::splat(-0.6), Vec3::splat(0.6)) }
}

/// Any direction stays as it is, whatever its length.
fn direction(v: Vec3, fallback: Vec3) -> Vec3 {
    if v.try_normalize().is_some() { v } else { fallback }
}
