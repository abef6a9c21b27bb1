//! Journals that are written, left behind and recovered.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

use super::folder::beside;
use super::{Event, Journal, Journals, Picture};
use crate::Project;
use crate::document::Document;
use crate::project::{load_project, save_project};

const WITHIN: Duration = Duration::from_secs(20);

/// A folder with the user's journals, and one with a saved project.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("work")).expect("a folder");
        save_project(&folder.path().join("work/red hair.lovelock"), &Project::default()).expect("saved");
        Self { folder }
    }

    fn project(&self) -> PathBuf {
        self.folder.path().join("work/red hair.lovelock")
    }

    fn journals(&self) -> Journals {
        Journals::new(self.folder.path().join("state/journals"))
    }

    fn open(&self) -> (Document, Journal) {
        let project = load_project(&self.project()).expect("a project").0;
        (Document::new(project, Some(self.project())), Journal::new(self.journals()).expect("a thread"))
    }

    fn files(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path().join(folder)).into_iter().flatten();
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// Leaves a journal as a crash does.
fn crash(document: &Document, mut journal: Journal) {
    assert!(journal.flush(document, WITHIN), "{:?}", journal.events());
}

fn distance(document: &mut Document, value: f32) {
    document.change("camera", |project| project.camera.distance = value);
}

#[test]
fn what_was_not_saved_is_found_and_recovered_with_its_undo_and_redo_steps() {
    let place = Place::new();
    let (mut document, mut journal) = place.open();
    assert!(journal.follow(&document).is_none());
    for k in 1..=30 {
        distance(&mut document, 1.0 + 0.1 * k as f32);
        journal.follow(&document);
    }
    document.undo();
    document.undo();
    let states = |mut document: Document| {
        let present = Project::clone(document.project());
        let mut undone = Vec::new();
        let redo: Vec<_> =
            std::iter::from_fn(|| document.redo().then(|| Project::clone(document.project()))).collect();
        while document.undo() {
            undone.push((
                Project::clone(document.project()),
                document.history().redo_label().map(str::to_owned),
            ));
        }
        (present, redo, undone)
    };
    let expected = states(document.clone());
    journal.keep_picture(Picture { width: 2, height: 1, rgba: vec![200; 8] });
    crash(&document, journal);
    assert_eq!(place.files("work"), [".red hair.lovelock.journal", "red hair.lovelock"]);
    let found = place.journals().unsaved(None);
    assert_eq!(found.len(), 1, "found although it lies beside the project");
    let unsaved = found.into_iter().next().expect("one");
    assert_eq!((unsaved.name().as_str(), unsaved.steps), ("red hair", 28));
    assert_eq!(unsaved.project.as_deref(), Some(place.project().as_path()));
    assert!(!unsaved.saved_later && unsaved.picture.as_ref().is_some_and(|path| path.exists()));
    let mut recovered = Document::recovered(unsaved.history().expect("a history"), unsaved.project.clone());
    assert_eq!(states(recovered.clone()), expected);
    assert!(recovered.is_modified());
    // Recovered work is safe in its new journal before the old one goes.
    let mut journal = Journal::new(place.journals()).expect("a thread");
    journal.replaces(unsaved);
    assert!(journal.flush(&recovered, WITHIN));
    assert_eq!(place.files("state/journals").iter().filter(|name| name.ends_with(".journal")).count(), 0);
    distance(&mut recovered, 7.0);
    crash(&recovered, journal);
    let found = place.journals().unsaved(Some(&place.project()));
    assert_eq!(found[0].history().expect("a history").project().camera.distance, 7.0);
    found.into_iter().for_each(super::Unsaved::discard);
    assert!(place.journals().unsaved(Some(&place.project())).is_empty());
    assert_eq!(place.files("state/journals"), [""; 0]);
}

#[test]
fn a_project_that_was_saved_or_closed_leaves_nothing() {
    let place = Place::new();
    let (mut document, mut journal) = place.open();
    distance(&mut document, 3.0);
    assert!(journal.flush(&document, WITHIN));
    assert!(place.journals().unsaved(None).is_empty(), "a program that runs keeps its own");
    save_project(&place.project(), document.project()).expect("saved");
    document.mark_saved(&place.project());
    crash(&document, journal);
    assert!(place.journals().unsaved(Some(&place.project())).is_empty(), "everything was saved");
    assert_eq!(place.files("work"), ["red hair.lovelock"]);
    let (mut document, mut journal) = place.open();
    distance(&mut document, 4.0);
    assert!(journal.flush(&document, WITHIN));
    journal.close();
    assert_eq!(
        (place.files("work"), place.files("state/journals")),
        (vec!["red hair.lovelock".to_owned()], vec![])
    );
}

#[test]
fn an_untitled_project_is_kept_in_the_users_folder_and_moves_when_it_is_saved() {
    let place = Place::new();
    let mut document = Document::new(Project::default(), None);
    let mut journal = Journal::new(place.journals()).expect("a thread");
    journal.flush(&document, WITHIN);
    assert!(place.files("state/journals").is_empty(), "nobody has touched it");
    distance(&mut document, 3.0);
    assert!(journal.flush(&document, WITHIN));
    assert!(place.files("state/journals")[0].starts_with("untitled-"));
    let path = place.folder.path().join("work/new.lovelock");
    save_project(&path, document.project()).expect("saved");
    document.mark_saved(&path);
    assert!(journal.flush(&document, WITHIN));
    assert!(beside(&path).exists());
    assert!(
        place
            .files("state/journals")
            .iter()
            .all(|name| Path::new(name).extension().is_some_and(|end| end == "at"))
    );
    distance(&mut document, 4.0);
    crash(&document, journal);
    let found = place.journals().unsaved(None);
    assert_eq!((found.len(), found[0].project.as_deref()), (1, Some(path.as_path())));
    assert_eq!(found[0].history().expect("a history").undo_len(), 2, "steps before the project was saved");
}

/// As another program does: in this process they differ by the time at which they began.
fn open_second(place: &Place) -> (Document, Journal) {
    std::thread::sleep(Duration::from_millis(3));
    place.open()
}

#[test]
fn both_programs_on_a_project_are_told_once_and_leave_nothing() {
    let place = Place::new();
    let note = beside(&place.project()).with_extension("opened");
    let (first, _) = place.open();
    let (wakes, woken) = sync_channel(8);
    let wake = move || {
        let _ = wakes.try_send(());
    };
    let mut journal = Journal::waking(place.journals(), wake).expect("a thread");
    assert!(journal.flush(&first, WITHIN));
    assert!(journal.events().is_empty(), "control: it is alone");
    let (mut second, mut other) = open_second(&place);
    assert!(other.flush(&second, WITHIN));
    assert!(matches!(&other.events()[..], [Event::OpenElsewhere(_)]));
    // Nothing changes in the first program, and it is told.
    woken.recv_timeout(WITHIN).expect("it looks now and then");
    let told = journal.events();
    assert!(matches!(&told[..], [Event::OpenElsewhere(_)]), "{told:?}");
    distance(&mut second, 3.5);
    assert!(journal.flush(&first, WITHIN) && other.flush(&second, WITHIN) && !note.exists());
    assert!(journal.events().is_empty() && other.events().is_empty(), "once");
    other.close();
    // A note that nobody has read goes with its reader, and is none for the next one.
    fs::write(&note, b"{\"process\": 7}").expect("a file");
    journal.close();
    assert_eq!(place.files("work"), ["red hair.lovelock"]);
    assert_eq!(place.files("state/journals"), [""; 0]);
    fs::write(&note, b"{\"process\": 7}").expect("a file");
    let (third, mut journal) = place.open();
    assert!(journal.flush(&third, WITHIN));
    assert!(journal.events().is_empty() && !note.exists(), "the note was for an earlier one");
    // Control: one that is left now is read.
    fs::write(&note, b"{\"process\": 7}").expect("a file");
    assert!(journal.flush(&third, WITHIN) && !note.exists());
    assert!(matches!(&journal.events()[..], [Event::OpenElsewhere(owner)] if owner.process == 7));
}

#[test]
fn a_program_that_opens_the_project_after_the_first_one_has_ended_meets_the_second() {
    // In either order: the second program has noticed by then that the first one has ended, or not.
    for notices in [true, false] {
        let place = Place::new();
        let (first, mut journal) = place.open();
        assert!(journal.flush(&first, WITHIN));
        let (mut second, mut other) = open_second(&place);
        distance(&mut second, 3.5);
        assert!(other.flush(&second, WITHIN));
        assert!(matches!(&other.events()[..], [Event::OpenElsewhere(_)]));
        journal.close();
        if notices {
            assert!(other.flush(&second, WITHIN) && beside(&place.project()).exists());
            assert!(!place.files("state/journals").iter().any(|name| name.ends_with(".journal")));
        }
        assert!(other.events().is_empty(), "control: it is alone");
        let (mut third, mut journal) = open_second(&place);
        for _ in 0..2 {
            assert!(journal.flush(&third, WITHIN) && other.flush(&second, WITHIN));
        }
        for told in [journal.events(), other.events()] {
            assert!(matches!(&told[..], [Event::OpenElsewhere(_)]), "{told:?}");
        }
        distance(&mut third, 4.5);
        assert!(journal.flush(&third, WITHIN) && other.flush(&second, WITHIN));
        assert!(journal.events().is_empty() && other.events().is_empty(), "once");
        drop((journal, other));
        let found = place.journals().unsaved(Some(&place.project()));
        let mut found: Vec<f32> = found
            .iter()
            .map(|unsaved| unsaved.history().expect("a history").project().camera.distance)
            .collect();
        found.sort_by(f32::total_cmp);
        assert_eq!(found, [3.5, 4.5]);
    }
}

#[test]
fn changes_of_a_first_program_that_crashed_are_announced_to_the_second() {
    let place = Place::new();
    let (mut first, mut journal) = place.open();
    assert!(journal.flush(&first, WITHIN));
    let (mut second, mut other) = open_second(&place);
    distance(&mut second, 3.5);
    assert!(other.flush(&second, WITHIN));
    assert_eq!(other.events().len(), 1);
    distance(&mut first, 2.5);
    crash(&first, journal);
    assert!(other.flush(&second, WITHIN));
    assert_eq!(other.events(), [Event::Found]);
    let found = place.journals().unsaved(Some(&place.project()));
    assert_eq!(found.len(), 1, "that of the second is not left");
    assert_eq!(found[0].history().expect("a history").project().camera.distance, 2.5);
    // Control: that of the second one took the place, and is found when it crashes, too.
    crash(&second, other);
    assert_eq!(place.journals().unsaved(Some(&place.project())).len(), 2);
}

#[test]
fn a_second_program_on_the_same_project_is_noticed_and_keeps_its_own_journal() {
    let place = Place::new();
    let (mut first, mut journal) = place.open();
    assert!(journal.flush(&first, WITHIN));
    // The lock is one of a file that is open, so that a second journal in this process meets it too.
    let (mut second, mut other) = open_second(&place);
    assert!(other.flush(&second, WITHIN));
    distance(&mut first, 2.5);
    distance(&mut second, 3.5);
    assert!(journal.flush(&first, WITHIN) && other.flush(&second, WITHIN));
    drop((journal, other));
    let mut found: Vec<f32> = place
        .journals()
        .unsaved(Some(&place.project()))
        .iter()
        .map(|unsaved| unsaved.history().expect("a history").project().camera.distance)
        .collect();
    found.sort_by(f32::total_cmp);
    assert_eq!(found, [2.5, 3.5]);
}

#[test]
fn unsaved_changes_of_a_project_that_is_opened_again_are_set_aside_and_announced() {
    let place = Place::new();
    let (mut document, journal) = place.open();
    distance(&mut document, 2.5);
    crash(&document, journal);
    let (mut document, mut journal) = place.open();
    assert!(journal.flush(&document, WITHIN));
    assert_eq!(journal.events(), [Event::Found]);
    distance(&mut document, 9.0);
    crash(&document, journal);
    assert_eq!(place.journals().unsaved(Some(&place.project())).len(), 2, "neither replaces the other");
}

#[test]
fn a_journal_of_a_newer_version_stays_and_changes_are_kept_beside_it() {
    let place = Place::new();
    let newer = b"LLJOURN2 and what only that version can read";
    let state = place.folder.path().join("state/journals");
    let (beside, inside) = (beside(&place.project()), state.join("new.1.journal"));
    fs::create_dir_all(&state).expect("a folder");
    for journal in [&beside, &inside] {
        fs::write(journal, newer).expect("a journal");
    }
    let (mut document, mut journal) = place.open();
    for value in [2.5, 3.5] {
        distance(&mut document, value);
        assert!(journal.flush(&document, WITHIN));
    }
    assert!(journal.events().is_empty());
    crash(&document, journal);
    let found = place.journals().unsaved(Some(&place.project()));
    assert_eq!(found.len(), 1, "{:?}", place.files("state/journals"));
    assert_eq!(found[0].history().expect("a history").project().camera.distance, 3.5);
    for journal in [&beside, &inside] {
        assert_eq!(fs::read(journal).expect("a journal"), newer);
    }
}

#[test]
fn a_journal_beside_a_project_belongs_to_the_project_where_it_lies() {
    let place = Place::new();
    let (mut document, journal) = place.open();
    distance(&mut document, 2.5);
    crash(&document, journal);
    let (work, copy) = (place.folder.path().join("work"), place.folder.path().join("copy"));
    fs::create_dir(&copy).expect("a folder");
    for name in place.files("work") {
        fs::copy(work.join(&name), copy.join(&name)).expect("copied");
    }
    let copied = copy.join("red hair.lovelock");
    // A crash can cut the last record: what names the place is not behind it.
    let mut bytes = fs::read(beside(&copied)).expect("a journal");
    bytes.extend([7; 20]);
    fs::write(beside(&copied), bytes).expect("a journal");
    let journals = Journals::new(place.folder.path().join("other"));
    for opened in [Some(copied.as_path()), None] {
        let found = journals.unsaved(opened);
        assert_eq!((found.len(), found[0].project.as_deref()), (1, Some(copied.as_path())));
        let history = found[0].history().expect("a history");
        assert_eq!((history.project().camera.distance, history.undo_len()), (2.5, 1));
    }
    assert!(!beside(&copied).exists());
    // Control: the one that nobody moved.
    let found = place.journals().unsaved(None);
    assert_eq!((found.len(), found[0].project.as_deref()), (1, Some(place.project().as_path())));
}

/// For a user who may write everything, as tests in containers have, it is moved as any other.
#[cfg(unix)]
#[test]
fn a_journal_in_a_folder_that_became_read_only_is_offered_once() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let (mut document, journal) = place.open();
    distance(&mut document, 2.5);
    crash(&document, journal);
    let set =
        |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("a mode");
    let work = place.folder.path().join("work");
    set(&beside(&place.project()), 0o444);
    set(&work, 0o555);
    let found = [(), ()].map(|()| place.journals().unsaved(Some(&place.project())));
    set(&work, 0o755);
    assert_eq!(found.each_ref().map(Vec::len), [1, 1], "{:?}", place.files("state/journals"));
    assert_eq!(found[0][0].history().expect("a history").project().camera.distance, 2.5);
}

/// As another user's program is, where this user may only read.
#[cfg(unix)]
#[test]
fn a_journal_that_a_program_writes_is_left_alone_where_it_can_only_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    let (mut document, mut journal) = place.open();
    distance(&mut document, 2.5);
    assert!(journal.flush(&document, WITHIN));
    fs::set_permissions(beside(&place.project()), fs::Permissions::from_mode(0o444)).expect("a mode");
    assert!(place.journals().unsaved(Some(&place.project())).is_empty(), "its program runs");
    crash(&document, journal);
    assert_eq!(place.journals().unsaved(Some(&place.project())).len(), 1, "control: its program ended");
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_or_is_gone_is_reported_and_changes_are_kept_elsewhere() {
    let place = Place::new();
    let (mut document, mut journal) = place.open();
    assert!(journal.flush(&document, WITHIN));
    fs::rename(place.folder.path().join("work"), place.folder.path().join("moved")).expect("moved");
    distance(&mut document, 2.5);
    assert!(journal.flush(&document, WITHIN));
    let events = journal.events();
    assert!(
        matches!(&events[..], [Event::KeptElsewhere { folder, .. }] if folder == &place.folder.path().join("work")),
        "{events:?}"
    );
    crash(&document, journal);
    let found = place.journals().unsaved(None);
    assert_eq!(found.len(), 1, "{:?}", place.files("state/journals"));
    assert_eq!(found[0].history().expect("a history").project().camera.distance, 2.5);
}

/// A user who may write everything, as tests in containers have, meets a folder where the journal should be.
#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_told_once_when_its_project_is_opened() {
    use std::os::unix::fs::PermissionsExt;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    for can_be_written in [true, false] {
        let place = Place::new();
        let work = place.folder.path().join("work");
        let set = |mode| fs::set_permissions(&work, fs::Permissions::from_mode(mode)).expect("a mode");
        if !can_be_written {
            set(0o555);
            if fs::create_dir(work.join("probe")).is_ok() {
                fs::create_dir(beside(&place.project()).with_extension("journal-partial")).expect("a folder");
            }
        }
        let (mut document, _) = place.open();
        let woken = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&woken);
        let wake = move || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        let mut journal = Journal::waking(place.journals(), wake).expect("a thread");
        assert!(journal.flush(&document, WITHIN));
        let events = journal.events();
        let told = usize::from(!can_be_written);
        assert_eq!((events.len(), woken.load(Ordering::Relaxed)), (told, told), "{events:?}");
        if let Some(event) = events.first() {
            let kept = place.folder.path().join("state/journals");
            assert!(
                matches!(event, Event::KeptElsewhere { folder, kept_in, .. } if *folder == work && *kept_in == kept),
                "{event:?}"
            );
        }
        distance(&mut document, 2.5);
        assert!(journal.flush(&document, WITHIN));
        assert!(journal.events().is_empty(), "once");
        crash(&document, journal);
        let found = place.journals().unsaved(Some(&place.project()));
        set(0o755);
        assert_eq!(found.len(), 1, "{:?}", place.files("state/journals"));
        assert_eq!(found[0].history().expect("a history").project().camera.distance, 2.5);
    }
}

#[test]
fn nowhere_to_write_is_reported_once_and_again_when_it_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file where the folder should be.
    let state = folder.path().join("state");
    fs::write(&state, b"").expect("a file");
    let mut journal = Journal::new(Journals::new(state.join("journals"))).expect("a thread");
    let mut document = Document::new(Project::default(), None);
    for value in [2.0, 3.0] {
        distance(&mut document, value);
        assert!(!journal.flush(&document, WITHIN));
    }
    let events = journal.events();
    assert!(matches!(&events[..], [Event::NotKept { .. }]), "{events:?}");
    fs::remove_file(&state).expect("removed");
    assert!(journal.flush(&document, WITHIN));
    assert_eq!(journal.events(), [Event::KeptAgain]);
}

#[test]
fn a_journal_that_is_cut_anywhere_is_recovered_up_to_there() {
    let place = Place::new();
    let (mut document, mut journal) = place.open();
    for k in 0..6 {
        distance(&mut document, 3.0 + k as f32);
        assert!(journal.flush(&document, WITHIN));
    }
    drop(journal);
    let whole = fs::read(beside(&place.project())).expect("a journal");
    let other = Place::new();
    let state = other.folder.path().join("state/journals");
    fs::create_dir_all(&state).expect("a folder");
    let (mut least, mut most) = (f32::MAX, f32::MIN);
    for cut in (0..whole.len()).step_by(37).chain([whole.len()]) {
        fs::write(state.join("x.1.journal"), &whole[..cut]).expect("a file");
        let found = other.journals().unsaved(None);
        let Some(unsaved) = found.first() else { continue };
        let history = unsaved.history().expect("a history");
        let value = history.project().camera.distance;
        assert_eq!(history.undo_len(), (value - 2.0) as usize, "cut at {cut}");
        (least, most) = (least.min(value), most.max(value));
    }
    assert_eq!((least, most), (3.0, 8.0));
    // Bytes that are no journal are no unsaved work.
    for bytes in [&b""[..], b"LLJOURN1", &[0xff; 1000]] {
        fs::write(state.join("x.1.journal"), bytes).expect("a file");
        assert!(other.journals().unsaved(Some(Path::new("/nowhere/x.lovelock"))).is_empty());
    }
}

#[test]
fn a_long_journal_is_written_anew_and_loses_nothing() {
    use super::encoder::Encoder;
    use super::owner::Owner;

    let mut document = Document::new(Project::default(), None);
    let (mut encoder, mut out) =
        Encoder::begin(&Owner::this(), &document.history().mark(), None).expect("a journal");
    let begun = out.len();
    for k in 0..1300 {
        distance(&mut document, 1.0 + (k % 50) as f32 * 0.1);
        encoder.append(&document.history().mark(), None, &mut out).expect("appended");
    }
    let each = (out.len() - begun) / 1300;
    println!("{begun} bytes, then {each} for each edit");
    assert!(each < 600, "{each} bytes for an edit");
    let (_, again) = Encoder::begin(&Owner::this(), &document.history().mark(), None).expect("a journal");
    assert!(again.len() < out.len());
}
