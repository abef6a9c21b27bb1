//! What a file says of whole strands and this program hands on: their groups, and where their roots lie on a surface.

use std::collections::{BTreeMap, BTreeSet};

use lovelock_base::memory::list_bytes;
use lovelock_base::words::counted;

/// The most groups that a note lists.
const LISTED: usize = 8;

/// The groups of strands, and the places of their roots on a surface. Each list has one entry per strand, or is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrandMarks {
    /// The number of each strand's group, as in `groom_group_id` of Unreal's grooms.
    pub groups: Vec<i32>,
    /// The names of groups that have one, by their numbers.
    pub group_names: BTreeMap<i32, String>,
    /// The coordinates of each root in the texture of its surface, as in `groom_root_uv` and in Blender's `surface_uv_coordinate`.
    pub root_uvs: Vec<[f32; 2]>,
}

impl StrandMarks {
    /// The memory of the lists, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.groups) + list_bytes(&self.root_uvs)
    }

    /// The marks of some strands, in their order.
    #[must_use]
    pub fn selected(&self, strands: impl Iterator<Item = usize> + Clone) -> Self {
        let groups = pick(&self.groups, strands.clone());
        let used: BTreeSet<i32> = groups.iter().copied().collect();
        let names = self.group_names.iter().filter(|(group, _)| used.contains(group));
        let group_names = names.map(|(group, name)| (*group, name.clone())).collect();
        Self { groups, group_names, root_uvs: pick(&self.root_uvs, strands) }
    }

    /// The group of a strand; 0 without groups.
    pub fn group(&self, strand: usize) -> i32 {
        self.groups.get(strand).copied().unwrap_or_default()
    }

    /// Adds strands at the end, in a group of their own with a name. Marks without any list stay without.
    pub fn add_group(&mut self, name: &str, strands: usize) {
        if !self.groups.is_empty() {
            let group = self.group_named(name);
            self.groups.extend(std::iter::repeat_n(group, strands));
        }
        if !self.root_uvs.is_empty() {
            self.root_uvs.extend(std::iter::repeat_n([0.0; 2], strands));
        }
    }

    /// The group with a name. A name that no group has yet gets the next number.
    pub(crate) fn group_named(&mut self, name: &str) -> i32 {
        if let Some((&group, _)) = self.group_names.iter().find(|(_, known)| *known == name) {
            return group;
        }
        let highest = self.groups.iter().chain(self.group_names.keys()).copied().max();
        let group = highest.map_or(0, |highest| highest.saturating_add(1));
        self.group_names.insert(group, name.to_owned());
        group
    }

    /// The groups as a sentence; `None` without groups.
    pub(crate) fn note(&self) -> Option<String> {
        let mut counts: BTreeMap<i32, usize> = BTreeMap::new();
        for &group in &self.groups {
            *counts.entry(group).or_default() += 1;
        }
        let listed = counts.iter().take(LISTED).map(|(group, &count)| {
            let name = self.group_names.get(group).map_or_else(String::new, |name| format!(" ({name})"));
            format!("{group}{name} has {}", counted(count, "strand", "strands"))
        });
        let listed: Vec<String> = listed.collect();
        let more = if counts.len() > LISTED { ", and so on" } else { "" };
        let groups = counted(counts.len(), "group", "groups");
        (!counts.is_empty()).then(|| format!("{groups} of strands: {}{more}.", listed.join(", ")))
    }
}

fn pick<T: Copy>(values: &[T], mut places: impl Iterator<Item = usize>) -> Vec<T> {
    let all: Option<Vec<T>> = if values.is_empty() {
        None
    } else {
        places.try_fold(Vec::new(), |mut all, place| {
            all.push(*values.get(place)?);
            Some(all)
        })
    };
    all.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::StrandMarks;

    #[test]
    fn marks_follow_their_strands_and_new_names_get_new_numbers() {
        let mut marks = StrandMarks { groups: vec![0, 5, 5], ..StrandMarks::default() };
        marks.root_uvs = vec![[0.0, 0.1], [0.2, 0.3], [0.4, 0.5]];
        assert_eq!(
            (marks.group_named("fringe"), marks.group_named("fringe"), marks.group_named("back")),
            (6, 6, 7)
        );
        let some = marks.selected([2, 0].into_iter());
        assert_eq!(
            (&some.groups[..], some.root_uvs[0], some.group_names.len()),
            (&[5, 0][..], [0.4, 0.5], 0)
        );
        marks.group_names.insert(5, "sides".to_owned());
        assert_eq!(
            marks.selected([1].into_iter()).group_names.len(),
            1,
            "names of groups without strands go"
        );
        let note = marks.note().expect("groups");
        assert_eq!(note, "2 groups of strands: 0 has 1 strand, 5 (sides) has 2 strands.");
        // Without marks nothing is selected or said.
        let none = StrandMarks::default();
        assert_eq!(
            (none.selected([4].into_iter()), none.note(), none.group(3)),
            (StrandMarks::default(), None, 0)
        );
    }
}
