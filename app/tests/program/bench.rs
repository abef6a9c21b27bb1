//! `lovelock bench`.

use crate::tool::run;

#[test]
fn a_scene_of_the_simulation_is_measured() {
    let dir = tempfile::tempdir().expect("a folder");
    let json =
        run(dir.path(), ["bench", "simulate-402", "--frames", "1", "--json", "-o", "a b.csv"]).done().json();
    assert!(json["machine"].as_str().is_some_and(|name| name.contains("threads")), "{json}");
    let scene = &json["scenes"][0];
    let stages = scene["stages"].as_array().expect("stages");
    for stage in stages {
        let [least, median, most] =
            ["min_ms", "median_ms", "max_ms"].map(|key| stage[key].as_f64().expect("a number"));
        assert!(0.0 < least && least <= median && median <= most, "{stage}");
        assert!(stage["multiple"].as_f64().is_some_and(|multiple| multiple > 0.0), "{stage}");
        assert!(stage["change"].is_null(), "there is no earlier run");
    }
    let csv = std::fs::read_to_string(dir.path().join("a b.csv")).expect("the file");
    assert_eq!(csv.lines().count(), 1 + stages.len());
    assert!(csv.lines().skip(1).all(|line| line.contains("a Pentium 4 at 3 GHz")), "{csv}");
    assert!(scene["published_note"].as_str().is_some_and(|note| note.contains("67 ms")), "{scene}");
    assert!(!stages.is_empty() && json["yardstick"]["copy_gb_per_s"].as_f64() > Some(0.0), "{json}");
}

#[test]
fn the_speed_up_of_every_stage_is_printed_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let args = ["bench", "simulate-402", "--frames", "2", "--threads", "1,2", "-o", "a.csv"];
    let text = run(dir.path(), args).done().stdout.clone();
    let heading = text.lines().find(|line| line.contains("2 threads")).expect("a heading");
    assert!(heading.matches("speed-up").count() == 2, "{text}");
    let line = text.lines().find(|line| line.trim().starts_with("animation/relaxation")).expect("a stage");
    assert_eq!(line.split_whitespace().nth(2), Some("1.00"), "{line}");
    let csv = std::fs::read_to_string(dir.path().join("a.csv")).expect("the file");
    assert_eq!(csv.lines().count(), 1 + 2 * 5, "{csv}");
}

#[test]
fn every_stage_of_a_scene_is_measured_long_suite() {
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
    for name in [
        "motion",
        "simulate",
        "interpolate",
        "animation",
        "shadow",
        "draw",
        "draw/points",
        "draw/tiles",
        "picture",
        "frame",
    ] {
        let [least, median, most] =
            ["min_ms", "median_ms", "max_ms"].map(|key| of(name)[key].as_f64().expect("a number"));
        assert!(0.0 < least && least <= median && median <= most, "{name}: {scene}");
    }
    assert_eq!(of("animation")["published_ms"], 70.0);
    assert!(of("simulate")["published_ms"].is_null(), "the published animation includes the strands");
    assert_eq!(of("frame")["published_ms"], 160.0);
    assert!(of("motion")["published_ms"].is_null());
    assert!(of("frame")["median_ms"].as_f64() >= of("draw")["median_ms"].as_f64());
    let picture = of("picture")["median_ms"].as_f64().expect("a number");
    let rate = scene["pictures_per_second"].as_f64().expect("a number");
    // Conversion to text may change the last digit.
    assert!((rate * picture / 1e3 - 1.0).abs() < 1e-12, "{rate} {picture}");
    assert!(scene["published_note"].as_str().is_some_and(|note| note.contains("6 frames")), "{scene}");
    let csv = std::fs::read_to_string(dir.path().join("a b.csv")).expect("the file");
    assert_eq!(csv.lines().count(), 1 + stages.len());
    for figure in ["copy_gb_per_s", "multiply_adds_g_per_s", "scattered_adds_m_per_s"] {
        assert!(json["yardstick"][figure].as_f64().is_some_and(|figure| figure > 0.0), "{figure}: {json}");
    }
    for (name, unit) in
        [("interpolate", "bytes copied per point"), ("shadow", "scattered additions per point and light")]
    {
        assert_eq!(of(name)["multiple_of"], unit, "{name}");
        assert!(of(name)["multiple"].as_f64().is_some_and(|multiple| multiple > 0.0), "{name}: {scene}");
        assert!(of(name)["change"].is_null(), "there is no earlier run");
    }
}

#[test]
fn a_run_is_compared_with_an_earlier_one_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let args = ["bench", "simulate-402", "--frames", "2", "--json"];
    let first = run(dir.path(), args).done().json();
    assert!(first["comparison"].is_null());
    // As if the earlier run had been a hundred times as fast in one stage and as slow in the others.
    let mut earlier = first.clone();
    let stages = earlier["scenes"][0]["stages"].as_array_mut().expect("stages");
    for (stage, factor) in stages.iter_mut().zip([0.01, 100.0, 100.0, 100.0, 100.0]) {
        stage["multiple"] = (stage["multiple"].as_f64().expect("a multiple") * factor).into();
    }
    std::fs::write(dir.path().join("before.json"), earlier.to_string()).expect("written");
    let second = run(dir.path(), args.iter().chain(&["--baseline", "before.json"])).done().json();
    let slower = second["comparison"]["slower"].as_array().expect("a comparison");
    assert_eq!(second["comparison"]["compared"], 5);
    assert_eq!((slower.len(), &slower[0]["stage"]), (1, &"simulate/direct".into()), "{second}");
    let other = run(dir.path(), ["bench", "smooth", "--baseline", "before.json"]);
    assert!(
        other.refused(2).contains("before.json: found simulate-402; must contain one of the measured scenes")
    );
    let broken = &earlier.to_string()[..100];
    std::fs::write(dir.path().join("before.json"), broken).expect("written");
    let other = run(dir.path(), ["bench", "smooth", "--baseline", "before.json"]);
    assert!(other.refused(2).contains("must be the output of `lovelock bench --json`"));
}

#[test]
fn a_published_scene_uses_its_own_settings_and_has_published_figures_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let measure = |more: &[&str]| {
        let args = ["bench", "woman-300k", "--frames", "1", "--backend", "cpu", "--json"];
        run(dir.path(), args.iter().chain(more)).done().json()["scenes"][0].clone()
    };
    let published = |scene: &serde_json::Value, name: &str| {
        let stages = scene["stages"].as_array().expect("stages");
        stages.iter().find(|stage| stage["name"] == name).expect(name)["published_ms"].as_f64()
    };
    let own = measure(&[]);
    assert_eq!((&own["strands"], &own["segments"]), (&20_000.into(), &300_000.into()));
    assert_eq!((&own["width"], &own["height"]), (&800.into(), &600.into()));
    assert_eq!(own["shadow"], "occupancy-maps");
    assert_eq!(own["transparency"], "occupancy-order");
    assert_eq!(published(&own, "interpolate"), Some(2.9));
    assert_eq!(published(&own, "picture").map(|ms| (1e4 / ms).round()), Some(373.0));
    assert!(own["published_note"].as_str().is_some_and(|note| note.contains("Sintorn")), "{own}");
    // Published figures do not apply to another method or size.
    let other = measure(&["--size", "96x64", "--shadow", "voxel-map", "--transparency", "sorted"]);
    assert_eq!((&other["width"], &other["shadow"]), (&96.into(), &"voxel-map".into()));
    assert_eq!(other["transparency"], "sorted");
    assert_eq!(published(&other, "interpolate").or(published(&other, "picture")), None);
    assert!(other["published_note"].is_null());
}

#[test]
fn wrong_requests_are_rejected_before_any_work() {
    let dir = tempfile::tempdir().expect("a folder");
    let wrong: [(&[&str], &str); 15] = [
        (&["bench", "wig"], "smooth-2m"),
        (&["bench", "wig"], "voxel-map, occupancy-order or reference"),
        (&["bench", "--baseline", "none.json"], "none.json"),
        (&["bench", "--frames", "0"], "1..=1000"),
        (&["bench", "--backend", "magic"], "must be auto, gpu or cpu"),
        (&["bench", "--shadow", "magic"], "occupancy-maps"),
        (&["bench", "--transparency", "magic"], "occupancy-order"),
        (&["bench", "--draw", "magic"], "clusters"),
        (&["bench", "smooth", "--threads", "1,0"], "1..=256"),
        (&["bench", "smooth", "--threads", "1,1024"], "1024 is not in 1..=256"),
        (&["bench", "smooth", "--threads", "1", "--backend", "gpu"], "must be used with cpu"),
        (&["bench", "locks", "--threads", "1"], "without a scene"),
        (&["bench", "smooth", "--threads", "1", "--baseline", "x.json"], "--baseline"),
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

#[test]
fn locks_are_measured_through_the_dance_with_changed_settings_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let of = |cohesion: &str| {
        let set = format!("simulation.locks.cohesion={cohesion}");
        let args = ["bench", "locks-long", "--set", "hair.groom.wisps=8", "--set", &set, "--json"];
        let json = run(dir.path(), args).done().json();
        assert_eq!(
            (json["scenes"].as_array().map(Vec::len), &json["locks"][0]["scene"]),
            (Some(0), &"locks-long".into())
        );
        assert_eq!(json["locks"][0]["locks"], 8);
        json["locks"][0]["figures"]["radius_mm"]["p95"].as_f64().expect("a number")
    };
    let (held, loose) = (of("60"), of("0"));
    assert!(loose > 1.2 * held, "{held} mm with cohesion, {loose} mm without");
    let unknown = run(dir.path(), ["bench", "locks-wig"]);
    assert!(unknown.refused(2).contains("locks-80cm"));
}

#[test]
fn reference_scenes_are_written_and_stand_alone() {
    let dir = tempfile::tempdir().expect("a folder");
    let scene = "reference-smooth-black-front";
    let args = [
        "bench",
        scene,
        "--size",
        "16x16",
        "--strands",
        "200",
        "--json",
        "-o",
        "a b",
        "--set",
        "look.roughness=0.5",
    ];
    let json = run(dir.path(), args).done().json();
    let entry = &json["scenes"][0];
    assert_eq!(entry["name"], "smooth-black-front");
    assert_eq!(entry["fibre"]["longitudinal_roughness"], 0.5);
    for key in ["strands_file", "image_file", "picture_file"] {
        let file = dir.path().join("a b").join(entry[key].as_str().expect(key));
        assert!(file.is_file(), "{}", file.display());
    }
    let written = std::fs::read_to_string(dir.path().join("a b/scenes.json")).expect("the file");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&written).expect("JSON"), json);
    let wrong: [(&[&str], &str); 6] = [
        (&[scene], "--out"),
        (&[scene, "smooth", "-o", "x"], "only scenes"),
        (&["smooth", "--strands", "900"], "--strands"),
        (&[scene, "--strands", "99", "-o", "x"], "--strands"),
        (&["reference-green", "-o", "x"], "dark-brown"),
        (&[scene, "-o", "a b/scenes.json"], "folder"),
    ];
    for (args, named) in wrong {
        let args: Vec<&str> = ["bench"].iter().chain(args).copied().collect();
        let ran = run(dir.path(), &args);
        let line = ran.refused(2);
        assert!(line.contains(named), "{args:?}: {line}");
        assert!(!dir.path().join("x").exists());
    }
}
