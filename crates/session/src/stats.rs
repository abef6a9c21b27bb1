//! Times of the stages of a frame, and their recent history for the plot.

use std::collections::VecDeque;

use lovelock_base::statistics::median;
use lovelock_render::{FrameStats, PassTime};
use serde::Serialize;

/// A stage of one frame, in order of execution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The pose, the colliders and the skinned surface.
    Motion,
    /// The simulation's steps.
    Simulate,
    /// Strands from guides.
    Interpolate,
    /// Shadow maps and their lookups.
    Shadow,
    /// Rendering.
    Draw,
    /// Encoding into a film or a file.
    Encode,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 6] =
        [Self::Motion, Self::Simulate, Self::Interpolate, Self::Shadow, Self::Draw, Self::Encode];

    /// The name in the interface.
    pub fn label(self) -> &'static str {
        match self {
            Self::Motion => "Motion",
            Self::Simulate => "Simulate",
            Self::Interpolate => "Interpolate",
            Self::Shadow => "Shadow",
            Self::Draw => "Draw",
            Self::Encode => "Encode",
        }
    }
}

/// Times of the stages of one frame, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageTimes {
    /// The pose, the colliders and the skinned surface.
    pub motion: f64,
    /// The simulation's steps of this frame.
    pub simulate: f64,
    /// Strands from guides.
    pub interpolate: f64,
    /// Shadow maps and their lookups.
    pub shadow: f64,
    /// Rendering.
    pub draw: f64,
    /// Encoding into a film or a file.
    pub encode: f64,
}

impl StageTimes {
    /// The time of one stage.
    pub fn get(&self, stage: Stage) -> f64 {
        match stage {
            Stage::Motion => self.motion,
            Stage::Simulate => self.simulate,
            Stage::Interpolate => self.interpolate,
            Stage::Shadow => self.shadow,
            Stage::Draw => self.draw,
            Stage::Encode => self.encode,
        }
    }

    /// Mutable access to the time of one stage.
    pub fn get_mut(&mut self, stage: Stage) -> &mut f64 {
        match stage {
            Stage::Motion => &mut self.motion,
            Stage::Simulate => &mut self.simulate,
            Stage::Interpolate => &mut self.interpolate,
            Stage::Shadow => &mut self.shadow,
            Stage::Draw => &mut self.draw,
            Stage::Encode => &mut self.encode,
        }
    }

    /// Sets the times of rendering to those of one image.
    pub fn take_picture(&mut self, stats: &FrameStats) {
        (self.interpolate, self.shadow, self.draw) = (stats.interpolate_ms, stats.shadow_ms, stats.draw_ms);
    }

    /// Adds the times of another image of the same frame.
    pub fn add_picture(&mut self, stats: &FrameStats) {
        self.interpolate += stats.interpolate_ms;
        self.shadow += stats.shadow_ms;
        self.draw += stats.draw_ms;
    }

    /// The sum of all stages.
    pub fn total(&self) -> f64 {
        Stage::ALL.iter().map(|&stage| self.get(stage)).sum()
    }
}

/// The stage times of the last frames.
#[derive(Clone, Debug)]
pub struct StageHistory {
    frames: VecDeque<StageTimes>,
    capacity: usize,
}

impl StageHistory {
    /// A history that keeps the last `capacity` frames (at least one).
    pub fn new(capacity: usize) -> Self {
        let capacity = capacity.max(1);
        Self { frames: VecDeque::with_capacity(capacity), capacity }
    }

    /// Adds a frame, and drops the oldest one if the history is full.
    pub fn push(&mut self, times: StageTimes) {
        if self.frames.len() == self.capacity {
            self.frames.pop_front();
        }
        self.frames.push_back(times);
    }

    /// The frames kept, oldest first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &StageTimes> {
        self.frames.iter()
    }

    /// One stage over the frames kept, oldest first, milliseconds.
    pub fn series(&self, stage: Stage) -> impl ExactSizeIterator<Item = f64> {
        self.frames.iter().map(move |times| times.get(stage))
    }

    /// The newest frame.
    pub fn newest(&self) -> Option<&StageTimes> {
        self.frames.back()
    }

    /// The median of each stage over the kept frames; zeros if there are none.
    pub fn medians(&self) -> StageTimes {
        let mut medians = StageTimes::default();
        for stage in Stage::ALL {
            *medians.get_mut(stage) = median(self.series(stage)).unwrap_or(0.0);
        }
        medians
    }

    /// The median of the frames' totals, milliseconds.
    pub fn median_total(&self) -> f64 {
        median(self.frames.iter().map(StageTimes::total)).unwrap_or(0.0)
    }
}

/// Times of the passes of the last frames, in the order of the newest frame.
#[derive(Clone, Debug)]
pub struct PassHistory {
    passes: Vec<(String, VecDeque<f64>)>,
    capacity: usize,
}

impl PassHistory {
    /// A history that keeps the last `capacity` frames (at least one).
    pub fn new(capacity: usize) -> Self {
        Self { passes: Vec::new(), capacity: capacity.max(1) }
    }

    /// Adds a frame. Passes that it lacks are dropped, because it was rendered in another way.
    pub fn push(&mut self, passes: &[PassTime]) {
        let mut before = std::mem::take(&mut self.passes);
        for pass in passes {
            let known = before.iter().position(|(name, _)| *name == pass.name);
            let (name, mut times) =
                known.map_or_else(|| (pass.name.clone(), VecDeque::new()), |at| before.swap_remove(at));
            if times.len() == self.capacity {
                times.pop_front();
            }
            times.push_back(pass.ms);
            self.passes.push((name, times));
        }
    }

    /// The median of each pass, milliseconds.
    pub fn medians(&self) -> Vec<PassTime> {
        let median = |times: &VecDeque<f64>| median(times.iter().copied()).unwrap_or(0.0);
        self.passes.iter().map(|(name, times)| PassTime { name: name.clone(), ms: median(times) }).collect()
    }
}

/// The times of the last whole images. That of an image that shows only what has moved is not the time of a whole one.
#[derive(Clone, Debug)]
pub struct ImageTimes {
    /// Times of stages.
    pub stages: StageHistory,
    /// Times of passes.
    pub passes: PassHistory,
}

impl ImageTimes {
    /// Times of the last `capacity` whole images (at least one).
    pub fn new(capacity: usize) -> Self {
        Self { stages: StageHistory::new(capacity), passes: PassHistory::new(capacity) }
    }

    /// Adds an image, unless it shows only what has moved.
    pub fn push(&mut self, times: StageTimes, stats: &FrameStats) {
        if stats.redrawn.is_none() {
            self.stages.push(times);
            self.passes.push(&stats.passes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_frame_is_forgotten() {
        let mut history = StageHistory::new(3);
        for i in 0..5 {
            history.push(StageTimes { draw: f64::from(i), ..StageTimes::default() });
        }
        assert_eq!(history.series(Stage::Draw).collect::<Vec<_>>(), [2.0, 3.0, 4.0]);
        assert_eq!(history.medians().draw, 3.0);
        assert_eq!(history.newest().map(StageTimes::total), Some(4.0));
    }

    #[test]
    fn passes_keep_their_order_and_those_that_end_are_forgotten() {
        let pass = |name: &str, ms: f64| PassTime { name: name.to_owned(), ms };
        let mut history = PassHistory::new(3);
        for ms in [9.0, 1.0, 2.0, 3.0] {
            history.push(&[pass("b", ms), pass("a", 10.0 * ms)]);
        }
        assert_eq!(history.medians(), [pass("b", 2.0), pass("a", 20.0)]);
        history.push(&[pass("a", 20.0), pass("c", 5.0)]);
        assert_eq!(history.medians(), [pass("a", 20.0), pass("c", 5.0)]);
        history.push(&[pass("d", 1.0), pass("c", 7.0), pass("a", 20.0)]);
        assert_eq!(history.medians(), [pass("d", 1.0), pass("c", 6.0), pass("a", 20.0)], "as they come now");
    }

    #[test]
    fn images_of_what_has_moved_are_not_among_the_times() {
        let passes = |ms: f64| vec![PassTime { name: "draw/tiles".to_owned(), ms }];
        let mut times = ImageTimes::new(9);
        for (ms, redrawn) in [(8.0, None), (1.0, Some(0.1)), (2.0, Some(0.2)), (8.0, None)] {
            let stats = FrameStats { redrawn, passes: passes(ms), ..FrameStats::default() };
            times.push(StageTimes { draw: ms, ..StageTimes::default() }, &stats);
        }
        assert_eq!(times.stages.series(Stage::Draw).collect::<Vec<_>>(), [8.0, 8.0]);
        assert_eq!(times.passes.medians(), passes(8.0));
    }

    #[test]
    fn every_stage_is_read_and_written_as_itself() {
        let mut times = StageTimes::default();
        for (i, stage) in Stage::ALL.into_iter().enumerate() {
            *times.get_mut(stage) = (1 << i) as f64;
        }
        assert_eq!(times.total(), 63.0);
        assert_eq!(times.encode, 32.0);
    }
}
