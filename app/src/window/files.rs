//! Opening and saving files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_jobs::info::FileKind;
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::files::FileRef;
use lovelock_project::history::GestureId;
use lovelock_project::project::{
    BodySection, CameraSection, CompareSection, Contender, load_project_with, save_project,
};
use lovelock_project::styles::Style;
use lovelock_session::scene::{Scene, camera_for_size};

use super::opening::{Aim, Found, Opened, Openings, Played};
use super::page::Page;
use super::path_dialog::PathDialog;
use super::up_axis::UpQuestion;
use super::{Window, notices, remember};

/// The action that waits for the confirmation that unsaved changes may be lost.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Pending {
    Quit,
    New,
    Open(PathBuf),
    /// Opens the new project in which strokes were played.
    Strokes(Arc<Played>),
    /// Makes an example and shows it.
    Example(lovelock_jobs::examples::Example),
    /// Recovers the unsaved project in a journal.
    Recover(PathBuf),
}

/// Files that are opened and saved, and what waits for them.
pub(super) struct Files {
    /// The dialog that asks for a path.
    pub(super) dialog: Option<PathDialog>,
    /// The files that are being looked into, and the context that their threads wake.
    pub(super) openings: Openings,
    pub(super) ctx: egui::Context,
    /// Shadow methods of the user's own.
    pub(super) methods: super::methods::Methods,
    /// The question for the up axis of the hair file that was opened last.
    pub(super) up_question: UpQuestion,
    /// The body that was opened last, until it is loaded.
    pub(super) framing: Option<Framing>,
    /// Whether what the command line names is not loaded yet: its errors are printed too.
    pub(super) starting: bool,
    /// What waits until the user has decided about unsaved changes.
    pub(super) pending: Option<Pending>,
    /// What waits until the project is saved under a name.
    pub(super) after_saving: Option<Pending>,
    /// The style that is exported, while its path is asked for.
    pub(super) exported: Option<Box<Style>>,
    /// Whether the window closes without asking again.
    pub(super) quitting: bool,
}

impl Files {
    /// Those of a window that starts.
    pub(super) fn new(ctx: &egui::Context, framing: Option<Framing>) -> Self {
        Self {
            dialog: None,
            openings: Openings::default(),
            methods: super::methods::Methods::default(),
            ctx: ctx.clone(),
            up_question: UpQuestion::default(),
            framing,
            starting: true,
            pending: None,
            after_saving: None,
            exported: None,
            quitting: false,
        }
    }
}

/// A body that was opened and is not loaded yet.
pub(super) struct Framing {
    body: BodySection,
    /// The undo step that opened it.
    gesture: GestureId,
    /// The scene before it.
    before: Option<Arc<Scene>>,
    /// The camera when it was opened. One that was moved since stays.
    camera: CameraSection,
}

impl Framing {
    /// That of a project that starts with a character and a camera of its own, if it does.
    pub(super) fn at_start(project: &Project, path: Option<&PathBuf>) -> Option<Self> {
        let opened = path.is_none() && project.body.file.is_some() && project.take.file.is_none();
        let framed = opened && project.camera == CameraSection::default();
        framed.then(|| Self { body: project.body.clone(), gesture: 0, before: None, camera: project.camera })
    }
}

/// The part of the project that a file of that kind becomes.
pub(super) fn place_of(kind: FileKind) -> Place {
    match kind {
        FileKind::Hair => Place::Hair,
        FileKind::Character => Place::Body,
        FileKind::Surroundings => Place::Surroundings,
        FileKind::Sound => Place::Sound,
        FileKind::Motion | FileKind::Project | FileKind::Style | FileKind::Take | FileKind::Strokes => {
            Place::Motion
        }
    }
}

/// Makes a file a part of the project.
pub(super) fn set_part(project: &mut Project, kind: FileKind, path: &Path) {
    match kind {
        FileKind::Hair => project.set_hair_file(path),
        FileKind::Character => project.set_body_file(path),
        FileKind::Surroundings => project.set_surroundings_file(path),
        FileKind::Sound => project.set_sound_file(path),
        FileKind::Motion | FileKind::Project | FileKind::Style | FileKind::Take | FileKind::Strokes => {
            project.set_motion_file(path);
        }
    }
}

impl Window {
    /// Opens a file of any kind that the program reads. What it is, is found out on a thread.
    pub(super) fn open_any(&mut self, path: &Path) {
        if self.open_method(path) {
            return;
        }
        self.look_into_or_tell(path, Aim::Open);
    }

    /// Plays a take with the project that it was recorded from. One undo step restores the previous project.
    pub(super) fn open_take(&mut self, path: &Path) {
        self.look_into_or_tell(path, Aim::PlayTake);
    }

    /// Starts to look into a file that a dialog has picked.
    pub(super) fn look_into(&mut self, path: &Path, aim: Aim) -> Result<(), String> {
        let hair = self.document.project().hair.clone();
        let new = match aim {
            Aim::Open | Aim::PlayTake => Some(Arc::default()),
            // The command line may have set something.
            Aim::Start => Some(Arc::clone(self.document.project())),
            Aim::Beside | Aim::Part(_) => None,
        };
        self.files
            .openings
            .start(path, aim, (hair, new), &self.files.ctx)
            .map_err(|error| format!("{}: could not start a thread to read it: {error}", path.display()))
    }

    pub(super) fn look_into_or_tell(&mut self, path: &Path, aim: Aim) {
        if let Err(error) = self.look_into(path, aim) {
            self.fail(error);
        }
    }

    /// Opens the files that were looked into, in their order: those behind a project wait until it is opened, and become parts of it.
    /// The dialog that asked for a file stays open if it cannot be used.
    pub(super) fn take_opened(&mut self) {
        while self.files.pending.is_none()
            && self.files.after_saving.is_none()
            && let Some(Opened { path, aim, found }) = self.files.openings.next()
        {
            let dialog = self.files.dialog.take_if(|dialog| dialog.waiting() == Some(path.as_path()));
            match found
                .map_err(|error| error.to_string())
                .and_then(|found| self.open_found(&path, aim, found))
            {
                Ok(()) => remember(&mut self.layout.files, &path),
                Err(error) => {
                    if aim == Aim::Start {
                        eprintln!("lovelock: {error}");
                    }
                    match dialog {
                        Some(mut dialog) => {
                            dialog.refuse(error);
                            self.files.dialog = Some(dialog);
                        }
                        None => self.fail(error),
                    }
                }
            }
        }
    }

    fn open_found(&mut self, path: &Path, aim: Aim, found: Found) -> Result<(), String> {
        match (aim, found) {
            (Aim::Beside, found) => self.put_beside(path, &found)?,
            (Aim::Part(Place::Body), _) => self.open_body(path),
            (Aim::Part(place), _) => self.open_part(place, path, |project| match place {
                Place::Surroundings => project.set_surroundings_file(path),
                Place::Sound => project.set_sound_file(path),
                _ => project.set_motion_file(path),
            }),
            (aim, Found::Take(project, problems)) => {
                let mut project = *project;
                // They are frames of the dance that was recorded, and those of a take begin where its recording did.
                project.recording.record_all();
                self.play(path, |_| project);
                self.warn(problems.into_iter().map(|problem| problem.message));
                if aim == Aim::PlayTake {
                    // Not sooner: the dance would go on until the take is found.
                    self.session.set_playing(true);
                } else {
                    // Saving must not write the take's project to the file of the previous project.
                    self.document.detach();
                    self.follow_path();
                }
            }
            (_, Found::Curves(curves)) => self.play(path, |project| curves.played_in(project)),
            // Asked after they were played: the user may change something meanwhile.
            (_, Found::Strokes(played)) if self.document.is_modified() => {
                self.files.pending = Some(Pending::Strokes(played));
            }
            (_, Found::Strokes(played)) => self.open_played(&played),
            (_, Found::Document(FileKind::Style)) => self.open_style(path)?,
            (_, Found::Document(_)) if self.document.is_modified() => {
                self.files.pending = Some(Pending::Open(path.to_owned()));
            }
            (_, Found::Document(_)) => self.open_project(path)?,
            (_, Found::Part(kind, unused)) => {
                self.warn(unused);
                if kind == FileKind::Character {
                    self.open_body(path);
                } else {
                    self.open_part(place_of(kind), path, |project| set_part(project, kind, path));
                    if kind == FileKind::Hair {
                        let import = self.document.project().hair.import;
                        let (files, gesture) = (&mut self.files, self.document.gesture() - 1);
                        files.up_question.look(path, &import, gesture, &files.ctx);
                    }
                }
            }
        }
        Ok(())
    }

    /// Makes a character the body of the project. The camera follows its size when it is loaded.
    pub(super) fn open_body(&mut self, path: &Path) {
        self.open_part(Place::Body, path, |project| project.set_body_file(path));
        self.files.framing = Some(Framing {
            body: self.document.project().body.clone(),
            gesture: self.document.gesture() - 1,
            before: self.session.scene.clone(),
            camera: self.document.project().camera,
        });
    }

    /// Moves the camera away from a large body and to a small one, as a part of the undo step that opened it. Called when a load has ended.
    pub(super) fn frame_opened_body(&mut self) {
        let Some(framing) = &self.files.framing else { return };
        let before = framing.before.as_ref();
        let is_other =
            |scene: &&Arc<Scene>| before.is_none_or(|before| !Arc::ptr_eq(&before.body, &scene.body));
        let Some(scene) = self.session.scene.as_ref().filter(is_other) else {
            // Another load began earlier, or this one ended without the body: then the next scene is none of its.
            if !self.session.worker().is_loading() {
                self.files.framing = None;
            }
            return;
        };
        let (gesture, project) = (framing.gesture, self.document.project());
        let before_scale = before.map_or(1.0, |before| before.hair_scale);
        let camera = camera_for_size(&project.camera, before_scale, scene.hair_scale);
        // Undone or replaced meanwhile, or seen from a place that the user chose.
        let is_same = project.body == framing.body && project.camera == framing.camera;
        let camera = camera.filter(|_| is_same);
        if let Some(camera) = camera {
            let framed = Project { camera, ..(**project).clone() };
            self.document.edit_in(gesture, "file", framed);
        }
        self.files.framing = None;
    }

    /// Makes a file that the user picked a part of the project. One that cannot be loaded leaves the project again.
    pub(super) fn open_part(&mut self, place: Place, path: &Path, set: impl FnOnce(&mut Project)) {
        self.session.pick(path);
        self.document.try_file("file", place, path, set);
        // The project may have named the file before without having access to it.
        let project = self.document.project().clone();
        self.session.reload(&project);
    }

    /// Plays a take or curves: `made` returns the project that does. One undo step restores the previous one.
    fn play(&mut self, path: &Path, made: impl FnOnce(&Project) -> Project) {
        self.session.pick(path);
        self.allow_granted(path);
        self.document.try_file("take", Place::Take, path, |project| *project = made(project));
        let project = self.document.project().clone();
        self.session.reload(&project);
    }

    /// Adds a pane that shows a take, rendered with the settings of the project. Panes that nobody has changed make place for it.
    fn put_beside(&mut self, path: &Path, found: &Found) -> Result<(), String> {
        match found {
            Found::Take(..) | Found::Curves(_) => {
                let panes = &self.document.project().compare.panes;
                let untouched = *panes == CompareSection::default().panes;
                if !untouched && panes.len() >= CompareSection::MAX_PANES {
                    let most = CompareSection::MAX_PANES;
                    return Err(format!(
                        "There are {most} panes, the most. Remove one, then open the take again."
                    ));
                }
                self.session.pick(path);
                self.allow_granted(path);
                let file = FileRef::new(path);
                self.change("add pane", |project| {
                    let own = Contender::of(project);
                    if untouched {
                        project.compare.panes = vec![own.clone()];
                    }
                    project.compare.panes.push(Contender { take: Some(file), ..own });
                });
                self.layout.page = Page::Compare;
            }
            Found::Part(_, Some(reason)) => return Err(reason.clone()),
            found => {
                return Err(format!("{}: found a {} file; must be a take", path.display(), found.label()));
            }
        }
        Ok(())
    }

    pub(super) fn open_project(&mut self, path: &Path) -> Result<(), String> {
        self.allow_granted(path);
        let mut access = self.session.access().clone();
        let (project, problems) = load_project_with(path, &mut access).map_err(|error| error.to_string())?;
        self.replace_document(project, Some(path.to_owned()));
        self.safety.stamp(Some(path));
        remember(&mut self.layout.recent, path);
        self.warn(problems.into_iter().map(|problem| problem.message));
        Ok(())
    }

    /// Puts the new project in which strokes were played in place of this one.
    pub(super) fn open_played(&mut self, played: &Played) {
        self.replace_document(played.project.clone(), None);
        self.notices.push(notices::Kind::Done, played.said.clone());
        self.warn(played.problems.iter().map(|problem| problem.message.clone()));
    }

    /// Puts another project in place of this one.
    pub(super) fn replace_document(&mut self, project: Project, path: Option<PathBuf>) {
        self.forget_document();
        self.document.replace(project, path);
        self.rest_all();
        self.follow_path();
    }

    /// Ends what was begun in the project that another one replaces.
    pub(super) fn forget_document(&mut self) {
        self.cancel_strokes();
        self.files.framing = None;
    }

    pub(super) fn save_to(&mut self, path: &Path) -> Result<(), String> {
        self.safety.check_stamp(path)?;
        save_project(path, self.document.project()).map_err(|error| error.to_string())?;
        self.safety.stamp(Some(path));
        self.document.mark_saved(path);
        self.forget_recent_picture();
        self.follow_path();
        remember(&mut self.layout.recent, path);
        self.notices.push(notices::Kind::Done, format!("Saved {}", path.display()));
        Ok(())
    }
}
