//! One part of a mask: a region of the head.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::MaskMap;

/// A region of the head.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum MaskRegion {
    /// Everywhere.
    #[default]
    All,
    /// The wearer's left of a plane.
    Left,
    /// The wearer's right of it.
    Right,
    /// In front of a plane.
    Front,
    /// Behind it.
    Back,
    /// Above a height.
    Top,
    /// Below it.
    Bottom,
    /// Around the place where the head is roundest behind its top.
    Crown,
    /// The lowest hair at the back.
    Nape,
    /// Both sides above and before the ears.
    Temples,
    /// Along the middle from the forehead to the nape.
    Middle,
    /// A sphere around a place.
    Patch,
    /// What was painted.
    Painted,
    /// A region of another version, which counts as empty.
    Unknown(String),
}

impl MaskRegion {
    /// Every region of this version, with its id and its label.
    pub const ALL: [(Self, &'static str, &'static str); 13] = [
        (Self::All, "all", "Everywhere"),
        (Self::Left, "left", "Left side"),
        (Self::Right, "right", "Right side"),
        (Self::Front, "front", "Front"),
        (Self::Back, "back", "Back"),
        (Self::Top, "top", "Top"),
        (Self::Bottom, "bottom", "Below a height"),
        (Self::Crown, "crown", "Crown"),
        (Self::Nape, "nape", "Nape"),
        (Self::Temples, "temples", "Temples"),
        (Self::Middle, "middle", "Middle line"),
        (Self::Patch, "patch", "Patch"),
        (Self::Painted, "painted", "Painted"),
    ];

    /// The id in files.
    pub fn id(&self) -> &str {
        match self {
            Self::Unknown(id) => id,
            known => Self::ALL.iter().find(|(region, ..)| region == known).map_or("all", |(_, id, _)| id),
        }
    }

    /// The name in the window.
    pub fn label(&self) -> &str {
        match self {
            Self::Unknown(id) => id,
            known => Self::ALL.iter().find(|(region, ..)| region == known).map_or("", |(.., label)| label),
        }
    }

    /// The region with an id.
    pub fn from_id(id: &str) -> Self {
        let known = Self::ALL.into_iter().find(|(_, known, _)| *known == id);
        known.map_or_else(|| Self::Unknown(id.to_owned()), |(region, ..)| region)
    }
}

impl Serialize for MaskRegion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

impl<'de> Deserialize<'de> for MaskRegion {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|id| Self::from_id(&id))
    }
}

/// How a part is combined with the parts before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MaskMix {
    /// Where both are.
    #[default]
    Multiply,
    /// Where either is.
    Add,
    /// Where those before are and this is not.
    Subtract,
}

impl Choices for MaskMix {
    const ALL: &'static [Self] = &[Self::Multiply, Self::Add, Self::Subtract];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Multiply => ("multiply", "Within"),
            Self::Add => ("add", "Plus"),
            Self::Subtract => ("subtract", "Minus"),
        }
    }
}

/// One part of a mask. It keeps the values of all regions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MaskPart {
    /// Which region it is.
    pub region: MaskRegion,
    /// How it is combined with the parts before it.
    pub mix: MaskMix,
    /// Whether it is turned round.
    pub inverted: bool,
    /// Where the border lies, as a fraction of half the head: moves planes and heights, and makes crown, nape, temples and middle
    /// larger.
    pub border: f32,
    /// Width of the transition at the border, in the same measure.
    pub softness: f32,
    /// Middle of a patch, relative to the head: 1 is its side.
    pub centre: Vec3,
    /// Radius of a patch, in the same measure.
    pub radius: f32,
    /// What was painted.
    pub map: MaskMap,
}

impl Default for MaskPart {
    fn default() -> Self {
        Self {
            region: MaskRegion::All,
            mix: MaskMix::Multiply,
            inverted: false,
            border: 0.0,
            softness: 0.15,
            centre: Vec3::new(0.0, 0.8, 0.5),
            radius: 0.5,
            map: MaskMap::default(),
        }
    }
}

impl Settings for MaskPart {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<MaskMix>(
            field!(Self, mix),
            "Combine",
            "How the region is combined with those before it. Within keeps the overlap, Plus adds the region, Minus removes it.",
        ),
        Setting::switch(
            field!(Self, inverted),
            "Invert",
            "Inverts the region: the layer acts on the rest of the head.",
        ),
        Setting::number(
            field!(Self, border),
            [-1.5, 1.5],
            "Border",
            "Moves the border of the region, as a fraction of half the head.",
        ),
        Setting::number(
            field!(Self, softness),
            [0.0, 2.0],
            "Softness",
            "Width of the transition at the border, as a fraction of half the head.",
        ),
        Setting::vector(
            field!(Self, centre),
            [-1.5, 1.5],
            "Patch position",
            ["Sideways", "Upward", "Forward"],
            "Middle of the patch: 1 is the side of the head toward the wearer's left, the top and the face.",
        ),
        Setting::number(
            field!(Self, radius),
            [0.0, 3.0],
            "Patch radius",
            "Radius of the patch, as a fraction of half the head.",
        )
        .unit(Unit::NONE),
    ];
}

/// Directions to the middles of regions, relative to the head.
const CROWN: Vec3 = Vec3::new(0.0, 0.88, -0.47);
/// Distances of the borders of regions when [`MaskPart::border`] is 0.
const CROWN_RADIUS: f32 = 0.55;
const NAPE_TOP: f32 = -0.45;
const TEMPLES_BACK: f32 = 0.1;
const MIDDLE_WIDTH: f32 = 0.25;

impl MaskPart {
    /// A part of that region with its usual border.
    pub fn region(region: MaskRegion) -> Self {
        Self { region, ..Self::default() }
    }

    /// The part at a place relative to the head, 0 to 1.
    pub fn at(&self, place: Vec3) -> f32 {
        // Positive inside the region.
        let depth = match &self.region {
            MaskRegion::All => f32::MAX,
            MaskRegion::Left => place.x - self.border,
            MaskRegion::Right => self.border - place.x,
            MaskRegion::Front => place.z - self.border,
            MaskRegion::Back => self.border - place.z,
            MaskRegion::Top => place.y - self.border,
            MaskRegion::Bottom => self.border - place.y,
            MaskRegion::Crown => CROWN_RADIUS + self.border - place.distance(CROWN),
            MaskRegion::Nape => (NAPE_TOP + self.border - place.y).min(-0.1 - place.z),
            MaskRegion::Temples => {
                (place.x.abs() - 0.5 + self.border).min(place.z - TEMPLES_BACK + self.border)
            }
            MaskRegion::Middle => MIDDLE_WIDTH + self.border - place.x.abs(),
            MaskRegion::Patch => self.radius - place.distance(self.centre),
            MaskRegion::Painted => return self.turned(self.map.at(place)),
            MaskRegion::Unknown(_) => return 0.0,
        };
        let half = 0.5 * self.softness;
        self.turned(if half > 0.0 { smoothstep(-half, half, depth) } else { f32::from(depth >= 0.0) })
    }

    fn turned(&self, value: f32) -> f32 {
        if self.inverted { 1.0 - value } else { value }
    }

    /// The part with every number in its range.
    #[must_use]
    pub fn clamped(&self) -> Self {
        Settings::clamped(self)
    }
}
