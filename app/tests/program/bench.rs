//! `lovelock bench`.

use crate::tool::run;

#[test]
fn a_scene_is_measured_stage_by_stage() {
    let dir = tempfile::tempdir().expect("a folder");
    let args = [
        "bench",
        "smooth",
        "--frames",
        "2",
        "--size",
        "96x64",
        "--backend",
        "cpu",
        "--json",
        "-o",
        "a b.csv",
    ];
    let ran = run(dir.path(), args);
    let json = ran.done().json();
    assert!(json["machine"].as_str().is_some_and(|name| name.contains("threads")), "{json}");
    let scene = &json["scenes"][0];
    assert_eq!((&scene["scene"], &scene["backend"]), (&"smooth".into(), &"cpu".into()));
    assert_eq!(scene["segments"], 100_500);
    assert_eq!(scene["points"], 103_850);
    let stages = scene["stages"].as_array().expect("stages");
    let of = |name: &str| stages.iter().find(|stage| stage["name"] == name).expect(name);
    for name in ["motion", "simulate", "interpolate", "shadow", "draw", "draw/points", "draw/tiles", "frame"]
    {
        let [least, median, most] =
            ["min_ms", "median_ms", "max_ms"].map(|key| of(name)[key].as_f64().expect("a number"));
        assert!(0.0 < least && least <= median && median <= most, "{name}: {scene}");
    }
    assert_eq!(of("simulate")["published_ms"], 70.0);
    assert_eq!(of("frame")["published_ms"], 160.0);
    assert!(of("motion")["published_ms"].is_null());
    assert!(of("frame")["median_ms"].as_f64() >= of("draw")["median_ms"].as_f64());
    let csv = std::fs::read_to_string(dir.path().join("a b.csv")).expect("the file");
    assert_eq!(csv.lines().count(), 1 + stages.len());
}

#[test]
fn wrong_requests_are_refused_before_any_work() {
    let dir = tempfile::tempdir().expect("a folder");
    let wrong: [(&[&str], &str); 5] = [
        (&["bench", "wig"], "smooth-2m"),
        (&["bench", "--frames", "0"], "1..=1000"),
        (&["bench", "--backend", "magic"], "expected auto, gpu or cpu"),
        (&["bench", "smooth", "-o", "no folder/x.csv"], "no folder"),
        (&["bench", "smooth", "--size", "8192x8192", "--backend", "cpu"], "at most 35 million"),
    ];
    for (args, wanted) in wrong {
        let ran = run(dir.path(), args);
        let said = &ran.stderr;
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:?}");
        assert!(said.contains(wanted), "{args:?}: {said}");
    }
}
