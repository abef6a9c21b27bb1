use super::{FrameLayers, SequenceFormat, SequenceSettings, SequenceWriter, frame_name};
use crate::partial::Opener;
use crate::partial::failing::small_disk;
use crate::{Manifest, RecordError, discard_unfinished, keep_unfinished, read_manifest};
use std::fs;
use std::path::Path;
use std::sync::Arc;

fn settings() -> SequenceSettings {
    SequenceSettings {
        width: 33,
        height: 7,
        fps: 24.0,
        first_frame: 0,
        format: SequenceFormat::Png,
        alpha: false,
        resume: false,
        settings: serde_json::json!({ "shadow": "voxel-map", "resolution": 128 }),
    }
}

fn picture(seed: u8) -> Vec<u8> {
    (0..33 * 7)
        .flat_map(|i: u32| [seed, (i % 33 * 7) as u8, (i / 33 * 30) as u8, 128 + (i % 100) as u8])
        .collect()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Checks that every file in the manifest exists and has the listed length and checksum.
fn check_files(folder: &Path, manifest: &Manifest) {
    for frame in &manifest.frames {
        let bytes = fs::read(folder.join(&frame.file)).unwrap();
        assert_eq!(frame.bytes, bytes.len() as u64);
        assert_eq!(frame.crc32, format!("{:08x}", crc32fast::hash(&bytes)));
    }
}

#[test]
fn frames_come_back_exactly() {
    for alpha in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("frames é");
        let mut writer =
            SequenceWriter::create(&folder, SequenceSettings { alpha, first_frame: 7, ..settings() })
                .unwrap();
        (0..12).for_each(|frame| writer.push(&picture(frame)).unwrap());
        let report = writer.finish().unwrap();
        let manifest = read_manifest(&folder).unwrap();
        assert_eq!((report.frames, manifest.frames.len(), manifest.complete), (12, 12, true));
        assert_eq!(report.bytes, manifest.frames.iter().map(|frame| frame.bytes).sum::<u64>());
        assert_eq!((manifest.width, manifest.height, manifest.fps, manifest.first_frame), (33, 7, 24.0, 7));
        assert_eq!(manifest.settings["resolution"], 128);
        check_files(&folder, &manifest);
        for (index, frame) in manifest.frames.iter().enumerate() {
            assert_eq!(
                (frame.number, &frame.file),
                (index as u64 + 7, &frame_name(index as u64 + 7, SequenceFormat::Png))
            );
            let image = image::open(folder.join(&frame.file)).unwrap();
            let wanted = picture(index as u8);
            if alpha {
                assert_eq!(image.into_rgba8().into_raw(), wanted);
            } else {
                assert_eq!(image.color(), image::ColorType::Rgb8);
                let opaque: Vec<u8> = wanted.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
                assert_eq!(image.into_rgb8().into_raw(), opaque);
            }
        }
        assert_eq!(files(&folder).len(), 13, "only frames and manifest");
    }
}

#[test]
fn a_cancel_keeps_complete_frames_and_marks_the_manifest_incomplete() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
    (0..3).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.cancel();
    let manifest = read_manifest(folder.path()).unwrap();
    assert!(!manifest.complete);
    check_files(folder.path(), &manifest);
    assert!(files(folder.path()).iter().all(|name| !name.ends_with(".partial")));
}

#[test]
fn a_shorter_sequence_replaces_a_longer_one_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.png"), b"mine").unwrap();
    for frames in [5, 2] {
        let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
        (0..frames).for_each(|frame| writer.push(&picture(frame)).unwrap());
        writer.finish().unwrap();
    }
    assert_eq!(files(folder.path()), ["frame_000000.png", "frame_000001.png", "manifest.json", "notes.png"]);
}

#[test]
fn a_manifest_cannot_name_files_to_remove() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
    writer.push(&picture(0)).unwrap();
    writer.finish().unwrap();
    let path = folder.path().join("manifest.json");
    let text = fs::read_to_string(&path).unwrap().replace("\"frame_000000.png\"", "\"precious.txt\"");
    fs::write(&path, text).unwrap();
    fs::write(folder.path().join("precious.txt"), b"mine").unwrap();
    let mut writer =
        SequenceWriter::create(folder.path(), SequenceSettings { first_frame: 5, ..settings() }).unwrap();
    writer.push(&picture(0)).unwrap();
    writer.finish().unwrap();
    assert!(folder.path().join("precious.txt").exists());
}

#[test]
fn a_full_disk_stops_the_sequence_and_leaves_no_unfinished_frame() {
    let folder = tempfile::tempdir().unwrap();
    let opener: Arc<Opener> = Arc::new(small_disk(50));
    let mut writer = SequenceWriter::create_on(folder.path(), settings(), &opener).unwrap();
    let mut pushed = 0;
    let error = loop {
        if let Err(error) = writer.push(&picture(0)) {
            break error;
        }
        pushed += 1;
        assert!(pushed < 10_000, "the disk never got full");
    };
    let RecordError::Io { source, .. } = &error else { panic!("{error:?}") };
    assert_eq!(source.kind(), std::io::ErrorKind::StorageFull);
    assert!(error.to_string().contains("frame_") && !error.is_request(), "{error}");
    assert!(matches!(writer.push(&picture(0)), Err(RecordError::Stopped { .. })));
    drop(writer);
    assert!(files(folder.path()).is_empty());
}

#[test]
fn impossible_sequences_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    assert!(SequenceWriter::create(&file, settings()).unwrap_err().is_request());
    for bad in [
        SequenceSettings { width: 0, ..settings() },
        SequenceSettings { height: 100_000, ..settings() },
        SequenceSettings { fps: f64::NAN, ..settings() },
    ] {
        assert!(SequenceWriter::create(&folder.path().join("new"), bad).unwrap_err().is_request());
    }
    assert!(!folder.path().join("new").exists());
    let empty = SequenceWriter::create(&folder.path().join("empty"), settings()).unwrap();
    assert!(empty.finish().unwrap_err().is_request());
    assert!(files(&folder.path().join("empty")).is_empty());
}

#[test]
fn foreign_manifests_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(read_manifest(folder.path()), Err(RecordError::Io { .. })));
    for text in ["", "[]", "{\"format\": \"other\"}", "\u{0}"] {
        fs::write(folder.path().join("manifest.json"), text).unwrap();
        let error = read_manifest(folder.path()).unwrap_err();
        assert!(error.is_request() && error.to_string().contains("manifest.json"), "{error}");
    }
}

/// Light, depth and transmittance of a frame.
type Numbers = (Vec<[f32; 4]>, Vec<f32>, Vec<f32>);

fn layers(seed: f32) -> Numbers {
    let light = |i: u32| [seed + i as f32 * 0.37, 0.001 * i as f32, 3.0, (i % 5) as f32 * 0.25];
    (
        (0..33 * 7).map(light).collect(),
        (0..33 * 7).map(|i| 1.0 + i as f32 * 1.234_567e-3).collect(),
        (0..33 * 7).map(|i| (i % 11) as f32 / 10.0).collect(),
    )
}

fn exr() -> SequenceSettings {
    SequenceSettings { format: SequenceFormat::Exr, first_frame: 3, fps: 23.976, ..settings() }
}

fn write_exr(folder: &Path, frames: u32) -> Manifest {
    let mut writer = SequenceWriter::create(folder, exr()).unwrap();
    for frame in 0..frames {
        let (light, depth, transmittance) = layers(frame as f32);
        let layers = FrameLayers { light: &light, depth: &depth, transmittance: &transmittance };
        writer.push_layers(&layers).unwrap();
    }
    writer.finish().unwrap();
    read_manifest(folder).unwrap()
}

#[test]
fn exr_files_contain_every_channel_and_their_metadata() {
    use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, Text, read};
    let folder = tempfile::tempdir().unwrap();
    let manifest = write_exr(folder.path(), 3);
    check_files(folder.path(), &manifest);
    assert_eq!(files(folder.path()).len(), 4);
    for frame in 0..3_u32 {
        let path = folder.path().join(format!("frame_{:06}.exr", frame + 3));
        let image =
            read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = image.from_file(&path).unwrap();
        assert_eq!(image.layer_data.len(), 1);
        let layer = &image.layer_data[0];
        let (light, depth, transmittance) = layers(frame as f32);
        let channel = |name: &str| {
            let channel = layer.channel_data.list.iter().find(|c| c.name.eq(name));
            &channel.unwrap_or_else(|| panic!("no {name}")).sample_data
        };
        for (c, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            assert!(matches!(channel(name), FlatSamples::F16(_)), "{name} is half");
            for (read, wanted) in channel(name).values_as_f32().zip(&light) {
                // Half a unit in the last place of 11 bits.
                assert!(
                    (read - wanted[c]).abs() <= wanted[c].abs() / 2048.0 + 1e-7,
                    "{name}: {read} {wanted:?}"
                );
            }
        }
        assert!(channel("Z").values_as_f32().eq(depth.iter().copied()), "depth is exact");
        let read = channel("transmittance.Y").values_as_f32();
        assert!(read.zip(&transmittance).all(|(a, b)| (a - b).abs() < 5e-4));
        assert_eq!(image.attributes.chromaticities.unwrap().red.0, 0.64);
        assert_eq!(layer.attributes.frames_per_second, Some((24_000, 1001)));
        let number = &layer.attributes.other[&Text::from("frame")];
        assert_eq!(format!("{number:?}"), format!("I32({})", frame + 3));
        let comments = layer.attributes.comments.as_ref().unwrap().to_string();
        assert_eq!(comments, "shadow voxel-map");
    }
}

#[test]
fn the_same_light_gives_the_same_exr_file_and_other_light_another() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (first, second) = (write_exr(a.path(), 2), write_exr(b.path(), 2));
    assert_eq!(first.frames, second.frames);
    assert_ne!(first.frames[0].crc32, first.frames[1].crc32, "the control");
}

#[test]
fn light_beyond_half_floats_is_clamped_and_frames_of_the_wrong_kind_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let settings = SequenceSettings { width: 2, height: 1, ..exr() };
    let mut writer = SequenceWriter::create(folder.path(), settings.clone()).unwrap();
    let light = [[1e9, f32::NAN, -1e9, 1.0], [f32::INFINITY, 0.0, 0.0, 0.0]];
    let (depth, transmittance) = ([1e10, 2.0], [1.0, f32::NAN]);
    let good = FrameLayers { light: &light, depth: &depth, transmittance: &transmittance };
    writer.push_layers(&good).unwrap();
    let short = FrameLayers { depth: &depth[1..], ..good };
    assert!(matches!(writer.push_layers(&short), Err(RecordError::FrameSize { .. })));
    assert!(writer.push(&[0; 8]).unwrap_err().is_request());
    writer.finish().unwrap();
    let image = exr::prelude::read_first_rgba_layer_from_file(
        folder.path().join("frame_000003.exr"),
        |size, _| vec![[0.0_f32; 4]; size.area()],
        |pixels, at, (r, g, b, a): (f32, f32, f32, f32)| pixels[at.y() * 2 + at.x()] = [r, g, b, a],
    );
    let pixels = image.unwrap().layer_data.channel_data.pixels;
    assert_eq!(pixels, [[65504.0, 0.0, -65504.0, 1.0], [65504.0, 0.0, 0.0, 0.0]]);
    let mut png = SequenceWriter::create(&folder.path().join("png"), self::settings()).unwrap();
    assert!(png.push_layers(&good).unwrap_err().is_request());
}

/// Writes frames until the writer is dropped. Returns the numbers of the frames that were not kept.
fn go_on(folder: &Path, settings: SequenceSettings, frames: u8) -> Result<Vec<u8>, RecordError> {
    let mut writer = SequenceWriter::create(folder, settings)?;
    let mut drawn = Vec::new();
    for frame in 0..frames {
        if writer.next_is_kept() {
            writer.keep_next();
        } else {
            writer.push(&picture(frame))?;
            drawn.push(frame);
        }
    }
    writer.finish().map(|_| drawn)
}

/// All files of a folder with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    files(folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

#[test]
fn a_sequence_is_resumed_and_damaged_frames_are_written_again() {
    let (whole, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let resume = SequenceSettings { resume: true, ..settings() };
    assert_eq!(go_on(whole.path(), resume.clone(), 8).unwrap(), [0, 1, 2, 3, 4, 5, 6, 7], "nothing to keep");
    let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
    (0..5).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.cancel();
    // One frame is truncated, one changed, one missing.
    let at = |n: u64| folder.path().join(frame_name(n, SequenceFormat::Png));
    let bytes = fs::read(at(1)).unwrap();
    fs::write(at(1), &bytes[..bytes.len() - 5]).unwrap();
    fs::write(at(2), fs::read(at(3)).unwrap()).unwrap();
    fs::remove_file(at(4)).unwrap();
    assert_eq!(go_on(folder.path(), resume.clone(), 8).unwrap(), [1, 2, 4, 5, 6, 7]);
    assert!(contents(folder.path()) == contents(whole.path()), "the same as without the interruption");
    // Resuming again has nothing to do, and a longer sequence continues.
    assert_eq!(go_on(folder.path(), resume.clone(), 8).unwrap(), [0_u8; 0]);
    assert_eq!(go_on(folder.path(), resume, 9).unwrap(), [8]);
    assert_eq!(go_on(folder.path(), settings(), 2).unwrap(), [0, 1], "negative control: without resuming");
}

#[test]
fn a_different_sequence_is_not_resumed_and_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    go_on(folder.path(), settings(), 3).unwrap();
    let before = contents(folder.path());
    let resume = SequenceSettings { resume: true, ..settings() };
    let with = |settings| SequenceSettings { settings, ..resume.clone() };
    for (wanted, said) in [
        (SequenceSettings { width: 31, ..resume.clone() }, "size was 33x7 and is 31x7 now"),
        (SequenceSettings { fps: 25.0, ..resume.clone() }, "rate was 24 and is 25 now"),
        (SequenceSettings { first_frame: 1, ..resume.clone() }, "it contains frame 0"),
        (
            with(serde_json::json!({ "shadow": "exact", "resolution": 128 })),
            "shadow was voxel-map and is exact now",
        ),
        (with(serde_json::json!({ "shadow": "voxel-map" })), "resolution was 128 and is none now"),
    ] {
        let error = go_on(folder.path(), wanted, 3).unwrap_err();
        assert!(error.is_request() && error.to_string().contains(said), "{error}");
        assert!(contents(folder.path()) == before, "{said}");
    }
    // The message names the parts, not their fingerprints.
    let parts = |lights: &str| serde_json::json!({ "project": { "lights": lights, "camera": "aa" } });
    go_on(folder.path(), SequenceSettings { settings: parts("12"), ..settings() }, 1).unwrap();
    let error = go_on(folder.path(), with(parts("34")), 1).unwrap_err().to_string();
    assert!(error.contains("lights changed") && !error.contains("camera"), "{error}");
}

#[test]
fn one_recording_at_a_time_writes_to_a_folder_or_a_film() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = SequenceWriter::create(folder.path(), settings()).unwrap();
    for resume in [false, true] {
        let error =
            SequenceWriter::create(folder.path(), SequenceSettings { resume, ..settings() }).unwrap_err();
        assert!(error.to_string().contains("another recording is writing"), "{error}");
    }
    first.push(&picture(0)).unwrap();
    assert_eq!(first.finish().unwrap().frames, 1);
    go_on(folder.path(), settings(), 1).unwrap();

    let path = folder.path().join("a.mp4");
    let film = crate::FilmSettings { width: 32, height: 32, fps: 24.0, quality: crate::FilmQuality::Good };
    let mut first = crate::FilmWriter::create(&path, film).unwrap();
    let error = crate::FilmWriter::create(&path, film).unwrap_err();
    assert!(
        error.to_string().contains("a.mp4") && error.to_string().contains("another recording"),
        "{error}"
    );
    first.push(&[90; 32 * 32 * 4]).unwrap();
    assert_eq!(first.finish().unwrap().frames, 1);
}

#[test]
fn images_of_a_sequence_that_was_continued_stay_when_what_a_crash_left_is_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let journal = at.join("manifest.partial");
    let resume = || SequenceWriter::create(at, SequenceSettings { resume: true, ..settings() }).unwrap();
    let mut writer = resume();
    (0..3).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.finish().unwrap();
    let mut writer = resume();
    let head = fs::read(&journal).unwrap();
    (0..3).for_each(|_| writer.keep_next());
    (3..5).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.finish().unwrap();
    let whole = read_manifest(at).unwrap();
    // What a crash leaves just before the end.
    let crash = |text: &[u8]| {
        fs::write(&journal, text).unwrap();
        fs::remove_file(at.join("manifest.json")).unwrap();
    };
    let lines: String =
        whole.frames[3..].iter().map(|frame| serde_json::to_string(frame).unwrap() + "\n").collect();
    let text = [&head[..], lines.as_bytes()].concat();
    crash(&text);
    assert_eq!(keep_unfinished(at).unwrap().expect("images").frames, 5);
    // A second crash, when it was continued again: the images of the first one are still not listed.
    crash(&text);
    let writer = resume();
    let again = fs::read(&journal).unwrap();
    assert_eq!(again, text);
    drop(writer);
    crash(&again);
    discard_unfinished(at).unwrap();
    let left = read_manifest(at).unwrap();
    assert_eq!((left.complete, &left.frames[..]), (false, &whole.frames[..3]));
    assert_eq!(files(at).len(), 4, "three images and their manifest");
}
