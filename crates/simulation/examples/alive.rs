//! Measures the liveliness of a motion: where the head turns fastest, whether roots follow at once and tips
//! lag, whether hair snaps or folds, how soon it settles once the body stands still, and what moves then.
//!
//! `alive STYLE [--motion FILE] [--stop SECS] [--ties JSON] [--set JSON]`: STYLE is a preset or a hair file.

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides, HairTie};

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage, frame, settings_of};

/// Observed places along a guide, as fractions of its points.
const PLACES: [f32; 5] = [0.1, 0.25, 0.5, 0.75, 1.0];
/// The longest lag that is tested, steps.
const LONGEST_LAG: usize = 45;
/// How long the body stands still at the end, seconds.
const STILL_SECS: f64 = 8.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "alive STYLE [--motion FILE] [--stop SECS] [--ties JSON] [--set JSON]";
    let style = args.next().ok_or(usage)?;
    let mut stage = Stage::named(&style, None);
    let mut settings = settings_of(&style);
    let mut stop = f64::INFINITY;
    while let Some(arg) = args.next() {
        let value = args.next().ok_or(usage)?;
        match arg.as_str() {
            "--motion" => stage.play(&value)?,
            "--stop" => stop = value.parse()?,
            "--ties" => stage.tie(&serde_json::from_str::<Vec<HairTie>>(&value)?),
            "--set" => settings = serde_json::from_str(&value)?,
            _ => return Err(usage.into()),
        }
    }
    let end = stop.min(stage.dance.duration_secs);
    let steps = (end / f64::from(STEP_SECS)).floor() as usize;
    let still = (STILL_SECS / f64::from(STEP_SECS)) as usize;
    let mut simulation = stage.simulation(Some(0.0));
    let rest = stage.style.guides.clone();
    let mut film = vec![frame(&simulation)];
    for step in 1..=steps + still {
        // Time continues; the body stays where it is.
        let time = step as f64 * f64::from(STEP_SECS);
        let mut input = stage.at(Some(time.min(end)));
        input.time_secs = time;
        simulation.step(&input, &settings, STEP_SECS);
        film.push(frame(&simulation));
    }
    turns(&film[..=steps]);
    lags(&film[..=steps], &rest);
    snaps(&film[..=steps], &rest);
    folds(&film[..=steps], &rest);
    stillness(&film[steps..]);
    Ok(())
}

/// The five fastest rotations of the head.
fn turns(film: &[GuideFrame]) {
    let turn = |a: &Affine3A, b: &Affine3A| {
        let (a, b) = (Quat::from_mat3a(&a.matrix3), Quat::from_mat3a(&b.matrix3));
        let q = b * a.conjugate();
        let angle = 2.0 * q.xyz().length().atan2(q.w.abs());
        (angle / STEP_SECS, q.xyz() * q.w.signum() * (2.0 / STEP_SECS))
    };
    let mut rates: Vec<_> =
        (1..film.len()).map(|i| (i, turn(&film[i - 1].world_from_head, &film[i].world_from_head))).collect();
    rates.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
    let mut told: Vec<usize> = Vec::new();
    for (i, (rate, axis)) in rates {
        if told.iter().all(|&other| other.abs_diff(i) > 24) {
            let at = i as f32 * STEP_SECS;
            println!("turn: {rate:5.2} rad/s at {at:5.2} s (frame {i}), about {axis:.1}");
            told.push(i);
        }
        if told.len() == 5 {
            break;
        }
    }
}

fn place(fraction: f32, points: usize) -> usize {
    ((fraction * (points - 1) as f32).round() as usize).clamp(1, points - 1)
}

/// How far places along the hair leave the head, and how much later than the head they move.
fn lags(film: &[GuideFrame], rest: &Guides) {
    let n = rest.points_per_guide;
    for fraction in PLACES {
        let k = place(fraction, n);
        // Actual velocities, and velocities as if the hair were a rigid helmet.
        let (mut own, mut rigid, mut away, mut most) = (Vec::new(), Vec::new(), 0.0_f64, 0.0_f32);
        for pair in film.windows(2) {
            let (mut v, mut w) = (Vec::new(), Vec::new());
            for g in 0..rest.count() {
                let r = rest.point(g, k);
                let at = pair[1].world_from_head.transform_point3(r);
                let p = pair[1].guides.point(g, k);
                v.push(p - pair[0].guides.point(g, k));
                w.push(at - pair[0].world_from_head.transform_point3(r));
                away += f64::from((p - at).length_squared());
                most = most.max((p - at).length());
            }
            own.push(v);
            rigid.push(w);
        }
        let likeness = |lag: usize| -> f32 {
            let mut sums = [0.0_f32; 3];
            for t in 0..rigid.len().saturating_sub(LONGEST_LAG) {
                for (a, b) in rigid[t].iter().zip(&own[t + lag]) {
                    sums[0] += a.dot(*b);
                    sums[1] += a.length_squared();
                    sums[2] += b.length_squared();
                }
            }
            sums[0] / (sums[1] * sums[2]).sqrt().max(1e-12)
        };
        let best = (0..LONGEST_LAG).max_by(|a, b| likeness(*a).total_cmp(&likeness(*b))).unwrap_or(0);
        println!(
            "place {fraction:.2}: lag {:3.0} ms (correlation {:.2}, {:.2} without), distance from the style {:.1} cm rms, {:.1} max",
            1e3 * best as f32 * STEP_SECS,
            likeness(best),
            likeness(0),
            100.0 * (away / (rigid.len() * rest.count()) as f64).sqrt(),
            100.0 * most
        );
    }
}

/// The largest changes of velocity from frame to frame, beyond those of the head.
fn snaps(film: &[GuideFrame], rest: &Guides) {
    let mut all = Vec::new();
    // The largest change of each guide in each frame, and its place.
    let mut worst = Vec::new();
    for t in 1..film.len().saturating_sub(1) {
        let three = &film[t - 1..=t + 1];
        for g in 0..rest.count() {
            let mut most = (0.0_f32, t, g, 0);
            for k in 1..rest.points_per_guide {
                let change =
                    |at: &dyn Fn(&GuideFrame) -> Vec3| at(&three[0]) - 2.0 * at(&three[1]) + at(&three[2]);
                let own = change(&|f| f.guides.point(g, k));
                let head = change(&|f| f.world_from_head.transform_point3(rest.point(g, k)));
                let change = (own - head).length() / STEP_SECS;
                all.push(change);
                if change > most.0 {
                    most = (change, t, g, k);
                }
            }
            worst.push(most);
        }
    }
    if all.is_empty() {
        return;
    }
    all.sort_by(|a, b| b.total_cmp(a));
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let share = |share: f64| all[(share * (all.len() - 1) as f64) as usize];
    println!(
        "change of velocity per frame: median {:.3} m/s, 1 in 1,000 {:.2}, 1 in 100,000 {:.2}",
        share(0.5),
        share(1e-3),
        share(1e-5)
    );
    let mut told: Vec<(usize, usize)> = Vec::new();
    for (change, t, g, k) in worst {
        if told.iter().all(|&(other, guide)| other.abs_diff(t) > 6 || guide / 3 != g / 3) {
            let p = film[t].guides.point(g, k) - Vec3::from(film[t].world_from_head.translation);
            let secs = t as f32 * STEP_SECS;
            println!("snap: {change:.2} m/s at {secs:.2} s, guide {g} point {k}, {p:.2} from the head joint");
            told.push((t, g));
        }
        if told.len() == 5 {
            break;
        }
    }
}

/// Points bent by more than 60 degrees beyond their rest bend.
fn folds(film: &[GuideFrame], rest: &Guides) {
    let n = rest.points_per_guide;
    let bend = |guides: &Guides, g: usize, k: usize| {
        let a = guides.point(g, k) - guides.point(g, k - 1);
        let b = guides.point(g, k + 1) - guides.point(g, k);
        if a.length() * b.length() < 1e-10 { 0.0 } else { a.angle_between(b).to_degrees() }
    };
    let (mut count, mut worst) = ([0_usize; 3], (0.0_f32, 0, 0, 0));
    let mut per_frame = vec![0_usize; film.len()];
    for (t, f) in film.iter().enumerate() {
        for g in 0..rest.count() {
            for k in 1..n - 1 {
                let more = bend(&f.guides, g, k) - bend(rest, g, k);
                for (count, limit) in count.iter_mut().zip([30.0, 60.0, 90.0]) {
                    *count += usize::from(more > limit);
                }
                per_frame[t] += usize::from(more > 30.0);
                if more > worst.0 {
                    worst = (more, t, g, k);
                }
            }
        }
    }
    let all = (film.len() * rest.count() * (n - 2)) as f32;
    let share = count.map(|c| 100.0 * c as f32 / all);
    println!(
        "bent by 30, 60, 90 degrees more than at rest: {:.3} %, {:.4} %, {:.4} %; max {:.0} at {:.2} s, guide {} point {}",
        share[0],
        share[1],
        share[2],
        worst.0,
        worst.1 as f32 * STEP_SECS,
        worst.2,
        worst.3
    );
    if let Some((t, c)) = per_frame.iter().enumerate().max_by_key(|(_, c)| **c) {
        println!("most bends over 30 degrees: {c} at {:.2} s", t as f32 * STEP_SECS);
    }
}

/// The largest movement of a point per frame, for each half second after the body stands still.
fn stillness(film: &[GuideFrame]) {
    let points = film[0].guides.x.len();
    for (i, half) in film.windows(2).collect::<Vec<_>>().chunks(30).enumerate() {
        if half.len() < 30 {
            continue;
        }
        let mut worst = (0.0_f32, 0);
        let mut sum = 0.0_f64;
        for pair in half {
            let at = |f: &GuideFrame, j: usize| Vec3::new(f.guides.x[j], f.guides.y[j], f.guides.z[j]);
            for j in 0..points {
                let moved = (at(&pair[1], j) - at(&pair[0], j)).length();
                sum += f64::from(moved);
                if moved > worst.0 {
                    worst = (moved, j);
                }
            }
        }
        let n = film[0].guides.points_per_guide;
        println!(
            "still for {:.1} s: max {:.4} mm per frame (guide {} point {}), mean {:.5}",
            0.5 * (i + 1) as f64,
            1e3 * worst.0,
            worst.1 / n,
            worst.1 % n,
            1e3 * sum / (points * half.len()) as f64
        );
    }
}
