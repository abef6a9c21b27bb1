//! Playing curves over time: hair that another program has simulated.
//!
//! The curves are in the world of the scene: the body and the motion of the project are those that they were simulated with, at
//! the times of the file. Strands are exactly the curves; the guides follow some of them, for what is computed from guides.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_groom::{
    CurveCache, GuideFrame, HairFormat, ImportSettings, ImportedInPlace, Strands, hair_look, import_in_place,
};
use lovelock_motion::Pose;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::{BodySection, HairSection, MotionSection, SurroundingsSection};
use lovelock_record::{FrameRate, TakeHeader};

use crate::scene::{Scene, SceneLoader, Surroundings};
use crate::snapshot::{FrameSnapshot, SnapshotPool};
use crate::stats::StageTimes;

/// The longest playback of curves, seconds.
const MAX_SECS: f64 = 86_400.0;

/// Whether the first bytes of a file are those of a format of hair. A take begins otherwise.
pub fn holds_curves(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(64).read_to_end(&mut start));
    read.is_ok() && HairFormat::of_magic(&start).is_some()
}

/// The project `base` set to play the curves of a file, in their colour.
///
/// # Errors
/// If the file holds no curves over time.
pub fn project_of_cache(base: &Project, path: &Path) -> Result<Project, ProjectError> {
    Ok(CurvesToPlay::read(path, &base.hair)?.played_in(base))
}

/// What a project takes over from curves over time in order to play them.
#[derive(Clone, Debug, PartialEq)]
pub struct CurvesToPlay {
    path: PathBuf,
    /// Eumelanin and pheomelanin, if the file has colours.
    pigments: Option<(f32, f32)>,
    /// The first time of the file, seconds.
    start_secs: f64,
}

impl CurvesToPlay {
    /// Reads the start of a file, in the unit and up axis of `hair`.
    ///
    /// # Errors
    /// If the file holds no curves over time.
    pub fn read(path: &Path, hair: &HairSection) -> Result<Self, ProjectError> {
        let cache = open(path, hair)?;
        let file = cache.hair();
        let colored = file.colours.is_some() || file.default_colour.is_some();
        let pigments = colored.then(|| hair_look(file)).map(|look| (look.eumelanin, look.pheomelanin));
        Ok(Self { path: path.to_owned(), pigments, start_secs: cache.times()[0].max(0.0) })
    }

    /// The project set to play the curves.
    pub fn played_in(&self, base: &Project) -> Project {
        let mut project = base.clone();
        if let Some(pigments) = self.pigments {
            (project.look.eumelanin, project.look.pheomelanin) = pigments;
        }
        project.set_take(&self.path);
        // Markers, tracks and the sound move to the timeline of the curves, as they do for a take.
        project.timeline.shift(-self.start_secs, f64::INFINITY);
        project.sound.offset_secs -= self.start_secs;
        (project.recording.first_frame, project.recording.end_frame) = (0, None);
        project
    }
}

/// The parts of a project that curves over time are shown with. A take brings its own.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveInputs(Box<(BodySection, MotionSection, ImportSettings)>);

impl CurveInputs {
    /// Those of a file; `None` for a take.
    pub fn of(path: &Path, project: &Project) -> Option<Self> {
        let Project { body, motion, hair, .. } = project;
        holds_curves(path).then(|| Self(Box::new((body.clone(), motion.clone(), hair.import))))
    }
}

/// Opens curves that move.
fn open(path: &Path, hair: &HairSection) -> Result<CurveCache, ProjectError> {
    let import = &hair.import;
    let cache = CurveCache::open(path, import.unit, import.up, import.include_hidden)
        .map_err(|error| ProjectError::input(path, error))?;
    if cache.times().len() < 2 {
        let message =
            format!("{}: found curves at one time; must have two or more times to be played", path.display());
        return Err(ProjectError::input(path, message));
    }
    Ok(cache)
}

/// Curves opened for playing, with their scene.
pub(super) struct CachePlayer {
    path: PathBuf,
    cache: CurveCache,
    imported: ImportedInPlace,
    header: TakeHeader,
    frames: u64,
    project: Project,
    scene: Arc<Scene>,
    first_point: Arc<[u32]>,
    /// The points of the curves at the current time, in the order of the file.
    points: Vec<Vec3>,
    guides: GuideFrame,
    pose: Pose,
    pool: SnapshotPool,
    shown: u64,
    origin_secs: f64,
}

impl CachePlayer {
    pub(super) fn open(
        path: &Path,
        access: &Access,
        project: &Project,
    ) -> Result<(Self, Vec<Problem>), ProjectError> {
        let mut project = project.clone();
        project.take.file = None;
        project.surroundings = SurroundingsSection::default();
        let mut cache = open(path, &project.hair)?;
        // The hair of the scene is replaced, so it is small; the body is needed as it is.
        let mut bare = Project { hair: HairSection::default(), ..project.clone() };
        (bare.hair.groom.wisps, bare.hair.groom.strands_per_wisp) = (8, 1);
        let (scene, mut problems) = SceneLoader::new().load_now(&bare, access)?;
        problems.retain(|problem| problem.place != Place::Hair);
        let times = cache.times();
        let (start, end) = (times[0], times[times.len() - 1]);
        let rate = rate_of(times);
        let mut header = TakeHeader {
            program: "curves".to_owned(),
            frames_per_second: rate,
            start_secs: start,
            clip: scene.clip.as_ref().map_or_else(String::new, |clip| clip.name.clone()),
            clip_secs: scene.clip.as_ref().map_or(0.0, |clip| clip.duration_secs),
            ..TakeHeader::default()
        };
        if end - start > MAX_SECS {
            let found = format!(
                "{}: found curves over {:.0} s; must be {MAX_SECS} s at most",
                path.display(),
                end - start
            );
            return Err(ProjectError::input(path, found));
        }
        let frames = ((end - start) * rate.as_f64() + 1e-3).floor().max(0.0) as u64 + 1;

        let mut pose = Pose::default();
        scene.pose_at(scene.clip_secs(start), &mut pose);
        let mut points = Vec::new();
        let refuse = |error: &dyn std::fmt::Display| ProjectError::input(path, error);
        cache.points_at(start, &mut points).map_err(|error| refuse(&error))?;
        let head_from_world = pose.world_from_head.inverse();
        let at_rest = points.iter().map(|&point| head_from_world.transform_point3(point)).collect();
        let imported = import_in_place(cache.hair(), &project.hair.import, &scene.style.scalp, at_rest)
            .map_err(|error| refuse(&error))?;
        imported.style.check().map_err(|error| refuse(&error))?;
        header.guides = imported.style.guides.count() as u32;
        header.points_per_guide = imported.style.guides.points_per_guide as u32;
        header.strands = imported.style.strands.count() as u32;
        let guides = GuideFrame::at_rest(&imported.style.guides, pose.world_from_head, start);
        let first_point = Arc::from(imported.style.strands.first_point.as_slice());
        let of_file = cache.notes().iter().map(|note| Problem::new(Place::Take, ProblemKind::Note, note));
        let others = scene.notes.iter().filter(|note| note.place != Place::Hair).cloned();
        let notes = others.chain(of_file).collect();
        let scene = Arc::new(Scene { style: Arc::new(imported.style.clone()), notes, ..(*scene).clone() });
        let player = Self {
            path: path.to_owned(),
            cache,
            imported,
            header,
            frames,
            project,
            scene,
            first_point,
            points,
            guides,
            pose,
            pool: SnapshotPool::default(),
            shown: 0,
            origin_secs: 0.0,
        };
        Ok((player, problems))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn header(&self) -> &TakeHeader {
        &self.header
    }

    pub(super) fn project(&self) -> &Project {
        &self.project
    }

    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    pub(super) fn count_on_dance(&mut self) {
        self.origin_secs = self.header.start_secs.max(0.0);
    }

    pub(super) fn origin_secs(&self) -> f64 {
        self.origin_secs
    }

    pub(super) fn set_surroundings(&mut self, pictures: Surroundings, notes: Vec<Problem>) -> bool {
        if self.scene.surroundings.is(&pictures) {
            return false;
        }
        let others = self
            .scene
            .notes
            .iter()
            .filter(|note| !matches!(note.place, Place::Surroundings | Place::Backdrop))
            .cloned();
        let notes = others.chain(notes).collect();
        self.scene = Arc::new(Scene { surroundings: pictures, notes, ..(*self.scene).clone() });
        true
    }

    pub(super) fn snapshot(&mut self, secs: f64) -> Result<Arc<FrameSnapshot>, ProjectError> {
        let watch = Stopwatch::start();
        let secs = secs - self.origin_secs;
        let duration_secs = self.header.secs_of(self.frames - 1);
        let secs = if secs.is_finite() { secs.clamp(0.0, duration_secs) } else { 0.0 };
        let time_secs = self.header.start_secs + secs;
        self.cache
            .points_at(time_secs, &mut self.points)
            .map_err(|error| ProjectError::input(&self.path, error))?;
        let scene = &self.scene;
        scene.pose_at(scene.clip_secs(time_secs), &mut self.pose);
        let file = self.cache.hair();
        self.imported.follow(&file.first_point, &self.points, &mut self.guides.guides);
        (self.guides.time_secs, self.guides.world_from_head) = (time_secs, self.pose.world_from_head);
        self.shown += 1;
        let (guides, pose, shown) = (&self.guides, &self.pose, self.shown);
        let position_secs = secs + self.origin_secs;
        Ok(self.pool.make(scene, |snapshot| {
            snapshot.step = shown;
            (snapshot.time_secs, snapshot.position_secs) = (time_secs, position_secs);
            snapshot.duration_secs = duration_secs;
            snapshot.pose.clone_from(pose);
            snapshot.follow_pose();
            snapshot.guides.clone_from(guides);
            let strands = snapshot.strands.get_or_insert_with(Strands::default);
            fill(strands, &self.first_point, &self.imported.strands, &file.first_point, &self.points);
            snapshot.times = StageTimes { motion: watch.ms(), ..StageTimes::default() };
        }))
    }
}

/// Puts the points of a file into the order of a hairstyle.
fn fill(strands: &mut Strands, first_point: &Arc<[u32]>, order: &[u32], of_file: &[u32], points: &[Vec3]) {
    strands.first_point = Arc::clone(first_point);
    for (axis, values) in [&mut strands.x, &mut strands.y, &mut strands.z].into_iter().enumerate() {
        values.clear();
        for &strand in order {
            let span = of_file[strand as usize] as usize..of_file[strand as usize + 1] as usize;
            values.extend(points[span].iter().map(|point| point[axis]));
        }
    }
}

/// The frames per second of times: by the middle one of the steps between them.
fn rate_of(times: &[f64]) -> FrameRate {
    let mut steps: Vec<f64> = times.array_windows().map(|[a, b]| b - a).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(1.0 / 24.0);
    FrameRate::from_fps((1.0 / step).clamp(1.0, 240.0)).unwrap_or(FrameRate { num: 24, den: 1 })
}
