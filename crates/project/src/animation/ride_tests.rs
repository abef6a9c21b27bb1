//! Recording passes driven by a wheel, and passes that last for minutes.

use super::*;
use crate::project::Project;
use crate::tracks::{Key, Track};
use lovelock_base::settings::Settings;

/// A project whose camera distance has a constant track of 1 m.
fn still_camera() -> Project {
    let key = |secs| Key { secs, value: vec![1.0] };
    let mut project = Project::default();
    project.timeline.tracks =
        vec![Track { keys: vec![key(0.0), key(2000.0)], ..Track::new("camera/distance") }];
    project
}

fn distance(project: &Project, secs: f64) -> f64 {
    f64::from(project.at(secs).camera.distance)
}

/// Sixty passes per second from `from` to `to`; `hand` returns the camera distance and whether the control is held.
fn ride(
    overdub: &mut Overdub,
    mut base: Project,
    [from, to]: [f64; 2],
    mut hand: impl FnMut(f64, &Project) -> (Option<f32>, bool),
) -> Project {
    for i in 0..=((to - from) * 60.0).round() as usize {
        let secs = from + i as f64 / 60.0;
        let shown = overdub.shown(&base, secs);
        let mut edited = shown.clone();
        let (put, held) = hand(secs, &shown);
        edited.camera.distance = put.unwrap_or(edited.camera.distance);
        base = overdub.edit(&base, &shown, edited, Moment { secs, playing: true, held, clock_secs: secs });
    }
    base
}

#[test]
fn wheel_notches_are_one_pass_until_the_wheel_rests() {
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    // Each notch adds half a metre to the shown value, at 1, 1.25 and 1.5 s.
    let notch = |times: &'static [f64]| {
        move |secs: f64, shown: &Project| {
            let turned = times.iter().any(|time| (secs - time).abs() < 1e-6);
            (turned.then_some(shown.camera.distance + 0.5), false)
        }
    };
    let project = ride(&mut overdub, still_camera(), [0.9, 1.85], notch(&[1.0, 1.25, 1.5]));
    assert_eq!(overdub.writes().count(), 1, "the pass may continue");
    let project = ride(&mut overdub, project, [1.85 + 1.0 / 60.0, 2.5], notch(&[]));
    assert_eq!(overdub.writes().count(), 0);
    for (secs, wanted) in
        [(0.9, 1.0), (1.1, 1.5), (1.4, 2.0), (1.6, 2.5), (1.88, 2.5), (2.0, 1.0), (3.0, 1.0)]
    {
        let at = distance(&project, secs);
        assert!((at - wanted).abs() < 1e-6, "{at} at {secs}, wanted {wanted}");
    }
    // Notches further apart than the resting time are separate passes; in between the track is unchanged.
    let project = ride(&mut overdub, still_camera(), [0.9, 3.0], notch(&[1.0, 2.0]));
    for (secs, wanted) in [(1.2, 1.5), (1.7, 1.0), (2.2, 1.5), (2.7, 1.0)] {
        let at = distance(&project, secs);
        assert!((at - wanted).abs() < 1e-6, "{at} at {secs}, wanted {wanted}");
    }
    // Releasing ends a held control, and pausing ends all.
    let project = ride(&mut overdub, still_camera(), [1.0, 1.5], |secs, _| (Some(2.0), secs < 1.4));
    assert!((distance(&project, 1.39) - 2.0).abs() < 1e-6 && (distance(&project, 1.45) - 2.0).abs() < 1e-6);
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    let project = ride(&mut overdub, still_camera(), [1.0, 1.1], notch(&[1.0]));
    let shown = overdub.shown(&project, 1.1);
    let still = Moment { secs: 1.1, playing: false, held: false, clock_secs: 1.1 };
    overdub.edit(&project, &shown, shown.clone(), still);
    assert_eq!(overdub.writes().count(), 0);
}

#[test]
fn an_undone_track_is_not_written_again() {
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    let before = still_camera();
    let project = ride(&mut overdub, before.clone(), [1.0, 1.2], |_, _| (Some(2.0), false));
    assert!(project != before && overdub.writes().count() == 1);
    overdub.let_go();
    let after = ride(&mut overdub, before.clone(), [1.2, 1.4], |_, _| (None, false));
    assert_eq!(after, before);
}

#[test]
fn a_pass_of_minutes_is_written_to_its_end_long_suite() {
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    // Two hundred seconds are 12,000 passes.
    let slow = |secs: f64| 3.0 + (0.05 * secs).sin() + 0.3 * (0.9 * secs).sin();
    let project =
        ride(&mut overdub, still_camera(), [1.0, 201.0], |secs, _| (Some(slow(secs) as f32), secs < 201.0));
    let track = &project.timeline.tracks[0];
    let off = (0..2000).map(|i| 1.0 + 0.1 * f64::from(i));
    let off = off.map(|secs| (distance(&project, secs) - slow(secs)).abs()).fold(0.0, f64::max);
    println!("{} keys, {off} off", track.keys.len());
    // 0.2 % of the range of 3.3 m; measured 0.0060 m.
    assert!(off < 0.002 * 3.3 + 1e-5, "{off}");
    assert!(track.keys.len() < Track::MAX_KEYS / 2, "{}", track.keys.len());
    assert!((distance(&project, 300.0) - 1.0).abs() < 1e-6, "after the pass the track is unchanged");

    // Noise that cannot be thinned: the end is still written, and the number of keys stays within its limit.
    let mut state = 1_u64;
    let mut shaken = |secs: f64, _: &Project| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (Some(2.0 + (state >> 40) as f32 / (1_u32 << 24) as f32), secs < 201.0)
    };
    let project = ride(&mut overdub, still_camera(), [1.0, 201.0], &mut shaken);
    let track = &project.timeline.tracks[0];
    println!("{} keys of noise", track.keys.len());
    assert!(track.keys.len() <= Track::MAX_KEYS / 2 + 8);
    let late = track.keys.iter().filter(|key| (190.0..201.0).contains(&key.secs)).count();
    assert!(late > 100, "the end is written: {late} keys");
    assert_eq!(project.clamped().timeline, project.timeline, "reading it again changes nothing");
}
