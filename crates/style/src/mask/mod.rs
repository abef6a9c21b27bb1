//! Masks: how much of an operation the hair at each place of the scalp gets.

mod brush;
mod region;
#[cfg(test)]
mod tests;

use glam::Vec3;
pub use lovelock_base::direction_map::DirectionMap as MaskMap;
use lovelock_groom::Scalp;
use serde::{Deserialize, Serialize};

pub use brush::{BrushMode, MaskBrush};
pub use region::{MaskMix, MaskPart, MaskRegion};

/// How much of an operation the hair at each place gets: parts that are combined one after another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Mask {
    /// The parts; without any, the mask is 1 everywhere.
    pub parts: Vec<MaskPart>,
    /// Whether the combined mask is turned round: 1 becomes 0.
    pub inverted: bool,
}

impl Mask {
    /// The most parts.
    pub const MAX_PARTS: usize = 16;

    /// A mask of one part.
    pub fn of(part: MaskPart) -> Self {
        Self { parts: vec![part], inverted: false }
    }

    /// Its part that is painted, which is added where there is none: as its only one, or so that it adds to those before it. `None` if
    /// there are too many parts.
    pub fn painted_mut(&mut self) -> Option<&mut MaskPart> {
        let painted = self.parts.iter().position(|part| part.region == MaskRegion::Painted);
        if painted.is_none() && self.parts.len() < Self::MAX_PARTS {
            self.parts.push(MaskPart { mix: MaskMix::Add, ..MaskPart::region(MaskRegion::Painted) });
        }
        self.parts.iter_mut().find(|part| part.region == MaskRegion::Painted)
    }

    /// Its part that is painted, if any, and whether what is painted there lowers the mask.
    pub fn painted(&self) -> Option<(&MaskPart, bool)> {
        let (i, part) = self.parts.iter().enumerate().find(|(_, part)| part.region == MaskRegion::Painted)?;
        let lowers = part.inverted ^ self.inverted ^ (i > 0 && part.mix == MaskMix::Subtract);
        Some((part, lowers))
    }

    /// Whether the mask is 1 everywhere.
    pub fn is_everywhere(&self) -> bool {
        self.parts.is_empty() && !self.inverted
    }

    /// Ids of regions that this version does not know.
    pub fn unknown(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().filter_map(|part| match &part.region {
            MaskRegion::Unknown(id) => Some(id.as_str()),
            _ => None,
        })
    }

    /// The mask at a place of a head, 0 to 1.
    pub fn at(&self, head: &HeadBox, place: Vec3) -> f32 {
        let place = head.relative(place);
        let mut value = 1.0;
        for (i, part) in self.parts.iter().enumerate() {
            let own = part.at(place);
            value = match part.mix {
                _ if i == 0 => own,
                MaskMix::Multiply => value * own,
                MaskMix::Add => value.max(own),
                MaskMix::Subtract => value * (1.0 - own),
            };
        }
        if self.inverted { 1.0 - value } else { value }
    }

    /// The mask with every number in its range.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let parts = self.parts.iter().take(Self::MAX_PARTS).map(MaskPart::clamped);
        Self { parts: parts.collect(), inverted: self.inverted }
    }
}

/// The box of the hair on a head. Masks are measured in it, so that they suit a head of any size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadBox {
    /// Its middle, head space, metres.
    pub middle: Vec3,
    /// Half of its size, metres.
    pub half: Vec3,
}

impl HeadBox {
    /// The box of the scalp where its mask is at least a half; a box of 0.1 m around the origin where none is.
    pub fn of(scalp: &Scalp) -> Self {
        match scalp.hairy_box() {
            Some((middle, half)) => Self { middle, half: half.max(Vec3::splat(1e-3)) },
            None => Self { middle: Vec3::ZERO, half: Vec3::splat(0.1) },
        }
    }

    /// A place relative to the box: 0 is its middle and ±1 its sides; x is toward the wearer's left, y up, z toward the face.
    pub fn relative(&self, place: Vec3) -> Vec3 {
        (place - self.middle) / self.half
    }

    /// The place of a head that has these relative coordinates.
    pub fn place(&self, relative: Vec3) -> Vec3 {
        self.middle + relative * self.half
    }
}
