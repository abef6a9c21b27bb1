//! `lovelock bench --threads`: the same scenes with several numbers of threads.

use std::fmt;
use std::ops::ControlFlow;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::Renderer;
use rayon::ThreadPoolBuilder;

use super::report::{ScalingReport, ThreadRun};
use super::yardstick::{Bound, Yardstick};
use super::{BenchRequest, Prepared};

/// Measures every scene of the request with every number of threads, on the CPU.
///
/// # Errors
/// As [`super::bench`].
pub(super) fn measure(
    request: &BenchRequest,
    change: &dyn Fn(&mut Project) -> Result<(), ProjectError>,
    renderers: &mut [Renderer],
    notes: &mut Vec<String>,
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<Vec<ScalingReport>, ProjectError> {
    let mut pools = Vec::new();
    for &threads in &request.threads {
        if progress(&format!("the yardstick with {}", counted(threads as u64))).is_break() {
            return Err(ProjectError::Cancelled);
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(ProjectError::work)?;
        let yardstick = pool.install(Yardstick::measure);
        pools.push((pool, yardstick));
    }
    let available = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    if request.threads.iter().any(|threads| *threads > available) {
        notes.push(format!("this machine runs at most {} at a time", counted(available as u64)));
    }
    let mut reports = Vec::new();
    for &scene in &request.scenes {
        let prepared = Prepared::new(scene, request, change)?;
        let mut runs: Vec<ThreadRun> = Vec::new();
        for (pool, yardstick) in &pools {
            let threads = counted(pool.current_num_threads() as u64);
            if progress(&format!("{} with {threads}", scene.id())).is_break() {
                return Err(ProjectError::Cancelled);
            }
            // Asked before each run instead, because it stays on this thread.
            let mut go_on = |_: &str| ControlFlow::Continue(());
            let mut said = Vec::new();
            let measured =
                pool.install(|| prepared.measure(request, renderers, yardstick, &mut said, &mut go_on))?;
            notes.extend(said.into_iter().map(|note| format!("{threads}: {note}")));
            for scene in measured {
                let first = runs.first().map(|run| &run.scene);
                let speed_up = scene.stages.iter().map(|stage| {
                    let before = first.unwrap_or(&scene).median_ms(&stage.name)?;
                    (before > 0.0 && stage.median_ms > 0.0).then(|| before / stage.median_ms)
                });
                runs.push(ThreadRun { yardstick: *yardstick, speed_up: speed_up.collect(), scene });
            }
        }
        reports.push(ScalingReport { scene: scene.id().to_owned(), runs });
    }
    Ok(reports)
}

/// `1 thread` or `N threads`.
pub(crate) fn counted(threads: u64) -> String {
    if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") }
}

impl fmt::Display for ScalingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.runs.first() else { return Ok(()) };
        writeln!(f, "{}", first.scene.heading())?;
        write!(f, "  {:<28}", "")?;
        for run in &self.runs {
            write!(f, "{:>14}{:>10}", counted(run.scene.threads), "speed-up")?;
        }
        writeln!(f)?;
        for (at, stage) in first.scene.stages.iter().enumerate() {
            write!(f, "  {:<28}", stage.name)?;
            for run in &self.runs {
                let speed_up = run.speed_up.get(at).copied().flatten();
                let speed_up = speed_up.map_or_else(|| "-".to_owned(), |times| format!("{times:.2}"));
                write!(
                    f,
                    "{:>14.2}{speed_up:>10}",
                    run.scene.stages.get(at).map_or(0.0, |stage| stage.median_ms)
                )?;
            }
            writeln!(f)?;
        }
        // What the machine itself gains: a stage gains no more than the figure that bounds it.
        let figures = [Bound::Copy, Bound::MultiplyAdds, Bound::ScatteredAdds];
        for bound in figures {
            write!(f, "  {:<28}", format!("the machine, {}", bound.unit()))?;
            for run in &self.runs {
                let times = first.yardstick.unit_ns(bound) / run.yardstick.unit_ns(bound);
                write!(f, "{:>14}{times:>10.2}", "")?;
            }
            writeln!(f)?;
        }
        if let Some(note) = first.scene.published_note {
            writeln!(f, "  {note}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::BenchScene;
    use crate::bench::report::tests::report;

    #[test]
    fn a_speed_up_is_the_first_time_divided_by_each() {
        let mut of = report();
        let runs = [10.0, 5.0, 0.0].map(|ms| {
            let mut scene = of.scenes[0].clone();
            scene.stages[0].median_ms = ms;
            scene
        });
        of.scenes.clear();
        let speed_up = [Some(1.0), Some(2.0), None];
        let runs = runs.into_iter().zip(speed_up).zip([1, 2, 4]).map(|((mut scene, speed_up), threads)| {
            scene.threads = threads;
            ThreadRun { yardstick: of.yardstick, scene, speed_up: vec![speed_up] }
        });
        let scaling = ScalingReport { scene: "smooth".to_owned(), runs: runs.collect() };
        let text = scaling.to_string();
        let line = text.lines().find(|line| line.trim().starts_with("draw")).expect("a line");
        let numbers: Vec<_> = line.split_whitespace().collect();
        assert_eq!(numbers, ["draw", "10.00", "1.00", "5.00", "2.00", "0.00", "-"]);
        assert!(text.contains("1 thread ") && text.contains("4 threads"), "{text}");
        // Each run is a line of the table.
        of.scaling = vec![scaling];
        let csv = of.csv();
        let threads: Vec<_> =
            csv.lines().skip(1).map(|line| line.split(",10.000,50.000,200.000,").nth(1)).collect();
        assert_eq!(threads, [Some("1,,,"), Some("2,,,"), Some("4,,,")]);
    }

    #[test]
    fn each_run_has_its_own_number_of_threads() {
        let request = BenchRequest {
            scenes: vec![BenchScene::Simulate402],
            threads: vec![1, 2],
            frames: 1,
            ..BenchRequest::default()
        };
        let change = |project: &mut Project| {
            project.hair.groom.wisps = 8;
            Ok(())
        };
        let (mut notes, mut said) = (Vec::new(), Vec::new());
        let mut progress = |what: &str| {
            said.push(what.to_owned());
            ControlFlow::Continue(())
        };
        let reports = measure(&request, &change, &mut [], &mut notes, &mut progress).expect("measured");
        let runs = &reports[0].runs;
        assert_eq!([runs[0].scene.threads, runs[1].scene.threads], [1, 2]);
        assert!(runs[0].speed_up.iter().all(|times| *times == Some(1.0)), "{runs:?}");
        assert!(runs[1].speed_up.iter().all(|times| times.is_some_and(|times| times > 0.0)), "{runs:?}");
        assert_eq!(said.len(), 4, "{said:?}");
        assert!(notes.iter().any(|note| note.starts_with("1 thread: simulate-402")), "{notes:?}");
        // Cancelling ends it before the next run.
        let stop = measure(&request, &change, &mut [], &mut notes, &mut |_| ControlFlow::Break(()));
        assert!(matches!(stop, Err(ProjectError::Cancelled)));
    }
}
