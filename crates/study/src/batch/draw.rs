//! The image, times and errors of one entrant.

use lovelock_base::clock::Stopwatch;
use lovelock_metrics::{Errors, Spread, errors, errors_of};
use lovelock_project::error::ProjectError;
use lovelock_render::{FrameInput, FrameStats, Picture, Renderer};

use super::truth::Points;
use super::work::CheckCancel;
use crate::report::{MethodReport, StageMs, TimeSpread, TransmittanceError};

/// Number of untimed draws that create buffers and fill caches.
const WARM_UP: u32 = 3;
/// Draws that are timed however long they take.
const LEAST: usize = 5;
/// After this time no more draws begin, seconds: a method that takes seconds a draw needs no thirty of them for a median.
const MOST_SECS: f64 = 10.0;
/// After this time a single timed draw is enough, seconds: what takes so long varies little.
const SLOW_SECS: f64 = 30.0;

/// The result of rendering.
pub(super) struct Drawn {
    pub picture: Picture,
    /// Transmittance of the first light at every strand point.
    pub transmittance: Vec<f32>,
}

/// Renders up to `draws` times after a warm-up and records times and memory; fewer times, but [`LEAST`], if that takes over [`MOST_SECS`],
/// and once after a single untimed draw if even that takes over [`SLOW_SECS`].
/// Every draw builds and looks up its maps, as while hair moves.
/// `check_cancel` is called before each draw, outside the measured time.
///
/// # Errors
/// If the shadow needs too much memory or the device is lost, or the error of `check_cancel`.
pub(super) fn draw(
    renderer: &mut Renderer,
    input: &FrameInput,
    [width, height]: [u32; 2],
    draws: u32,
    report: &mut MethodReport,
    check_cancel: &mut CheckCancel,
) -> Result<Drawn, ProjectError> {
    let mut picture = Picture::default();
    let mut stats = Vec::new();
    renderer.set_keeping(false);
    let watch = Stopwatch::start();
    let timed = (0..WARM_UP + draws.max(1)).try_for_each(|draw| {
        let secs = watch.secs();
        if stats.len() >= LEAST && secs > MOST_SECS || !stats.is_empty() && secs > SLOW_SECS {
            return Ok(());
        }
        check_cancel()?;
        let one = renderer.picture(input, width, height, &mut picture)?;
        if draw >= WARM_UP || draw > 0 && secs > MOST_SECS {
            stats.push(one);
        }
        Ok::<_, ProjectError>(())
    });
    renderer.set_keeping(true);
    timed?;
    let transmittance = renderer.transmittance(0)?;
    report.times = times(&stats);
    let median = |name: &str| report.times.iter().find(|time| time.name == name).map(|time| time.median);
    report.ms = Some(StageMs {
        build: median("build"),
        query: median("query"),
        draw: median("draw").unwrap_or(0.0),
        whole: median("whole").unwrap_or(0.0),
    });
    report.memory_bytes = stats.iter().map(|stats| stats.shadow_bytes).max();
    report.fallbacks = stats.iter().map(|stats| stats.shadow_fallbacks).max().unwrap_or(0);
    report.draw_bytes = stats.iter().map(|stats| stats.draw_bytes).max();
    Ok(Drawn { picture, transmittance })
}

/// The stages, then the passes of the backend in their order.
fn times(stats: &[FrameStats]) -> Vec<TimeSpread> {
    let spread = |name: &str, of: &dyn Fn(&FrameStats) -> f64| {
        let all: Vec<f64> = stats.iter().map(of).collect();
        Spread::of(&all).map(|Spread { median, low, high, count }| TimeSpread {
            name: name.to_owned(),
            median,
            low,
            high,
            count: count as u32,
        })
    };
    let passes = stats.first().map_or(&[][..], |stats| &stats.passes);
    // A device without timers only gives the time of whole images.
    let mut times = Vec::new();
    if !passes.is_empty() {
        times.extend(spread("build", &FrameStats::build_ms));
        times.extend(spread("query", &FrameStats::query_ms));
    }
    times.extend(spread("draw", &|stats| stats.draw_ms));
    times.extend(spread("whole", &|stats| stats.shadow_ms + stats.draw_ms));
    for pass in passes {
        let of = |stats: &FrameStats| {
            let same = stats.passes.iter().filter(|other| other.name == pass.name);
            same.map(|pass| pass.ms).sum()
        };
        if times.iter().all(|time| time.name != pass.name) {
            times.extend(spread(&pass.name, &of));
        }
    }
    times
}

/// Errors of transmittance against `truth`; if the ground truth at points is known, also for points where light enters.
pub(super) fn transmittance_error(
    test: &[f32],
    truth: &[f32],
    points: Option<&Points>,
) -> TransmittanceError {
    let Errors { count, rmse, bias, p99, max, left_out: _ } = errors(test, truth);
    let first = points.map(|points| errors_of(test, truth, points.first.iter().copied()));
    let first10_rmse = first.filter(|first| first.count > 0).map(|first| first.rmse);
    TransmittanceError { count: count as u64, rmse, bias, p99, max, first10_rmse }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use lovelock_project::files::Access;
    use lovelock_render::{Backend, ShadowMethod};
    use lovelock_session::dance::Dance;
    use lovelock_session::progress::Progress;
    use lovelock_session::testing::small_project;
    use lovelock_shadow::{MapKind, cpu_shadow};
    use lovelock_testkit::clock::alone_ms;

    use super::super::hair::{Hair, lights};
    use super::*;

    /// The benchmark is measured as the CPU time of one thread, which other work on the machine does not change, and shared among all threads.
    /// Other work only makes the draws slower.
    #[test]
    fn the_times_of_every_method_are_those_of_its_work() {
        let mut project = small_project().compared();
        // With one light, a draw and the benchmark build one map each.
        project.lights.truncate(1);
        project.lights[0].enabled = true;
        let mut progress = |_: Progress| ControlFlow::Continue(());
        let (mut dance, _) = Dance::open(&project, &Access::new(), 30.0, &mut progress).expect("a dance");
        dance.begin(0, 0.0, &mut progress).expect("a start");
        let hair = Hair::new(dance.snapshot(0).expect("a snapshot"), &project);
        let light = &lights(&project)[0];
        for &method in ShadowMethod::ALL.iter().filter(|method| method.map_kind() != MapKind::None) {
            project.shadow.method = method;
            let input = hair.shadow_input(&project, light);
            let strands = &hair.strands;
            let mut answers = vec![1.0; strands.points()];
            let mut benchmark = || {
                let mut map = cpu_shadow(method);
                map.build(&input, &project.shadow).expect("a map");
                map.transmittance_at(&strands.x, &strands.y, &strands.z, &mut answers);
            };
            let least = (0..3).map(|_| alone_ms(&mut benchmark)).fold(f64::MAX, f64::min);
            let least =
                least / std::thread::available_parallelism().map_or(1.0, |threads| threads.get() as f64);

            let frame = hair.frame_input(&project);
            let mut renderer = Renderer::open(Backend::Cpu).expect("the CPU");
            let mut report = MethodReport::default();
            draw(&mut renderer, &frame, [32, 32], 3, &mut report, &mut || Ok(())).expect("draws");
            let ms = report.ms.and_then(|ms| Some([ms.build?, ms.query?])).expect("times");
            assert!(ms.iter().all(|ms| *ms > 0.0), "{method}: {ms:?}");
            assert!(ms[0] + ms[1] >= 0.1 * least, "{method}: {ms:?} of {least}");

            // Negative control: a renderer that keeps its maps would be caught, and says what it kept.
            let mut picture = Picture::default();
            let mut draw = || renderer.picture(&frame, 32, 32, &mut picture).expect("a picture");
            let (first, second) = (draw(), draw());
            assert_eq!((second.build_ms(), second.query_ms()), (0.0, 0.0), "{method}");
            let anew = second.made_anew();
            assert_eq!((anew.build_ms(), anew.query_ms()), (first.build_ms(), first.query_ms()), "{method}");
        }
    }
}
