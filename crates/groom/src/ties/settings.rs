//! What an artist sets about a tie.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::{Scalp, ScalpIndex};

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
    /// Centre of the ring, metres. A ring inside the head is moved out of it.
    pub at: Vec3,
    /// Direction in which hair leaves the ring: any vector but zero.
    pub axis: Vec3,
    /// Radius of the opening, metres.
    pub radius: f32,
    /// How firmly hair lies on the head before the tie: 0 loose, 1 combed tight.
    pub tightness: f32,
    /// Outer radius of a bun, metres.
    pub bun_radius: f32,
    /// Turns of the hair of a bun around the axis while it turns once about itself.
    pub bun_coils: f32,
    /// Which hair it gathers.
    pub reach: TieReach,
    /// A point of the plane of [`TieReach::AbovePlane`], metres.
    pub plane_point: Vec3,
    /// The side of that plane on which hair is gathered: any vector but zero.
    pub plane_normal: Vec3,
    /// Whether the sphere of [`TieReach::InSphere`] is around the ring, wherever that is; `sphere_centre` says nothing then. Off in
    /// files that do not tell.
    #[serde(default)]
    pub sphere_at_ring: bool,
    /// Centre of that sphere, metres.
    pub sphere_centre: Vec3,
    /// Its radius, metres.
    pub sphere_radius: f32,
}

impl Default for HairTie {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Choices for TieKind {
    const ALL: &'static [Self] = &[Self::Ponytail, Self::Bun];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Ponytail => ("Ponytail", "Ponytail"),
            Self::Bun => ("Bun", "Bun"),
        }
    }
}

impl Choices for TieReach {
    const ALL: &'static [Self] = &[Self::All, Self::BehindEars, Self::AbovePlane, Self::InSphere];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::All => ("All", "All hair that is long enough"),
            Self::BehindEars => ("BehindEars", "Hair behind the ears"),
            Self::AbovePlane => ("AbovePlane", "Hair above a plane"),
            Self::InSphere => ("InSphere", "Hair in a patch"),
        }
    }
}

/// How far from the origin of head space each coordinate of a place may be, metres.
const REACH: [f64; 2] = [-0.6, 0.6];

impl Settings for HairTie {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<TieKind>(
            field!(Self, kind),
            "Style",
            "What the hair does beyond the tie: hangs down, or winds into a bun.",
        ),
        Setting::vector(
            field!(Self, at),
            REACH,
            "Position",
            ["Sideways", "Upward", "Forward"],
            "Moves the tie toward the dancer's left, up, or to the front. It can also be dragged in \
             the image.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::direction(field!(Self, axis), "Direction", "Direction in which hair leaves the tie."),
        Setting::number(field!(Self, radius), [0.004, 0.05], "Ring radius", "Radius of the tie's opening.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, tightness),
            [0.0, 1.0],
            "Tightness",
            "How firmly hair lies on the head before the tie: 0 % is loose, 100 % combed tight.",
        )
        .unit(Unit::FRACTION),
        Setting::number(field!(Self, bun_radius), [0.015, 0.12], "Bun radius", "Outer radius of the bun.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, bun_coils),
            [0.5, 8.0],
            "Coils",
            "Turns of the hair around the bun while it turns once about itself. Lower values twist \
             it more.",
        )
        .decimals(1),
        Setting::choice::<TieReach>(
            field!(Self, reach),
            "Gathered hair",
            "Which hair the tie gathers, by where it grows. Where several ties reach the same hair, \
             the first one gathers it.",
        ),
        Setting::vector(
            field!(Self, plane_point),
            REACH,
            "Plane position",
            ["Parting", "Height", "Depth"],
            "A point of the plane that divides gathered hair from the rest. Left is the dancer's.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::direction(
            field!(Self, plane_normal),
            "Plane direction",
            "The side of the plane on which hair is gathered.",
        ),
        Setting::switch(
            field!(Self, sphere_at_ring),
            "Follow ring",
            "Moves the patch with the tie. Off, the patch has its own position.",
        ),
        Setting::vector(
            field!(Self, sphere_centre),
            REACH,
            "Patch position",
            ["Patch sideways", "Patch upward", "Patch forward"],
            "Moves the patch toward the dancer's left, up, or to the front.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, sphere_radius),
            [0.005, 0.6],
            "Patch radius",
            "Radius of the patch whose hair is gathered.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl HairTie {
    /// The most ties of one hairstyle.
    pub const MAX: usize = 8;

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
        let (Some((centre, half)), Some(out)) = (scalp.hairy_box(), direction.try_normalize()) else {
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
