//! Seamless loops: after one period of a looping clip the body is back in the same pose, but the hair is not. The hair at the end
//! of the film is therefore blended into the hair one period before, which leads to the first frame.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use lovelock_groom::GuideFrame;
use lovelock_project::error::ProjectError;
use lovelock_record::mix_guides;

use super::step_before;
use crate::clock::FrameClock;
use crate::engine::Engine;
use crate::prepare::{STEPS_PER_REPORT, simulate_to};
use crate::progress::{Progress, report_progress};
use crate::scene::Scene;
use crate::snapshot::FrameSnapshot;
use crate::take::TakePlayer;

/// Duration of the blend, seconds, and its largest fraction of a period.
const FADE_SECS: f64 = 0.75;
const MAX_OF_ROUND: f64 = 0.4;

/// Tolerance of the head's position after one period, metres, so that both states of the hair fit the same head.
const SAME_PLACE_M: f32 = 1e-3;

/// Weight of the blend, 0 to 1, `left_secs` before the end of the period. It is 1 from the last frame on, one frame before the
/// end, so that the hair moves from there to the first frame as it did one period before.
fn share(left_secs: f64, fade_secs: f64, frame_secs: f64) -> f64 {
    let u = (1.0 - (left_secs - frame_secs) / (fade_secs - frame_secs).max(1e-9)).clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

fn fade_secs(period_secs: f64) -> f64 {
    FADE_SECS.min(MAX_OF_ROUND * period_secs)
}

/// The snapshot with its hair blended into `before` by the weight `share`.
fn mixed(now: &Arc<FrameSnapshot>, before: &GuideFrame, share: f64) -> Arc<FrameSnapshot> {
    let mut snapshot = FrameSnapshot::clone(now);
    mix_guides(&now.guides, before, share, &mut snapshot.guides);
    snapshot.resident = None;
    // The head's transform is exactly that of the body.
    snapshot.guides.world_from_head = now.guides.world_from_head;
    Arc::new(snapshot)
}

/// The loop of a simulation: the film shows the second period, and the hair around the end of the first one is stored.
pub(crate) struct Seam {
    frames: Range<u64>,
    frame_secs: f64,
    fade_secs: f64,
    /// Hair of the first period from the start of the blend on, and shortly after the period, by the time of the film.
    before: Vec<(f64, GuideFrame)>,
}

impl Seam {
    /// The loop of frames that cover one or several periods of a scene.
    ///
    /// # Errors
    /// If the motion does not loop, or the frames do not cover whole periods.
    pub(super) fn of(scene: &Scene, frames: &Range<u64>, frame_secs: f64) -> Result<Self, ProjectError> {
        if !scene.loops_smoothly() {
            return Err(ProjectError::option(
                "a seamless loop: the motion does not loop without a jump; turn on looping with a loop blend",
            ));
        }
        let (count, round) = (frames.end - frames.start, scene.duration_secs());
        let length = count as f64 * frame_secs;
        let rounds = if round > 0.0 { (length / round).round() } else { 1.0 };
        // A period is seldom a whole number of frames; the film may differ by half a frame at most.
        if round > 0.0 && (rounds < 1.0 || (length - rounds * round).abs() > 0.5001 * frame_secs) {
            let whole = (round / frame_secs).round();
            return Err(ProjectError::option(format!(
                "a seamless loop: frames {}..{} are {length:.2} s, and the motion repeats every {round:.2} s, which are {whole} frames",
                frames.start, frames.end
            )));
        }
        let fade_secs = fade_secs(length);
        Ok(Self { frames: frames.clone(), frame_secs, fade_secs, before: Vec::new() })
    }

    /// Frames per period.
    pub(super) fn frames(&self) -> u64 {
        self.frames.end - self.frames.start
    }

    /// Length of a period, seconds.
    pub(super) fn period_secs(&self) -> f64 {
        self.frames() as f64 * self.frame_secs
    }

    /// Time of a frame of the film, seconds.
    pub(super) fn secs_of(&self, frame: u64) -> f64 {
        frame as f64 * self.frame_secs
    }

    fn end_secs(&self) -> f64 {
        self.secs_of(self.frames.end)
    }

    /// Simulates the first period, up to film time `first_secs` in the second one, and stores the hair around its end.
    ///
    /// # Errors
    /// [`ProjectError::Cancelled`].
    pub(super) fn simulate_period(
        &mut self,
        engine: &mut Engine,
        clock: &FrameClock,
        first_secs: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), ProjectError> {
        let last = step_before(first_secs + self.period_secs(), clock).0;
        let kept = step_before(self.end_secs() - self.fade_secs, clock).0.min(last);
        self.before.clear();
        simulate_to(engine, kept, progress)?;
        for step in kept..=last {
            engine.advance_to_step(step);
            self.keep(step as f64 * clock.step_secs, engine.snapshot().as_ref());
            if step % STEPS_PER_REPORT == 0 {
                report_progress(progress, Progress::Simulating { done: step, total: last })?;
            }
        }
        Ok(())
    }

    /// Stores the hair at a time of the simulation, up to two frames after the end of the first period.
    fn keep(&mut self, secs: f64, snapshot: &FrameSnapshot) {
        let newer = self.before.last().is_none_or(|(last, _)| secs > last + 1e-9);
        if newer && secs <= self.end_secs() + 2.0 * self.frame_secs {
            self.before.push((secs, snapshot.guides.clone()));
        }
    }

    /// A snapshot of the second period, at film time `secs`, with its hair blended.
    pub(super) fn blended(&mut self, secs: f64, now: &Arc<FrameSnapshot>) -> Arc<FrameSnapshot> {
        // The end of the first period is followed by the start of the film, which the last open shutter may reach.
        self.keep(secs + self.period_secs(), now);
        let share = share(self.end_secs() - secs, self.fade_secs, self.frame_secs);
        if share <= 0.0 {
            return Arc::clone(now);
        }
        let after = self.before.partition_point(|(at, _)| *at < secs - 1e-9);
        let last = self.before.len().saturating_sub(1);
        let (Some((to, b)), Some((from, a))) =
            (self.before.get(after.min(last)), self.before.get(after.saturating_sub(1)))
        else {
            return Arc::clone(now);
        };
        let t = if to > from { ((secs - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        if t >= 1.0 {
            return mixed(now, b, share);
        }
        let mut between = a.clone();
        mix_guides(a, b, t, &mut between);
        mixed(now, &between, share)
    }
}

/// A looping part of a take. All times in seconds.
pub(crate) struct SeamOfTake {
    end: f64,
    round: f64,
    fade: f64,
    frame: f64,
}

impl SeamOfTake {
    /// The part from `start_secs` with a length of `period_secs` and a film frame every `frame_secs`.
    ///
    /// # Errors
    /// If the take does not start early enough before the part, or the body is elsewhere at its ends.
    pub(super) fn of(
        player: &mut TakePlayer,
        start_secs: f64,
        period_secs: f64,
        frame_secs: f64,
    ) -> Result<Self, ProjectError> {
        let fade = fade_secs(period_secs);
        let name = player.path().display().to_string();
        if start_secs < fade {
            return Err(ProjectError::option(format!(
                "a seamless loop: {name} has {start_secs:.2} s before the first frame, but the blend needs {fade:.2} s before it"
            )));
        }
        let end_secs = start_secs + period_secs;
        for secs in [end_secs - fade, end_secs - 0.5 * fade, end_secs] {
            // The last frame of a take also lasts for one frame.
            let secs = secs.min(player.duration_secs());
            let at = |snapshot: &FrameSnapshot| {
                let GuideFrame { guides, world_from_head, .. } = &snapshot.guides;
                (world_from_head.translation, (guides.count(), guides.points_per_guide))
            };
            let now = at(player.snapshot(secs)?.as_ref());
            let before = at(player.snapshot(secs - period_secs)?.as_ref());
            if now.1 != before.1 {
                return Err(ProjectError::option(format!(
                    "a seamless loop: at {secs:.2} s of {name} the hair has other guides than {period_secs:.2} s before; \
                     choose frames between which it stays the same"
                )));
            }
            let off = now.0.distance(before.0);
            if off > SAME_PLACE_M {
                return Err(ProjectError::option(format!(
                    "a seamless loop: at {secs:.2} s of {name} the head is {:.0} mm from where it was {period_secs:.2} s \
                     before; the frames must be one round of the dance",
                    1e3 * off
                )));
            }
        }
        Ok(Self { end: end_secs, round: period_secs, fade, frame: frame_secs })
    }

    /// The snapshot `secs` after the take's start.
    ///
    /// # Errors
    /// As [`TakePlayer::snapshot`].
    pub(super) fn snapshot(
        &self,
        player: &mut TakePlayer,
        secs: f64,
    ) -> Result<Arc<FrameSnapshot>, ProjectError> {
        let left = self.end - secs;
        if left >= self.fade {
            return player.snapshot(secs);
        }
        let before = player.snapshot(secs - self.round)?.guides.clone();
        let now = player.snapshot(secs)?;
        if before.guides.points_per_guide != now.guides.guides.points_per_guide
            || before.guides.count() != now.guides.guides.count()
        {
            return Ok(now);
        }
        Ok(mixed(&now, &before, share(left, self.fade, self.frame)))
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lovelock_motion::LoopBlend;
    use lovelock_project::Project;
    use lovelock_project::files::Access;

    use super::super::Dance;
    use super::*;
    use crate::prepare::settled_at;
    use crate::take::TakeRecording;
    use crate::testing::{load, small_project};

    fn go_on(_: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// A motion of about a second in a wind that does not repeat.
    fn windy() -> Project {
        let mut project = small_project();
        (project.motion.start_secs, project.motion.end_secs) = (1.0, Some(2.5));
        (project.simulation.wind.speed, project.simulation.wind.gusts) = (6.0, 1.0);
        project.simulation.wind.turbulence = 1.0;
        // The stiffness and the length of the round at which the values below were measured.
        project.simulation.stiffness_root = 14.0;
        project.motion.loop_blend = LoopBlend::Start;
        project
    }

    /// Hair of frames in head space.
    fn hair(dance: &mut Dance, frames: Range<u64>) -> Vec<Vec<Vec3>> {
        dance.begin(frames.start, dance.secs_of(frames.start), &mut go_on).expect("a dance");
        let points = |frame| {
            let snapshot = dance.snapshot(frame).expect("a frame");
            let (guides, head) = (&snapshot.guides.guides, snapshot.guides.world_from_head.inverse());
            let points = (0..guides.x.len()).map(|i| Vec3::new(guides.x[i], guides.y[i], guides.z[i]));
            points.map(|p| head.transform_point3(p)).collect()
        };
        frames.map(points).collect()
    }

    /// Mean distance between points of hair, metres.
    fn off(a: &[Vec3], b: &[Vec3]) -> f32 {
        a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f32>() / a.len() as f32
    }

    fn opened(project: &Project) -> Dance {
        Dance::open(project, &Access::new(), 30.0, &mut go_on).expect("a dance").0
    }

    #[test]
    fn a_loop_of_a_simulation_ends_where_it_began() {
        let project = windy();
        let frames = 0..opened(&project).frames();
        let n = frames.end as usize;
        let free = hair(&mut opened(&project), 0..2 * frames.end);
        let mut closed = opened(&project);
        closed.close(&frames).expect("a round");
        let film = hair(&mut closed, frames.clone());
        assert!(
            film[0] == free[n] && film[n / 2] == free[n + n / 2],
            "before the blend it is the second period"
        );
        // From the last frame to the first the hair moves as far as one period before, but for rounding.
        let (seam, natural) = (off(&film[n - 1], &film[0]), off(&free[n - 1], &free[n]));
        assert!((seam - natural).abs() < 1e-3 * natural, "{seam} at the seam, {natural} one round before");
        // Control: without the blend the hair jumps, measured 1.3 times as far.
        let jump = off(&free[2 * n - 1], &free[n]);
        assert!(jump > 1.15 * natural, "{jump} without, {natural} one round before");
        // The blend is even: measured, no frame of the film moves farther than without it.
        let most = film.windows(2).map(|pair| off(&pair[0], &pair[1])).fold(0.0, f32::max);
        let free_most = free[n..].windows(2).map(|pair| off(&pair[0], &pair[1])).fold(0.0, f32::max);
        assert!(most < 1.05 * free_most, "{most} against {free_most}");
        let refused = opened(&project).close(&(0..frames.end - 5)).expect_err("no whole round");
        assert!(refused.to_string().contains("repeats every"), "{refused}");
        let mut once = project;
        once.motion.looping = false;
        assert!(opened(&once).close(&frames).is_err());
    }

    #[test]
    fn a_loop_of_a_take_ends_where_it_began_and_needs_the_time_before_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut project = windy();
        let round = opened(&project).frames();
        let out = folder.path().join("windy.take");
        let clock = FrameClock::new(30.0);
        let (scene, _) = load(&project);
        let mut engine = settled_at(&scene, &project, &clock, [0, 0], &mut go_on).expect("settled hair");
        let mut take = TakeRecording::start(&out, &Arc::new(project.clone()), &engine).expect("a take");
        for step in 1..clock.step_of_frame(2 * round + 20) {
            engine.advance_to_step(step);
            take.push(&engine).expect("a frame");
        }
        take.finish().expect("a whole take");
        project.set_take(&out);
        let mut access = Access::new();
        access.pick(&out);
        let opened = || Dance::open(&project, &access, 30.0, &mut go_on).expect("a take").0;
        let start = 26;
        let frames = start..start + round;
        let (n, first) = (round as usize, start as usize);
        let free = hair(&mut opened(), 0..start + round);
        let mut closed = opened();
        closed.close(&frames).expect("a round");
        let film = hair(&mut closed, frames);
        assert!(film[0] == free[first] && film[n / 2] == free[first + n / 2]);
        let (seam, natural) = (off(&film[n - 1], &film[0]), off(&free[first - 1], &free[first]));
        assert!((seam - natural).abs() < 1e-3 * natural, "{seam} at the seam, {natural} one round before");
        // Measured 1.7 times.
        let jump = off(&free[first + n - 1], &free[first]);
        assert!(jump > 1.15 * natural, "{jump} without, {natural} one round before");
        let early = opened().close(&(2..2 + round)).expect_err("no time before it");
        assert!(early.to_string().contains("before the first frame"), "{early}");
        let other = opened().close(&(start..start + round - 6)).expect_err("the body is elsewhere");
        assert!(other.to_string().contains("mm from where it was"), "{other}");
    }
}
