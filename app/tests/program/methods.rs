//! `lovelock method`, and methods of the user's own in the other commands.

use std::fs;

use lovelock_render::Gpu;

use crate::tool::{run, saved, small_project};

#[test]
fn a_method_is_written_checked_and_compared() {
    let dir = tempfile::tempdir().expect("a folder");
    let ran = run(dir.path(), ["method", "new", "mein Nebel ü", "--json"]);
    let json = ran.done().json();
    assert_eq!((&json["id"], json["files"].as_array().map(Vec::len)), (&"mein-nebel".into(), Some(2)));
    let again = run(dir.path(), ["method", "new", "mein Nebel ü"]);
    assert!(again.refused(2).contains("is there already"), "{again:?}");
    assert!(
        run(dir.path(), ["method", "check", "mein Nebel ü"]).done().stdout.contains("My method compiles")
    );

    // A problem is one line with file and line, and nothing is written.
    let shader = dir.path().join("mein Nebel ü/method.wgsl");
    let text = fs::read_to_string(&shader).expect("the shader");
    fs::write(&shader, text.replace("sum += record_load", "sum += record_lode")).expect("written");
    for arguments in [
        &["method", "check", "mein Nebel ü"][..],
        &["compare", "--method", "mein Nebel ü", "-o", "out"],
        &["record", "--method", "mein Nebel ü", "-o", "out"],
    ] {
        let ran = run(dir.path(), arguments);
        assert!(ran.refused(2).contains("method.wgsl, line 26:"), "{ran:?}");
    }
    assert!(!dir.path().join("out").exists());
    fs::write(&shader, &text).expect("written");
    if let Err(error) = Gpu::open() {
        lovelock_testkit::skip_without_adapter(&error);
        return;
    }
    saved(dir.path(), "a.lovelock", &small_project());
    let compare = |methods: &str, backend: &str| {
        let ran = run(
            dir.path(),
            [
                "compare",
                "a.lovelock",
                "-o",
                "out",
                "--frame",
                "3",
                "--methods",
                methods,
                "--method",
                "mein Nebel ü",
                "--size",
                "48x32",
                "--backend",
                backend,
                "--quick",
                "--json",
            ],
        );
        ran.done().json()
    };
    let json = compare("opacity-maps", "both");
    let methods = json["methods"].as_array().expect("methods");
    let of = |id: &str, backend: &str| {
        let found = methods.iter().find(|method| method["id"] == id && method["backend"] == backend);
        found.unwrap_or_else(|| panic!("no {id} on {backend} in {methods:?}"))
    };
    for backend in ["cpu", "gpu"] {
        let (own, known) = (of("mein-nebel", backend), of("opacity-maps", backend));
        assert_eq!(own["label"], "My method");
        let error = |method: &serde_json::Value| method["transmittance"]["rmse"].as_f64().expect("an error");
        assert!((error(own) - error(known)).abs() < 1.0 / 255.0, "{own} {known}");
        assert!(error(own) > 0.0 && own["refused"].is_null());
    }
    // The error that a loop without an end leaves is that of its method alone.
    fs::write(&shader, text.replace("    let place", "    loop { }\n    let place")).expect("written");
    let json = compare("voxel-map", "gpu");
    let methods = json["methods"].as_array().expect("methods");
    for method in methods {
        let refused = method["refused"].as_str().unwrap_or_default();
        assert_eq!(refused.contains("did not end"), method["id"] == "mein-nebel", "{method}");
    }
}
