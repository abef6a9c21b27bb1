//! A style: layers in their order, and groups of them.

mod edit;
mod layer;
#[cfg(test)]
mod tests;

use lovelock_base::settings::{Part, PartMut, Setting, Settings};
use serde::{Deserialize, Serialize};

use crate::Operation;
use crate::hand::HandEdits;

pub use layer::{Group, Layer};

/// An ordered list of operations on a hairstyle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StyleStack {
    /// The layers, in the order in which they act.
    pub layers: Vec<Layer>,
    /// The groups that layers name.
    pub groups: Vec<Group>,
    /// The only layer that acts, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solo: Option<u32>,
    /// The only group whose layers act, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solo_group: Option<u32>,
}

impl StyleStack {
    /// The most layers.
    pub const MAX_LAYERS: usize = 256;
    /// The most groups.
    pub const MAX_GROUPS: usize = 64;

    /// The layer with that number.
    pub fn layer(&self, id: u32) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.id == id)
    }

    /// The same, to be changed.
    pub fn layer_mut(&mut self, id: u32) -> Option<&mut Layer> {
        self.layers.iter_mut().find(|layer| layer.id == id)
    }

    /// What brushes did in a layer; `None` if it is none of theirs.
    pub fn hand(&self, id: u32) -> Option<&HandEdits> {
        match &self.layer(id)?.operation {
            Operation::Hand(hand) => Some(&hand.edits),
            _ => None,
        }
    }

    /// The layer that brushes write to: `chosen` if it is one of theirs, otherwise the last of them. One that does not act would not keep
    /// what is brushed, and is passed over.
    pub fn hand_layer(&self, chosen: Option<u32>) -> Option<u32> {
        let takes = |layer: &&Layer| {
            matches!(layer.operation, Operation::Hand(_)) && self.factor(layer) * layer.weight > 0.0
        };
        let chosen = chosen.and_then(|id| self.layer(id)).filter(takes);
        chosen.or_else(|| self.layers.iter().rev().find(takes)).map(|layer| layer.id)
    }

    /// The group with that number.
    pub fn group(&self, id: u32) -> Option<&Group> {
        self.groups.iter().find(|group| group.id == id)
    }

    /// The factor that a layer's group and the solo layer put on its weight: 0 where it does not act.
    pub fn factor(&self, layer: &Layer) -> f32 {
        let group = layer.group.and_then(|id| self.group(id));
        let heard = self.solo.is_none_or(|solo| solo == layer.id)
            && self.solo_group.is_none_or(|solo| layer.group == Some(solo));
        let on = layer.on && heard && group.is_none_or(|group| group.on);
        if on { group.map_or(1.0, |group| group.weight) } else { 0.0 }
    }

    /// Ids of operations and regions of masks that this version does not know, with the names of their layers.
    pub fn unknown(&self) -> Vec<(String, String)> {
        let mut out = Vec::new();
        for layer in &self.layers {
            if layer.operation.known().is_none() {
                out.push((layer.label().to_owned(), layer.operation.id().to_owned()));
            }
            out.extend(layer.mask.unknown().map(|id| (layer.label().to_owned(), id.to_owned())));
        }
        out
    }
}

impl Settings for StyleStack {
    const TABLE: &'static [Setting<Self>] = &[];

    /// Layers by their numbers and not by their places, so that tracks follow a layer that is moved.
    fn parts(&self) -> Vec<Part<'_>> {
        let groups =
            self.groups.iter().map(|group| -> Part<'_> { (format!("group{}", group.id).into(), group) });
        let layers = self.layers.iter().map(|layer| -> Part<'_> { (layer.id.to_string().into(), layer) });
        groups.chain(layers).collect()
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        let groups = self
            .groups
            .iter_mut()
            .map(|group| -> PartMut<'_> { (format!("group{}", group.id).into(), group) });
        let layers =
            self.layers.iter_mut().map(|layer| -> PartMut<'_> { (layer.id.to_string().into(), layer) });
        groups.chain(layers).collect()
    }

    /// Limits the numbers of layers and groups, gives each layer a number of its own, and keeps the layers of a group together.
    fn reconcile(&mut self) {
        self.layers.truncate(Self::MAX_LAYERS);
        self.groups.truncate(Self::MAX_GROUPS);
        self.number();
        self.gather_groups();
    }
}
