//! `lovelock record` of portraits: light rigs, backgrounds, the turntable and depth of field.

use crate::tool::{names, run, saved, small_project};

/// A folder with a small project and a photograph of one colour.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    let room = image::RgbImage::from_pixel(40, 30, image::Rgb([20, 120, 220]));
    room.save(dir.path().join("room.png")).expect("a picture");
    dir
}

const RECORD: [&str; 6] = ["record", "p.lovelock", "--backend", "cpu", "--json", "-o"];

fn pixel(dir: &tempfile::TempDir, file: &str, x: u32, y: u32) -> [u8; 3] {
    image::open(dir.path().join(file)).expect("an image").into_rgb8().get_pixel(x, y).0
}

#[test]
fn a_turntable_is_one_turn_and_a_rig_lights_it() {
    let dir = folder();
    let more = ["turn", "--turntable", "1", "--fps", "4", "--size", "64x48", "--lights", "rim-at-night"];
    let json = run(dir.path(), RECORD.iter().chain(&more)).done().json();
    assert_eq!(json["frames"], 4);
    assert_eq!(names(&dir.path().join("turn")).len(), 5, "four frames and the manifest");
    let corner = pixel(&dir, "turn/frame_000000.png", 0, 0);
    assert!(corner.iter().all(|&byte| byte < 40), "the night is dark: {corner:?}");
    let both = ["two", "--turntable", "1", "--fps", "4", "--frames", "0..2", "--size", "64x48"];
    assert_eq!(run(dir.path(), RECORD.iter().chain(&both)).done().json()["frames"], 2);
    for (option, value) in [("--turntable", "0"), ("--turntable", "inf"), ("--lights", "noon")] {
        let ran = run(dir.path(), RECORD.iter().chain(&["y", option, value]));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(value), "{ran:?}");
    }
}

#[test]
fn a_photograph_is_behind_the_figure_in_its_own_colours_also_through_a_lens() {
    let dir = folder();
    let usual =
        ["--frames", "0..1", "--size", "64x48", "--background", "room.png", "--set", "picture.ground=false"];
    let lens = ["--set", "camera.lens.enabled=true", "--set", "camera.lens.samples=4"];
    for (out, more) in [("sharp", &[][..]), ("soft", &lens[..])] {
        let output = [out];
        let json = run(dir.path(), RECORD.iter().chain(&output).chain(&usual).chain(more)).done().json();
        assert_eq!(json["lens_samples"], if more.is_empty() { 1 } else { 4 });
        let corner = pixel(&dir, &format!("{out}/frame_000000.png"), 1, 1);
        assert!(corner.iter().zip([20, 120, 220]).all(|(a, b)| a.abs_diff(b) <= 2), "{out}: {corner:?}");
    }
}

#[test]
fn a_background_that_is_no_picture_is_refused_by_name() {
    let dir = folder();
    std::fs::write(dir.path().join("broken.png"), b"\x89PNG\r\n\x1a\nand no more").expect("a file");
    for (name, found) in
        [("broken.png", "damaged"), ("gone.png", "not found"), ("p.lovelock", "must be a PNG")]
    {
        let ran = run(dir.path(), RECORD.iter().chain(&["x", "--frames", "0..1", "--background", name]));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stdout.contains(name) && ran.stdout.contains(found), "{ran:?}");
    }
}
