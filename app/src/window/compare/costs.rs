//! The rendering times of the panes over the last seconds, and their history under other settings.

use std::collections::VecDeque;
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_base::statistics::median;
use lovelock_panes::request::{LiveError, LivePane, LiveTimes};
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::{Backend, HairDrawing, ShadowMethod, Transparency};
use lovelock_session::render_thread::Adapter;

/// Seconds that are plotted.
pub(super) const PLOTTED_SECS: f64 = 12.0;
/// Numbers of images per variant and of variants that are kept.
const MAX_SAMPLES: usize = 720;
const MAX_WAYS: usize = 60;

/// Times of one image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Seconds since the window was opened.
    pub(super) at_secs: f64,
    pub(super) times: LiveTimes,
}

/// One variant of rendering, with the times of its images.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) contender: Contender,
    /// The adapter that rendered it, whichever backend was chosen.
    pub(super) adapter: Adapter,
    pub(super) samples: VecDeque<Sample>,
    pub(super) shadow_bytes: u64,
    pub(super) error: LiveError,
}

/// The key of one trail: a variant whose other settings change. The backend is the one that rendered it.
pub(super) type Series = (ShadowMethod, HairDrawing, Transparency, Backend);

impl Way {
    /// The trail to which it belongs.
    pub(super) fn series(&self) -> Series {
        let Contender { draw, transparency, .. } = self.contender;
        (self.contender.shadow.method, draw, transparency, self.adapter.backend)
    }

    /// Its method and its backend, such as `Voxel map · CPU`: times of two backends are not comparable.
    pub(super) fn label(&self) -> String {
        let method = self.contender.shadow.method.label();
        let draw = self.contender.draw_label().map(|draw| format!(" · {draw}")).unwrap_or_default();
        format!("{method}{draw} · {}", self.adapter.backend_label())
    }

    /// The median of a stage over its last images, milliseconds; `None` if the device does not measure it.
    pub(super) fn median(&self, stage: impl Fn(&LiveTimes) -> Option<f64>) -> Option<f64> {
        median(self.samples.iter().filter_map(|sample| stage(&sample.times)))
    }

    /// The median of the whole images, milliseconds.
    pub(super) fn whole(&self) -> f64 {
        self.median(|times| Some(times.whole)).unwrap_or_default()
    }
}

/// The rendered variants, the latest at the end.
pub(super) struct Costs {
    clock: Stopwatch,
    ways: Vec<Way>,
    /// The project that all variants share, and the size of a pane.
    drawn_of: Option<(Arc<Project>, [u32; 2])>,
}

impl Default for Costs {
    fn default() -> Self {
        Self { clock: Stopwatch::start(), ways: Vec::new(), drawn_of: None }
    }
}

impl Costs {
    /// Adds the times of a pane.
    pub(super) fn push(&mut self, pane: &LivePane) {
        if pane.problem.is_some() {
            return;
        }
        // Variants are compared with each other, so they must show the same scene.
        let same = self.drawn_of.as_ref().is_some_and(|(project, size)| {
            *size == pane.asked_size && is_same_but_for_panes(project, &pane.project)
        });
        if !same {
            self.ways.clear();
        }
        self.drawn_of = Some((Arc::clone(&pane.project), pane.asked_size));
        // The same choice can resolve to another backend later.
        self.ways
            .retain(|way| way.contender.backend != pane.contender.backend || way.adapter == pane.adapter);
        let known = self.ways.iter().position(|way| way.contender == pane.contender);
        let mut way = match known {
            Some(at) => self.ways.remove(at),
            None => Way {
                contender: pane.contender.clone(),
                adapter: pane.adapter.clone(),
                samples: VecDeque::new(),
                shadow_bytes: 0,
                error: LiveError::NotMeasured,
            },
        };
        let at_secs = self.clock.secs();
        // Old times are dropped; the last ones of a variant that is no longer rendered stay for its trail.
        while way.samples.len() >= MAX_SAMPLES
            || way.samples.front().is_some_and(|sample| sample.at_secs < at_secs - PLOTTED_SECS)
        {
            way.samples.pop_front();
        }
        way.samples.push_back(Sample { at_secs, times: pane.times });
        way.shadow_bytes = pane.shadow_bytes;
        if pane.error != LiveError::NotMeasured {
            way.error = pane.error.clone();
        }
        if self.ways.len() == MAX_WAYS {
            self.ways.remove(0);
        }
        self.ways.push(way);
    }

    /// The times of a contender.
    pub(super) fn of(&self, contender: &Contender) -> Option<&Way> {
        self.ways.iter().find(|way| way.contender == *contender)
    }

    /// The variants of a trail, the latest at the end.
    pub(super) fn trail(&self, series: Series) -> impl Iterator<Item = &Way> {
        self.ways.iter().filter(move |way| way.series() == series)
    }
}

/// Whether two projects are equal in everything that panes share.
fn is_same_but_for_panes(a: &Arc<Project>, b: &Arc<Project>) -> bool {
    let of_panes = |project: &Project| Project { compare: a.compare.clone(), ..project.clone() };
    Arc::ptr_eq(a, b) || **a == of_panes(b)
}

#[cfg(test)]
pub(super) mod tests {
    use lovelock_panes::view::LiveShows;
    use lovelock_render::{Camera, Image};

    use super::*;

    /// A pane that took `ms`, of that resolution.
    pub(crate) fn pane(resolution: u32, ms: f64, rmse: f64) -> LivePane {
        let mut contender = Contender::default();
        contender.shadow.voxel_map.resolution = resolution;
        LivePane {
            adapter: Adapter { name: String::new(), backend: Backend::Cpu, software: true },
            camera: Camera {
                eye: glam::Vec3::ZERO,
                target: glam::Vec3::Z,
                fov_y: 0.5,
                shear: glam::Vec2::ZERO,
            },
            contender,
            project: Arc::default(),
            asked_size: [640, 360],
            image: Image::default(),
            problem: None,
            colors_problem: None,
            step: 0,
            time_secs: 0.0,
            times: LiveTimes { build: Some(ms), ask: Some(0.0), draw: Some(1.0), whole: ms + 1.0 },
            shadow_bytes: u64::from(resolution).pow(3),
            shadow_fallbacks: 0,
            draw_bytes: 0,
            error: LiveError::Measured { rmse, bias: 0.0, p99: rmse },
            flip: None,
            shows: LiveShows::Picture,
        }
    }

    #[test]
    fn settings_of_a_way_are_its_trail_and_problems_are_none() {
        let mut costs = Costs::default();
        for (resolution, ms) in [(64, 1.0), (64, 3.0), (128, 5.0), (64, 2.0)] {
            costs.push(&pane(resolution, ms, 0.1));
        }
        costs.push(&LivePane { problem: Some("no".to_owned()), ..pane(256, 9.0, 0.1) });
        let of = |resolution| costs.of(&pane(resolution, 0.0, 0.0).contender);
        assert_eq!(of(64).map(|way| way.median(|times| times.build)), Some(Some(2.0)));
        assert_eq!(of(64).map(Way::whole), Some(3.0));
        assert!(of(256).is_none());
        let mine = of(64).expect("a way").series();
        let trail: Vec<u32> =
            costs.trail(mine).map(|way| way.contender.shadow.voxel_map.resolution).collect();
        assert_eq!(trail, [128, 64], "the newest at the end");
        let other = (ShadowMethod::Exact, mine.1, mine.2, mine.3);
        assert_eq!(costs.trail(other).count(), 0);
    }

    #[test]
    fn ways_of_another_scene_size_or_backend_are_forgotten() {
        let first = pane(64, 1.0, 0.1);
        let ways = |then: LivePane| {
            let mut costs = Costs::default();
            costs.push(&first);
            costs.push(&then);
            costs.ways.len()
        };
        let second = pane(128, 1.0, 0.1);
        assert_eq!(ways(second.clone()), 2);
        let mut project = Project::default();
        project.compare.panes.clear();
        let other_panes = LivePane { project: Arc::new(project.clone()), ..second.clone() };
        assert_eq!(ways(other_panes), 2, "panes are not what they share");
        project.look.diameter *= 2.0;
        assert_eq!(ways(LivePane { project: Arc::new(project), ..second.clone() }), 1);
        assert_eq!(ways(LivePane { asked_size: [320, 180], ..second.clone() }), 1);
        let card = Adapter { name: "a card".to_owned(), backend: Backend::Gpu, software: false };
        let drawn_there = LivePane { adapter: card.clone(), ..second.clone() };
        assert_eq!(ways(drawn_there.clone()), 1, "what was chosen drew elsewhere");
        let mut chosen = drawn_there;
        chosen.contender.backend = Backend::Gpu;
        assert_eq!(ways(chosen.clone()), 2, "another choice beside the first");
        let mut costs = Costs::default();
        costs.push(&chosen);
        assert_eq!(costs.of(&chosen.contender).map(Way::label), Some("Voxel map · GPU".to_owned()));
    }

    #[test]
    fn what_is_kept_has_a_bound() {
        let mut costs = Costs::default();
        for i in 0..2000 {
            costs.push(&pane(i % 97, 1.0, 0.1));
        }
        for _ in 0..2000 {
            costs.push(&pane(5, 1.0, 0.1));
        }
        assert!(costs.ways.len() <= MAX_WAYS);
        assert!(costs.ways.iter().all(|way| way.samples.len() <= MAX_SAMPLES));
    }
}
