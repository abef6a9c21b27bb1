//! The thread: takes the newest request when it is free, simulates and renders its variants side by side.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::variants::adopt;
use lovelock_render::Image;
use rayon::prelude::*;

use super::cell::{Cell, lighten};
use super::{Wall, WallCell, WallRequest};
use crate::latest::{Job, Latest, LatestJob};
use crate::memory::Held;
use crate::scene::{Scene, SceneLoader};
use crate::threads::{background_workers, lower_priority};
use crate::window_device::WindowDevice;

/// What the thread publishes.
type Outputs = ([Latest<WallCell>; Wall::CELLS], Latest<f64>);

pub(super) struct Worker {
    jobs: LatestJob<WallRequest>,
    outputs: Outputs,
    on_drawn: Box<dyn Fn() + Send>,
    window: WindowDevice,
    loader: SceneLoader,
    cells: Vec<Cell>,
    /// The project without hair whose scene the cells have.
    loaded: Option<Arc<Project>>,
    instant: Instant,
    held: Held,
}

/// The instant that the cells show. While time passes, it follows that of the requests by at most [`Instant::MAX_SECS`] a round, so that where
/// rounds take longer the hair moves slowly instead of jumping.
#[derive(Default)]
pub(super) struct Instant {
    shown_secs: f64,
    /// The time of the last request, and since when it was.
    last: Option<(f64, Stopwatch)>,
}

impl Instant {
    /// The most that a round simulates, seconds.
    const MAX_SECS: f64 = 4.0 / 30.0;
    /// A request that is further ahead of the last one than the clock is a jump, seconds.
    const JUMP_SECS: f64 = 0.5;

    /// The instant of the next round.
    pub(super) fn next(&mut self, request: &WallRequest) -> f64 {
        let wanted = request.time_secs;
        let passed = self.last.take().map(|(secs, watch)| (wanted - secs, watch.secs()));
        self.last = Some((wanted, Stopwatch::start()));
        self.shown_secs = match passed {
            Some((by, clock)) if request.playing && (0.0..clock + Self::JUMP_SECS).contains(&by) => {
                (self.shown_secs + by.min(Self::MAX_SECS)).min(wanted)
            }
            _ => wanted,
        };
        self.shown_secs
    }
}

impl Worker {
    pub(super) fn new(
        (jobs, outputs, held): (LatestJob<WallRequest>, Outputs, Held),
        on_drawn: Box<dyn Fn() + Send>,
        window: WindowDevice,
    ) -> Self {
        Self {
            jobs,
            outputs,
            on_drawn,
            window,
            loader: SceneLoader::new(),
            cells: Vec::new(),
            loaded: None,
            instant: Instant::default(),
            held,
        }
    }

    /// Runs until the window is closed, on background workers of low priority, so that the window keeps running. The workers end with
    /// what is kept, when the page is left: their memory as well.
    pub(super) fn run(mut self) {
        lower_priority();
        let mut workers = None;
        while let Some(job) = self.jobs.next() {
            let Job::Do(request) = job else {
                workers = None;
                self.forget();
                self.outputs.0.iter().for_each(Latest::clear);
                self.held.set(0);
                self.jobs.done(None);
                (self.on_drawn)();
                continue;
            };
            let workers = workers.get_or_insert_with(|| background_workers("wall"));
            // A panic costs the simulations and one round, but not the window.
            let drawn = catch_unwind(AssertUnwindSafe(|| match workers {
                Some(workers) => workers.install(|| self.round(&request)),
                None => self.round(&request),
            }));
            if drawn.is_err() {
                tracing::error!("the wall failed and was restarted");
                self.forget();
            }
            self.held.set(self.cells.iter().map(Cell::bytes).sum());
            self.jobs.done(None);
            (self.on_drawn)();
        }
    }

    /// Drops simulations, renderers and scenes.
    fn forget(&mut self) {
        (self.cells, self.loaded) = (Vec::new(), None);
        (self.loader, self.instant) = (SceneLoader::new(), Instant::default());
    }

    fn round(&mut self, request: &WallRequest) {
        let watch = Stopwatch::start();
        self.load(request);
        let shown = request.variants.len().min(Wall::CELLS);
        self.cells.truncate(shown);
        let time_secs = self.instant.next(request);
        let (jobs, window) = (&self.jobs, &self.window);
        // A small image or simulation divides its own work only coarsely, so several run beside each other.
        self.cells.par_iter_mut().zip(&self.outputs.0).for_each(|(cell, slot)| {
            if !jobs.is_dropped() {
                cell.advance(request, time_secs);
                slot.put(Arc::new(cell.draw(request, window)));
            }
        });
        self.outputs.1.put(Arc::new(watch.ms()));
    }

    /// Loads the scenes of variants that are new, and of all if the body or the motion has changed.
    fn load(&mut self, request: &WallRequest) {
        let same_scene = self.loaded.as_ref().is_some_and(|loaded| {
            Arc::ptr_eq(loaded, &request.project)
                || (loaded.body == request.project.body
                    && loaded.motion == request.project.motion
                    && loaded.surroundings == request.project.surroundings)
        });
        self.loaded = Some(Arc::clone(&request.project));
        for (index, variant) in request.variants.iter().take(Wall::CELLS).enumerate() {
            let cell = self.cells.get_mut(index);
            let is_current = |cell: &&mut Cell| same_scene && Arc::ptr_eq(cell.variant(), variant);
            if cell.as_ref().is_some_and(is_current) {
                continue;
            }
            let mut project = (*request.project).clone();
            adopt(&mut project, variant);
            lighten(&mut project);
            match self.loader.load_now(&project, &request.access) {
                Ok((scene, _)) => self.take(index, variant, scene),
                Err(error) => {
                    let problem = Some(error.to_string());
                    let (variant, image) = (Arc::clone(variant), Image::default());
                    let failed = WallCell { variant, image, time_secs: request.time_secs, problem };
                    if let Some(slot) = self.outputs.0.get(index) {
                        slot.put(Arc::new(failed));
                    }
                    // Cells stand in the order of variants, so nothing may be left out before the next one.
                    self.cells.truncate(index);
                    return;
                }
            }
            if self.jobs.is_dropped() {
                return;
            }
        }
    }

    fn take(&mut self, index: usize, variant: &Arc<Project>, scene: Arc<Scene>) {
        match self.cells.get_mut(index) {
            Some(cell) => cell.set(Arc::clone(variant), scene),
            None => self.cells.push(Cell::new(Arc::clone(variant), scene)),
        }
    }
}
