//! EXR files of the program, read by the Python package of `OpenEXR`.

use crate::python::environment;
use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

/// The library of the format's authors in the Python Package Index.
const PACKAGES: [&str; 2] = ["OpenEXR==3.4.4", "numpy<3"];

/// Records a frame and compares what that reader finds with the expected values.
pub(super) fn run(folder: &Path) -> anyhow::Result<()> {
    let frames = folder.join("exr");
    let record = ["record", "--format", "exr", "--transparent"];
    let more = ["--frames", "7..8", "--fps", "23.976", "--size", "320x180", "--backend", "cpu", "-o"];
    tool::run(Command::new(tool::program()).args(record).args(more).arg(&frames))?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/interchange/exr_facts.py");
    let python = environment(&folder.join("python-exr"), &PACKAGES)?;
    let output = Command::new(&python)
        .arg(&script)
        .arg(frames.join("frame_000007.exr"))
        .output()
        .with_context(|| format!("could not start {}", python.display()))?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    let found = serde_json::from_slice(&output.stdout).context("the script printed no facts")?;
    check(&found)?;
    println!("interchange: an EXR file as {} reads it", PACKAGES[0]);
    Ok(())
}

/// Fails if a value differs from the expected one.
fn check(found: &Value) -> anyhow::Result<()> {
    let half = "float16";
    let same = [
        (
            "channels",
            json!({ "R": half, "G": half, "B": half, "A": half, "Z": "float32", "transmittance.Y": half }),
        ),
        ("size", json!([320, 180])),
        ("compression", json!("ZIP_COMPRESSION")),
        ("chromaticities", json!([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329])),
        ("rate", json!([24_000, 1001])),
        ("frame", json!(7)),
        ("finite", json!(true)),
        ("light_where_clear", json!(0.0)),
    ];
    for (name, wanted) in same {
        ensure!(found[name] == wanted, "{name}: found {}; must be {wanted}", found[name]);
    }
    ensure!(found["comments"].as_str().is_some_and(|text| text.contains("voxel-map")), "comments: {found}");
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    // The camera is 2 m in front of the head, and the figure covers a third of the image.
    for (name, value, low, high) in [
        ("covered", number(&found["covered"]), 0.1, 0.7),
        ("clear", number(&found["clear"]), 0.2, 0.9),
        ("nearest_m", number(&found["nearest_m"]), 1.5, 2.0),
        ("farthest_covered_m", number(&found["farthest_covered_m"]), 1.8, 2.6),
        ("depth_where_clear", number(&found["depth_where_clear"]), 1e10, 1e10),
        ("least transmittance", number(&found["transmittance"][0]), 0.0, 0.5),
        ("most transmittance", number(&found["transmittance"][1]), 1.0, 1.0),
    ] {
        ensure!((low..=high).contains(&value), "{name}: found {value}; must be {low} to {high}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fact_that_is_off_is_found() {
        let good = json!({
            "channels": {
                "R": "float16", "G": "float16", "B": "float16", "A": "float16", "Z": "float32",
                "transmittance.Y": "float16"
            },
            "size": [320, 180],
            "compression": "ZIP_COMPRESSION",
            "chromaticities": [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329],
            "rate": [24000, 1001],
            "frame": 7,
            "comments": "shadow voxel-map",
            "finite": true,
            "light_where_clear": 0.0,
            "covered": 0.3,
            "clear": 0.6,
            "nearest_m": 1.8,
            "farthest_covered_m": 2.2,
            "depth_where_clear": 1e10,
            "transmittance": [0.1, 1.0]
        });
        assert!(check(&good).is_ok(), "{:?}", check(&good));
        for (name, wrong) in [
            ("channels", json!({ "R": "float16" })),
            ("finite", json!(false)),
            ("nearest_m", json!(0.2)),
            ("transmittance", json!([0.9, 1.0])),
            ("depth_where_clear", Value::Null),
        ] {
            let mut bad = good.clone();
            bad[name] = wrong;
            assert!(check(&bad).is_err(), "{name}");
        }
    }
}
