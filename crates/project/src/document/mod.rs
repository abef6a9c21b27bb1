//! The document: the project that is edited, with its history, its file, and what of it is shown at a time.

mod trial;

use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::animation::{Moment, Overdub};
use crate::error::Problem;
use crate::history::{GestureId, History};
use crate::project::Project;
use crate::styles::{Style, StyleParts};
use trial::Trial;

/// A project that is edited.
#[derive(Clone, Debug)]
pub struct Document {
    history: History,
    path: Option<PathBuf>,
    /// The projects that were put in place of another one by an undo step, and the files of those before them.
    detached: Vec<(Arc<Project>, Option<PathBuf>)>,
    overdub: Overdub,
    gesture: GestureId,
    /// The project at a time, with its tracks applied.
    at_time: Option<AtTime>,
    /// The project with a style that is shown and not applied.
    preview: Option<Preview>,
    /// A project at a time, and the same with the colours of its morph.
    morphed: Option<(Arc<Project>, Arc<Project>)>,
    /// Files that were opened and are not loaded yet.
    trials: Vec<Trial>,
    /// The problems of the last load.
    problems: Vec<Problem>,
}

/// A project at a time of its timeline, seconds.
#[derive(Clone, Debug)]
struct AtTime {
    of: Arc<Project>,
    secs: f64,
    project: Arc<Project>,
}

/// The project with a style that is shown without being applied, and its inputs.
#[derive(Clone, Debug)]
struct Preview {
    of: Arc<Project>,
    id: String,
    parts: StyleParts,
    project: Arc<Project>,
    /// The project at a time of its timeline, seconds.
    at_time: (f64, Arc<Project>),
}

/// What is simulated and drawn.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The project that is simulated.
    pub project: Arc<Project>,
    /// The project at the current time that is drawn.
    pub drawn: Arc<Project>,
}

impl Document {
    /// A project without undo steps, and its file.
    pub fn new(project: Project, path: Option<PathBuf>) -> Self {
        Self {
            history: History::new(project),
            path,
            detached: Vec::new(),
            overdub: Overdub::default(),
            gesture: 1,
            at_time: None,
            preview: None,
            morphed: None,
            trials: Vec::new(),
            problems: Vec::new(),
        }
    }

    /// A project that was not saved, with its undo steps, and its file.
    pub fn recovered(history: History, path: Option<PathBuf>) -> Self {
        Self { history, ..Self::new(Project::default(), path) }
    }

    /// As [`Document::replace`], with a project that was not saved and its undo steps.
    pub fn recover(&mut self, history: History, path: Option<PathBuf>) {
        self.replace(Project::default(), path);
        self.history = history;
    }

    /// Puts another project in place of this one: no undo step leads back. Gestures continue to be counted, and moved controls
    /// continue to write keys, unless only one control of the previous project did.
    pub fn replace(&mut self, project: Project, path: Option<PathBuf>) {
        let (gesture, armed) = (self.gesture + 1, self.overdub.is_armed() && self.overdub.only().is_none());
        *self = Self { gesture, ..Self::new(project, path) };
        self.overdub.set_armed(armed);
    }

    /// The project as it is edited, without its tracks applied.
    pub fn project(&self) -> &Arc<Project> {
        self.history.project()
    }

    /// The file of the project.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The project belongs to no file from now on. Undoing the newest step returns to the file before, and redoing it leaves that file.
    pub fn detach(&mut self) {
        self.detached.push((Arc::clone(self.history.project()), self.path.take()));
    }

    /// The index in `detached` of the newest step that put `project` in place of another.
    fn detached_by(&self, project: &Arc<Project>) -> Option<usize> {
        self.detached.iter().rposition(|(detached, _)| Arc::ptr_eq(detached, project))
    }

    /// Records that the project has been saved to `path`.
    pub fn mark_saved(&mut self, path: &Path) {
        self.history.mark_saved();
        self.detached.clear();
        self.path = Some(path.to_owned());
    }

    /// Whether the project differs from its file.
    pub fn is_modified(&self) -> bool {
        self.history.is_modified()
    }

    /// The name of the project, and a mark in front of it if there are unsaved changes.
    pub fn title(&self) -> String {
        let name = self
            .path
            .as_deref()
            .and_then(Path::file_stem)
            .map_or_else(|| "untitled".to_owned(), |stem| stem.to_string_lossy().into_owned());
        format!("{}{name}", if self.is_modified() { "● " } else { "" })
    }

    /// The undo steps.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Undoes the newest step. Returns whether there was one.
    pub fn undo(&mut self) -> bool {
        self.overdub.let_go();
        let detached = self.detached_by(self.history.project());
        let is_undone = self.history.undo().is_some();
        if let Some(index) = detached.filter(|_| is_undone) {
            self.path.clone_from(&self.detached[index].1);
        }
        is_undone
    }

    /// Redoes the step that was undone last. Returns whether there was one.
    pub fn redo(&mut self) -> bool {
        self.overdub.let_go();
        let is_redone = self.history.redo().is_some();
        if is_redone && self.detached_by(self.history.project()).is_some() {
            self.path = None;
        }
        is_redone
    }

    /// The number of the gesture to which changes belong.
    pub fn gesture(&self) -> GestureId {
        self.gesture
    }

    /// Ends the gesture: the next change starts an undo step.
    pub fn end_gesture(&mut self) {
        self.gesture += 1;
    }

    /// Replaces the project. The changes of one gesture are one undo step. Returns whether anything changed.
    pub fn edit(&mut self, label: &str, project: Project) -> bool {
        self.history.edit(label, Some(self.gesture), project)
    }

    /// As [`Document::edit`], as a part of an earlier gesture.
    pub fn edit_in(&mut self, gesture: GestureId, label: &str, project: Project) -> bool {
        self.history.edit(label, Some(gesture), project)
    }

    /// Takes the newest step back as if it had never been made, if it is that of `gesture`. Returns whether it was.
    pub fn take_back_gesture(&mut self, gesture: GestureId) -> bool {
        self.history.take_back_gesture(gesture)
    }

    /// Makes a change that is one undo step. Returns whether anything changed.
    pub fn change(&mut self, label: &str, change: impl FnOnce(&mut Project)) -> bool {
        self.end_gesture();
        let changed = self.history.change(label, Some(self.gesture), change);
        self.end_gesture();
        changed
    }

    /// What turns moved controls into keys.
    pub fn overdub(&self) -> &Overdub {
        &self.overdub
    }

    /// What turns moved controls into keys.
    pub fn overdub_mut(&mut self) -> &mut Overdub {
        &mut self.overdub
    }

    /// Applies the edits of controls to the project at the time of `now`: values with a track are written to the track. `seen` is the
    /// project that the controls showed. Returns the control whose track refuses the edit, if there is one.
    pub fn edit_seen(&mut self, seen: &Project, edited: Project, now: Moment) -> Option<String> {
        self.edit_seen_as(changed_part(seen, &edited), seen, edited, now)
    }

    /// As [`Document::edit_seen`], with the label of the undo step.
    pub fn edit_seen_as(
        &mut self,
        label: &str,
        seen: &Project,
        edited: Project,
        now: Moment,
    ) -> Option<String> {
        let project = self.overdub.edit(self.history.project(), seen, edited, now);
        self.edit(label, project);
        self.overdub.take_refused()
    }

    /// As [`Document::edit_seen`], as an undo step of its own.
    pub fn change_seen(&mut self, now: Moment, change: impl FnOnce(&mut Project)) -> Option<String> {
        let seen = self.at(now.secs);
        let mut project = (*seen).clone();
        change(&mut project);
        self.end_gesture();
        let refused = self.edit_seen(&seen, project, now);
        if self.overdub.writes().next().is_none() {
            self.end_gesture();
        }
        refused
    }

    /// The project at a time of its timeline in seconds, with its tracks applied: the same allocation until something changes.
    pub fn at(&mut self, secs: f64) -> Arc<Project> {
        let of = Arc::clone(self.history.project());
        if !of.is_animated() && self.overdub.writes().next().is_none() {
            self.at_time = None;
            return of;
        }
        let known = self
            .at_time
            .take()
            .filter(|known| Arc::ptr_eq(&known.of, &of) && known.secs.to_bits() == secs.to_bits());
        let at_time = known.unwrap_or_else(|| {
            let project = Arc::new(self.overdub.shown(&of, secs));
            AtTime { of, secs, project }
        });
        Arc::clone(&self.at_time.insert(at_time).project)
    }

    /// What is simulated and drawn at a time in seconds: with the style that is tried, by its id, below the layers of the user, and with
    /// the colours of the morph.
    pub fn shown(&mut self, secs: f64, tried: Option<(&str, &Style, StyleParts)>) -> Shown {
        let Shown { project, drawn } = self.tried(secs, tried);
        let Some(look) = drawn.morphed_look() else {
            self.morphed = None;
            return Shown { project, drawn };
        };
        // The same allocation as long as nothing changes, so that nothing is drawn again.
        let known = self.morphed.take().filter(|(of, _)| Arc::ptr_eq(of, &drawn));
        let (_, drawn) = self.morphed.insert(known.unwrap_or_else(|| {
            let morphed = Arc::new(Project { look, ..(*drawn).clone() });
            (drawn, morphed)
        }));
        Shown { project, drawn: Arc::clone(drawn) }
    }

    /// Whether a style is shown that is not applied.
    pub fn is_preview(&self) -> bool {
        self.preview.is_some()
    }

    fn tried(&mut self, secs: f64, tried: Option<(&str, &Style, StyleParts)>) -> Shown {
        let of = Arc::clone(self.history.project());
        let Some((id, style, parts)) = tried else {
            self.preview = None;
            return Shown { drawn: self.at(secs), project: of };
        };
        let same = |known: &Preview| Arc::ptr_eq(&known.of, &of) && known.id == id && known.parts == parts;
        let known = self.preview.take().filter(same);
        let mut preview = known.unwrap_or_else(|| {
            let mut project = (*of).clone();
            project.apply_style_below_layers(style, parts);
            let project = Arc::new(project);
            let at_time = (f64::NAN, Arc::clone(&project));
            Preview { of, id: id.to_owned(), parts, project, at_time }
        });
        if preview.project.is_animated() && preview.at_time.0.to_bits() != secs.to_bits() {
            preview.at_time = (secs, Arc::new(self.overdub.shown(&preview.project, secs)));
        }
        let shown = Shown { project: Arc::clone(&preview.project), drawn: Arc::clone(&preview.at_time.1) };
        self.preview = Some(preview);
        shown
    }
}

/// The name of the part that differs, for the undo history.
pub fn changed_part(before: &Project, after: &Project) -> &'static str {
    let parts = [
        (before.camera != after.camera, "camera"),
        (before.hair != after.hair, "hairstyle"),
        (before.look != after.look, "look"),
        (before.simulation != after.simulation, "simulation"),
        (before.shadow != after.shadow, "shadow"),
        (before.lights != after.lights, "light"),
        (before.surroundings != after.surroundings, "surroundings"),
        (before.reference != after.reference, "reference"),
        (before.sound != after.sound, "sound"),
        (before.picture != after.picture, "picture"),
        (before.body != after.body, "body"),
        (before.motion != after.motion, "motion"),
        (before.recording != after.recording, "recording"),
        (before.compare != after.compare, changed_panes(before, after)),
        (before.timeline.markers != after.timeline.markers, "marker"),
        (before.timeline.preroll_secs != after.timeline.preroll_secs, "pre-roll"),
        (before.timeline.tracks != after.timeline.tracks, "track"),
    ];
    parts.iter().find(|(differs, _)| *differs).map_or("change", |(_, name)| name)
}

/// The name of a change of the comparison.
fn changed_panes(before: &Project, after: &Project) -> &'static str {
    match after.compare.panes.len().cmp(&before.compare.panes.len()) {
        Ordering::Greater => "add pane",
        Ordering::Less => "remove pane",
        Ordering::Equal => "comparison",
    }
}

#[cfg(test)]
mod tests;
