//! Playing a recorded simulation: the snapshot at a time.

use std::path::Path;
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_groom::Hairstyle;
use lovelock_motion::Pose;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::{SurroundingsSection, project_of_text};
use lovelock_record::{
    AssetState, TakeCondition, TakeError, TakeFrame, TakeHeader, TakeReader, hairstyle_fingerprint,
};
use lovelock_simulation::StepReport;

use crate::scene::{Scene, SceneLoader, Styling, Surroundings};
use crate::snapshot::{FrameSnapshot, SnapshotPool};
use crate::stats::StageTimes;

/// Number of cached scenes of a take, so that seeking between parts does not grow the hair again.
const MAX_SCENES: usize = 8;

/// A take opened for playing, with its scene.
pub(super) struct RecordedPlayer {
    reader: TakeReader,
    access: Access,
    loader: SceneLoader,
    /// The project of the first frame.
    first: Project,
    /// The text of the project of the current scene.
    text: Arc<str>,
    scene: Arc<Scene>,
    /// The tracks of the hairstyle in that project, and the scene with the hairstyle of the last snapshot.
    styling: Option<Styling>,
    /// Scenes with the projects that they were loaded from, the most recently used last.
    scenes: Vec<(Project, Arc<Scene>)>,
    /// The picture that gives light, and notes about it.
    surroundings: (Surroundings, Vec<Problem>),
    frame: TakeFrame,
    pose: Pose,
    pool: SnapshotPool,
    shown: u64,
    /// First frame of the run of lost frames that was reported last.
    told_lost: Option<u64>,
    /// The time of its first frame, seconds.
    origin_secs: f64,
    notices: Vec<String>,
}

impl RecordedPlayer {
    /// The memory of decoded frames, bytes.
    pub(super) fn cached_bytes(&self) -> u64 {
        self.reader.cached_bytes() as u64
    }

    /// Opens a take and loads its scene. Problems say what has changed, is missing or is damaged.
    ///
    /// # Errors
    /// If the file is not a take, is of a newer version, has no frames, or its guides no longer fit the hair.
    pub(super) fn open(path: &Path, access: &Access) -> Result<(Self, Vec<Problem>), ProjectError> {
        let mut reader = TakeReader::open(path)?;
        let start = reader.nearest(0).unwrap_or(0);
        let text = reader.project_at(start).unwrap_or_else(|_| Arc::from(reader.header().project.as_str()));
        let (mut project, mut problems) = project_of_text(path, &text)?;
        project.take.file = None;
        // The light is that of the project that plays the take.
        project.surroundings = SurroundingsSection::default();
        // Files beside the take may be read, as for a project.
        let mut access = access.clone();
        access.set_take(path);
        let mut loader = SceneLoader::new();
        let (scene, of_scene) = loader.load_now(&project, &access)?;
        let mut frame = TakeFrame::default();
        let header_guides = {
            let header = reader.header();
            (header.guides as usize, header.points_per_guide as usize)
        };
        // If that frame is damaged as well, use the layout in the header.
        let guides = reader.frame_into(start, &mut frame).map_or(header_guides, |()| guides_of(&frame));
        fits(path, guides, &scene.style, &of_scene)?;
        let header = reader.header();
        problems.extend(of_scene);
        problems.extend(differences(path, header, &access, &reader.condition(), &scene.style));
        let player = Self {
            reader,
            access,
            loader,
            first: project.clone(),
            text,
            styling: Styling::of(&project, None),
            scene: Arc::clone(&scene),
            scenes: vec![(made_of(&project), scene)],
            surroundings: (Surroundings::default(), Vec::new()),
            frame,
            pose: Pose::default(),
            pool: SnapshotPool::default(),
            shown: 0,
            told_lost: None,
            origin_secs: 0.0,
            notices: Vec::new(),
        };
        Ok((player, problems))
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        self.reader.path()
    }

    /// The header of the take.
    pub(super) fn header(&self) -> &TakeHeader {
        self.reader.header()
    }

    /// Known damage of the take.
    pub(super) fn condition(&self) -> TakeCondition {
        self.reader.condition()
    }

    /// The project at the first frame.
    pub(super) fn project(&self) -> &Project {
        &self.first
    }

    /// The scene of the last snapshot.
    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Sets the pictures around the figure, and notes about them. A take records none. Returns whether they are others than before.
    pub(super) fn set_surroundings(&mut self, pictures: Surroundings, notes: Vec<Problem>) -> bool {
        let others = !self.surroundings.0.is(&pictures);
        self.surroundings = (pictures, notes);
        for at in 0..self.scenes.len() {
            let lit = self.lit(&self.scenes[at].1);
            if Arc::ptr_eq(&self.scene, &self.scenes[at].1) {
                self.scene = Arc::clone(&lit);
            }
            self.scenes[at].1 = lit;
        }
        others
    }

    /// The scene in the light of the surroundings.
    fn lit(&self, scene: &Arc<Scene>) -> Arc<Scene> {
        let (pictures, notes) = &self.surroundings;
        if pictures.is(&scene.surroundings) {
            return Arc::clone(scene);
        }
        let others =
            scene.notes.iter().filter(|note| !matches!(note.place, Place::Surroundings | Place::Backdrop));
        let notes = others.chain(notes).cloned().collect();
        Arc::new(Scene { surroundings: pictures.clone(), notes, ..(**scene).clone() })
    }

    /// Number of frames.
    pub(super) fn frames(&self) -> u64 {
        self.reader.frames()
    }

    /// Length of a frame, seconds.
    pub(super) fn frame_secs(&self) -> f64 {
        1.0 / self.header().frames_per_second.as_f64()
    }

    /// Time from the first frame to the last one, seconds.
    pub(super) fn duration_secs(&self) -> f64 {
        self.header().secs_of(self.frames() - 1)
    }

    /// Counts time, and the timeline, from the start of the original motion instead of the start of the take.
    pub(super) fn count_on_dance(&mut self) {
        let secs = self.header().start_secs;
        self.origin_secs = if secs.is_finite() { secs.max(0.0) } else { 0.0 };
    }

    /// Time of the first frame, seconds: 0, or its time in the original motion after [`RecordedPlayer::count_on_dance`].
    pub(super) fn origin_secs(&self) -> f64 {
        self.origin_secs
    }

    /// The snapshot `secs` after the start, clamped to the take and interpolated between frames.
    ///
    /// # Errors
    /// If the frames around it are damaged or cannot be read.
    pub(super) fn snapshot(&mut self, secs: f64) -> Result<Arc<FrameSnapshot>, ProjectError> {
        let watch = Stopwatch::start();
        let secs = secs - self.origin_secs;
        let secs = if secs.is_finite() { secs.clamp(0.0, self.duration_secs()) } else { 0.0 };
        let position_secs = secs + self.origin_secs;
        let mut shown = match self.reader.frame_at(secs, &mut self.frame) {
            Ok(shown) => shown,
            Err(error) => self.play_over((secs / self.frame_secs()).round() as u64, error)?,
        };
        // Each iteration finds another damaged part of the file.
        loop {
            match self.reader.project_at(shown) {
                Ok(text) => break self.follow(text)?,
                Err(error) => shown = self.play_over(shown, error)?,
            }
        }
        let styled = self.styled();
        self.scene.pose_at(self.frame.clip_secs, &mut self.pose);
        self.shown += 1;
        let duration_secs = self.duration_secs();
        let (scene, frame, pose, shown) = (&styled, &self.frame, &self.pose, self.shown);
        let report = StepReport { substeps: frame.substeps, jumped: frame.jumped, ..StepReport::default() };
        Ok(self.pool.make(scene, |snapshot| {
            snapshot.step = shown;
            // The camera uses the time of the scene; the timeline uses the time of the take.
            (snapshot.time_secs, snapshot.position_secs) = (frame.guides.time_secs, position_secs);
            snapshot.duration_secs = duration_secs;
            snapshot.pose.clone_from(pose);
            snapshot.follow_pose();
            snapshot.guides.clone_from(&frame.guides);
            snapshot.report = report;
            snapshot.times = StageTimes { motion: watch.ms(), ..StageTimes::default() };
        }))
    }

    /// Returns the nearest readable frame in place of a lost one, and reports each run of lost frames once.
    fn play_over(&mut self, frame: u64, error: TakeError) -> Result<u64, ProjectError> {
        let TakeError::Lost { first, .. } = error else { return Err(error.into()) };
        let near = loop {
            let Some(near) = self.reader.nearest(frame) else { return Err(error.into()) };
            match self.reader.frame_into(near, &mut self.frame) {
                Ok(()) => break near,
                // The reader now knows that the frame is lost and will not return it again.
                Err(TakeError::Lost { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        };
        if self.told_lost != Some(first) {
            self.told_lost = Some(first);
            self.notices.push(format!("{error}; frame {near} is shown instead"));
        }
        Ok(near)
    }

    /// Notices about lost frames since the last call.
    pub(super) fn notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notices)
    }

    /// The scene with the hairstyle of the current frame: that of the step at it or after it, as the simulation drew it.
    fn styled(&mut self) -> Arc<Scene> {
        let frame_secs = self.frame_secs();
        let Some(styling) = &mut self.styling else { return Arc::clone(&self.scene) };
        let secs = self.frame.guides.time_secs;
        let steps = secs / frame_secs;
        let secs = if (steps - steps.round()).abs() < 1e-3 { secs } else { steps.ceil() * frame_secs };
        styling.scene_at(&self.scene, self.scene.position_secs(secs))
    }

    /// Switches to the scene of the project `text`, which the current frame belongs to.
    fn follow(&mut self, text: Arc<str>) -> Result<(), ProjectError> {
        if Arc::ptr_eq(&text, &self.text) || text == self.text {
            return self.check_guides();
        }
        let (mut project, _) = project_of_text(self.reader.path(), &text)?;
        project.surroundings = SurroundingsSection::default();
        let key = made_of(&project);
        if let Some(place) = self.scenes.iter().position(|(of, _)| *of == key) {
            self.scenes[place..].rotate_left(1);
        } else {
            let (scene, problems) = self.loader.load_now(&project, &self.access)?;
            fits(self.reader.path(), guides_of(&self.frame), &scene.style, &problems)?;
            if self.scenes.len() == MAX_SCENES {
                self.scenes.remove(0);
            }
            let scene = self.lit(&scene);
            self.scenes.push((key, scene));
        }
        if let Some((_, scene)) = self.scenes.last() {
            self.scene = Arc::clone(scene);
        }
        self.styling = Styling::of(&project, self.styling.take());
        self.text = text;
        self.check_guides()
    }

    /// Rejects guides that do not fit the scene, for example because a file differed during a part of the take.
    fn check_guides(&self) -> Result<(), ProjectError> {
        fits(self.reader.path(), guides_of(&self.frame), &self.scene.style, &[])
    }
}

/// The project with defaults for all sections that a scene does not depend on.
fn made_of(project: &Project) -> Project {
    let Project { body, motion, hair, .. } = project.clone();
    Project { body, motion, hair, ..Project::default() }
}

/// Number of guides of a frame, and points per guide.
fn guides_of(frame: &TakeFrame) -> (usize, usize) {
    (frame.guides.guides.count(), frame.guides.guides.points_per_guide)
}

/// Checks that the scene is the recorded one: no file is missing, and number and points of the recorded guides match its
/// hairstyle.
fn fits(
    path: &Path,
    recorded: (usize, usize),
    style: &Hairstyle,
    problems: &[Problem],
) -> Result<(), ProjectError> {
    let (guides, points) = (style.guides.count(), style.guides.points_per_guide);
    let fits = (guides, points) == recorded;
    if fits && !problems.iter().any(Problem::is_failure) {
        return Ok(());
    }
    let why: Vec<_> =
        problems.iter().filter(|problem| problem.is_failure()).map(|p| p.cause.as_str()).collect();
    let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
    if fits {
        // Recorded hair on another body or motion would show something that never happened.
        return Err(ProjectError::input(
            path,
            format!("{}: a part of its scene is missing{why}", path.display()),
        ));
    }
    Err(ProjectError::input(
        path,
        format!(
            "{}: its hairstyle has changed: found {guides} guides of {points} points; must be {} of {}{why}",
            path.display(),
            recorded.0,
            recorded.1
        ),
    ))
}

/// Differences from the state at the time of recording.
fn differences(
    path: &Path,
    header: &TakeHeader,
    access: &Access,
    condition: &TakeCondition,
    style: &Hairstyle,
) -> Vec<Problem> {
    let note =
        |what: String| Problem::new(Place::Take, ProblemKind::Note, format!("{}: {what}", path.display()));
    let mut problems = Vec::new();
    if !condition.is_whole() {
        problems.push(note(format!("the take is {condition}")));
    }
    for asset in &header.assets {
        let (role, file) = (&asset.role, asset.path.display());
        // Skip files that may not be read, which the loader has reported, and anything that is not a regular file, which may be
        // endless.
        let data = std::fs::metadata(&asset.path);
        if !access.allows(&asset.path) || data.as_ref().is_ok_and(|data| !data.is_file()) {
            continue;
        }
        if data.is_ok_and(|data| data.len() != asset.bytes) {
            problems.push(note(format!("the {role} file {file} has changed since the take was recorded")));
            continue;
        }
        match asset.state() {
            AssetState::Same => {}
            AssetState::Changed { .. } => {
                problems
                    .push(note(format!("the {role} file {file} has changed since the take was recorded")));
            }
            AssetState::Missing(error) => {
                problems.push(note(format!("the {role} file {file} of the take cannot be read ({error})")));
            }
        }
    }
    if hairstyle_fingerprint(style) != header.hairstyle {
        problems.push(note(
            "the hairstyle has changed since the take was recorded; its strands follow the recorded guides"
                .to_owned(),
        ));
    }
    problems
}
