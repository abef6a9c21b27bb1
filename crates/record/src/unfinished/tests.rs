use super::*;
use crate::{
    FilmQuality, FilmReader, FilmSettings, FilmWriter, SequenceFormat, SequenceSettings, SequenceWriter,
    TakeHeader, TakeWriter, read_manifest,
};

const SIDE: u32 = 32;
const FILM: FilmSettings = FilmSettings { width: SIDE, height: SIDE, fps: 30.0, quality: FilmQuality::High };

fn picture(frame: u32) -> Vec<u8> {
    (0..SIDE * SIDE).flat_map(|k| [(k % SIDE * 4) as u8, (frame * 9) as u8, 60, 255]).collect()
}

/// What a crash would leave of a folder: copies, which nobody has locked.
fn left_of(folder: &Path) -> tempfile::TempDir {
    let left = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), left.path().join(entry.file_name())).unwrap();
    }
    left
}

fn wait_for(is_so: impl Fn() -> bool) {
    let since = lovelock_base::clock::Stopwatch::start();
    while !is_so() {
        assert!(since.secs() < 60.0, "it did not happen");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

fn decoded(film: &Path) -> Vec<Vec<u8>> {
    let mut reader = FilmReader::open(film).unwrap();
    let mut frames = Vec::new();
    let mut frame = Vec::new();
    while reader.next_frame(&mut frame).unwrap() {
        frames.push(frame.clone());
    }
    frames
}

#[test]
fn the_images_of_an_interrupted_film_are_a_film() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("dance ü.mp4");
    let mut writer = FilmWriter::create(&film, FILM).unwrap();
    assert!(is_unfinished(&film));
    (0..20).for_each(|frame| writer.push(&picture(frame)).unwrap());
    wait_for(|| folder.path().join("dance ü.mp4.partial.tables").exists());
    assert!(keep_unfinished(&film).is_err(), "it is still being written");
    let left = left_of(folder.path());
    (20..40).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.finish().unwrap();
    assert!(!is_unfinished(&film));
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        1,
        "a film that is finished leaves nothing beside it"
    );
    let whole = decoded(&film);

    let name = left.path().join("dance ü.mp4");
    fs::write(&name, b"an older film").unwrap();
    assert!(can_be_kept(&name).unwrap());
    let kept = keep_unfinished(&name).unwrap().expect("a film");
    assert_eq!((kept.frames, kept.path.as_path()), (16, left.path().join("dance ü-1.mp4").as_path()));
    assert_eq!(decoded(&kept.path), whole[..16]);
    assert!(!is_unfinished(&name) && fs::read(&name).unwrap() == b"an older film");
    assert_eq!(fs::read_dir(left.path()).unwrap().count(), 2);
}

#[test]
fn an_interrupted_film_survives_a_recording_of_the_same_name_that_is_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("dance.mp4");
    let files = ["dance.mp4.partial", "dance.mp4.partial.tables"].map(|name| folder.path().join(name));
    for path in &files {
        fs::write(path, b"left by a crash").unwrap();
    }
    let record = || {
        let mut writer = FilmWriter::create(&film, FILM).unwrap();
        (0..3).for_each(|frame| writer.push(&picture(frame)).unwrap());
        writer
    };
    drop(record());
    wait_for(|| fs::read_dir(folder.path()).unwrap().count() == 2);
    assert!(files.iter().all(|path| fs::read(path).unwrap() == b"left by a crash"));
    // A crash of the second recording leaves both: the older one comes back when the newer one is gone.
    for (path, aside) in files.iter().zip(["dance.mp4.partial-before", "dance.mp4.partial.tables-before"]) {
        fs::rename(path, folder.path().join(aside)).unwrap();
    }
    assert!(is_unfinished(&film));
    assert!(!can_be_kept(&film).unwrap());
    assert_eq!(keep_unfinished(&film).unwrap(), None, "nothing that plays");
    assert!(files.iter().all(|path| path.exists()));
    // Control: one that ends well replaces it.
    record().finish().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A folder with what a crash left of `dance.mp4`: 16 images and their tables.
fn cut_film() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = FilmWriter::create(&folder.path().join("dance.mp4"), FILM).unwrap();
    (0..20).for_each(|frame| writer.push(&picture(frame)).unwrap());
    wait_for(|| folder.path().join("dance.mp4.partial.tables").exists());
    left_of(folder.path())
}

/// The names of [`cut_film`] in a folder, and those of the same files when they are aside.
fn names_in(folder: &Path) -> [[PathBuf; 2]; 2] {
    [
        ["dance.mp4.partial", "dance.mp4.partial.tables"],
        ["dance.mp4.partial-before", "dance.mp4.partial.tables-before"],
    ]
    .map(|names| names.map(|name| folder.join(name)))
}

fn contents(paths: &[PathBuf; 2]) -> [Vec<u8>; 2] {
    paths.each_ref().map(|path| fs::read(path).unwrap())
}

#[test]
fn an_older_film_that_plays_outlives_newer_recordings_that_do_not() {
    let folder = cut_film();
    let film = folder.path().join("dance.mp4");
    let [written, aside] = names_in(folder.path());
    let older = contents(&written);
    // The second recording was interrupted in its first second, before it had tables.
    let interrupt_second = || {
        for (path, aside) in written.iter().zip(&aside) {
            fs::rename(path, aside).unwrap();
        }
        fs::write(&written[0], [7; 500]).unwrap();
    };
    interrupt_second();
    assert!(has_older(&film));
    let mut third = FilmWriter::create(&film, FILM).unwrap();
    (0..3).for_each(|frame| third.push(&picture(frame)).unwrap());
    assert_eq!(contents(&aside), older);
    third.cancel();
    assert_eq!(contents(&written), older);
    assert!(!has_older(&film));
    // Discarded, the second one does not take the first one along.
    interrupt_second();
    discard_unfinished(&film).unwrap();
    assert!(!written[0].exists() && is_unfinished(&film) && has_older(&film));
    assert_eq!(keep_unfinished(&film).unwrap().expect("a film").frames, 16);
    // Control: nothing is left of either.
    assert!(!is_unfinished(&film) && fs::read_dir(folder.path()).unwrap().count() == 1);
}

#[test]
fn of_two_interrupted_films_that_play_the_older_one_is_kept_when_a_third_begins() {
    let folder = cut_film();
    let film = folder.path().join("dance.mp4");
    let [written, aside] = names_in(folder.path());
    let newer = contents(&written);
    for (path, aside) in written.iter().zip(&aside) {
        fs::copy(path, aside).unwrap();
    }
    FilmWriter::create(&film, FILM).unwrap().cancel();
    assert_eq!(contents(&written), newer);
    let older = folder.path().join("dance-1.mp4");
    assert_eq!((decoded(&older).len(), film.exists()), (16, false));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    // Control: with one alone no film is made.
    FilmWriter::create(&film, FILM).unwrap().cancel();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    assert_eq!(keep_unfinished(&film).unwrap().expect("a film").path, film);
}

#[test]
fn a_film_that_cannot_be_set_aside_is_not_written_over() {
    let folder = cut_film();
    let film = folder.path().join("dance.mp4");
    let [written, aside] = names_in(folder.path());
    let left = contents(&written);
    for blocked in &aside {
        fs::create_dir(blocked).unwrap();
        let error = FilmWriter::create(&film, FILM).unwrap_err();
        assert!(error.to_string().contains("dance.mp4"), "{error}");
        assert_eq!(contents(&written), left);
        fs::remove_dir(blocked).unwrap();
    }
    // Control: where it can be, it is replaced.
    let mut writer = FilmWriter::create(&film, FILM).unwrap();
    writer.push(&picture(0)).unwrap();
    writer.finish().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_film_without_tables_or_with_damaged_ones_is_not_kept_and_can_be_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("dance.mp4");
    let partial = folder.path().join("dance.mp4.partial");
    let tables = folder.path().join("dance.mp4.partial.tables");
    fs::write(&partial, [7; 500]).unwrap();
    for bytes in [None, Some(&b""[..]), Some(&b"LLFILMT1"[..]), Some(&[0xff; 300][..])] {
        if let Some(bytes) = bytes {
            fs::write(&tables, bytes).unwrap();
        }
        assert_eq!(keep_unfinished(&film).unwrap(), None);
        assert!(partial.exists(), "nothing is lost by trying");
    }
    discard_unfinished(&film).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_take_that_is_being_recorded_is_neither_offered_nor_kept_nor_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let take = folder.path().join("dance.take");
    let part = folder.path().join("dance.take.part");
    assert!(!is_unfinished(&take) && !part.exists(), "asking creates nothing");
    let header = TakeHeader { guides: 3, points_per_guide: 4, ..TakeHeader::default() };
    let recording = TakeWriter::create(&take, header).unwrap();
    assert!(!is_unfinished(&take));
    let kept = keep_unfinished(&take).unwrap_err().to_string();
    assert!(kept.contains("dance.take: ") && kept.contains("another recording"), "{kept}");
    let discarded = discard_unfinished(&take).unwrap_err().to_string();
    assert!(discarded.contains("dance.take.part: "), "{discarded}");
    assert!(part.exists());
    // Control: one that a crash left, with nothing that plays.
    drop(recording);
    fs::write(&part, b"cut").unwrap();
    assert!(is_unfinished(&take));
    assert!(!can_be_kept(&take).unwrap());
    assert_eq!(keep_unfinished(&take).unwrap(), None);
    discard_unfinished(&take).unwrap();
    assert!(!part.exists() && !is_unfinished(&take));
    // What cannot be read is not taken for a short one.
    fs::create_dir(&part).unwrap();
    assert!(can_be_kept(&take).unwrap_err().to_string().contains("dance.take.part"));
}

#[test]
fn takes_whose_files_were_renamed_are_found_by_the_name_that_was_recorded_again() {
    use std::time::Duration;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (take, part) = (at("dance ü.take"), at("dance ü.take.part"));
    fs::write(&part, b"left by a crash").unwrap();
    assert_eq!(unfinished_outs(&take), [take.as_path()]);
    let header = TakeHeader { guides: 3, points_per_guide: 4, ..TakeHeader::default() };
    let recording = TakeWriter::create(&take, header).unwrap();
    assert_eq!(unfinished_outs(&take), [at("dance ü-cut1.take")], "the new one is being recorded");
    drop(recording);
    // A second crash, whose file is renamed by a third recording, and others of similar names.
    fs::write(at("dance ü-cut2.take.part"), b"left").unwrap();
    let first = fs::File::options().write(true).open(at("dance ü-cut1.take.part")).unwrap();
    first.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(1_000_000_000)).unwrap();
    for other in
        ["dance ü-cut.take.part", "dance ü-cutx.take.part", "dance-cut1.take.part", "dance ü-cut3.take"]
    {
        fs::write(at(other), b"other").unwrap();
    }
    fs::write(&part, b"left").unwrap();
    let cuts = [at("dance ü-cut2.take"), at("dance ü-cut1.take")];
    assert_eq!(unfinished_outs(&take), [&take, &cuts[0], &cuts[1]].map(PathBuf::clone));
    discard_unfinished(&cuts[0]).unwrap();
    discard_unfinished(&take).unwrap();
    assert_eq!(unfinished_outs(&take), [cuts[1].as_path()]);
    // Control: films have no such names.
    fs::write(at("film-cut1.mp4.part"), b"other").unwrap();
    assert!(unfinished_outs(&at("film.mp4")).is_empty());
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<_> = entries.map(|name| name.into_string().unwrap()).collect();
    names.sort();
    names
}

/// A sequence that continues what is in the folder.
fn sequence(frames: &Path) -> Result<SequenceWriter, RecordError> {
    let settings = SequenceSettings {
        width: SIDE,
        height: SIDE,
        fps: 30.0,
        first_frame: 0,
        format: SequenceFormat::Png,
        alpha: true,
        resume: true,
        settings: serde_json::json!({}),
    };
    SequenceWriter::create(frames, settings)
}

/// A sequence of which `count` images have their names.
fn begun(frames: &Path, count: u32) -> SequenceWriter {
    let mut writer = sequence(frames).unwrap();
    (0..count).for_each(|frame| writer.push(&picture(frame)).unwrap());
    wait_for(|| {
        // With the journal.
        let names = names(frames);
        names.len() == count as usize + 1 && !names.iter().any(|name| name.ends_with(".png.partial"))
    });
    writer
}

#[test]
fn the_images_of_an_interrupted_sequence_are_listed_or_removed() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let writer = begun(&frames, 6);
    let lines = fs::read_to_string(frames.join("manifest.partial")).unwrap().lines().count();
    assert_eq!(lines, 7, "an image is in the journal before it has its name");
    let (kept, discarded) = (left_of(&frames), left_of(&frames));
    drop(writer);
    assert!(is_unfinished(kept.path()));
    assert_eq!(keep_unfinished(kept.path()).unwrap().expect("images").frames, 6);
    let manifest = read_manifest(kept.path()).unwrap();
    assert!(!manifest.complete && manifest.frames.len() == 6 && !is_unfinished(kept.path()));
    discard_unfinished(discarded.path()).unwrap();
    assert!(!discarded.path().exists());
    // Control: a finished folder is left alone.
    discard_unfinished(kept.path()).unwrap();
    assert_eq!(fs::read_dir(kept.path()).unwrap().count(), 7);
}

#[test]
fn a_sequence_that_cannot_be_continued_keeps_the_images_of_the_interrupted_one() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames");
    let writer = begun(&frames, 3);
    let left = left_of(&frames);
    drop(writer);
    // Nothing can be written beside the journal, as on a full disk.
    let blocked = left.path().join("manifest.partial.partial");
    fs::create_dir(&blocked).unwrap();
    sequence(left.path()).unwrap_err();
    fs::remove_dir(&blocked).unwrap();
    // An image that another thread wrote is listed behind a line that is not whole.
    let journal = left.path().join("manifest.partial");
    let lines = fs::read_to_string(&journal).unwrap();
    let (head, images) = lines.split_once('\n').unwrap();
    fs::write(&journal, format!("{head}\n{{\"number\": 7\n{images}")).unwrap();
    assert_eq!(keep_unfinished(left.path()).unwrap().expect("images").frames, 3);
    // Control: a folder in which nothing was recorded is left as it was.
    let empty = tempfile::tempdir().unwrap();
    fs::create_dir(empty.path().join("manifest.partial.partial")).unwrap();
    sequence(empty.path()).unwrap_err();
    assert_eq!(names(empty.path()), ["manifest.partial.partial"]);
}

#[test]
fn a_killed_recording_leaves_nothing_beside_what_is_kept_or_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("dance ü.mp4");
    let write =
        |names: &[&str]| names.iter().for_each(|name| fs::write(folder.path().join(name), b"x").unwrap());
    // Killed while tables were written.
    write(&["dance ü.mp4.partial", "dance ü.mp4.partial.tables-new"]);
    tidy_finished(&film);
    assert_eq!(names(folder.path()).len(), 2, "control: it is not finished");
    discard_unfinished(&film).unwrap();
    assert!(names(folder.path()).is_empty());
    // Killed when the film had its name.
    write(&["dance ü.mp4", "dance ü.mp4.partial.tables", "dance ü.mp4.partial.tables-new"]);
    assert!(!is_unfinished(&film));
    tidy_finished(&film);
    assert_eq!(names(folder.path()), ["dance ü.mp4"]);

    let frames = folder.path().join("frames");
    let at = |name: &str| frames.join(name);
    let writer = begun(&frames, 3);
    let journal = fs::read(at("manifest.partial")).unwrap();
    writer.finish().unwrap();
    let whole = names(&frames);
    assert_eq!(whole, ["frame_000000.png", "frame_000001.png", "frame_000002.png", "manifest.json"]);
    // Killed before the next recording had begun its journal.
    for keeps in [true, false] {
        fs::write(at("manifest.partial"), b"").unwrap();
        assert!(is_unfinished(&frames));
        if keeps {
            assert_eq!(keep_unfinished(&frames).unwrap(), None);
        } else {
            discard_unfinished(&frames).unwrap();
        }
        assert!(names(&frames) == whole && read_manifest(&frames).unwrap().complete);
    }
    // Killed when all was written but the journal was there, with files that have no name yet, and one of the user.
    let leave = || {
        fs::write(at("manifest.partial"), &journal).unwrap();
        let begun = ["frame_000003.png.partial", "manifest.json.partial", "manifest.partial.partial"];
        for name in begun.into_iter().chain(["notes.partial"]) {
            fs::write(at(name), b"x").unwrap();
        }
    };
    leave();
    assert_eq!(keep_unfinished(&frames).unwrap().expect("images").frames, 3);
    assert!(read_manifest(&frames).unwrap().complete);
    assert_eq!(names(&frames), [&whole[..], &["notes.partial".to_owned()]].concat());
    // Whole, and kept in part before it was to be continued.
    for complete in [true, false] {
        let manifest = fs::read_to_string(at("manifest.json")).unwrap();
        let marked = manifest.replace("\"complete\": true", &format!("\"complete\": {complete}"));
        fs::write(at("manifest.json"), marked).unwrap();
        leave();
        discard_unfinished(&frames).unwrap();
        assert_eq!(read_manifest(&frames).unwrap().complete, complete);
        let rest = [&whole[..], &["notes.partial".to_owned()]].concat();
        assert_eq!(names(&frames), rest, "a whole sequence and its notes stay");
    }
    // Control: one that has no manifest yet goes.
    fs::remove_file(at("manifest.json")).unwrap();
    leave();
    discard_unfinished(&frames).unwrap();
    assert_eq!(names(&frames), ["notes.partial"]);
}
