//! Exported curves equal the simulation: USD is read by our importer, glTF by our character reader.

use std::ops::ControlFlow;
use std::path::Path;

use glam::Vec3;
use lovelock_groom::{Strands, load_hair};
use lovelock_motion::{Pose, Skin, load_character, pose_at, skin};
use lovelock_project::error::ProjectError;
use lovelock_session::take::project_of_take;
use lovelock_session::testing::{played, recorded, small_project};

use super::take_tests::folder;
use super::*;

/// Largest allowed distance of a point, metres.
const LIMIT_M: f32 = 1e-4;
/// Largest allowed distance of a point of the body, whose joints have the digits of the file, metres.
const BODY_LIMIT_M: f32 = 1e-5;

fn write(take: &Path, name: &str, curves: Option<CurveSource>) -> Result<CurveRecordReport, ProjectError> {
    let mut request = RecordRequest {
        out: take.with_file_name(name),
        frames: Some(3..9),
        fps: Some(30.0),
        curves,
        ..RecordRequest::default()
    };
    request.access.pick(take);
    let (project, _) = project_of_take(take)?;
    record_curves(&project, &request, &mut |_| ControlFlow::Continue(()))
}

fn off(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn curves_come_back_as_they_were_played() {
    let (_folder, path) = folder();
    recorded(&path, &small_project(), 24, |_, _| {});
    let mut player = played(&path);
    let [first, last] = [3.0, 8.0].map(|frame: f64| player.snapshot(frame / 30.0).expect("an instant"));
    let points = |strands: &Strands| (0..strands.points()).map(|i| strands.point(i)).collect::<Vec<_>>();
    for (name, source) in [("a.usdc", None), ("b.usda", Some(CurveSource::Guides))] {
        let report = write(&path, name, source).expect(name);
        assert_eq!((report.frames, report.first_frame, report.fps), (6, 3, 30.0), "{name}");
        let [wanted, other] = [&first, &last].map(|snapshot| {
            if source.is_some() {
                let guides = &snapshot.guides.guides;
                return (0..guides.x.len())
                    .map(|i| Vec3::new(guides.x[i], guides.y[i], guides.z[i]))
                    .collect();
            }
            let mut strands = Strands::default();
            snapshot.interpolate(&mut strands);
            [points(&strands), points(&snapshot.skin_strands)].concat()
        });
        let hair = load_hair(&path.with_file_name(name)).expect(name);
        assert_eq!(
            (hair.strands() as u64, hair.points.len() as u64),
            (report.strands, report.points),
            "{name}"
        );
        let found = off(&hair.points, &wanted);
        assert!(found <= LIMIT_M, "{name}: {found} m off");
        assert!(off(&hair.points, &other) > 10.0 * LIMIT_M, "{name}: the control: another frame");
    }

    let report = write(&path, "c.glb", None).expect("a glTF");
    assert_eq!(report.curves, "guides");
    let character = load_character(&path.with_file_name("c.glb")).expect("a character");
    let (mut pose, mut body) = (Pose::default(), Skin::default());
    let clip = character.clips.first().expect("a clip");
    for (secs, wanted, other) in [(0.0, &first, &last), (5.0 / 30.0 - 1e-6, &last, &first)] {
        pose_at(&character.body, Some(clip), secs, &mut pose);
        skin(&character.body, &pose, &mut body);
        // The vertices are those of the scene, also where several materials share them.
        let found = off(&body.positions, &wanted.skin.positions);
        assert!(found <= BODY_LIMIT_M, "{secs} s: the body is {found} m off");
        assert!(off(&body.positions, &other.skin.positions) > 10.0 * LIMIT_M, "{secs} s: the control");
    }
    assert_eq!(character.body.skin.morphs.len(), first.scene.body.skin.morphs.len());
}

#[test]
fn hair_that_changes_on_the_way_is_followed_or_refused_in_words() {
    let (_folder, path) = folder();
    recorded(&path, &small_project(), 24, |step, project| {
        if step == 10 {
            project.hair.groom.length *= 1.2;
        }
    });
    write(&path, "longer.usdc", None).expect("the same strands, longer");

    let other = path.with_file_name("other.take");
    recorded(&other, &small_project(), 24, |step, project| {
        if step == 10 {
            project.hair.groom.strands_per_wisp += 2;
        }
    });
    write(&other, "guides.usdc", Some(CurveSource::Guides)).expect("the same guides");
    let error = write(&other, "strands.usdc", None).expect_err("other strands");
    assert!(error.to_string().contains("frame 5: the structure of the hair changes"), "{error}");
    assert_eq!(error.exit_code(), 2);
    assert!(
        !path.with_file_name("strands.usdc").exists()
            && !path.with_file_name("strands.usdc.partial").exists()
    );
}

#[test]
fn options_of_pictures_frames_outside_and_cancels_are_told() {
    let (_folder, path) = folder();
    recorded(&path, &small_project(), 24, |_, _| {});
    let (project, _) = project_of_take(&path).expect("a take");
    let mut request =
        RecordRequest { out: path.with_file_name("a.usdc"), fps: Some(30.0), ..RecordRequest::default() };
    request.access.pick(&path);
    let run = |request: RecordRequest| record_curves(&project, &request, &mut |_| ControlFlow::Continue(()));
    for (request, wanted) in [
        (RecordRequest { size: Some((64, 48)), ..request.clone() }, "--size"),
        (RecordRequest { label: true, ..request.clone() }, "--label"),
        (RecordRequest { frames: Some(5..5), ..request.clone() }, "an empty range"),
        (RecordRequest { frames: Some(0..40), ..request.clone() }, "frames 0..40"),
        (RecordRequest { frames: Some(0..1), out: path.with_file_name("a.fbx"), ..request.clone() }, ".usdc"),
    ] {
        let error = run(request).expect_err(wanted);
        assert!(error.to_string().contains(wanted) && error.exit_code() == 2, "{error}");
    }
    let cancelled = record_curves(&project, &request, &mut |progress| match progress {
        lovelock_session::progress::Progress::Frame { done: 2, .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert!(matches!(cancelled, Err(ProjectError::Cancelled)));
    let left = std::fs::read_dir(path.parent().expect("a folder")).expect("a folder").count();
    assert_eq!(left, 1, "the take alone");
}
