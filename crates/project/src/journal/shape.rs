//! A history as numbers of its states, and how it changes.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A step: its label, and the number of the state on its other side.
pub(super) type Step = (String, u64);

/// A history, its projects by their numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Shape {
    /// The steps that can be undone, oldest first.
    pub past: Vec<Step>,
    /// The current project.
    pub present: u64,
    /// The steps that can be redone, the next one last.
    pub future: Vec<Step>,
    /// The project that was saved or opened.
    pub saved: u64,
}

/// How a history differs from the one before.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Change {
    /// When it was written, milliseconds since 1970.
    pub time_ms: u64,
    /// Whether the project differs from what was saved.
    pub modified: bool,
    /// The file of the project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<PathBuf>,
    /// The number of the oldest steps that are no longer there.
    dropped: usize,
    /// The number of steps after those that are as before.
    kept: usize,
    past: Vec<Step>,
    present: u64,
    future_kept: usize,
    future: Vec<Step>,
    saved: u64,
}

/// The number of steps from the start that both have.
fn shared(a: &[Step], b: &[Step]) -> usize {
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

impl Change {
    /// How `after` differs from `before`.
    pub(super) fn between(before: &Shape, after: &Shape) -> Self {
        // The oldest steps leave where the number of steps is limited.
        let first = after.past.first();
        let dropped = first.and_then(|first| before.past.iter().position(|step| step == first)).unwrap_or(0);
        let kept = shared(&before.past[dropped..], &after.past);
        let future_kept = shared(&before.future, &after.future);
        Self {
            dropped,
            kept,
            past: after.past[kept..].to_vec(),
            present: after.present,
            future_kept,
            future: after.future[future_kept..].to_vec(),
            saved: after.saved,
            ..Self::default()
        }
    }

    /// The history after the change; `None` if it does not fit `before`.
    pub(super) fn apply(&self, before: &Shape) -> Option<Shape> {
        let kept = before.past.get(self.dropped..self.dropped.checked_add(self.kept)?)?;
        let future = before.future.get(..self.future_kept)?;
        Some(Shape {
            past: [kept, &self.past].concat(),
            present: self.present,
            future: [future, &self.future].concat(),
            saved: self.saved,
        })
    }
}

impl Shape {
    /// The numbers of all its states.
    pub(super) fn states(&self) -> impl Iterator<Item = u64> {
        let steps = self.past.iter().chain(&self.future).map(|step| step.1);
        steps.chain([self.present, self.saved])
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn steps(range: std::ops::Range<u64>) -> Vec<Step> {
        range.map(|k| (format!("step {k}"), k)).collect()
    }

    #[test]
    fn a_change_names_only_what_is_new() {
        let before = Shape { past: steps(0..1200), present: 1200, future: Vec::new(), saved: 0 };
        let after = Shape { past: steps(1..1201), present: 1201, future: Vec::new(), saved: 0 };
        let change = Change::between(&before, &after);
        assert_eq!((change.dropped, change.kept, change.past.len()), (1, 1199, 1));
        assert_eq!(change.apply(&before), Some(after.clone()));
        assert_eq!(change.apply(&Shape::default()), None, "it does not fit an empty history");
        let undone = Shape { past: steps(1..1199), present: 1199, future: steps(1200..1202), saved: 0 };
        let change = Change::between(&after, &undone);
        assert!(change.past.is_empty() && change.future.len() == 2);
        assert_eq!(change.apply(&after), Some(undone));
    }

    proptest! {
        #[test]
        fn applying_a_change_gives_the_history_after_it(
            a in prop::collection::vec(0_u64..5, 0..9),
            b in prop::collection::vec(0_u64..5, 0..9),
            split in 0_usize..9,
        ) {
            let shape = |numbers: &[u64]| {
                let (past, future) = numbers.split_at(split.min(numbers.len()));
                let of = |part: &[u64]| part.iter().map(|k| (format!("{}", k % 2), *k)).collect();
                Shape { past: of(past), present: numbers.len() as u64, future: of(future), saved: 7 }
            };
            let (before, after) = (shape(&a), shape(&b));
            prop_assert_eq!(Change::between(&before, &after).apply(&before), Some(after));
        }
    }
}
