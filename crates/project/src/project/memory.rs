//! The memory of a project beside another one, with which it shares what brushes did.

use lovelock_base::memory::list_bytes;
use lovelock_style::hand::HandEdits;
use lovelock_style::{Layer, Operation};

use super::{HairSection, Project};
use crate::tracks::Track;

impl Project {
    /// Bytes of memory that this has and `other` does not share with it.
    pub fn bytes_beside(&self, other: &Self) -> u64 {
        let tracks = &self.timeline.tracks;
        let of_track = |track: &Track| {
            list_bytes(&track.keys) + track.keys.iter().map(|key| list_bytes(&key.value)).sum::<u64>()
        };
        let morph = self.hair.morph.to.as_ref().map_or(0, |to| of_hair(&to.hair, other));
        size_of::<Self>() as u64
            + list_bytes(tracks)
            + tracks.iter().map(of_track).sum::<u64>()
            + list_bytes(&self.timeline.markers)
            + list_bytes(&self.compare.panes)
            + list_bytes(&self.lights)
            + list_bytes(&self.body.other_scalps)
            + of_hair(&self.hair, other)
            + morph
    }
}

fn of_hair(hair: &HairSection, other: &Project) -> u64 {
    let to = other.hair.morph.to.as_ref().map_or(&[][..], |to| &to.hair.stack.layers);
    let of_layer = |layer: &Layer| {
        let before = other.hair.stack.layers.iter().chain(to).find(|before| before.id == layer.id);
        layer_bytes(layer, before)
    };
    let layers = &hair.stack.layers;
    size_of::<HairSection>() as u64
        + list_bytes(&hair.cut.kept)
        + list_bytes(&hair.ties)
        + list_bytes(layers)
        + layers.iter().map(of_layer).sum::<u64>()
}

fn layer_bytes(layer: &Layer, before: Option<&Layer>) -> u64 {
    let hand = match (&layer.operation, before.map(|before| &before.operation)) {
        (Operation::Hand(hand), Some(Operation::Hand(before))) => hand.edits.bytes_beside(&before.edits),
        (Operation::Hand(hand), _) => hand.edits.bytes_beside(&HandEdits::default()),
        _ => 0,
    };
    let maps = layer.mask.parts.iter().enumerate().map(|(k, part)| {
        let before = before.and_then(|before| before.mask.parts.get(k)).map(|part| &part.map);
        part.map.bytes_beside(before)
    });
    hand as u64 + list_bytes(&layer.mask.parts) + maps.sum::<u64>()
}
