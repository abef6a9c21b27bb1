//! The project of a command, with the changes of the command line.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use lovelock_groom::CurveMotion;
use lovelock_jobs::info::FileKind;
use lovelock_jobs::presets::style_named;
use lovelock_panes::sheet::Sheet;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::{Access, FileRef};
use lovelock_project::grants::Grants;
use lovelock_project::project::{BodySource, CompareSection, Contender, HairSource, load_project_with};
use lovelock_project::styles::StyleParts;
use lovelock_session::progress::Progress;
use lovelock_session::take::{project_of_cache, project_of_take};

use super::args::SourceArguments;
use super::bar::Bar;

/// A project with the changes of the command line.
pub(super) struct Source {
    pub(super) project: Project,
    pub(super) access: Access,
    /// A name for people, made of what the command line names.
    pub(super) name: String,
    /// Files that are named on the command line.
    named: Vec<(Place, PathBuf)>,
}

impl Source {
    /// Reads the project and applies the other options.
    pub(super) fn open(task: &SourceArguments) -> Result<Self, ProjectError> {
        let mut access = Access::of_command();
        for path in &task.allow {
            required(path, &mut access)?;
        }
        if let Some(path) = &task.project {
            Grants::of_user().allow(path, &mut access);
        }
        // A file that cannot be read is one for its reader, which says why.
        let kind = task.project.as_deref().and_then(|path| FileKind::of(path).ok());
        let (mut project, problems) = match &task.project {
            Some(path) if kind == Some(FileKind::Strokes) => {
                let message = format!(
                    "{}: found recorded strokes; must be a project or a take (`lovelock style --strokes FILE` plays strokes on a \
                     project)",
                    path.display()
                );
                return Err(ProjectError::input(path, message));
            }
            Some(path) if kind == Some(FileKind::Take) => {
                access.pick(path);
                project_of_take(path)?
            }
            Some(path) => match CurveMotion::of(path) {
                CurveMotion::Moving(_) => {
                    access.pick(path);
                    let around = Self::around(task, &mut access)?;
                    (project_of_cache(&around, path)?, Vec::new())
                }
                CurveMotion::Refused(reason) => {
                    let message = format!(
                        "{reason}; these curves cannot be played: use --hair to load them as a still hairstyle"
                    );
                    return Err(ProjectError::input(path, message));
                }
                CurveMotion::Still => {
                    access.set_project(Some(path));
                    load_project_with(path, &mut access)?
                }
            },
            None => (Project::default(), Vec::new()),
        };
        print_problems(&problems);
        let shipped = task.body.as_deref().and_then(shipped_body);
        let body_file = task.body.clone().filter(|_| shipped.is_none());
        if let Some(take) = project.take.file.clone() {
            Grants::of_user().allow(&take.path, &mut access);
            allow(task, &project, &take.path, &mut access)?;
            // Light and sound are not recorded, and curves have neither body nor motion.
            let mut named = Vec::new();
            if project.plays_curves() {
                if let Some(path) = &body_file {
                    named.push((Place::Body, required(path, &mut access)?));
                    project.set_body_file(path);
                }
                if let Some(source) = shipped {
                    project.show_shipped_body(source);
                }
                if let Some(path) = &task.motion {
                    named.push((Place::Motion, required(path, &mut access)?));
                    project.set_motion_file(path);
                }
            }
            if let Some(path) = &task.surroundings {
                named.push((Place::Surroundings, required(path, &mut access)?));
                project.set_surroundings_file(path);
            }
            if let Some(path) = &task.sound {
                named.push((Place::Sound, required(path, &mut access)?));
                project.set_sound_file(path);
            }
            if let Some(path) = &task.background {
                named.push((Place::Backdrop, required(path, &mut access)?));
            }
            set_light(task, &mut project);
            set_import(task, &mut project)?;
            project.assign(&task.set)?;
            let name = task.project.as_ref().unwrap_or(&take.path).display().to_string();
            return Ok(Self { project, access, name, named });
        }
        let file_name = |path: &PathBuf| {
            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let mut names = vec![task.project.as_ref().map_or_else(|| "default project".to_owned(), file_name)];
        if let Some(id) = &task.preset {
            let listed = style_named(id)?;
            if let Some(file) = &listed.style.hair.file {
                access.pick(&file.path);
            }
            project.apply_style(&listed.style, StyleParts::ALL);
            names.push(id.clone());
        }
        if let Some(id) = &task.morph {
            let listed = style_named(id)?;
            if let Some(file) = &listed.style.hair.file {
                access.pick(&file.path);
            }
            project.start_morph(&listed.style);
            names.push(format!("to {id}"));
        }
        let places = [
            (Place::Hair, &task.hair),
            (Place::Body, &body_file),
            (Place::Motion, &task.motion),
            (Place::Surroundings, &task.surroundings),
            (Place::Sound, &task.sound),
            (Place::Backdrop, &task.background),
        ];
        let mut named = Vec::new();
        for (place, path) in places {
            let Some(path) = path else { continue };
            names.push(file_name(path));
            named.push((place, required(path, &mut access)?));
        }
        if let Some(path) = &task.hair {
            project.set_hair_file(path);
        }
        if let Some(path) = &body_file {
            project.set_body_file(path);
        }
        if let Some(source) = shipped {
            names.extend(source.name().map(ToOwned::to_owned));
            project.show_shipped_body(source);
        }
        if let Some(path) = &task.motion {
            project.set_motion_file(path);
        }
        if let Some(path) = &task.surroundings {
            project.set_surroundings_file(path);
        }
        if let Some(path) = &task.sound {
            project.set_sound_file(path);
        }
        set_light(task, &mut project);
        set_import(task, &mut project)?;
        project.assign(&task.set)?;
        Ok(Self { project, access, name: names.join(", "), named })
    }

    /// The project that curves are played with: the default one, with the body and the motion of the command line.
    fn around(task: &SourceArguments, access: &mut Access) -> Result<Project, ProjectError> {
        let mut project = Project::default();
        if let Some(path) = &task.body {
            required(path, access)?;
            project.set_body_file(path);
        }
        if let Some(path) = &task.motion {
            required(path, access)?;
            project.set_motion_file(path);
        }
        Ok(project)
    }

    /// Adds a pane per take beside the project; returns the layout of the panes.
    pub(super) fn beside(&mut self, takes: &[PathBuf]) -> Result<Sheet, ProjectError> {
        let most = CompareSection::MAX_PANES - 1;
        if takes.len() > most {
            let found = takes.len();
            return Err(ProjectError::option(format!(
                "--beside: found {found} takes; must be at most {most}"
            )));
        }
        let own = Contender::of(&self.project);
        let mut panes = vec![own.clone()];
        for take in takes {
            match FileKind::of(take)? {
                FileKind::Take => {}
                kind => {
                    let motion =
                        if kind == FileKind::Hair { CurveMotion::of(take) } else { CurveMotion::Still };
                    match motion {
                        CurveMotion::Moving(_) => {}
                        CurveMotion::Refused(reason) => {
                            return Err(ProjectError::input(take, format!("--beside: {reason}")));
                        }
                        CurveMotion::Still => {
                            let message = format!(
                                "--beside {}: found a {} file; must be a take",
                                take.display(),
                                kind.label()
                            );
                            return Err(ProjectError::input(take, message));
                        }
                    }
                }
            }
            self.access.pick(take);
            panes.push(Contender { take: Some(FileRef::new(take)), ..own.clone() });
        }
        self.project.compare.panes = panes;
        Ok(Sheet::default())
    }

    /// Runs the work and shows its progress.
    pub(super) fn watched<T>(
        &self,
        work: impl FnOnce(&Project, &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<T, ProjectError>,
    ) -> Result<T, ProjectError> {
        let mut bar = Bar::new();
        let mut refused = None;
        let result = work(&self.project, &mut |progress| {
            if let Progress::Loaded { problems } = &progress {
                // A missing file of the project is replaced with a warning. A missing file of the command line is an error.
                for problem in problems.iter().filter(|problem| problem.is_failure()) {
                    if let Some((_, path)) = self.named.iter().find(|(place, _)| *place == problem.place) {
                        refused = Some(ProjectError::input(path, problem.cause.clone()));
                        return ControlFlow::Break(());
                    }
                }
            }
            bar.show(&progress);
            ControlFlow::Continue(())
        });
        bar.done();
        refused.map_or(result, Err)
    }
}

/// Grants access to a file that is named on the command line, which must be there.
fn required(path: &Path, access: &mut Access) -> Result<PathBuf, ProjectError> {
    if !path.is_file() {
        return Err(ProjectError::input(path, format!("{}: not found; must be a file", path.display())));
    }
    access.pick(path);
    Ok(path.to_owned())
}

/// Grants access to the files that are named beside a take, which plays as recorded, so they must be its own.
fn allow(
    task: &SourceArguments,
    project: &Project,
    take: &Path,
    access: &mut Access,
) -> Result<(), ProjectError> {
    let refused = |option: &str| {
        let take = take.display();
        ProjectError::option(format!(
            "{option}: {take} was recorded with another file and plays as recorded; leave the option out"
        ))
    };
    if task.preset.is_some() {
        return Err(refused("--preset"));
    }
    if task.morph.is_some() {
        return Err(refused("--morph"));
    }
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    for (option, named, own) in [
        ("--hair", &task.hair, &project.hair.file),
        ("--body", &task.body, &project.body.file),
        ("--motion", &task.motion, &project.motion.file),
    ] {
        let Some(named) = named else { continue };
        if option != "--hair" && project.plays_curves() {
            // Curves play on any body.
            continue;
        }
        if own.as_ref().is_none_or(|own| real(&own.path) != real(named)) {
            return Err(refused(option));
        }
        access.pick(named);
    }
    Ok(())
}

/// The shipped body that `--body` names. A file of that name comes first.
pub(super) fn shipped_body(given: &Path) -> Option<BodySource> {
    given.to_str().filter(|_| !given.exists()).and_then(BodySource::shipped)
}

/// Sets the lights and the background.
fn set_light(task: &SourceArguments, project: &mut Project) {
    if let Some(rig) = task.lights {
        rig.apply(&mut project.lights, &mut project.picture);
    }
    if let Some(path) = &task.background {
        project.set_backdrop_file(path);
    }
}

/// Sets the unit and the up axis of the hair file that the project uses.
fn set_import(task: &SourceArguments, project: &mut Project) -> Result<(), ProjectError> {
    let is_read =
        project.plays_curves() || project.take.file.is_none() && project.hair.source == HairSource::File;
    for (option, given) in [("--unit", task.unit.is_some()), ("--up", task.up.is_some())] {
        if given && !is_read {
            return Err(ProjectError::option(format!(
                "{option}: found no hair file; must be given with one"
            )));
        }
    }
    let import = &mut project.hair.import;
    import.unit = task.unit.unwrap_or(import.unit);
    import.up = task.up.unwrap_or(import.up);
    Ok(())
}

/// Prints the problems in the project's text. The loader reports missing files and their replacements.
fn print_problems(problems: &[Problem]) {
    for problem in problems.iter().filter(|problem| !problem.is_failure()) {
        eprintln!("lovelock: {}", problem.message);
    }
}
