//! Undo and redo.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::project::Project;

/// Identifies one gesture, such as one drag of a slider or one edit of a text field. Its changes are one undo step.
pub type GestureId = u64;

/// A project with its undo and redo steps.
#[derive(Clone, Debug)]
pub struct History {
    past: VecDeque<Step>,
    present: Arc<Project>,
    future: Vec<Step>,
    /// The gesture that made the newest step, as long as it may continue.
    gesture: Option<GestureId>,
    /// The redo steps that the newest step has discarded: they come back with it if it is taken back.
    discarded: Vec<Step>,
    /// The project on disk, for the mark of unsaved changes.
    saved: Arc<Project>,
    limit: usize,
    most_bytes: u64,
}

/// A change: its label, and the project on the other side of it.
#[derive(Clone, Debug)]
struct Step {
    label: String,
    project: Arc<Project>,
    /// The memory that it does not share with the project on this side of the change, bytes.
    bytes: u64,
}

/// A history as it is at one moment: all its projects, shared.
#[derive(Clone, Debug)]
pub struct HistoryMark {
    /// The steps that can be undone, oldest first: their labels, and the projects before them.
    pub past: Vec<(String, Arc<Project>)>,
    /// The current project.
    pub present: Arc<Project>,
    /// The steps that can be redone, the next one last: their labels, and the projects after them.
    pub future: Vec<(String, Arc<Project>)>,
    /// The project that was saved or opened.
    pub saved: Arc<Project>,
}

impl History {
    /// Number of steps kept by default. A project is a few kilobytes, and shares what brushes did with the step before.
    pub const LIMIT: usize = 1200;
    /// The most memory of all steps, bytes: a project with long tracks has megabytes. The newest step is always kept.
    pub const MAX_BYTES: u64 = 256 << 20;

    /// A project without undo steps.
    pub fn new(project: Project) -> Self {
        Self::with_limit(project, Self::LIMIT)
    }

    /// A project that keeps at most `limit` steps (at least one).
    pub fn with_limit(project: Project, limit: usize) -> Self {
        let present = Arc::new(project);
        Self {
            past: VecDeque::new(),
            saved: Arc::clone(&present),
            present,
            future: Vec::new(),
            gesture: None,
            discarded: Vec::new(),
            limit: limit.max(1),
            most_bytes: Self::MAX_BYTES,
        }
    }

    /// The history as it is now.
    pub fn mark(&self) -> HistoryMark {
        let of = |step: &Step| (step.label.clone(), Arc::clone(&step.project));
        HistoryMark {
            past: self.past.iter().map(of).collect(),
            present: Arc::clone(&self.present),
            future: self.future.iter().map(of).collect(),
            saved: Arc::clone(&self.saved),
        }
    }

    /// Whether nothing has changed since `mark`. Compares allocations, so it costs nothing.
    pub fn is_at(&self, mark: &HistoryMark) -> bool {
        Arc::ptr_eq(&self.present, &mark.present)
            && Arc::ptr_eq(&self.saved, &mark.saved)
            && (self.past.len(), self.future.len()) == (mark.past.len(), mark.future.len())
    }

    /// The history that a mark was made of: the newest steps, as many as are kept by default.
    pub fn of_mark(mark: HistoryMark) -> Self {
        let HistoryMark { past, present, future, saved } = mark;
        let mut history = Self { saved, ..Self::with_limit(Project::default(), Self::LIMIT) };
        history.present = present;
        let mut newer = Arc::clone(&history.present);
        for (label, project) in past.into_iter().rev() {
            let bytes = project.bytes_beside(&newer);
            newer = Arc::clone(&project);
            history.past.push_front(Step { label, project, bytes });
        }
        let mut older = Arc::clone(&history.present);
        for (label, project) in future.into_iter().rev() {
            let bytes = project.bytes_beside(&older);
            older = Arc::clone(&project);
            history.future.insert(0, Step { label, project, bytes });
        }
        history.drop_oldest();
        history
    }

    /// Drops the oldest steps beyond the limits.
    fn drop_oldest(&mut self) {
        let mut bytes = self.bytes();
        while self.past.len() > self.limit || (bytes > self.most_bytes && self.past.len() > 1) {
            bytes -= self.past.pop_front().map_or(0, |step| step.bytes);
        }
    }

    /// The memory of all steps, bytes.
    pub fn bytes(&self) -> u64 {
        self.past.iter().chain(&self.future).map(|step| step.bytes).sum()
    }

    /// The current project.
    pub fn project(&self) -> &Arc<Project> {
        &self.present
    }

    /// Replaces the project. Consecutive changes with the same `gesture` are one step; a gesture that ends at its start value
    /// is no step. Returns whether anything changed.
    pub fn edit(&mut self, label: &str, gesture: Option<GestureId>, project: Project) -> bool {
        if project == *self.present {
            return false;
        }
        let project = Arc::new(project);
        if gesture.is_some() && gesture == self.gesture {
            self.present = project;
            if self.past.back().is_some_and(|step| step.project == self.present) {
                if let Some(step) = self.past.pop_back() {
                    self.present = step.project;
                }
                self.gesture = None;
                self.future = std::mem::take(&mut self.discarded);
                return true;
            }
        } else {
            let before = std::mem::replace(&mut self.present, project);
            let bytes = before.bytes_beside(&self.present);
            self.past.push_back(Step { label: label.to_owned(), project: before, bytes });
            self.discarded = std::mem::take(&mut self.future);
            self.drop_oldest();
            self.gesture = gesture;
        }
        self.future.clear();
        true
    }

    /// As [`History::edit`], for a change made in place.
    pub fn change(
        &mut self,
        label: &str,
        gesture: Option<GestureId>,
        change: impl FnOnce(&mut Project),
    ) -> bool {
        let mut project = (*self.present).clone();
        change(&mut project);
        self.edit(label, gesture, project)
    }

    /// Takes the newest step back as if it had never been made, if it is that of `gesture` and the gesture may continue. Returns whether it
    /// was.
    pub fn take_back_gesture(&mut self, gesture: GestureId) -> bool {
        let before =
            self.past.back().filter(|_| self.gesture == Some(gesture)).map(|step| (*step.project).clone());
        before.is_some_and(|before| self.edit("", Some(gesture), before))
    }

    /// Ends the gesture: the next change starts a new step.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    /// Undoes the newest step.
    pub fn undo(&mut self) -> Option<&Arc<Project>> {
        let step = self.past.pop_back()?;
        let after = std::mem::replace(&mut self.present, step.project);
        let bytes = after.bytes_beside(&self.present);
        self.future.push(Step { label: step.label, project: after, bytes });
        (self.gesture, self.discarded) = (None, Vec::new());
        Some(&self.present)
    }

    /// Takes back the newest step if it was made on `before`, as if it had never been: it cannot be redone, and the redo steps that it
    /// discarded are there again. Returns whether it was.
    pub fn take_back(&mut self, before: &Arc<Project>) -> bool {
        let Some(step) = self.past.pop_back_if(|step| Arc::ptr_eq(&step.project, before)) else {
            return false;
        };
        self.present = step.project;
        self.gesture = None;
        self.future = std::mem::take(&mut self.discarded);
        true
    }

    /// Redoes the step that was undone last.
    pub fn redo(&mut self) -> Option<&Arc<Project>> {
        let step = self.future.pop()?;
        let before = std::mem::replace(&mut self.present, step.project);
        let bytes = before.bytes_beside(&self.present);
        self.past.push_back(Step { label: step.label, project: before, bytes });
        self.gesture = None;
        Some(&self.present)
    }

    /// Label of the step that [`History::undo`] would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.past.back().map(|step| step.label.as_str())
    }

    /// Label of the step that [`History::redo`] would redo.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }

    /// Number of steps that can be undone.
    pub fn undo_len(&self) -> usize {
        self.past.len()
    }

    /// Number of steps that can be redone.
    pub fn redo_len(&self) -> usize {
        self.future.len()
    }

    /// Records that the current project has been saved.
    pub fn mark_saved(&mut self) {
        self.saved = Arc::clone(&self.present);
        self.gesture = None;
    }

    /// Whether the project differs from what was saved or opened.
    pub fn is_modified(&self) -> bool {
        !Arc::ptr_eq(&self.saved, &self.present) && self.saved != self.present
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(distance: f32) -> Project {
        let mut project = Project::default();
        project.camera.distance = distance;
        project
    }

    #[test]
    fn a_thousand_strokes_are_undone_and_done_again_and_share_their_memory() {
        use lovelock_groom::{GroomSettings, PlainHead, grow};
        use lovelock_style::hand::{HandEdit, HandEdits, HandRoots};
        use lovelock_style::operations::Hand;
        use lovelock_style::{Layer, Operation};

        let settings = GroomSettings {
            wisps: 60,
            strands_per_wisp: 2,
            segments_per_strand: 8,
            ..GroomSettings::default()
        };
        let style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
        let roots = HandRoots::of(&style);
        let mut project = at(1.0);
        project.hair.stack.push(Layer::of(Hand::default()));
        let (mut history, mut states, mut bytes) = (History::new(project.clone()), vec![project.clone()], 0);
        let mut edits = HandEdits::default();
        for stroke in 0..1000_usize {
            let before = edits.clone();
            let edit = HandEdit { length: 0.5 + 0.001 * (stroke % 400) as f32, ..HandEdit::default() };
            edits.change(&roots, (0..9).map(|k| ((stroke * 7 + k) % style.guides.count(), edit.clone())));
            bytes += edits.bytes_beside(&before);
            project.hair.stack.layers[0].operation = Operation::Hand(Hand { edits: edits.clone() });
            assert!(history.edit("comb", Some(stroke as GestureId + 9), project.clone()), "stroke {stroke}");
            states.push(project.clone());
        }
        for state in states.iter().rev().skip(1) {
            assert_eq!(history.undo().map(|project| &**project), Some(state));
        }
        assert!(history.undo().is_none());
        for state in &states[1..] {
            assert_eq!(history.redo().map(|project| &**project), Some(state));
        }
        println!("{bytes} bytes of edits in a thousand steps");
        assert!(bytes < 16 << 20);
    }

    #[test]
    fn steps_with_long_tracks_stay_within_their_memory() {
        use crate::tracks::{Key, Track};

        let keys: Vec<Key> = (0..2000_i32).map(|k| Key { secs: f64::from(k), value: vec![0.0; 3] }).collect();
        let long = Track { keys, ..Track::new("look/eumelanin") };
        let with = |distance: f32, tracks: usize| {
            let mut project = at(distance);
            project.timeline.tracks = vec![long.clone(); tracks];
            project
        };
        let mut history = History { most_bytes: 1 << 20, ..History::new(with(0.5, 2)) };
        for i in 1..100 {
            assert!(history.edit("Distance", None, with(1.0 + i as f32 * 0.01, 2)));
            assert!(history.bytes() <= 1 << 20, "{} bytes after {i} steps", history.bytes());
        }
        assert!((3..99).contains(&history.undo_len()), "{}", history.undo_len());
        // Undone steps count as well, and the newest step is kept whatever it takes.
        while history.undo().is_some() {}
        assert!(history.bytes() <= 1 << 20 && history.redo_len() > 2);
        history.edit("Distance", None, with(3.0, 64));
        history.edit("Distance", None, with(4.0, 64));
        assert_eq!(history.undo_len(), 1, "one step of {} bytes", history.bytes());
        // Control: small projects keep all of theirs.
        let mut small = History { most_bytes: 1 << 20, ..History::new(at(0.5)) };
        (1..100).for_each(|i| {
            small.edit("Distance", None, at(1.0 + i as f32 * 0.01));
        });
        assert_eq!(small.undo_len(), 99);
    }

    #[test]
    fn a_drag_is_one_step() {
        let mut history = History::new(at(1.0));
        for i in 2..20 {
            assert!(history.edit("Distance", Some(7), at(i as f32)));
        }
        history.end_gesture();
        history.edit("Distance", Some(7), at(30.0));
        assert_eq!(history.undo_len(), 2, "a second drag with the same id, after the first has ended");
        assert_eq!(history.undo().map(|p| p.camera.distance), Some(19.0));
        assert_eq!(history.undo().map(|p| p.camera.distance), Some(1.0));
        assert!(history.undo().is_none());
        assert_eq!(history.redo().map(|p| p.camera.distance), Some(19.0));
    }

    #[test]
    fn a_drag_that_returns_is_no_step() {
        let mut history = History::new(at(1.0));
        history.edit("Distance", Some(1), at(2.0));
        history.edit("Distance", Some(1), at(1.0));
        assert_eq!(history.undo_len(), 0);
        history.edit("Distance", Some(1), at(3.0));
        assert_eq!(history.undo_len(), 1, "the gesture may continue");
        assert_eq!(history.undo().map(|p| p.camera.distance), Some(1.0));
    }

    #[test]
    fn a_gesture_that_is_taken_back_leaves_undo_and_redo_as_they_were() {
        let mut history = History::new(at(1.0));
        history.edit("Distance", None, at(2.0));
        history.edit("Distance", None, at(3.0));
        history.undo();
        history.edit("stroke", Some(7), at(9.0));
        assert_eq!(history.redo_len(), 0);
        assert!(!history.take_back_gesture(8), "another gesture");
        assert!(history.take_back_gesture(7) && !history.take_back_gesture(7));
        assert_eq!((history.undo_len(), history.redo_len()), (1, 1));
        assert_eq!(history.project().camera.distance, 2.0);
        assert_eq!(history.redo().map(|p| p.camera.distance), Some(3.0));
        // A drag that returns does the same; one that does not discards the redo steps.
        history.undo();
        history.edit("Distance", Some(9), at(5.0));
        history.edit("Distance", Some(9), at(2.0));
        assert_eq!(history.redo_label(), Some("Distance"));
        history.edit("Distance", Some(10), at(5.0));
        assert!(history.redo().is_none());
    }

    #[test]
    fn a_step_that_is_taken_back_leaves_undo_and_redo_as_they_were() {
        let mut history = History::new(at(1.0));
        history.edit("Distance", None, at(2.0));
        history.undo();
        let before = Arc::clone(history.project());
        history.edit("file", None, at(9.0));
        assert!(history.take_back(&before) && !history.take_back(&before));
        assert_eq!((history.undo_len(), history.redo_len()), (0, 1));
        assert_eq!(history.redo().map(|p| p.camera.distance), Some(2.0));
        // What was undone after the step had been made on it, and goes with it.
        history.undo();
        history.edit("file", None, at(9.0));
        history.edit("Distance", None, at(4.0));
        history.undo();
        assert!(history.take_back(&before));
        assert_eq!((history.undo_len(), history.redo_len()), (0, 0));
    }

    #[test]
    fn no_change_is_no_step_and_keeps_the_future() {
        let mut history = History::new(at(1.0));
        history.edit("Distance", None, at(2.0));
        history.undo();
        assert!(!history.edit("Distance", None, at(1.0)));
        assert_eq!(history.redo_label(), Some("Distance"));
        assert!(history.edit("Distance", None, at(5.0)));
        assert!(history.redo().is_none(), "a new change discards the redo steps");
    }

    #[test]
    fn the_mark_of_an_unsaved_change_follows_undo() {
        let mut history = History::new(at(1.0));
        assert!(!history.is_modified());
        history.edit("Distance", None, at(2.0));
        assert!(history.is_modified());
        history.mark_saved();
        assert!(!history.is_modified());
        history.undo();
        assert!(history.is_modified());
        history.redo();
        assert!(!history.is_modified());
    }

    proptest! {
        /// Undoing everything and redoing everything returns every state in order, up to the limit.
        #[test]
        fn undo_and_redo_are_inverse(values in prop::collection::vec(1_u8..=4, 1..40), limit in 1_usize..12) {
            let mut history = History::with_limit(at(0.5), limit);
            let mut states = vec![0.5];
            for v in values {
                if history.edit("Distance", None, at(f32::from(v))) {
                    states.push(f32::from(v));
                }
            }
            let kept = states.len().min(limit + 1);
            let states = &states[states.len() - kept..];
            for expected in states.iter().rev().skip(1) {
                prop_assert_eq!(history.undo().map(|p| p.camera.distance), Some(*expected));
            }
            prop_assert!(history.undo().is_none());
            for expected in states.iter().skip(1) {
                prop_assert_eq!(history.redo().map(|p| p.camera.distance), Some(*expected));
            }
            prop_assert!(history.redo().is_none());
        }
    }
}
