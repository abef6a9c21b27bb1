//! Figures and tables of Bertails, Ménier, Cani 2005. Numbers of figures are those of Graphics Interface; the report counts differently.

use lovelock_groom::{HairShading, Preset};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{Backend, MapForm, MapValue, ShadowMethod, VoxelFilter};

use super::figures::{Figure, Paper};
use super::studio::{Moment, Studio, brightness};
use crate::bench::{BenchRequest, BenchScene, SceneReport, bench, counted};

const PAPER: Paper = Paper::Bertails;

/// In the order of the paper.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "bertails-1",
        paper: PAPER,
        title: "Figure 1 (report: 8): without shadow, the map, with shadow.",
        shows: "Dynamic hair without self-shadowing looks flat; the light-oriented map holds density and transmittance; shaded with \
                it, hair shows its volume.",
        differs: "The map is drawn over the hair: its density at points, and its transmittance on a plane along the light.",
        make: shadow_and_map,
    },
    Figure {
        id: "bertails-5",
        paper: PAPER,
        title: "Figure 5: the effect of filtering.",
        shows: "Without a filter, regular patterns along the map are visible in the shadow; with the filter they have vanished.",
        differs: "Beside the printed filter stands ours, which does not displace the shadow.",
        make: filters,
    },
    Figure {
        id: "bertails-7",
        paper: PAPER,
        title: "Figure 7 (report: 6): a captured hairstyle.",
        shows: "Hair captured from photographs, 87,500 strands of 1,123 K segments, rendered in 2 s: with self-shadows wisps stand out.",
        differs: "The captured hair is not available. The nearest is our long hairstyle with as many strands and 1,137 K segments.",
        make: captured,
    },
    Figure {
        id: "bertails-8",
        paper: PAPER,
        title: "Figure 8 (report: 7): resolutions of the map.",
        shows: "Curly hair with maps of 32³, 64³, 128³ and 256³ cells: curls are properly shadowed from 128³ on.",
        differs: "The optical depth of a cell does not depend on the resolution, so no factor has to be found for each.",
        make: resolutions,
    },
    Figure {
        id: "bertails-9",
        paper: PAPER,
        title: "Figure 9: two dances.",
        shows: "A smooth brown hairstyle of 100 K segments and a curly red one of 200 K, in different dances.",
        differs: "Both are on the shipped dancer, at two instants of her dance.",
        make: dances,
    },
    Figure {
        id: "bertails-10",
        paper: PAPER,
        title: "Figure 10: beside real hair.",
        shows: "A photograph of hair in one strong light beside a rendering in similar light.",
        differs: "The photograph is not available. The nearest is our hair in a light of that kind; `cargo xtask reference` compares it \
                  with a path tracer instead.",
        make: one_light,
    },
    Figure {
        id: "bertails-tables",
        paper: PAPER,
        title: "Tables 1 and 2: times.",
        shows: "A frame of 100 K segments takes 0.16 s on a Pentium 4 of 3 GHz: 67 ms of animation, 3 of collisions, 53 of density and \
                transmittance, 37 of filtering and drawing. Of curly hair the table prints 0.557 s, but its parts sum to 0.387 s.",
        differs: "Our frames include collisions with the body, the published ones do not: with them 6 frames per second fall to 3.5. We \
                  blend three lights with shadows.",
        make: tables,
    },
    Figure {
        id: "bertails-parallel",
        paper: PAPER,
        title: "Section 4.2: parallel version.",
        shows: "Simulation and shadow are divided among processors; with three the frame rate doubles.",
        differs: "Threads of one machine instead of a cluster.",
        make: parallel,
    },
];

/// A preset in the published setting: stored strands in the shading of comparisons, one strong light.
pub(super) fn scene(preset: Preset) -> Project {
    let mut project = Project::default();
    project.set_preset(preset);
    project.compare.shading = HairShading::KajiyaKayPublished;
    let mut project = project.compared();
    project.lights.truncate(1);
    if let Some(key) = project.lights.first_mut() {
        key.intensity = 4.5;
    }
    project.picture.ambient = 0.35;
    project.camera.distance = 1.35;
    project.camera.follow_offset.y = -0.06;
    project
}

/// The frame at which [`close_up`] sees the side of the hair.
pub(super) const CLOSE_FRAME: u64 = 58;

/// Moves the camera to the hair.
pub(super) fn close_up(project: &mut Project) {
    (project.camera.distance, project.camera.azimuth) = (0.75, 1.2);
    project.camera.follow_offset.y = 0.05;
}

/// The same without shadows.
pub(super) fn unshadowed(project: &Project) -> Project {
    let mut project = project.clone();
    project.shadow.method = ShadowMethod::None;
    project
}

fn shadow_and_map(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = scene(Preset::Smooth);
    close_up(&mut project);
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let plain = studio.draw("without", "Without self-shadowing", &unshadowed(&project), &moment)?;
    let size = project.shadow.size_label();
    for (name, value, form) in [
        ("density", MapValue::Density, MapForm::Points),
        ("transmittance", MapValue::Transmittance, MapForm::AlongLightY),
    ] {
        let mut shown = project.clone();
        (shown.picture.map_view.value, shown.picture.map_view.form) = (value, form);
        studio.draw(name, format!("The map of {size}: {name}"), &shown, &moment)?;
    }
    let shaded = studio.draw("with", "With the light-oriented map", &project, &moment)?;
    let (before, after) = (brightness(&plain.picture), brightness(&shaded.picture));
    studio.check(
        "Self-shadowing darkens the image",
        format!("mean grey value {before:.1} without, {after:.1} with it"),
        after < before - 1.0,
    );
    Ok(())
}

fn filters(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = scene(Preset::Smooth);
    project.shadow.voxel_map.resolution = 64;
    close_up(&mut project);
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let truth = studio.truth(&project, &moment)?;
    let (mut rows, mut errors) = (Vec::new(), Vec::new());
    for (filter, id, name) in [
        (VoxelFilter::Closest, "closest", "Without a filter"),
        (VoxelFilter::Paper, "paper", "The printed filter"),
        (VoxelFilter::Centred, "centred", "Our filter"),
    ] {
        project.shadow.voxel_map.filter = filter;
        studio.draw(id, format!("{name}, 64³ cells"), &project, &moment)?;
        let error = studio.measure(&project, &project.shadow, &moment)?.rmse(&truth);
        rows.push(vec![name.to_owned(), format!("{error:.4}")]);
        errors.push(error);
    }
    studio.table("Transmittance at every strand point against the exact method", &["", "RMSE"], rows);
    studio.check(
        "Our filter is closer to the exact shadow than no filter",
        format!("RMSE {:.4} and {:.4}", errors[2], errors[0]),
        errors[2] < errors[0],
    );
    Ok(())
}

fn captured(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = scene(Preset::Long);
    let groom = &mut project.hair.groom;
    (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (875, 100, 13);
    project.shadow.voxel_map.resolution = 256;
    project.camera.distance = 1.9;
    let moment = studio.moment(&project, 0)?;
    studio.draw("without", "Without self-shadowing", &unshadowed(&project), &moment)?;
    studio.draw("with", "With the map of 256³", &project, &moment)?;
    let [strands, shadow, draw] = studio.image_ms(&project, &moment)?;
    let ms = strands + shadow + draw;
    let row = |name: &str, published: &str, found: String, ratio: String| {
        vec![name.to_owned(), published.to_owned(), found, ratio]
    };
    let counts = &moment.hair.strands;
    studio.table(
        format!("Published: Pentium 4 at 3 GHz. Measured: {}", studio.adapter()),
        &["", "published", "measured", "published / measured"],
        vec![
            row("strands", "87,500", counts.count().to_string(), String::new()),
            row("segments", "1,123,000", counts.segments().to_string(), String::new()),
            row("one image", "2,000 ms", format!("{ms:.0} ms"), format!("{:.1}", 2000.0 / ms.max(1e-9))),
        ],
    );
    Ok(())
}

fn resolutions(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = scene(Preset::Curly);
    close_up(&mut project);
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let truth = studio.truth(&project, &moment)?;
    let mut rows = Vec::new();
    let (mut errors, mut means, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for (cells, published) in [(32, "0.5"), (64, "0.2"), (128, "0.1"), (256, "0.05")] {
        project.shadow.voxel_map.resolution = cells;
        studio.draw(&cells.to_string(), format!("{cells}³ cells"), &project, &moment)?;
        let measured = studio.measure(&project, &project.shadow, &moment)?;
        let error = measured.rmse(&truth);
        rows.push(vec![
            format!("{cells}³"),
            published.to_owned(),
            format!("{:.1} mm", 1e3 * measured.report.cell_size),
            format!("{:.3}", measured.mean()),
            format!("{error:.4}"),
            format!("{:.2} MiB", measured.report.memory_bytes as f64 / f64::from(1 << 20)),
        ]);
        errors.push(error);
        means.push(measured.mean());
        bytes.push(measured.report.memory_bytes as f64);
    }
    studio.table(
        "Transmittance at every strand point against the exact method on its finest map",
        &["map", "published ds", "cell", "mean", "RMSE", "memory"],
        rows,
    );
    let list =
        |values: &[f64]| values.iter().map(|value| format!("{value:.4}")).collect::<Vec<_>>().join(", ");
    studio.check(
        "Each finer map is closer to the exact shadow up to 128³, and 256³ is closer than 64³",
        format!("RMSE {}", list(&errors)),
        errors[..3].windows(2).all(|pair| pair[1] < pair[0]) && errors[3] < errors[1],
    );
    let spread =
        means.iter().copied().fold(f64::MIN, f64::max) - means.iter().copied().fold(f64::MAX, f64::min);
    studio.check(
        "The mean shadow does not depend on the resolution: it differs by less than 0.02",
        format!("mean transmittance {}", list(&means)),
        spread < 0.02,
    );
    studio.check(
        "Memory grows with the number of cells: eight times for twice the resolution, within a fifth",
        format!(
            "{} MiB",
            bytes.iter().map(|b| format!("{:.2}", b / f64::from(1 << 20))).collect::<Vec<_>>().join(", ")
        ),
        bytes.windows(2).all(|pair| (pair[1] / pair[0] / 8.0 - 1.0).abs() < 0.2),
    );
    Ok(())
}

fn dances(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let smooth = scene(Preset::Smooth);
    let mut red = scene(Preset::Curly);
    (red.look.eumelanin, red.look.pheomelanin) = (0.25, 1.6);
    for (name, project, frames) in [("smooth", &smooth, [CLOSE_FRAME, 118]), ("curly", &red, [120, 175])] {
        for frame in frames {
            let moment = studio.moment(project, frame)?;
            let segments = moment.hair.strands.segments();
            let caption = format!("{name}, {segments} segments, frame {frame}");
            let drawn = studio.draw(&format!("{name}-{frame}"), caption, project, &moment)?;
            studio.check(
                format!("All segments of the {name} hair are drawn at frame {frame}"),
                format!("{} of {segments}", drawn.stats.segments),
                drawn.stats.segments == segments as u64,
            );
        }
    }
    Ok(())
}

fn one_light(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = scene(Preset::Smooth);
    project.picture.ambient = 0.15;
    project.camera.azimuth = 2.4;
    if let Some(key) = project.lights.first_mut() {
        key.direction = glam::Vec3::new(-0.75, -0.55, 0.30);
        key.intensity = 6.0;
    }
    let moment = studio.moment(&project, 0)?;
    studio.draw("light", "Our hair in one strong light from the side", &project, &moment)?;
    Ok(())
}

/// The report of a scene with its own settings.
fn measured(
    studio: &mut Studio<'_>,
    scenes: Vec<BenchScene>,
    threads: Vec<usize>,
) -> Result<crate::bench::BenchReport, ProjectError> {
    let backend = if threads.is_empty() { studio.backend() } else { Backend::Cpu };
    let request = BenchRequest {
        scenes,
        threads,
        backends: vec![backend],
        frames: studio.frames(),
        ..BenchRequest::default()
    };
    let mut watch = studio.watch();
    bench(&request, &|_| Ok(()), &mut |what| watch(what))
}

fn tables(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let report = measured(studio, vec![BenchScene::Smooth, BenchScene::Curly], Vec::new())?;
    let ms = |scene: &SceneReport, name: &str| scene.median_ms(name).unwrap_or(0.0);
    let heads = ["", "published, ms", "measured, ms", "published / measured"];
    let row = |name: &str, published: f64, found: f64| {
        let ratio = if found > 0.0 { format!("{:.1}", published / found) } else { String::new() };
        vec![name.to_owned(), format!("{published:.0}"), format!("{found:.1}"), ratio]
    };
    for (scene, [density, filter, animation, collisions, total]) in
        report.scenes.iter().zip([[53.0, 37.0, 67.0, 3.0, 160.0], [77.0, 53.0, 254.0, 3.0, 557.0]])
    {
        let machines =
            format!("Published: Pentium 4 at 3 GHz. Measured: {}, {}", report.machine, scene.adapter);
        let [build, ask] = ["shadow/build", "shadow/ask"].map(|pass| ms(scene, pass));
        // A graphics device that times no passes has whole stages alone.
        let (build, ask) = if build + ask > 0.0 { (build, ask) } else { (ms(scene, "shadow"), 0.0) };
        let drawing = ask + ms(scene, "draw");
        studio.table(
            format!("Table 1, {} ({} segments). {machines}", scene.scene, scene.segments),
            &heads,
            vec![
                row("map reset, density, transmittance", density, build),
                row("filter and draw", filter, drawing),
                row("total rendering", density + filter, build + drawing),
            ],
        );
        studio.table(
            format!("Table 2, {} ({} segments). {machines}", scene.scene, scene.segments),
            &heads,
            vec![
                row("animation and collisions of hair", animation + collisions, ms(scene, "animation")),
                row("rendering", density + filter, build + drawing),
                row("total, as printed", total, ms(scene, "frame")),
                row(
                    "total, sum of the printed parts",
                    animation + collisions + density + filter,
                    ms(scene, "frame"),
                ),
            ],
        );
    }
    let [smooth, curly] = [0, 1].map(|at| report.scenes.get(at).map_or(0, |scene| scene.segments));
    studio.check(
        "The hair has the published numbers of segments: 134 wisps of 25 strands of 30 and 60 segments",
        format!("{smooth} and {curly}"),
        (smooth, curly) == (100_500, 201_000),
    );
    Ok(())
}

fn parallel(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let available = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads: Vec<usize> = [1, 2, 3, 4, 8].into_iter().filter(|threads| *threads <= available).collect();
    let report = measured(studio, vec![BenchScene::Smooth], threads)?;
    let Some(scaling) = report.scaling.first() else { return Ok(()) };
    let mut heads = vec!["stage".to_owned()];
    heads.extend(scaling.runs.iter().map(|run| format!("{}: ms (speed-up)", counted(run.scene.threads))));
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let wanted = ["animation", "shadow", "draw", "frame"];
    let rows = wanted.map(|name| {
        let mut row = vec![name.to_owned()];
        for run in &scaling.runs {
            let at = run.scene.stages.iter().position(|stage| stage.name == name);
            let times = at.and_then(|at| run.speed_up.get(at).copied().flatten()).unwrap_or(0.0);
            row.push(format!("{:.1} ({times:.2})", run.scene.median_ms(name).unwrap_or(0.0)));
        }
        row
    });
    studio.table(
        format!("The smooth scene on {}; the paper: 2.0 with three processors", report.machine),
        &heads,
        rows.to_vec(),
    );
    Ok(())
}

/// A moment of the smooth hair in the published setting, for other papers.
pub(super) fn smooth(studio: &mut Studio<'_>) -> Result<(Project, Moment), ProjectError> {
    let project = scene(Preset::Smooth);
    let moment = studio.moment(&project, 40)?;
    Ok((project, moment))
}
