//! Takes in which the number of guides changes. No test here needs a graphics adapter.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_record::{MAX_ERROR_M, TakeFrame, TakeReader, TakeWriter};

use super::TakePlayer;
use super::tests::folder;
use crate::testing::{farthest, guides, played, recorded, regrown, small_project};
use crate::window_device::WindowDevice;

#[test]
fn hair_with_other_guides_is_recorded_on_and_plays_in_any_order() {
    let (_folder, path) = folder();
    let frames = regrown(&path);
    let (few, many) = (guides(&frames[0]), guides(&frames[50]));
    assert!(few < many && guides(&frames[80]) == few);
    let mut player = played(&path);
    for n in [0, 39, 40, 41, 69, 70, 99, 71, 40, 39, 12] {
        let frame = player.snapshot(n as f64 / 60.0).expect("a frame");
        let off = farthest(&frame, &frames[n]);
        assert!(f64::from(off) <= MAX_ERROR_M, "frame {n} is {off} m off");
        assert_eq!(guides(&frame), frame.scene.style.guides.count(), "frame {n}");
    }
    // Between frames with different guides, the nearer one is shown with its own hairstyle.
    for (place, wanted) in [(39.3, 39), (39.7, 40), (69.5, 70), (69.4, 69)] {
        let frame = player.snapshot(place / 60.0).expect("an instant");
        assert!(f64::from(farthest(&frame, &frames[wanted])) <= MAX_ERROR_M, "{place}");
        assert_eq!(guides(&frame), frame.scene.style.guides.count(), "{place}");
    }
}

#[test]
fn damage_near_the_change_never_shows_guides_on_other_hair() {
    let (_folder, path) = folder();
    regrown(&path);
    let bytes = std::fs::read(&path).expect("a file");
    let mut lost = 0;
    for place in lovelock_testkit::suite::sample(1..10, 3) {
        let mut changed = bytes.clone();
        changed[bytes.len() * place / 10] ^= 4;
        std::fs::write(&path, changed).expect("a file");
        let (mut player, _) = TakePlayer::open(&path, &Access::new()).expect("a take that plays");
        // From the end, because the reader then knows nothing about earlier parts.
        for half in (0..200).rev() {
            let frame = player.snapshot(f64::from(half) / 120.0).expect("something to show");
            assert_eq!(guides(&frame), frame.scene.style.guides.count(), "{place}: {half}");
        }
        lost += player.notices().len();
    }
    assert!(lost > lovelock_testkit::suite::cases(&[0], &[3])[0], "the control: frames were lost");
}

#[test]
fn a_part_of_a_take_with_other_guides_than_its_project_is_refused() {
    let (_folder, path) = folder();
    let frames = recorded(&path, &small_project(), 60, |_, _| {});
    let header = TakeReader::open(&path).expect("a take").header().clone();
    // The same project throughout but other guides from frame 30 on, as if a file had changed on disk.
    let other = path.with_file_name("other.take");
    let mut writer = TakeWriter::create(&other, header).expect("a take");
    let mut frame = TakeFrame::default();
    for (n, snapshot) in frames.iter().enumerate() {
        frame.guides.clone_from(&snapshot.guides);
        if n >= 30 {
            frame.guides.guides.points_per_guide -= 1;
            let kept = frames[0].guides.guides.count() * frame.guides.guides.points_per_guide;
            let to = &mut frame.guides.guides;
            for axis in [&mut to.x, &mut to.y, &mut to.z] {
                axis.truncate(kept);
            }
        }
        writer.set_layout(guides(snapshot), frame.guides.guides.points_per_guide).expect("a size");
        writer.push(&frame).expect("a frame");
    }
    writer.finish().expect("a whole take");
    let mut player = played(&other);
    player.snapshot(29.0 / 60.0).expect("what fits");
    let error = player.snapshot(30.0 / 60.0).expect_err("what does not");
    assert!(error.to_string().contains("its hairstyle has changed"), "{error}");
    player.snapshot(0.0).expect("what fits");
}

#[test]
fn the_thread_records_other_guides_and_stops_without_hair() {
    use lovelock_testkit::wait::wait_until;

    use crate::worker::{Event, Worker};
    let (_folder, path) = folder();
    let mut project = small_project();
    let worker =
        Worker::start(Arc::new(project.clone()), Access::new(), &WindowDevice::default(), Arc::new(|| {}))
            .expect("threads");
    let frames = || worker.take_progress().map_or(0, |take| take.frames);
    wait_until("a scene", || worker.frame().is_some());
    worker.record_take(&path);
    wait_until("some frames", || frames() > 5);
    project.hair.groom.wisps = 21;
    worker.set_project(Arc::new(project.clone()), Access::new());
    let mut style = None;
    wait_until("the other hair", || {
        match worker.poll_event() {
            Some(Event::Loaded { scene, .. }) => style = Some(scene),
            Some(Event::TakeSaved { .. } | Event::TakeFailed { .. }) => panic!("the take ended"),
            _ => {}
        }
        style.as_ref().is_some_and(|scene| scene.style.guides.count() > 60)
    });
    let before = frames();
    wait_until("frames of it", || frames() > before + 5);
    // A scene without hair.
    let scene = style.expect("a scene");
    let mut bald = (*scene.style).clone();
    bald.guides = lovelock_groom::Guides { points_per_guide: 2, ..Default::default() };
    bald.strands = lovelock_groom::StrandSet { first_point: vec![0], ..Default::default() };
    bald.wisps.clear();
    worker.put_scene(Arc::new(crate::scene::Scene { style: Arc::new(bald), ..(*scene).clone() }));
    let mut because = None;
    wait_until("the end of the take", || {
        if let Some(Event::TakeSaved { because: why, .. }) = worker.poll_event() {
            because = why;
        }
        because.is_some()
    });
    assert_eq!(because.as_deref(), Some("there is no hair any more"));
    drop(worker);
    let counts: Vec<u32> = TakeReader::open(&path)
        .expect("a take")
        .layouts()
        .expect("a take")
        .iter()
        .map(|l| l.guides)
        .collect();
    assert_eq!(counts, [48, 63]);
    let mut player = played(&path);
    let last = player.duration_secs();
    assert_eq!(guides(&player.snapshot(last).expect("a frame")), 63);
    assert_eq!(
        Project { take: lovelock_project::project::TakeSection::default(), ..player.project().clone() },
        small_project()
    );
}
