//! The parts of a comparison, in order.

use std::ops::ControlFlow;
use std::sync::Arc;

use lovelock_metrics::pareto;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{Light, Renderer, ShadowMethod, ShadowSettings, ValueRenderer};
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_shadow::CONVERGED_CHANGE;

use super::entrants::Entrant;
use super::folder::Folder;
use super::hair::{Hair, LitHair};
use super::light_sweep::LightSweep;
use super::pictures::ReferencePictures;
use super::probe::Probe;
use super::request::CompareRequest;
use super::sequence::Played;
use super::stability::{Film, fits};
use super::steps::{Step, Steps};
use super::swim::frames_shifted;
use super::truth::{Points, Truths};
use super::{maps, probe};
use crate::budget::{beaten, winners};
use crate::report::{CompareReport, MethodReport};

/// Called regularly; returns an error if the work is cancelled.
pub(super) type CheckCancel<'a> = dyn FnMut() -> Result<(), ProjectError> + 'a;

/// Inputs of all parts of the work.
pub(super) struct Work<'a> {
    pub project: &'a Project,
    pub request: &'a CompareRequest,
    pub folder: &'a Folder,
    pub size: [u32; 2],
    /// The enabled lights; at least one.
    pub lights: Vec<Light>,
}

/// The references that an entrant is compared with.
pub(super) struct References<'a> {
    pub hair: &'a Hair,
    pub truths: &'a Truths,
    /// Index of the one that is common to all.
    pub common: usize,
    pub points: Option<&'a Points>,
    pub pictures: &'a ReferencePictures,
    pub film: Option<&'a Film>,
    /// The frames in which maps are shifted.
    pub shifted: &'a [Arc<FrameSnapshot>],
    pub light_sweep: Option<&'a LightSweep>,
    /// One value per pixel, finite where it shows hair.
    pub hair_pixels: &'a [f32],
}

impl Work<'_> {
    /// Runs all parts. Finished results are in the report and its folder.
    ///
    /// # Errors
    /// [`ProjectError::Cancelled`], or if a file cannot be written.
    pub(super) fn run(
        &self,
        snapshots: &[Arc<FrameSnapshot>],
        entrants: Vec<Entrant>,
        renderers: &mut [Renderer],
        report: &mut CompareReport,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), ProjectError> {
        let mut steps = Steps::new(self.steps(snapshots.len(), entrants.len()));
        let mut part = |what: String, begins: bool| {
            if begins {
                steps.begin();
            }
            let ([done, total], left_secs) = (steps.count(), steps.left_secs());
            report_progress(progress, Progress::Comparing { what, done, total, left_secs })
        };
        let Some(first) = snapshots.first() else { return Ok(()) };
        let hair = Hair::new(Arc::clone(first), self.project);
        let lit = LitHair { hair: &hair, project: self.project, light: &self.lights[0] };
        let mut truths = Truths::default();
        let mut found = Vec::new();
        for entrant in &entrants {
            part(format!("ground truth for {}", entrant.report.name), true)?;
            found.push(truths.find(lit, &entrant.contender.shadow, Some(&entrant.report.name)));
        }
        part("ground truth at points".to_owned(), true)?;
        let points = match Points::new(lit) {
            Ok(points) => Some(points),
            Err(error) => {
                report.reference.refused.push(format!("the truth at points: {error}"));
                None
            }
        };
        part("reference images".to_owned(), true)?;
        let shadow = ShadowSettings { method: ShadowMethod::Exact, ..self.project.shadow };
        let (common, _) = truths.find(lit, &shadow, None);
        let pictures = self.reference(&hair, &truths.0[common], renderers, report)?;
        note_truths(report, &truths, points.as_ref());
        let film = self.film(snapshots, &truths, report, &mut part)?;
        let shifted = if self.request.quick { Vec::new() } else { frames_shifted(snapshots.len()) };
        report.swim_frames = shifted.iter().map(|at| report.frames[0] + *at as u64).collect();
        let shifted: Vec<_> = shifted.iter().map(|at| Arc::clone(&snapshots[*at])).collect();
        let light_sweep = if self.request.quick {
            None
        } else {
            let turning = || "ground truth under a turning light".to_owned();
            part(turning(), true)?;
            let check_cancel = || part(turning(), false);
            let light_sweep = LightSweep::new(lit, &truths.0, &mut report.reference, check_cancel)?;
            light_sweep.map_err(|refused| report.notes.push(refused)).ok()
        };

        let mut values = ValueRenderer::default();
        let input = hair.frame_input(self.project);
        let known = truths.0.iter().find_map(|truth| truth.transmittance.as_ref().ok());
        let known = known.or(points.as_ref().map(|points| &points.transmittance));
        let lit = vec![1.0; hair.strands.points()];
        let numbers = known.unwrap_or(&lit);
        let hair_pixels = maps::at_pixels(&mut values, &input, numbers, self.size)?;
        report.reference.gpu_from_cpu = pictures.gpu_from_cpu(&hair_pixels).map_err(ProjectError::work)?;
        part("probes".to_owned(), true)?;
        let mut probes = self.probes(&mut values, &hair, &hair_pixels, points.as_ref(), report);
        report.reference.settle();

        let references = References {
            hair: &hair,
            truths: &truths,
            common,
            points: points.as_ref(),
            pictures: &pictures,
            film: film.as_ref(),
            shifted: &shifted,
            light_sweep: light_sweep.as_ref(),
            hair_pixels: &hair_pixels,
        };
        report.legends = maps::kinds(film.is_some()).map(|kind| kind.legend()).collect();
        let mut played = Vec::new();
        for (entrant, (truth, cell_size)) in entrants.into_iter().zip(found) {
            let name = entrant.report.name.clone();
            part(name.clone(), true)?;
            let backend = entrant.contender.backend;
            let Some(renderer) = renderers.iter_mut().find(|open| open.backend() == backend) else {
                continue;
            };
            let mut entrant = entrant;
            renderer.adapter().clone_into(&mut entrant.report.adapter);
            entrant.report.cell_size_m = cell_size;
            entrant.report.cells_total = cell_size.and(truths.0[truth].cells());
            let tools = (&mut *renderer, &mut values, &mut probes[..]);
            let result = self.measure(&mut entrant, &references, (truth, cell_size), tools, &mut || {
                part(name.clone(), false)
            });
            match result {
                Ok(()) => {}
                // An entrant that does not fit into memory is only noted; a full disk ends the run.
                Err(ProjectError::Work { file: None, message }) => entrant.report.refused = Some(message),
                Err(error) => return Err(error),
            }
            if !entrant.report.frame_errors.is_empty() {
                played.push(Played { at: report.methods.len(), contender: entrant.contender, truth });
            }
            report.methods.push(entrant.report);
            mark_fronts(report);
            report.probes = probes.iter().map(|probe| probe.report.clone()).collect();
            self.folder.report(report)?;
        }
        if let Some(film) = film.as_ref().filter(|_| self.request.film) {
            let name = || "films of all methods".to_owned();
            part(name(), true)?;
            self.films(film, &played, renderers, report, &mut || part(name(), false))?;
        }
        Ok(())
    }

    /// The steps of the run, in order.
    fn steps(&self, frames: usize, entrants: usize) -> Vec<Step> {
        let mut steps = vec![Step::Truth; entrants];
        steps.extend([Step::Points, Step::Picture]);
        steps.extend((frames > 1).then_some(Step::Film));
        steps.extend((!self.request.quick).then_some(Step::LightSweep));
        steps.push(Step::Probes);
        steps.extend(vec![Step::Entrant; entrants]);
        steps.extend((frames > 1 && self.request.film).then_some(Step::Sequence));
        steps
    }

    /// The probed rays. A pixel without hair is skipped.
    fn probes(
        &self,
        values: &mut ValueRenderer,
        hair: &Hair,
        hair_pixels: &[f32],
        points: Option<&Points>,
        report: &mut CompareReport,
    ) -> Vec<Probe> {
        let usual;
        let pixels = if self.request.probes.is_empty() {
            usual = probe::default_pixels(hair_pixels, self.size[0]);
            &usual
        } else {
            &self.request.probes
        };
        let mut probes = Vec::new();
        for &pixel in pixels {
            let (input, light) = (hair.frame_input(self.project), &self.lights[0]);
            let shadow_input = hair.shadow_input(self.project, light);
            match Probe::new(values, &input, self.size, pixel, shadow_input.light, points) {
                Some(mut probe) => {
                    // If the exact map does not fit, the finer one would take minutes.
                    if points.is_some() {
                        let reference = &mut report.reference;
                        match probe.find_reference(&shadow_input, &self.project.shadow) {
                            Ok(facts) => reference.probes.push(facts),
                            Err(error) => {
                                reference.refused.push(format!("the truth of the {}: {error}", probe.name()));
                            }
                        }
                    }
                    probes.push(probe);
                }
                None => report.notes.push(format!("the probe at {},{} meets no hair", pixel[0], pixel[1])),
            }
        }
        probes
    }

    /// The frames for pop and flicker; `None` for a single frame.
    fn film(
        &self,
        snapshots: &[Arc<FrameSnapshot>],
        truths: &Truths,
        report: &mut CompareReport,
        part: &mut dyn FnMut(String, bool) -> Result<(), ProjectError>,
    ) -> Result<Option<Film>, ProjectError> {
        if snapshots.len() < 2 {
            return Ok(None);
        }
        let by_frame = || "ground truth of every frame".to_owned();
        part(by_frame(), true)?;
        let points = report.scene.points as usize;
        if let Err(refused) = fits("pop and flicker", snapshots.len() as u64, points, truths.0.len()) {
            report.notes.push(refused);
            return Ok(None);
        }
        let check_cancel = || part(by_frame(), false);
        let frames = (report.frames[0], snapshots);
        Film::new(frames, self.project, &self.lights[0], &truths.0, &mut report.reference, check_cancel)
            .map(Some)
    }
}

/// Records the facts of the ground truths in the report.
fn note_truths(report: &mut CompareReport, truths: &Truths, points: Option<&Points>) {
    let reference = &mut report.reference;
    reference.limit = CONVERGED_CHANGE;
    for truth in &truths.0 {
        match &truth.transmittance {
            Ok(_) => reference.footprints.push(truth.facts.clone()),
            Err(error) => {
                let of = truth.facts.methods.join(", ");
                let of = if of.is_empty() { "exact" } else { &of };
                reference.refused.push(format!("the truth for the texels of {of}: {error}"));
            }
        }
    }
    reference.settle();
    reference.points = points.map(|points| points.facts.clone());
}

/// Marks the methods on the front of error and cost among those with the same backend, drawing and transparency.
fn mark_fronts(report: &mut CompareReport) {
    let methods = &mut report.methods;
    let error = |method: &MethodReport| method.front_error().unwrap_or(f64::NAN);
    let time = |method: &MethodReport| {
        let stages = method.ms.and_then(|ms| Some(ms.build? + ms.query?));
        stages.unwrap_or(f64::NAN)
    };
    let memory = |method: &MethodReport| method.memory_bytes.map_or(f64::NAN, |bytes| bytes as f64);
    let mut fronts = vec![[false; 2]; methods.len()];
    for (at, method) in methods.iter().enumerate() {
        let key = |method: &MethodReport| {
            (method.backend.clone(), method.draw.clone(), method.transparency.clone())
        };
        let same: Vec<usize> = (0..methods.len()).filter(|&i| key(&methods[i]) == key(method)).collect();
        // Handle each group once, at its first member.
        if same.first() != Some(&at) {
            continue;
        }
        let points = |cost: &dyn Fn(&MethodReport) -> f64| -> Vec<(f64, f64)> {
            same.iter().map(|&i| (cost(&methods[i]), error(&methods[i]))).collect()
        };
        let of_time = pareto(&points(&time));
        let of_memory = pareto(&points(&memory));
        for (k, &i) in same.iter().enumerate() {
            fronts[i] = [of_time[k], of_memory[k]];
        }
    }
    for (method, [of_time, of_memory]) in methods.iter_mut().zip(fronts) {
        (method.front_of_time, method.front_of_memory) = (of_time, of_memory);
    }
    (report.budgets, report.beaten) = (winners(report), beaten(report));
}
