//! `lovelock record`.

use std::path::Path;
use std::sync::OnceLock;

use lovelock_project::project::{HairSource, MotionSource};
use lovelock_record::read_film;
use serde_json::Value;
use tempfile::TempDir;

use crate::tool::{Outcome, lovelock, names, run, run_command, saved, small_project};

/// The keys of the JSON output that scripts may rely on.
const KEYS: [&str; 18] = [
    "out",
    "frames",
    "fps",
    "width",
    "height",
    "backend",
    "adapter",
    "shadow",
    "draw",
    "transparency",
    "strands",
    "segments",
    "frame_ms",
    "stage_ms",
    "max_stretch",
    "max_penetration_m",
    "recovered_guides",
    "state_hash",
];

/// The same four frames as a film and as image sequences, recorded once with different numbers of threads and shared by
/// several tests.
struct Recordings {
    dir: TempDir,
    film: Outcome,
    /// Recorded with 1, 2 and 8 threads.
    pictures: Vec<Outcome>,
}

const FILM: &str = "films of mine/größe & ü.mp4";

fn recordings() -> Option<&'static Recordings> {
    static RECORDINGS: OnceLock<Option<Recordings>> = OnceLock::new();
    let make = || {
        let dir = tempfile::tempdir().expect("a folder");
        saved(dir.path(), "ein Projekt ü.lovelock", &small_project());
        let record = |threads: &str, backend: &str, out: &str| {
            let args = [
                "record",
                "ein Projekt ü.lovelock",
                "--frames",
                "3..7",
                "--backend",
                backend,
                "--json",
                "-o",
                out,
            ];
            run_command(lovelock().current_dir(dir.path()).args(args).env("RAYON_NUM_THREADS", threads))
        };
        let film = record("2", "auto", FILM);
        let pictures =
            ["1", "2", "8"].map(|threads| record(threads, "cpu", &format!("frames {threads}"))).into();
        Some(Recordings { dir, film, pictures })
    };
    RECORDINGS.get_or_init(make).as_ref()
}

#[test]
fn a_recorded_film_can_be_read_back() {
    let Some(recordings) = recordings() else { return };
    let printed = &recordings.film.done().stderr;
    assert!(!printed.contains("error"), "an error where nothing failed: {printed}");
    let film = read_film(&recordings.dir.path().join(FILM)).expect("a film");
    assert_eq!((film.width, film.height, film.frames), (96, 64, 4));
    assert_eq!(film.codec, "avc1");
    // Four frames at 30 per second; the time base of the file may round the duration by less than a thousandth.
    assert!((film.duration_secs - 4.0 / 30.0).abs() < 1e-3, "{}", film.duration_secs);
    assert_eq!(
        names(&recordings.dir.path().join("films of mine")),
        ["größe & ü.mp4"],
        "other files are left beside it"
    );
}

#[test]
fn the_json_has_the_documented_keys() {
    let Some(recordings) = recordings() else { return };
    for ran in recordings.pictures.iter().chain([&recordings.film]) {
        let json = ran.done().json();
        for key in KEYS {
            assert!(!json[key].is_null(), "no `{key}` in {json}");
        }
        for stage in ["motion", "simulate", "interpolate", "shadow", "draw", "encode"] {
            assert!(json["stage_ms"][stage].as_f64().is_some_and(|ms| ms >= 0.0), "{stage}: {json}");
        }
        assert_eq!((&json["frames"], &json["width"], &json["height"]), (&4.into(), &96.into(), &64.into()));
        assert_eq!((&json["fps"], &json["shadow"]), (&30.0.into(), &"voxel-map".into()));
        assert_eq!(
            (&json["strands"], &json["segments"]),
            (&128.into(), &1280.into()),
            "not 16 wisps of 8 strands of 10 segments"
        );
        assert_eq!(json["recovered_guides"], 0);
        assert!(json["max_stretch"].as_f64().is_some_and(|v| v < 1e-3), "{json}");
        assert!(json["frame_ms"].as_f64().is_some_and(|v| v > 0.0), "{json}");
        let hash = json["state_hash"].as_str().expect("text");
        assert!(hash.len() == 16 && hash.bytes().all(|b| b.is_ascii_hexdigit()), "{hash}");
        for line in ran.stderr.lines() {
            assert!(!line.starts_with('{') && !line.contains('\r'), "progress is not plain lines: {line:?}");
        }
    }
    assert_eq!(recordings.film.json()["out"], FILM);
}

#[test]
fn the_number_of_threads_does_not_change_a_byte() {
    let Some(recordings) = recordings() else { return };
    let hash = recordings.film.done().json()["state_hash"].clone();
    let pictures = |threads: &str| -> Vec<(String, Vec<u8>)> {
        let folder = recordings.dir.path().join(format!("frames {threads}"));
        let pngs =
            names(&folder).into_iter().filter(|name| Path::new(name).extension().is_some_and(|e| e == "png"));
        pngs.map(|name| (name.clone(), std::fs::read(folder.join(name)).expect("a picture"))).collect()
    };
    for ran in &recordings.pictures {
        assert_eq!(ran.done().json()["state_hash"], hash);
    }
    let one = pictures("1");
    let found: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(found, ["frame_000003.png", "frame_000004.png", "frame_000005.png", "frame_000006.png"]);
    assert!(one == pictures("2") && one == pictures("8"));
    assert_ne!(one[0].1, one[3].1, "the first and the last frame are the same, so the test compares nothing");
}

#[test]
fn an_image_sequence_has_a_manifest_and_no_temporary_files() {
    let Some(recordings) = recordings() else { return };
    let folder = recordings.dir.path().join("frames 1");
    let found = names(&folder);
    assert_eq!(found.len(), 5, "{found:?}");
    let manifest = found
        .iter()
        .find(|name| Path::new(name).extension().is_some_and(|ending| ending == "json"))
        .expect("a manifest");
    let text = std::fs::read_to_string(folder.join(manifest)).expect("a manifest");
    let manifest: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(manifest["complete"], true);
    assert_eq!(manifest["frames"].as_array().map(Vec::len), Some(4));
}

#[test]
fn options_override_the_project() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    let args = [
        "--json",
        "record",
        "p.lovelock",
        "-o",
        "a.mp4",
        "--frames",
        "0..2",
        "--fps",
        "24",
        "--size",
        "64x48",
        "--shadow",
        "none",
        "--backend",
        "cpu",
    ];
    let ran = run(dir.path(), args);
    let json = ran.done().json();
    assert_eq!((&json["fps"], &json["width"], &json["height"]), (&24.0.into(), &64.into(), &48.into()));
    assert_eq!((&json["shadow"], &json["backend"]), (&"none".into(), &"cpu".into()));
    let film = read_film(&dir.path().join("a.mp4")).expect("a film");
    assert_eq!((film.width, film.height, film.frames), (64, 48, 2));
    // Without --json the same facts are printed as text.
    let ran = run(dir.path(), ["record", "p.lovelock", "-o", "a.mp4", "--frames", "0..1"]);
    assert!(ran.done().stdout.contains("a.mp4: 1 frames of 96x64"), "{ran:?}");
    assert_eq!(
        read_film(&dir.path().join("a.mp4")).expect("the new film").frames,
        1,
        "the old film was not replaced"
    );
}

#[test]
fn a_project_with_missing_files_records_and_reports_them() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    project.set_hair_file(dir.path().join("no such hair.hair"));
    project.set_motion_file(dir.path().join("no such dance.bvh"));
    project.set_body_file(dir.path().join("no such body.glb"));
    assert_eq!((project.hair.source, project.motion.source), (HairSource::File, MotionSource::File));
    saved(dir.path(), "p.lovelock", &project);
    let ran = run(dir.path(), ["record", "p.lovelock", "-o", "a.mp4", "--frames", "0..2", "--json"]);
    let json = ran.done().json();
    let notes = json["notes"].to_string();
    for file in ["no such hair.hair", "no such dance.bvh", "no such body.glb"] {
        assert!(ran.stderr.contains(file), "{file} is not reported: {}", ran.stderr);
        assert!(notes.contains(file), "{file} is not in {notes}");
    }
    assert_eq!(read_film(&dir.path().join("a.mp4")).expect("a film").frames, 2);
}

#[cfg(unix)]
#[test]
fn a_full_disk_stops_the_recording_without_partial_files() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    for (out, limit) in [("a.mp4", 4), ("frames", 2)] {
        // The limit on file sizes makes writing fail as on a full disk; ignoring XFSZ avoids the signal.
        let script = format!(
            "trap '' XFSZ; ulimit -f {limit}; exec \"$0\" record p.lovelock -o {out} --frames 0..12 --size 256x192 --json"
        );
        let mut shell = std::process::Command::new("sh");
        shell.current_dir(dir.path()).arg("-c").arg(script).arg(env!("CARGO_BIN_EXE_lovelock"));
        // Keeps drivers from writing their caches of compiled shaders, which the limit would affect too.
        shell.env("MESA_SHADER_CACHE_DISABLE", "true");
        let ran = run_command(&mut shell);
        assert_eq!(ran.code, Some(1), "{ran:?}");
        let told: Vec<&str> = ran.stderr.lines().filter(|line| line.starts_with("lovelock:")).collect();
        assert!(
            matches!(told[..], [line] if line.contains(out)),
            "not one line that names the file: {ran:?}"
        );
        let error = &ran.json()["error"];
        assert!(error["file"].as_str().is_some_and(|file| file.contains(out)), "{error}");
        let left = names(dir.path());
        assert!(left.iter().all(|name| name == "p.lovelock" || name == "frames"), "{left:?}");
    }
    let frames = dir.path().join("frames");
    if frames.is_dir() {
        for name in names(&frames) {
            assert!(!name.contains("partial"), "{name}");
            if Path::new(&name).extension().is_some_and(|ending| ending == "png") {
                let bytes = std::fs::read(frames.join(&name)).expect("a picture");
                assert!(bytes.ends_with(b"IEND\xae\x42\x60\x82"), "{name} is truncated");
            }
        }
    }
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    std::fs::write(dir.path().join("a file"), b"x").expect("a file");
    for out in ["a file/film.mp4", "a file/frames"] {
        let ran = run(dir.path(), ["record", "p.lovelock", "-o", out, "--frames", "0..1"]);
        assert!(matches!(ran.code, Some(1 | 2)), "{ran:?}");
        let last = ran.stderr.lines().last().unwrap_or_default();
        assert!(last.starts_with("lovelock:") && last.contains(out), "{ran:?}");
        assert_eq!(ran.stdout, "");
    }
    assert_eq!(names(dir.path()), ["a file", "p.lovelock"]);
}

#[test]
fn only_files_named_on_the_command_line_must_exist() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    project.set_hair_file(dir.path().join("no such hair.hair"));
    saved(dir.path(), "p.lovelock", &project);
    let record = |option: &str, file: &str| {
        let file = data.join(file);
        let args = ["record", "p.lovelock", "-o", "a.mp4", "--frames", "0..1", option];
        run(dir.path(), args.iter().map(std::ffi::OsStr::new).chain([file.as_os_str()]))
    };
    // Missing files of the project are replaced by defaults.
    let ran = record("--motion", "motion/cmu1_jumping_jacks.bvh");
    assert!(ran.done().stderr.contains("no such hair.hair"), "{}", ran.stderr);
    std::fs::remove_file(dir.path().join("a.mp4")).expect("the film");
    // Broken files on the command line are errors.
    for (option, file) in
        [("--hair", "hair/broken/truncated.hair"), ("--body", "characters/broken/badArray.gltf")]
    {
        let ran = record(option, file);
        let line = ran.refused(2);
        assert!(line.contains(file), "{line}");
        assert_eq!(names(dir.path()), ["p.lovelock"]);
    }
}

#[test]
fn files_on_the_command_line_replace_those_of_the_project() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let dir = tempfile::tempdir().expect("a folder");
    let hair = data.join("hair/tressfx/sintel_vk.tfx");
    let motion = data.join("motion/cmu1_jumping_jacks.bvh");
    let ran = run_command(lovelock().current_dir(dir.path()).args([
        "record".as_ref(),
        "-o".as_ref(),
        "a.mp4".as_ref(),
        "--frames".as_ref(),
        "0..2".as_ref(),
        "--size".as_ref(),
        "96x64".as_ref(),
        "--json".as_ref(),
        "--hair".as_ref(),
        hair.as_os_str(),
        "--motion".as_ref(),
        motion.as_os_str(),
    ]));
    let json = ran.done().json();
    assert_eq!(json["strands"], 228, "strands of the file are missing");
    assert_eq!(read_film(&dir.path().join("a.mp4")).expect("a film").frames, 2);
}

#[test]
fn the_gpu_records_other_methods_and_reports_its_passes_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    let record = |backend: &str, shadow: &str, transparency: &str| {
        let args = ["record", "p.lovelock", "-o", "a", "--frames", "0..2", "--json", "--backend", backend];
        run(dir.path(), args.iter().chain(&["--shadow", shadow, "--transparency", transparency]))
    };
    for (shadow, transparency, passes) in [
        ("occupancy-maps", "occupancy-order", ["shadow/range", "draw/occupancy"]),
        ("density-clustering", "exact", ["shadow/clusters", "draw/scatter"]),
    ] {
        let ran = record("gpu", shadow, transparency);
        if ran.stderr.contains("no graphics adapter") {
            return lovelock_testkit::skip_without_adapter(&ran.stderr);
        }
        let json = ran.done().json();
        assert_eq!((&json["backend"], &json["shadow"]), (&"gpu".into(), &shadow.into()));
        assert_eq!(json["transparency"], transparency);
        assert_eq!(json["frames"], 2);
        assert!(json["shadow_bytes"].as_u64() > Some(0) && json["draw_bytes"].as_u64() > Some(0), "{json}");
        for pass in passes {
            // A GPU without timers reports no passes.
            let told = json["passes_ms"].as_object().expect("passes");
            assert!(told.is_empty() || told[pass].as_f64() > Some(0.0), "{pass}: {json}");
        }
    }
    // Control: the CPU backend has other passes.
    let json = record("cpu", "occupancy-maps", "occupancy-order").done().json();
    assert_eq!(json["backend"], "cpu");
    assert!(json["passes_ms"]["draw/tiles"].as_f64() > Some(0.0), "{json}");
    assert!(json["passes_ms"]["shadow/range"].is_null());
}

/// A Yuksel `.hair` file of 40 strands with three points each: a header of 128 bytes, then the points.
fn tuft() -> Vec<u8> {
    let mut bytes = b"HAIR".to_vec();
    for number in [40_u32, 120, 2, 2] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.resize(128, 0);
    for (root, point) in (0..40).flat_map(|root| (0..3).map(move |point| (root, point))) {
        for v in [root as f32 * 0.4, 170.0 - 8.0 * point as f32, 0.0] {
            bytes.extend(v.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn a_take_reads_files_outside_its_folder_only_if_they_are_named() {
    let (hair, takes) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let (file, other) = (hair.path().join("tuft.hair"), hair.path().join("other.hair"));
    std::fs::write(&file, tuft()).expect("a file");
    std::fs::write(&other, tuft()).expect("a file");
    let run = |args: &[&str]| run(takes.path(), args);
    let (file, other) = (file.to_string_lossy().into_owned(), other.to_string_lossy().into_owned());
    let set = "timeline.preroll_secs=0";
    run(&["record", "--hair", &file, "--set", set, "--frames", "0..2", "-o", "d.take", "--json"]).done();
    let info = run(&["info", "d.take", "--json"]).done().json();
    assert_eq!((&info["kind"], &info["condition"]), (&Value::from("take"), &Value::from("whole")));
    assert_eq!(info["complete"], Value::from(true));
    let draw = ["record", "d.take", "--size", "32x32", "--backend", "cpu", "--json", "-o", "film.mp4"];
    // Without what this machine remembers, as on another one.
    let elsewhere = |args: &[&str]| {
        let state = hair.path().join("state");
        run_command(lovelock().current_dir(takes.path()).args(args).env("LOVELOCK_STATE", state))
    };
    let refused = elsewhere(&draw);
    assert!(refused.refused(2).contains("tuft.hair"), "{refused:?}");
    let drawn = elsewhere(&[&draw[..], &["--allow", &file]].concat()).done().json();
    assert_eq!(drawn["strands"], Value::from(40));
    assert!(elsewhere(&draw).code == Some(2), "what is allowed once for a film is not remembered");
    // The take was recorded here, where the file was named.
    let drawn = run(&draw).done().json();
    assert_eq!(drawn["strands"], Value::from(40));
    let refused = run(&[&draw[..], &["--hair", &other]].concat());
    assert!(refused.refused(2).contains("--hair"), "{refused:?}");
    let refused = run(&[&draw[..], &["--preset", "curly"]].concat());
    assert!(refused.refused(2).contains("--preset"), "{refused:?}");
    let drawn = run(&[&draw[..], &["--hair", &file]].concat()).done().json();
    assert_eq!((&drawn["frames"], &drawn["strands"]), (&Value::from(2), &Value::from(40)));
}

#[test]
fn takes_beside_each_other_give_the_same_image_each_time_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let run = |args: &[&str]| run(dir.path(), args);
    let mut project = small_project();
    saved(dir.path(), "calm.lovelock", &project);
    project.simulation.wind.speed = 12.0;
    saved(dir.path(), "windy.lovelock", &project);
    for name in ["calm", "windy"] {
        let (project, out) = (format!("{name}.lovelock"), format!("{name}.take"));
        run(&["record", &project, "-o", &out, "--frames", "0..10", "--json"]).done();
    }
    let draw = |beside: &str, out: &str| {
        let args =
            ["record", "calm.take", "--beside", beside, "-o", out, "--frames", "8..9", "--size", "320x160"];
        run(&[&args[..], &["--backend", "cpu", "--json"]].concat()).done();
        let picture = std::fs::read_dir(dir.path().join(out)).expect("a folder").filter_map(Result::ok);
        let picture =
            picture.map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "png"));
        let decoded = image_of(&picture.expect("a picture"));
        let half = |from: usize| -> Vec<u8> {
            decoded.chunks_exact(4 * 320).flat_map(|row| row[4 * from..4 * (from + 150)].to_vec()).collect()
        };
        // The last 150 columns of each pane; a pane is 158 wide, with a gap of 4 between the two.
        [half(8), half(170)]
    };
    let [calm, windy] = draw("windy.take", "a");
    assert!(
        draw("windy.take", "b") == [calm.clone(), windy.clone()],
        "the image depends on the run, for instance on a measured time"
    );
    assert!(calm != windy);
    // Control: a take beside itself differs only in the labels, which are in the top rows.
    let [same, itself] = draw("calm.take", "c");
    assert!(same == calm);
    let below = |half: &[u8]| half[4 * 150 * 40..].to_vec();
    assert!(below(&itself) == below(&calm));
    let refused = run(&["record", "calm.take", "--beside", "calm.lovelock", "-o", "d"]);
    assert!(refused.refused(2).contains("must be a take"), "{refused:?}");
}

/// The pixels of a PNG file, four bytes per pixel.
fn image_of(path: &std::path::Path) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG file");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a picture");
    let channels = info.color_type.samples();
    bytes.truncate(info.buffer_size());
    bytes
        .chunks_exact(channels)
        .flat_map(|p| [p[0], p[1], p[2], if channels == 4 { p[3] } else { 255 }])
        .collect()
}
