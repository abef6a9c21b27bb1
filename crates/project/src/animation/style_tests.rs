use lovelock_base::settings::Settings;
use lovelock_style::operations::{Curl, Wave};
use lovelock_style::{Layer, Mask, MaskPart, MaskRegion};

use super::*;
use crate::history::History;
use crate::project::Project;
use crate::tracks::{Key, Track};

/// A project with the layers curl (1) and wave (2).
fn layered() -> Project {
    let mut project = Project::default();
    project.hair.stack.push(Layer::of(Curl::default()));
    let mask = Mask::of(MaskPart::region(MaskRegion::Left));
    project.hair.stack.push(Layer { name: "Ends".to_owned(), mask, ..Layer::of(Wave::default()) });
    project
}

fn track(target: &str, keys: &[(f64, f64)]) -> Track {
    let keys = keys.iter().map(|&(secs, value)| Key { secs, value: vec![value] }).collect();
    Track { keys, ..Track::new(target) }
}

#[test]
fn layers_follow_tracks_by_their_numbers() {
    let mut project = layered();
    project.timeline.tracks = vec![
        track("hair/stack/1/weight", &[(0.0, 0.0), (2.0, 1.0)]),
        track("hair/stack/2/wave/height", &[(0.0, 0.01), (2.0, 9.0)]),
        track("hair/stack/7/weight", &[(0.0, 0.3)]),
        track("hair/groom/length", &[(0.0, 0.3)]),
    ];
    let tracks = StyleTracks::of(&project).expect("tracks");
    let half = tracks.stack_with(&project.hair.stack, &tracks.values_at(1.0));
    assert_eq!(half.layers[0].weight, 0.5);
    assert_eq!(project.at(1.0).hair.stack, half, "the window shows what is simulated");
    assert_eq!(project.at(1.0).hair.groom, project.hair.groom, "growing follows no track");
    // Out of range.
    let end = tracks.stack_with(&project.hair.stack, &tracks.values_at(2.0));
    assert_eq!(end, end.clone().clamped());
    assert_ne!(end.layers[1].operation, project.hair.stack.layers[1].operation);
    // Moved in the list, the layer keeps its track.
    project.hair.stack.move_to(1, 2, None);
    let moved = tracks.stack_with(&project.hair.stack, &tracks.values_at(1.0));
    assert_eq!((moved.layers[1].id, moved.layers[1].weight), (1, 0.5));
    project.timeline.tracks.truncate(1);
    project.timeline.tracks[0].muted = true;
    assert_eq!(StyleTracks::of(&project), None);
}

#[test]
fn tracks_of_layers_are_called_by_their_layers() {
    let project = layered();
    for (target, label) in [
        ("hair/stack/1/curl/radius", "Curl radius"),
        ("hair/stack/1/weight", "Curl weight"),
        ("hair/stack/2/wave/height", "Ends height"),
        ("hair/stack/9/weight", "Layer 9 weight"),
        ("simulation/gravity", "Gravity"),
    ] {
        assert_eq!(Track::new(target).label_in(&project.hair.stack), label);
    }
}

#[test]
fn moving_numbers_of_layers_writes_keys_and_one_undo_removes_them() {
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    let mut history = History::new(layered());
    for i in 0..30 {
        let secs = 1.0 + f64::from(i) / 60.0;
        let now = Moment { secs, playing: true, held: i < 29, clock_secs: secs };
        let base = history.project().clone();
        let shown = overdub.shown(&base, secs);
        let mut edited = shown.clone();
        edited.hair.stack.layers[0].weight = i as f32 / 30.0;
        let project = overdub.edit(&base, &shown, edited, now);
        history.edit("Layers", Some(1), project);
    }
    let project = history.project();
    assert_eq!(project.timeline.tracks[0].target, "hair/stack/1/weight");
    assert!((project.at(1.25).hair.stack.layers[0].weight - 0.5).abs() < 0.05);
    assert_eq!(project.hair.stack, layered().hair.stack, "the project's own numbers stay");
    history.undo();
    assert_eq!(**history.project(), layered());
}

#[test]
fn a_mask_with_other_parts_writes_no_keys_and_removed_layers_leave_no_track() {
    let mut overdub = Overdub::default();
    overdub.set_armed(true);
    let base = layered();
    let now = Moment { secs: 1.0, playing: true, held: true, clock_secs: 1.0 };
    let mut edited = base.clone();
    let soft = MaskPart { softness: 0.0, ..MaskPart::region(MaskRegion::Front) };
    edited.hair.stack.layers[1].mask.parts.insert(0, soft);
    let made = overdub.edit(&base, &base, edited, now);
    assert!(made.timeline.tracks.is_empty(), "{:?}", made.timeline.tracks);
    let mut tracked = layered();
    tracked.timeline.tracks =
        vec![track("hair/stack/1/weight", &[(0.0, 0.5)]), track("hair/stack/2/weight", &[(0.0, 0.5)])];
    let shown = tracked.at(1.0);
    let mut edited = shown.clone();
    edited.hair.stack.remove(2);
    let made = Overdub::default().edit(&tracked, &shown, edited, Moment { playing: false, ..now });
    let left: Vec<&str> = made.timeline.tracks.iter().map(|track| track.target.as_str()).collect();
    assert_eq!(left, ["hair/stack/1/weight"]);
}
