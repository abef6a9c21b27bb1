//! What figures are made with: instants of projects, images, measurements of transmittance, and the report of one figure.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use lovelock_base::statistics::median;
use lovelock_metrics::{Image, errors};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_render::{Backend, FrameStats, Picture, Renderer, ShadowMethod, ShadowSettings};
use lovelock_session::dance::Dance;
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_shadow::{CpuShadow, RayMark, ShadowInput, ShadowReport, cpu_shadow};
use lovelock_study::batch::{Hair, lights};

use super::folder::Folder;
use super::report::{CheckReport, CurveReport, FigureReport, PictureReport, PlotReport, TableReport};

/// What to make.
#[derive(Clone, Debug)]
pub struct PapersRequest {
    /// The folder of the gallery.
    pub out: PathBuf,
    /// Names of figures, or beginnings of names; all figures if empty.
    pub figures: Vec<String>,
    /// Width and height of each image, pixels.
    pub size: (u32, u32),
    /// Frames of each measured time.
    pub frames: u32,
    /// What draws.
    pub backend: Backend,
}

impl Default for PapersRequest {
    fn default() -> Self {
        Self {
            out: PathBuf::from("papers"),
            figures: Vec::new(),
            size: (480, 480),
            frames: 9,
            backend: Backend::Auto,
        }
    }
}

/// Frames per second of the dances.
pub(super) const FPS: f64 = 30.0;

/// Makes one figure.
pub(super) struct Studio<'a> {
    request: &'a PapersRequest,
    folder: &'a Folder,
    renderer: &'a mut Renderer,
    figure: &'static str,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    report: FigureReport,
    images: Vec<Drawing>,
}

/// An image of a figure, written when the figure is finished.
struct Drawing {
    name: String,
    caption: String,
    picture: Picture,
    /// What draws it.
    project: Project,
}

/// The hair of a project at one instant.
pub(super) struct Moment {
    pub hair: Hair,
    frame: u64,
}

/// An image with its measurements.
pub(super) struct Drawn {
    pub picture: Picture,
    pub stats: FrameStats,
}

/// The transmittance of the first light at every strand point, and what its map costs.
pub(super) struct Measured {
    pub transmittance: Vec<f32>,
    pub report: ShadowReport,
}

impl Measured {
    /// Root mean square difference from a truth.
    pub(super) fn rmse(&self, truth: &Self) -> f64 {
        errors(&self.transmittance, &truth.transmittance).rmse
    }

    /// Mean transmittance.
    pub(super) fn mean(&self) -> f64 {
        let sum: f64 = self.transmittance.iter().map(|value| f64::from(*value)).sum();
        sum / self.transmittance.len().max(1) as f64
    }
}

impl<'a> Studio<'a> {
    pub(super) fn new(
        request: &'a PapersRequest,
        folder: &'a Folder,
        renderer: &'a mut Renderer,
        figure: &'static str,
        progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Self {
        Self {
            request,
            folder,
            renderer,
            figure,
            progress,
            report: FigureReport::default(),
            images: Vec::new(),
        }
    }

    /// Writes the images, so that a figure that is stopped leaves those of an earlier run.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn finish(mut self) -> Result<FigureReport, ProjectError> {
        let (width, height) = self.request.size;
        for Drawing { name, caption, picture, project } in self.images {
            let (first, end) = (project.recording.first_frame, project.recording.first_frame + 1);
            let file = self.folder.picture(&name, (width, height, &picture.rgba))?;
            let project = self.folder.project(&name, &project)?;
            let command = format!(
                "lovelock record {project} --frames {first}..{end} --fps {FPS:.0} --size {width}x{height} -o {name}"
            );
            let (project, command) = (Some(project), Some(command));
            self.report.pictures.push(PictureReport { file, caption, project, command });
        }
        Ok(self.report)
    }

    /// Number of frames of each measured time.
    pub(super) fn frames(&self) -> u32 {
        self.request.frames
    }

    /// The device that draws, for captions.
    pub(super) fn adapter(&self) -> String {
        self.renderer.adapter().to_owned()
    }

    pub(super) fn backend(&self) -> lovelock_render::Backend {
        self.renderer.backend()
    }

    /// A callback for work that reports what it does, and the way to cancel it.
    pub(super) fn watch(&mut self) -> impl FnMut(&str) -> ControlFlow<()> + '_ {
        |what| (self.progress)(Progress::Loading { what: what.to_owned() })
    }

    /// The path of a file that projects of the gallery read.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.folder.beside_projects(name)
    }

    /// The hair of a project at a frame of its motion.
    pub(super) fn moment(&mut self, project: &Project, frame: u64) -> Result<Moment, ProjectError> {
        let mut access = Access::new();
        if let Some(file) = &project.hair.file {
            access.pick(&file.path);
        }
        let (mut dance, _) = Dance::open(project, &access, FPS, self.progress)?;
        let frame = frame.min(dance.frames().saturating_sub(1));
        dance.begin(frame, dance.secs_of(frame), self.progress)?;
        let snapshot = dance.snapshot(frame)?;
        Ok(Moment { hair: Hair::new(snapshot, project), frame })
    }

    /// Draws a moment with the settings of `project`, and puts the image into the figure together with the project.
    pub(super) fn draw(
        &mut self,
        name: &str,
        caption: impl Into<String>,
        project: &Project,
        moment: &Moment,
    ) -> Result<Drawn, ProjectError> {
        report_progress(self.progress, Progress::Loading { what: format!("{}: {name}", self.figure) })?;
        let drawn = self.drawn(project, moment)?;
        let name = format!("{}-{name}", self.figure);
        let (width, height) = self.request.size;
        let mut saved = project.clone();
        (saved.recording.width, saved.recording.height, saved.recording.fps) = (width, height, FPS);
        saved.recording.first_frame = moment.frame;
        self.images.push(Drawing {
            name,
            caption: caption.into(),
            picture: drawn.picture.clone(),
            project: saved,
        });
        Ok(drawn)
    }

    /// Draws a moment without putting it into the figure.
    pub(super) fn drawn(&mut self, project: &Project, moment: &Moment) -> Result<Drawn, ProjectError> {
        let snapshot: &Arc<FrameSnapshot> = &moment.hair.snapshot;
        let camera = snapshot.camera(&project.camera);
        let mut picture = Picture::default();
        let (width, height) = self.request.size;
        let stats =
            self.renderer.picture(&snapshot.measured_input(project, &camera), width, height, &mut picture)?;
        Ok(Drawn { picture, stats })
    }

    /// Median milliseconds of an image in which nothing is reused: strands, shadow and drawing.
    pub(super) fn image_ms(&mut self, project: &Project, moment: &Moment) -> Result<[f64; 3], ProjectError> {
        self.renderer.set_keeping(false);
        let mut times: [Vec<f64>; 3] = Default::default();
        let mut result = Ok(());
        // The first image creates buffers.
        for frame in 0..=self.request.frames.max(1) {
            let going =
                report_progress(self.progress, Progress::Loading { what: format!("{}: times", self.figure) });
            let drawn = match going.and_then(|()| self.drawn(project, moment)) {
                Ok(drawn) => drawn,
                Err(error) => {
                    result = Err(error);
                    break;
                }
            };
            if frame > 0 {
                let stats = drawn.stats;
                for (all, ms) in times.iter_mut().zip([stats.interpolate_ms, stats.shadow_ms, stats.draw_ms])
                {
                    all.push(ms);
                }
            }
        }
        self.renderer.set_keeping(true);
        result.map(|()| times.map(|times| median(times).unwrap_or(0.0)))
    }

    /// The transmittance that a method computes at every strand point, in the first light of the project.
    pub(super) fn measure(
        &mut self,
        project: &Project,
        settings: &ShadowSettings,
        moment: &Moment,
    ) -> Result<Measured, ProjectError> {
        let what = format!("{}: {}", self.figure, settings.method);
        report_progress(self.progress, Progress::Loading { what })?;
        let map = built(project, settings, moment)?;
        let strands = &moment.hair.strands;
        let mut transmittance = vec![1.0; strands.points()];
        map.transmittance_at(&strands.x, &strands.y, &strands.z, &mut transmittance);
        Ok(Measured { transmittance, report: map.report() })
    }

    /// The truth for [`Studio::measure`]: the exact method on the finest map that the strands allow.
    pub(super) fn truth(&mut self, project: &Project, moment: &Moment) -> Result<Measured, ProjectError> {
        self.measure(project, &exact(project), moment)
    }

    /// The fragments (depth, metres, and optical depth) along the light through every 197th strand point, nearest to the light first. The
    /// ray with most fragments is first.
    pub(super) fn rays(
        &mut self,
        project: &Project,
        moment: &Moment,
    ) -> Result<Vec<Vec<(f32, f32)>>, ProjectError> {
        report_progress(self.progress, Progress::Loading { what: format!("{}: rays", self.figure) })?;
        let map = built(project, &exact(project), moment)?;
        let strands = &moment.hair.strands;
        let points = (0..strands.points()).step_by(197);
        let fragment = |mark: &RayMark| (mark.start, mark.optical_depth);
        let mut rays: Vec<Vec<_>> =
            points.map(|at| map.along_ray(strands.point(at)).marks.iter().map(fragment).collect()).collect();
        rays.sort_by_key(|ray| std::cmp::Reverse(ray.len()));
        Ok(rays)
    }

    /// Puts curves into the figure; the first is the truth.
    pub(super) fn plot(&mut self, caption: impl Into<String>, axes: [&str; 2], curves: Vec<CurveReport>) {
        let axes = axes.map(str::to_owned);
        self.report.plots.push(PlotReport { caption: caption.into(), axes, curves });
    }

    /// Puts a table into the figure.
    pub(super) fn table(&mut self, caption: impl Into<String>, heads: &[&str], rows: Vec<Vec<String>>) {
        let heads = heads.iter().map(|head| (*head).to_owned()).collect();
        self.report.tables.push(TableReport { caption: caption.into(), heads, rows });
    }

    /// Puts a claim into the figure that must hold.
    pub(super) fn check(&mut self, claim: impl Into<String>, found: impl Into<String>, holds: bool) {
        self.report.checks.push(CheckReport { claim: claim.into(), found: found.into(), holds });
    }
}

/// The exact method with the finest map that strands allow.
fn exact(project: &Project) -> ShadowSettings {
    let mut settings = ShadowSettings { method: ShadowMethod::Exact, ..project.shadow };
    settings.exact.resolution = *lovelock_shadow::TEXEL_RESOLUTIONS.end();
    settings.exact.filter = lovelock_shadow::TexelFilter::Nearest;
    settings
}

/// The map of the first light.
fn built(
    project: &Project,
    settings: &ShadowSettings,
    moment: &Moment,
) -> Result<Box<dyn CpuShadow + Send + Sync>, ProjectError> {
    let lights = lights(project);
    let light = lights.first().ok_or_else(|| ProjectError::work("no light of the figure is switched on"))?;
    let input: ShadowInput = moment.hair.shadow_input(project, light);
    let mut map = cpu_shadow(settings.method);
    map.build(&input, settings).map_err(ProjectError::work)?;
    Ok(map)
}

/// Mean of the grey values of an image, 0 to 255.
pub(super) fn brightness(picture: &Picture) -> f64 {
    let sum: u64 = picture
        .rgba
        .as_chunks::<4>()
        .0
        .iter()
        .map(|[r, g, b, _]| u64::from(*r) + u64::from(*g) + u64::from(*b))
        .sum();
    sum as f64 / (3.0 * f64::from(picture.width.max(1)) * f64::from(picture.height.max(1)))
}

/// Mean FLIP of two images of one size.
pub(super) fn flip(reference: &Picture, test: &Picture) -> Result<f64, ProjectError> {
    let of = |picture: &'_ Picture| (picture.width, picture.height);
    let (width, height) = of(reference);
    let image = Image::new(width, height, &reference.rgba);
    let other = Image::new(width, height, &test.rgba);
    let map = image.and_then(|image| lovelock_metrics::flip(&image, &other?)).map_err(ProjectError::work)?;
    Ok(map.mean())
}
