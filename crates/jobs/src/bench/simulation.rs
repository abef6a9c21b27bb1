//! Measures the simulation alone, by every method with rigid links.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_base::clock::Stopwatch;
use lovelock_groom::{GuideFrame, Guides, Hairstyle, MotionFactors, StrandSet, Strands, Wisp, interpolate};
use lovelock_project::Project;
use lovelock_render::Backend;
use lovelock_session::clock::STEP_SECS;
use lovelock_session::engine::Engine;
use lovelock_session::health::{Gauge, health};
use lovelock_session::scene::Scene;
use lovelock_simulation::{Integrator, SimulationSettings};

use super::BenchRequest;
use super::published::ANIMATION;
use super::report::{SceneReport, StageReport};
use super::scenes::BenchScene;

/// The step after which measuring starts, when the hair is in full motion.
const FIRST_STEP: u64 = 320;

/// Number of uncounted steps of each method before measuring.
const WARM_UP: u64 = 10;

/// Results of one method.
struct Measured {
    method: Integrator,
    /// Times of the steps, milliseconds.
    times: Vec<f64>,
    /// The largest stretch of a link.
    stretch: f32,
    /// Times of interpolating the strands after each step, milliseconds; empty where every strand is simulated.
    strands: Vec<f64>,
    /// Smallest and largest number of substeps per step.
    substeps: [u32; 2],
    /// Whether a graphics device did the steps.
    on_device: bool,
}

/// The stable name of a method.
const fn id(method: Integrator) -> &'static str {
    match method {
        Integrator::Direct => "direct",
        Integrator::Relaxation => "relaxation",
        Integrator::FollowTheLeader => "follow-the-leader",
    }
}

/// Measures the same steps of the motion by each method. All start from the same hair, simulated up to there by the default method.
/// A step is 1/60 s. Also returns a sentence about the results of the methods.
pub(super) fn measure(
    scene: BenchScene,
    project: &Project,
    loaded: &Arc<Scene>,
    request: &BenchRequest,
) -> (SceneReport, String) {
    super::memory::reset_peak_memory();
    let loaded = if scene.simulates_strands() {
        let style = Arc::new(strands_as_guides(&loaded.style));
        Arc::new(Scene { style, ..Scene::clone(loaded) })
    } else {
        Arc::clone(loaded)
    };
    let mut start = Engine::at_rest(Arc::clone(&loaded), project.simulation, STEP_SECS);
    start.follow(project);
    start.seek(FIRST_STEP as f64 * STEP_SECS);
    start.settle();
    let mut gauges = Vec::new();
    let mut strands = Strands::default();
    // The first time allocates.
    interpolate(&loaded.style, &start.snapshot().guides, &mut strands);
    let mut refused = None;
    let measured: Vec<_> = scene
        .integrators()
        .iter()
        .map(|&method| {
            let mut engine = start.copy();
            engine.set_settings(&SimulationSettings { integrator: method, ..project.simulation });
            engine.advance_to_step(FIRST_STEP + WARM_UP);
            engine.clear_totals();
            engine.take_simulate_ms();
            let (mut times, mut drawn, mut substeps) = (Vec::new(), Vec::new(), [u32::MAX, 0]);
            for _ in 0..request.frames.max(1) {
                engine.step();
                let (simulate_ms, taken) = engine.take_simulate_ms();
                times.push(simulate_ms);
                substeps = [substeps[0].min(taken), substeps[1].max(taken)];
                if !scene.simulates_strands() {
                    let snapshot = engine.snapshot();
                    let watch = Stopwatch::start();
                    interpolate(&loaded.style, &snapshot.guides, &mut strands);
                    drawn.push(watch.ms());
                }
            }
            if method == Integrator::Direct {
                gauges = health(&engine.totals(), engine.rest_inside(), &loaded, &project.simulation);
            }
            let (on_device, refusal) = engine.simulated_on_device();
            refused = refused.take().or_else(|| refusal.cloned());
            let stretch = engine.totals().max_stretch;
            Measured { method, times, stretch, strands: drawn, substeps, on_device }
        })
        .collect();
    let stretch = |of: &Measured| format!("{:.2e} ({})", of.stretch, id(of.method));
    let [least, most] = measured
        .iter()
        .fold([u32::MAX, 0], |[least, most], of| [least.min(of.substeps[0]), most.max(of.substeps[1])]);
    let refused = refused.map_or_else(String::new, |reason| format!(" ({reason})"));
    let note = format!(
        "{scene}{refused}: a step is {:.1} ms of {least} to {most} substeps; the largest stretch of a link is {}",
        STEP_SECS * 1e3,
        measured.iter().map(stretch).collect::<Vec<_>>().join(", ")
    );
    let on_device = measured.iter().any(|of| of.on_device);
    let backend = if on_device { Backend::Gpu } else { Backend::Cpu };
    (SceneReport::of_simulation(scene, backend, &loaded.style.guides, gauges, &measured), note)
}

impl SceneReport {
    /// The report of a scene without rendering.
    fn of_simulation(
        scene: BenchScene,
        backend: Backend,
        guides: &Guides,
        health: Vec<Gauge>,
        measured: &[Measured],
    ) -> Self {
        let row = |name: &str, times: &[f64]| StageReport::new(name, scene.published(name), times);
        let mut stages: Vec<_> =
            measured.iter().map(|of| row(&format!("simulate/{}", id(of.method)), &of.times)).collect();
        // The published animation is by relaxation, and includes the strands.
        let published = measured.iter().find(|of| of.method == Integrator::Relaxation);
        if let Some(of) = published.filter(|of| !of.strands.is_empty()) {
            let both: Vec<f64> =
                of.times.iter().zip(&of.strands).map(|(step, strands)| step + strands).collect();
            stages.push(row("interpolate", &of.strands));
            stages.push(row(&format!("{ANIMATION}/{}", id(of.method)), &both));
        }
        Self {
            scene: scene.id().to_owned(),
            backend: backend.to_string(),
            adapter: "simulation".to_owned(),
            threads: rayon::current_num_threads() as u64,
            shadow: String::new(),
            draw: String::new(),
            transparency: String::new(),
            width: 0,
            height: 0,
            strands: guides.count() as u64,
            points: guides.x.len() as u64,
            segments: (guides.x.len() - guides.count()) as u64,
            frames: measured.first().map_or(0, |of| of.times.len()) as u64,
            stages,
            pictures_per_second: 0.0,
            frames_per_second: 0.0,
            published_note: scene.published_note(),
            health,
            shadow_bytes: 0,
            draw_bytes: 0,
            peak_memory_bytes: super::memory::peak_memory_bytes(),
        }
    }

    /// Whether the scene is not rendered.
    pub(super) fn is_simulated_alone(&self) -> bool {
        self.width == 0
    }

    /// Whether a stage of a scene without rendering ran on the CPU. `animation` contains the simulation.
    pub(super) fn is_on_cpu(&self, stage: &str) -> bool {
        self.backend == Backend::Cpu.id() || !["simulate", ANIMATION].iter().any(|of| stage.starts_with(of))
    }

    /// One line about the measurement.
    pub(super) fn heading(&self) -> String {
        let Self { scene, strands, segments, width, height, shadow, draw, transparency, frames, .. } = self;
        if self.is_simulated_alone() {
            return format!(
                "{scene}: {strands} guides, {segments} links; medians of {frames} steps, milliseconds"
            );
        }
        let draw = if draw == "strands" { String::new() } else { format!(", drawn as {draw}") };
        format!(
            "{scene}: {strands} strands, {segments} segments{draw}, {width}x{height}, {shadow}, {transparency}; medians of {frames} \
             frames, milliseconds"
        )
    }
}

/// The hairstyle with one guide along each of its strands.
fn strands_as_guides(style: &Hairstyle) -> Hairstyle {
    let at_rest =
        GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides: style.guides.clone() };
    let mut strands = Strands::default();
    interpolate(style, &at_rest, &mut strands);
    let points = style.guides.points_per_guide;
    let whole = |g: usize| strands.first_point[g + 1] as usize - strands.first_point[g] as usize == points;
    let mut guides = Guides { points_per_guide: points, ..Guides::default() };
    for g in (0..strands.count()).filter(|&g| whole(g)) {
        let run: Vec<_> = (0..points).map(|p| strands.point(strands.first_point[g] as usize + p)).collect();
        guides.push(&run);
    }
    // Groups of three; one or two left over would belong to no wisp.
    let wisps = guides.count() / 3;
    for axis in [&mut guides.x, &mut guides.y, &mut guides.z] {
        axis.truncate(3 * wisps * points);
    }
    let first = |w: usize| 3 * w as u32;
    let of = 3 * wisps;
    Hairstyle {
        wisps: (0..wisps)
            .map(|w| Wisp {
                guides: [first(w), first(w) + 1, first(w) + 2],
                first_strand: first(w),
                strand_count: 3,
            })
            .collect(),
        strands: StrandSet {
            wisp: (0..of as u32).map(|g| g / 3).collect(),
            weights: (0..of).map(|g| std::array::from_fn(|k| if k == g % 3 { 1.0 } else { 0.0 })).collect(),
            first_point: (0..=of).map(|g| (g * points) as u32).collect(),
            guide_param: (0..of).flat_map(|_| (0..points).map(|p| p as f32)).collect(),
            offset_normal: vec![0.0; of * points],
            offset_binormal: vec![0.0; of * points],
            offset_tangent: vec![0.0; of * points],
            taper: vec![1.0; of * points],
            shade: vec![0.5; of],
            ..StrandSet::default()
        },
        guides,
        held: Vec::new(),
        ropes: Vec::new(),
        widest: Vec::new(),
        motion: MotionFactors::default(),
        ..style.clone()
    }
}

#[cfg(test)]
mod tests {
    use lovelock_project::error::ProjectError;
    use lovelock_render::Gpu;

    use super::*;

    #[test]
    fn each_strand_becomes_a_guide_that_runs_as_it_did() {
        let mut project = BenchScene::Simulate20k.project();
        (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (12, 7);
        let style = super::super::load(&project).expect("a scene").style.clone();
        let own = strands_as_guides(&style);
        own.check().expect("whole");
        assert_eq!((own.guides.count(), own.strands.count(), own.wisps.len()), (84, 84, 28));
        let strands = |style: &Hairstyle| {
            let guides = style.guides.clone();
            let frame = GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides };
            let mut strands = Strands::default();
            interpolate(style, &frame, &mut strands);
            strands
        };
        let (before, after) = (strands(&style), strands(&own));
        let apart =
            (0..before.points()).map(|i| before.point(i).distance(after.point(i))).fold(0.0, f32::max);
        assert!(before.points() == after.points() && apart < 1e-6, "{apart} m");
    }

    #[test]
    fn every_method_is_measured_on_the_same_steps() {
        let mut project = BenchScene::Simulate402.project();
        project.hair.groom.wisps = 12;
        let loaded = super::super::load(&project).expect("a scene");
        let request = BenchRequest { frames: 3, ..BenchRequest::default() };
        let (report, note) = measure(BenchScene::Simulate402, &project, &loaded, &request);
        let names: Vec<_> = report.stages.iter().map(|stage| stage.name.as_str()).collect();
        let methods = ["simulate/direct", "simulate/relaxation", "simulate/follow-the-leader"];
        assert_eq!(names[..3], methods);
        assert_eq!(names[3..], ["interpolate", "animation/relaxation"]);
        assert!(report.stages.iter().all(|stage| stage.min_ms > 0.0 && stage.max_ms >= stage.median_ms));
        assert_eq!((report.strands, report.segments, report.frames), (36, 36 * 30, 3));
        // The published animation includes the strands.
        assert_eq!((report.stages[1].published_ms, report.stages[4].published_ms), (None, Some(70.0)));
        assert!(report.stages[4].min_ms >= report.stages[1].min_ms + report.stages[3].min_ms);
        assert!(!report.health.is_empty() && note.contains("(relaxation)"), "{note}");
        assert_eq!(report.backend, "cpu");
        // Multiples are those of the CPU.
        let on_cpu = |report: &SceneReport| names.iter().filter(|name| report.is_on_cpu(name)).count();
        let on_card = SceneReport { backend: "gpu".to_owned(), ..report.clone() };
        assert_eq!([on_cpu(&report), on_cpu(&on_card)], [5, 1]);
        assert!(on_card.is_on_cpu("interpolate"));
    }

    #[test]
    fn the_report_says_what_simulated_long_suite() {
        if let Err(error) = Gpu::open() {
            return lovelock_testkit::skip_without_adapter(&error);
        }
        let mut project = BenchScene::Simulate402.project();
        project.hair.groom.wisps = 8;
        project.timeline.preroll_secs = 0.1;
        project.picture.simulate = Backend::Gpu;
        let loaded = super::super::load(&project).expect("a scene");
        let request = BenchRequest { frames: 1, ..BenchRequest::default() };
        let (report, note) = measure(BenchScene::Simulate402, &project, &loaded, &request);
        assert_eq!(report.backend, "gpu", "{note}");
    }

    #[test]
    fn the_option_chooses_what_simulates_before_the_setting() {
        let set = |project: &mut Project| {
            project.picture.simulate = Backend::Gpu;
            Ok(())
        };
        let chosen = |simulate, change: &dyn Fn(&mut Project) -> Result<(), ProjectError>| {
            let request = BenchRequest { simulate, ..BenchRequest::default() };
            let project = super::super::changed(BenchScene::Simulate402, &request, change);
            project.expect("a project").picture.simulate
        };
        assert_eq!(chosen(None, &|_| Ok(())), Backend::Cpu);
        assert_eq!(chosen(None, &set), Backend::Gpu);
        assert_eq!(chosen(Some(Backend::Auto), &set), Backend::Auto);
    }
}
