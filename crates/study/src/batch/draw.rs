//! The image, times and errors of one entrant.

use lovelock_metrics::{Errors, Image, Spread, errors, errors_of, flip, psnr_db, ssim};
use lovelock_project::error::ProjectError;
use lovelock_render::{FrameInput, FrameStats, Picture, Renderer};

use super::truth::Points;
use super::work::CheckCancel;
use crate::report::{FlipError, MethodReport, StageMs, TimeSpread, TransmittanceError};

/// Number of untimed draws that create buffers and fill caches.
const WARM_UP: u32 = 3;

/// The result of rendering.
pub(super) struct Drawn {
    pub picture: Picture,
    /// Transmittance of the first light at every strand point.
    pub transmittance: Vec<f32>,
}

/// Renders `draws` times after a warm-up and records times and memory. `check_cancel` is called before each draw, outside the
/// measured time.
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
    for draw in 0..WARM_UP + draws.max(1) {
        check_cancel()?;
        let one = renderer.picture(input, width, height, &mut picture)?;
        if draw >= WARM_UP {
            stats.push(one);
        }
    }
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
        times.extend(spread("query", &FrameStats::ask_ms));
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

/// Records the difference of an image from the reference, and returns it per pixel. `hair` is finite where a pixel shows hair.
///
/// # Errors
/// If the images have different sizes.
pub(super) fn picture_error(
    picture: &Picture,
    reference: &Picture,
    hair: &[f32],
    report: &mut MethodReport,
) -> Result<Vec<f32>, lovelock_metrics::ImageError> {
    let test = Image::new(picture.width, picture.height, &picture.rgba)?;
    let reference = Image::new(reference.width, reference.height, &reference.rgba)?;
    let seen = flip(&reference, &test)?;
    let on_hair = seen.values.iter().zip(hair).filter(|(_, hair)| hair.is_finite());
    let (sum, count) =
        on_hair.fold((0.0, 0_u64), |(sum, count), (seen, _)| (sum + f64::from(*seen), count + 1));
    let hair_mean = (count > 0).then(|| sum / count as f64);
    report.flip = Some(FlipError { mean: seen.mean(), hair_mean, p99: seen.percentile(0.99) });
    report.psnr_db = Some(psnr_db(&reference, &test)?).filter(|db| db.is_finite());
    // An image smaller than the SSIM window has no SSIM.
    report.ssim = ssim(&reference, &test).ok();
    Ok(seen.values)
}
