//! Collects the groups of curves, and the places of their roots on a surface, object by object.

use crate::StrandMarks;

/// The marks of the curves so far.
#[derive(Default)]
pub(super) struct Marks {
    all: StrandMarks,
    has_groups: bool,
    /// Whether an object has no coordinates of its roots.
    lacks_uvs: bool,
}

impl Marks {
    /// Adds what an object says of each of its curves.
    pub(super) fn add(
        &mut self,
        curves: usize,
        groups: Option<Vec<i32>>,
        names: Option<Vec<String>>,
        root_uvs: Option<Vec<[f32; 2]>>,
    ) {
        self.has_groups |= groups.is_some() || names.is_some();
        let is_named = |name: &&String| !name.is_empty();
        match (groups, names) {
            (Some(groups), names) => {
                for (group, name) in
                    groups.iter().zip(names.iter().flatten()).filter(|(_, name)| is_named(name))
                {
                    if !self.all.group_names.contains_key(group) {
                        self.all.group_names.insert(*group, name.clone());
                    }
                }
                self.all.groups.extend(groups);
            }
            (None, Some(names)) => {
                // Most names repeat the one before.
                let mut last: Option<(&str, i32)> = None;
                for name in &names {
                    let group = match last {
                        Some((before, group)) if before == name => group,
                        _ => self.all.group_named(name),
                    };
                    last = Some((name, group));
                    self.all.groups.push(group);
                }
            }
            (None, None) => self.all.groups.extend(std::iter::repeat_n(0, curves)),
        }
        match root_uvs {
            Some(uvs) => self.all.root_uvs.extend(uvs),
            None => self.lacks_uvs = true,
        }
    }

    /// The marks of all curves. Groups that no object states, and places that one lacks, are left out.
    pub(super) fn finish(mut self) -> StrandMarks {
        if !self.has_groups {
            self.all.groups.clear();
        }
        if self.lacks_uvs {
            self.all.root_uvs.clear();
        }
        self.all
    }
}

/// Values for each curve: one for all, one per curve, or one per control point, of which the root's counts. `counts` are the numbers of control
/// points.
pub(super) fn per_curve<T: Clone>(values: &[T], counts: &[usize]) -> Option<Vec<T>> {
    let total: usize = counts.iter().sum();
    if values.len() == counts.len() {
        Some(values.to_vec())
    } else if let [one] = values {
        Some(vec![one.clone(); counts.len()])
    } else if values.len() == total {
        let roots = counts.iter().scan(0, |end, count| Some(std::mem::replace(end, *end + count)));
        // A curve without points has no root.
        Some(roots.map(|root| values[root.min(total - 1)].clone()).collect())
    } else {
        None
    }
}
