use lovelock_base::settings::{Value, find};
use lovelock_shadow::ShadowMethod;

use super::*;
use crate::project::Project;
use crate::tracks::Track;

#[test]
fn a_key_is_set_replaced_and_removed_with_its_track() {
    let mut project = Project::default();
    let before = project.clone();
    assert!(project.set_key("lights/0/intensity", 1.0, vec![2.0]));
    assert!(project.set_key("lights/0/intensity", 2.0, vec![4.0]));
    // Within half a step it is the same key.
    assert!(project.set_key("lights/0/intensity", 1.0 + 0.9 * Track::AT_SECS, vec![3.0]));
    let [track] = project.timeline.tracks.as_slice() else { panic!("{:?}", project.timeline.tracks) };
    assert_eq!(track.keys.iter().map(|key| key.value[0]).collect::<Vec<_>>(), [3.0, 4.0]);
    assert!((project.at(2.0).lights[0].intensity - 4.0).abs() < 1e-6);
    assert!(!project.remove_key("lights/0/intensity", 1.5), "there is none");
    assert!(project.remove_key("lights/0/intensity", 1.0));
    assert!(project.remove_key("lights/0/intensity", 2.0));
    assert_eq!(project, before, "the last key takes its track along");
    assert!(!project.set_key("lights/0/intensity", f64::NAN, vec![1.0]) && project == before);
    assert!(project.set_key("lights/0/intensity", 1.0, vec![2.0]));
    let before = project.clone();
    assert!(!project.set_key("lights/0/intensity", f64::NAN, vec![1.0]) && project == before);
}

#[test]
fn switches_and_choices_keep_their_value_from_key_to_key() {
    let mut project = Project::default();
    let path = "shadow.method";
    let (info, _) = find(&project, path).expect("a setting");
    let number = |method: ShadowMethod| {
        let mut project = Project::default();
        project.shadow.method = method;
        key_numbers(info, find(&project, path).expect("a setting").1)
    };
    let [from, to] = [ShadowMethod::ALL[0], ShadowMethod::ALL[3]];
    assert!(project.set_key("shadow/method", 1.0, number(from)));
    assert!(project.set_key("shadow/method", 3.0, number(to)));
    assert!(project.set_key("lights/0/enabled", 1.0, vec![1.0]));
    assert!(project.set_key("lights/0/enabled", 3.0, vec![0.0]));
    for (secs, method, on) in
        [(0.0, from, true), (1.0, from, true), (2.9, from, true), (3.0, to, false), (9.0, to, false)]
    {
        let at = project.at(secs);
        assert_eq!((at.shadow.method, at.lights[0].enabled), (method, on), "{secs}");
    }
    // Smoothing would show the choices between the two.
    let mut smooth = project.timeline.tracks[0].clone();
    smooth.smooth();
    assert_eq!(smooth, project.timeline.tracks[0]);
    assert!(key_numbers(info, Value::None).is_empty());
}

#[test]
fn recording_one_control_leaves_the_others_alone() {
    let base = Project::default();
    let mut overdub = Overdub::default();
    overdub.arm_only("camera/distance".to_owned());
    let moved = |overdub: &mut Overdub, base: &Project, now: Moment| {
        let shown = overdub.shown(base, now.secs);
        let mut edited = shown.clone();
        edited.camera.distance = 3.0;
        edited.lights[0].intensity = 9.0;
        overdub.edit(base, &shown, edited, now)
    };
    let playing = Moment { secs: 1.0, playing: true, held: true, clock_secs: 1.0 };
    let ridden = moved(&mut overdub, &base, playing);
    let targets: Vec<_> = ridden.timeline.tracks.iter().map(|track| track.target.as_str()).collect();
    assert_eq!(targets, ["camera/distance"]);
    assert_eq!(ridden.lights[0].intensity, 9.0, "an ordinary change");
    // While paused it sets a key, the first one included.
    overdub.let_go();
    let paused = Moment { playing: false, ..playing };
    let keyed = moved(&mut overdub, &base, paused);
    let [track] = keyed.timeline.tracks.as_slice() else { panic!("{:?}", keyed.timeline.tracks) };
    assert_eq!((track.keys.len(), track.keys[0].value[0]), (1, 3.0));
    assert_eq!(keyed.camera, base.camera, "the project's own value stays");
    // Control: recording all of them writes both during playback.
    overdub.set_armed(true);
    assert_eq!(moved(&mut overdub, &base, playing).timeline.tracks.len(), 2);
}
