//! Changes of a stack as the list of layers makes them.

use super::{Group, Layer, StyleStack};

impl StyleStack {
    /// Adds a layer at a place of the list, with a number of its own; returns the number, or `None` if the stack is full.
    pub fn insert(&mut self, at: usize, mut layer: Layer) -> Option<u32> {
        if self.layers.len() >= Self::MAX_LAYERS {
            return None;
        }
        layer.id = self.layers.iter().map(|layer| layer.id).max().unwrap_or(0).checked_add(1)?;
        let id = layer.id;
        self.layers.insert(at.min(self.layers.len()), layer);
        self.gather_groups();
        Some(id)
    }

    /// Adds a layer at the end: see [`StyleStack::insert`].
    pub fn push(&mut self, layer: Layer) -> Option<u32> {
        self.insert(self.layers.len(), layer)
    }

    /// Adds a copy of a layer after it; returns the copy's number.
    pub fn duplicate(&mut self, id: u32) -> Option<u32> {
        let at = self.layers.iter().position(|layer| layer.id == id)?;
        self.insert(at + 1, self.layers[at].clone())
    }

    /// Removes a layer.
    pub fn remove(&mut self, id: u32) {
        self.layers.retain(|layer| layer.id != id);
        self.solo = self.solo.filter(|solo| *solo != id);
        self.drop_empty_groups();
    }

    /// Moves a layer so that it stands before the one that is at `to` now, in the group `group`.
    pub fn move_to(&mut self, id: u32, to: usize, group: Option<u32>) {
        let Some(at) = self.layers.iter().position(|layer| layer.id == id) else { return };
        let mut layer = self.layers.remove(at);
        layer.group = group;
        let to = if to > at { to - 1 } else { to };
        self.layers.insert(to.min(self.layers.len()), layer);
        self.gather_groups();
        self.drop_empty_groups();
    }

    /// Puts layers into a new group; returns its number.
    pub fn make_group(&mut self, ids: &[u32], name: &str) -> Option<u32> {
        if self.groups.len() >= Self::MAX_GROUPS || !self.layers.iter().any(|layer| ids.contains(&layer.id)) {
            return None;
        }
        let id = self.groups.iter().map(|group| group.id).max().unwrap_or(0).checked_add(1)?;
        self.groups.push(Group { id, name: name.to_owned(), ..Group::default() });
        for layer in self.layers.iter_mut().filter(|layer| ids.contains(&layer.id)) {
            layer.group = Some(id);
        }
        self.gather_groups();
        self.drop_empty_groups();
        Some(id)
    }

    /// Takes the layers out of a group, which is removed.
    pub fn ungroup(&mut self, id: u32) {
        for layer in self.layers.iter_mut().filter(|layer| layer.group == Some(id)) {
            layer.group = None;
        }
        self.drop_empty_groups();
    }

    /// Removes a group with its layers.
    pub fn remove_group(&mut self, id: u32) {
        let removed = |layer: &Layer| layer.group == Some(id);
        self.solo = self.solo.filter(|solo| !self.layers.iter().any(|l| l.id == *solo && removed(l)));
        self.layers.retain(|layer| !removed(layer));
        self.drop_empty_groups();
    }

    /// Moves a group so that its layers stand before the layer that is at `to` now; not into another group.
    pub fn move_group(&mut self, id: u32, to: usize) {
        let in_group = |layer: &Layer| layer.group == Some(id);
        let to = to.min(self.layers.len());
        // Another group is not divided.
        let inside = self.layers.get(to).and_then(|layer| layer.group).filter(|group| *group != id);
        let to =
            inside.and_then(|group| self.layers.iter().position(|l| l.group == Some(group))).unwrap_or(to);
        let before = self.layers[..to].iter().filter(|layer| !in_group(layer)).count();
        let (moved, mut rest): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.layers).into_iter().partition(|layer| in_group(layer));
        rest.splice(before..before, moved);
        self.layers = rest;
    }

    /// Gives each layer and group a number of its own; those that have one keep it.
    pub(super) fn number(&mut self) {
        let mut taken = std::collections::BTreeSet::new();
        let mut highest =
            self.layers.iter().map(|layer| layer.id).filter(|id| *id < u32::MAX).max().unwrap_or(0);
        for layer in &mut self.layers {
            if layer.id == 0 || layer.id == u32::MAX || !taken.insert(layer.id) {
                highest += 1;
                layer.id = highest;
                taken.insert(highest);
            }
        }
        let mut taken = std::collections::BTreeSet::new();
        self.groups.retain(|group| group.id != u32::MAX && taken.insert(group.id));
        for layer in &mut self.layers {
            layer.group = layer.group.filter(|id| taken.contains(id));
        }
        self.solo = self.solo.filter(|id| self.layers.iter().any(|layer| layer.id == *id));
        self.solo_group =
            self.solo_group.filter(|id| self.layers.iter().any(|layer| layer.group == Some(*id)));
    }

    /// Brings the layers of each group together, at the place of the first of them.
    pub(super) fn gather_groups(&mut self) {
        let order = |layer: &Layer, i: usize| {
            let first = self.layers.iter().position(|other| other.group == layer.group);
            layer.group.and(first).unwrap_or(i)
        };
        let mut places: Vec<(usize, usize)> =
            self.layers.iter().enumerate().map(|(i, layer)| (order(layer, i), i)).collect();
        places.sort_unstable();
        let layers = places.into_iter().map(|(_, i)| self.layers[i].clone()).collect();
        self.layers = layers;
    }

    fn drop_empty_groups(&mut self) {
        let Self { layers, groups, .. } = self;
        groups.retain(|group| layers.iter().any(|layer| layer.group == Some(group.id)));
        self.solo_group = self.solo_group.filter(|solo| self.groups.iter().any(|group| group.id == *solo));
    }
}
