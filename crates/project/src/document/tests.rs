use super::*;
use crate::error::{Place, ProblemKind};
use crate::styles::shipped;
use crate::tracks::{Key, Track};

const STILL: Moment = Moment { secs: 1.0, playing: false, held: false, clock_secs: 0.0 };

fn animated() -> Document {
    let mut project = Project::default();
    let keys = [(0.0, 1.0), (2.0, 3.0)].map(|(secs, value)| Key { secs, value: vec![value] });
    project.timeline.tracks = vec![Track { keys: keys.into(), ..Track::new("camera/distance") }];
    Document::new(project, None)
}

#[test]
fn the_title_marks_unsaved_changes() {
    let mut document = Document::new(Project::default(), None);
    assert_eq!(document.title(), "untitled");
    document.change("camera", |project| project.camera.distance = 3.0);
    assert_eq!(document.title(), "● untitled");
    document.mark_saved(Path::new("/a/my hair.ron"));
    assert_eq!(document.title(), "my hair");
}

#[test]
fn the_edits_of_a_gesture_are_one_step_and_a_change_is_its_own() {
    let mut document = Document::new(Project::default(), None);
    for distance in [2.5, 3.0] {
        let project = Project::clone(document.project());
        document.edit(
            "camera",
            Project { camera: crate::project::CameraSection { distance, ..project.camera }, ..project },
        );
    }
    assert_eq!(document.history().undo_len(), 1);
    assert!(document.change("camera", |project| project.camera.distance = 4.0));
    assert!(document.change("camera", |project| project.camera.distance = 5.0));
    assert!(!document.change("camera", |project| project.camera.distance = 5.0), "nothing changes");
    assert_eq!(document.history().undo_len(), 3);
    assert!(document.undo() && document.undo() && document.undo() && !document.undo());
    assert_eq!(document.project().camera, Project::default().camera);
}

#[test]
fn a_project_at_a_time_is_the_same_allocation_until_something_changes() {
    let mut document = animated();
    let at = document.at(1.0);
    assert_eq!(at.camera.distance, 2.0);
    assert!(Arc::ptr_eq(&at, &document.at(1.0)));
    assert!(!Arc::ptr_eq(&at, &document.at(1.5)), "control: another time");
    document.change("look", |project| project.look.grey = 0.5);
    assert_eq!(document.at(1.0).look.grey, 0.5);
    let mut still = Document::new(Project::default(), None);
    assert!(Arc::ptr_eq(&still.at(1.0), &still.at(2.0)), "without tracks there is one project");
}

#[test]
fn an_edit_of_a_value_with_a_track_sets_a_key() {
    let mut document = animated();
    let refused = document.change_seen(STILL, |project| project.camera.distance = 2.5);
    assert_eq!(refused, None);
    assert_eq!(document.at(1.0).camera.distance, 2.5);
    assert_eq!(document.project().timeline.tracks[0].keys.len(), 3);
    assert_eq!(document.history().undo_label(), Some("camera"));
}

#[test]
fn undo_says_that_a_pane_was_added_or_removed() {
    let mut document = Document::new(Project::default(), None);
    let panes = document.project().compare.panes.len();
    document.change_seen(STILL, |project| project.compare.panes.extend_from_within(..1));
    assert_eq!(document.project().compare.panes.len(), panes + 1);
    assert_eq!(document.history().undo_label(), Some("add pane"));
    document.change_seen(STILL, |project| project.compare.panes.truncate(panes));
    assert_eq!(document.history().undo_label(), Some("remove pane"));
    document.change_seen(STILL, |project| project.compare.panes.swap(0, 1));
    assert_eq!(document.history().undo_label(), Some("comparison"));
}

#[test]
fn a_tried_style_is_shown_and_not_applied() {
    let mut document = animated();
    let before = Arc::clone(document.project());
    let style = &shipped::by_id("curly").expect("shipped").style;
    let tried = document.shown(1.0, Some(("curly", style, StyleParts::ALL)));
    assert!(document.is_preview() && Arc::ptr_eq(document.project(), &before));
    assert!(tried.project.hair != before.hair && tried.drawn.camera.distance == 2.0);
    let again = document.shown(1.0, Some(("curly", style, StyleParts::ALL)));
    assert!(Arc::ptr_eq(&tried.project, &again.project) && Arc::ptr_eq(&tried.drawn, &again.drawn));
    let own = document.shown(1.0, None);
    assert!(Arc::ptr_eq(&own.project, &before) && !document.is_preview());
}

#[test]
fn a_morph_is_drawn_with_its_colours_by_one_allocation() {
    let mut project = Project::default();
    project.start_morph(&shipped::by_id("curly").expect("shipped").style);
    project.hair.morph.amount = 0.5;
    let mut document = Document::new(project, None);
    let shown = document.shown(0.0, None);
    assert!(shown.drawn.look != document.project().look, "the colours between the styles");
    assert!(Arc::ptr_eq(&shown.drawn, &document.shown(0.0, None).drawn));
}

#[test]
fn another_project_has_no_steps_back_and_numbers_its_gestures_on() {
    let mut document = animated();
    document.overdub_mut().set_armed(true);
    document.change("look", |project| project.look.grey = 0.5);
    let gesture = document.gesture();
    document.replace(Project::default(), Some("/a/b.lovelock".into()));
    assert!(document.gesture() > gesture && document.overdub().is_armed());
    assert!(!document.undo() && !document.is_modified());
    assert_eq!(document.path(), Some(Path::new("/a/b.lovelock")));
    document.overdub_mut().arm_only("camera/distance".to_owned());
    document.replace(Project::default(), None);
    assert!(!document.overdub().is_armed(), "one control alone was recorded, of the project before");
}

#[test]
fn a_file_that_is_not_loaded_leaves_the_project_and_its_undo_steps() {
    let path = Path::new("/missing/body.glb");
    let mut document = Document::new(Project::default(), None);
    document.change("camera", |project| project.camera.distance = 3.0);
    document.undo();
    let before = Arc::clone(document.project());
    document.try_file("file", Place::Body, path, |project| project.set_body_file(path));
    let loaded = Arc::clone(document.project());
    let problems =
        [Problem::new(Place::Body, ProblemKind::NotLoaded, "/missing/body.glb: not found".to_owned())];
    // A load of the project before says nothing about the file.
    assert_eq!(document.take_problems(&before, &problems), problems);
    assert_eq!(document.take_problems(&before, &[]), []);
    assert!(Arc::ptr_eq(document.project(), &loaded));
    assert_eq!(document.take_problems(&loaded, &problems), problems);
    assert!(Arc::ptr_eq(document.project(), &before));
    assert_eq!((document.history().undo_len(), document.history().redo_len()), (0, 1));
    // Opened again, it is reported again.
    document.try_file("file", Place::Body, path, |project| project.set_body_file(path));
    let loaded = Arc::clone(document.project());
    assert_eq!(document.take_problems(&loaded, &problems), problems);
    // One that was loaded stays whatever follows.
    document.try_file("file", Place::Body, path, |project| project.set_body_file(path));
    let loaded = Arc::clone(document.project());
    document.take_problems(&loaded, &[]);
    document.refuse_unloaded();
    assert!(Arc::ptr_eq(document.project(), &loaded));
}

#[test]
fn a_file_that_the_program_was_started_with_leaves_no_step() {
    let path = Path::new("/missing/hair.abc");
    let mut project = Project::default();
    project.set_hair_file(path);
    let mut document = Document::new(project, None);
    document.try_part(Place::Hair, path, Arc::new(Project::default()));
    document.refuse_unloaded();
    assert_ne!(document.project().hair.file.as_ref().map(|file| file.path.as_path()), Some(path));
    assert!(!document.undo() && !document.is_modified());
}

#[test]
fn a_take_that_is_not_loaded_gives_the_project_its_file_back() {
    let (path, saved) = (Path::new("/missing/dance.take"), Path::new("/missing/hair.lovelock"));
    let mut document = Document::new(Project::default(), Some(saved.to_owned()));
    let before = Arc::clone(document.project());
    document.try_file("take", Place::Take, path, |project| project.set_take(path));
    document.detach();
    document.refuse_unloaded();
    assert!(Arc::ptr_eq(document.project(), &before));
    assert_eq!(document.path(), Some(saved));
}

#[test]
fn undo_of_an_opened_take_returns_to_the_file_of_the_project() {
    let (path, saved) = (Path::new("/a/dance.take"), Path::new("/a/hair.lovelock"));
    let mut document = Document::new(Project::default(), Some(saved.to_owned()));
    document.change("look", |project| project.look.grey = 0.5);
    document.change("take", |project| project.set_take(path));
    document.detach();
    document.change("look", |project| project.look.grey = 0.1);
    let steps = [false, false, true, true].map(|redo| {
        assert!(if redo { document.redo() } else { document.undo() });
        document.path().map(Path::to_owned)
    });
    assert_eq!(steps, [None, Some(saved.to_owned()), None, None]);
    // Saved under a name of its own, it keeps that name.
    let other = Path::new("/a/take.lovelock");
    document.mark_saved(other);
    for _ in 0..3 {
        assert!(document.undo());
        assert_eq!(document.path(), Some(other));
    }
    assert!(!document.undo());
}

#[test]
fn a_sound_is_judged_by_itself() {
    let path = Path::new("/missing/dance.ogg");
    let mut document = Document::new(Project::default(), None);
    for stays in [false, true] {
        document.try_file("file", Place::Sound, path, |project| project.set_sound_file(path));
        document.refuse_unloaded();
        assert!(
            document.project().sound.file.is_some(),
            "the scene was not loaded, which is no matter of the sound"
        );
        document.end_sound_trial(stays);
        assert_eq!(document.project().sound.file.is_some(), stays);
    }
}
