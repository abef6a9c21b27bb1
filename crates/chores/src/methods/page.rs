//! The page of the documents.

use super::growth::{Bench, Scene};
use super::report::{Method, Report};
use super::verdicts::{FACTOR, twice_the_error};
use super::{BENCH, OPTIONS};
use std::fmt::Write as _;

/// The whole page, from the name and the report of each scene, and the measured methods with their growth.
pub(super) fn page(scenes: &[(&str, Report)], growing: &[(&str, Bench)]) -> String {
    let machine = scenes.first().map_or("", |(_, report)| report.machine.as_str());
    let mut text = format!(
        "# Shadow methods on hair, fur and grass\n\n\
         Measured on: {machine}. This page is written by `cargo xtask methods`, which runs `lovelock compare {OPTIONS}` for each scene: hairstyles from frame 45 of the dance on, fur and grass at rest. \
         Every method has its default settings, except `voxel-map` on fur and grass, whose projects set 256 cells in place of 128; \
         errors are those of the first light.\n\n\
         - *RMSE*, *bias*, *99 %*: root mean square, mean (above 0 where too bright) and 99th percentile of the difference of transmittance \
         at every point of the strands, against one ground truth: the converged mean of the light over a texel of `exact`.\n\
         - *FLIP*: mean perceived difference of the image from the one with converged shadow.\n\
         - *Build* and *lookup*: milliseconds for the maps of all lights and for all points, medians on the CPU.\n\
         - *Flicker*: root mean square difference between the changes of the method and of the truth from frame to frame of the dance. Fur and grass \
         stand still, with a tenth of the strands of `docs/examples`.\n\n\
         [Shadow methods](shadow_methods.md) has the same methods on both backends, and what bounds each; [the papers' own figures](papers.md) \
         stand beside ours there.\n"
    );
    for (name, report) in scenes {
        text += &scene(name, report);
    }
    text += "\n## What they say together\n\n";
    let all: Vec<&Report> = scenes.iter().map(|(_, report)| report).collect();
    let found = twice_the_error(&all);
    for (worse, better, least) in &found {
        let _ = writeln!(
            text,
            "- `{worse}` errs at least {least:.1} times as much as `{better}` in every scene, which needs neither more time nor more memory."
        );
    }
    if found.is_empty() {
        let _ = writeln!(
            text,
            "No method errs {FACTOR} times as much as another one with at most its time and memory in every scene."
        );
    }
    text + &growth(growing)
}

fn scene(name: &str, report: &Report) -> String {
    let converged = if report.reference.converged { "" } else { ", not converged" };
    let mut text = format!(
        "\n## {name}\n\n{} strands, {} segments; last change of the ground truth {:.4}{converged}.\n\n\
         | method | RMSE | bias | 99 % | FLIP | build, ms | lookup, ms | memory | flicker |\n\
         |---|---|---|---|---|---|---|---|---|\n",
        report.scene.strands, report.scene.segments, report.reference.change
    );
    for method in &report.methods {
        text += &row(method);
    }
    text
}

fn row(method: &Method) -> String {
    if let Some(refused) = &method.refused {
        return format!("| `{}` | {refused} | | | | | | | |\n", method.id);
    }
    let error = method.transmittance_common.unwrap_or_default();
    let (build, query) = method.cost().unwrap_or_default();
    let flip = method.flip.unwrap_or_default().mean;
    let flicker = method.stability.and_then(|found| found.flicker).filter(|flicker| *flicker > 0.0);
    let flicker = flicker.map_or_else(String::new, |flicker| format!("{flicker:.4}"));
    format!(
        "| `{}` | {:.4} | {:+.4} | {:.3} | {flip:.4} | {build:.2} | {query:.2} | {} | {flicker} |\n",
        method.id,
        error.rmse,
        error.bias,
        error.p99,
        bytes(method.memory_bytes.unwrap_or(0))
    )
}

/// Time and memory by the number of segments.
fn growth(methods: &[(&str, Bench)]) -> String {
    let mut text = format!(
        "\n## Growth with the number of segments\n\n\
         Smooth hair drawn by more and thinner strands (`lovelock bench {BENCH} --shadow METHOD`): milliseconds to build and to look up the maps of \
         three lights, and their memory. A frame of `ray-traced` takes minutes there.\n\n"
    );
    let scenes = methods.first().map_or(&[][..], |(_, bench)| &bench.scenes);
    text += "| method |";
    for scene in scenes {
        let _ = write!(text, " {} segments, ms | memory |", scene.segments);
    }
    text += " times as long |\n|---|";
    text += &"---|".repeat(2 * scenes.len() + 1);
    text.push('\n');
    for (method, Bench { scenes }) in methods {
        let _ = write!(text, "| `{method}` |");
        for scene in scenes {
            let _ = write!(text, " {:.1} | {} |", scene.ms(), bytes(scene.shadow_bytes));
        }
        let ms = |scene: Option<&Scene>| scene.map_or(f64::NAN, Scene::ms);
        let _ = writeln!(text, " {:.1} |", ms(scenes.last()) / ms(scenes.first()));
    }
    text
}

/// Bytes in KiB or MiB.
fn bytes(bytes: u64) -> String {
    let kib = bytes as f64 / 1024.0;
    match bytes {
        0 => "0".to_owned(),
        _ if kib < 1024.0 => format!("{kib:.0} KiB"),
        _ => format!("{:.1} MiB", kib / 1024.0),
    }
}
