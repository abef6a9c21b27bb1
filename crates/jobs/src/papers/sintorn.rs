//! Figures and tables of Sintorn, Assarsson 2009.

use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{ShadowMethod, ShadowSettings, Transparency};
use lovelock_shadow::TexelFilter;
use lovelock_shadow::methods::deep_opacity_maps::Layers;
use lovelock_shadow::methods::occupancy_maps::Occupancy;
use lovelock_shadow::methods::texels::Fragment;

use super::bertails::{CLOSE_FRAME, close_up, scene};
use super::curves::{curve, named, rmse, spread, steps};
use super::figures::{Figure, Paper};
use super::studio::{Studio, flip};
use crate::bench::{BenchRequest, BenchScene, bench};

const PAPER: Paper = Paper::Sintorn;

/// In the order of the paper.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "sintorn-1",
        paper: PAPER,
        title: "Figure 1: woman and dog.",
        shows: "A woman with 20 K strands (300 K segments) at 37.3 images per second and a dog with 400 K strands (2 M segments) at 17.2, on a \
                GeForce GTX 280.",
        differs: "The models are not available: the shipped dancer has as many strands and segments, and a four-legged body of our own has \
                  400 K hairs on its whole skin.",
        make: woman_and_dog,
    },
    Figure {
        id: "sintorn-2",
        paper: PAPER,
        title: "Figure 2: transparency.",
        shows: "Depth peeling as ground truth (4.01 images per second, 112 layers), occupancy order (51), weighted average (72) and no \
                transparency (120), all with occupancy maps as shadows.",
        differs: "The reference sorts lists of fragments instead of peeling layers, so it is not an order of magnitude slower.",
        make: transparency,
    },
    Figure {
        id: "sintorn-4",
        paper: PAPER,
        title: "Figure 4: beside deep opacity maps.",
        shows: "Occupancy maps show deep shadows in hair without the false stripes of deep opacity maps of four layers.",
        differs: "",
        make: beside_layers,
    },
    Figure {
        id: "sintorn-5",
        paper: PAPER,
        title: "Figures 5 and 8: visibility along rays.",
        shows: "Behind a stray strand, and at a highlight, occupancy and slab maps follow the visibility of infinitely many slices, while \
                four layers miss its sudden falls.",
        differs: "The rays are the deepest one of our smooth hair, alone and with a stray fragment before it.",
        make: visibility,
    },
    Figure {
        id: "sintorn-6",
        paper: PAPER,
        title: "Figure 6: stills from an animation.",
        shows: "20,000 strands in motion at 30 images per second.",
        differs: "",
        make: stills,
    },
    Figure {
        id: "sintorn-9",
        paper: PAPER,
        title: "Figure 9: jitter.",
        shows: "Because many fragments are blended in a pixel, aliasing of the shadow disappears if lookups are jittered by half a texel.",
        differs: "Our texels are as wide as strands at least, so aliasing is weak without jitter, and FLIP, which also counts the noise of \
                  jitter, hardly tells them apart. The default is a bilinear lookup.",
        make: jitter,
    },
    Figure {
        id: "sintorn-10",
        paper: PAPER,
        title: "Figure 10: numbers of strands.",
        shows: "20,000, 10,000 and 5,000 strands of 30 segments at 27.6, 37.0 and 60.6 images per second.",
        differs: "",
        make: numbers,
    },
    Figure {
        id: "sintorn-table",
        paper: PAPER,
        title: "The table of section 4: passes.",
        shows: "Strands, three passes of shadow maps, three of the eye's maps and the image take 31.6 ms on a GeForce GTX 280.",
        differs: "Occupancy and slab sizes are one pass here.",
        make: passes,
    },
    Figure {
        id: "sintorn-memory",
        paper: PAPER,
        title: "Section 4: memory, and section 3.3: convergence.",
        shows: "Occupancy maps of 512² take 10 MB, deep opacity maps of 16 and 32 layers 18 and 34 MB, opacity maps of 128 and 256 slices 130 \
                and 258 MB; the order of fragments converges as slices are added.",
        differs: "Ours store only texels with hair, so all numbers are smaller; deep opacity maps have at most 16 layers.",
        make: memory,
    },
];

/// A project with the shadow and the blending of the paper.
fn occupancy(mut project: Project) -> Project {
    project.shadow.method = ShadowMethod::OccupancyMaps;
    project.shadow.occupancy_maps.slabs = 4;
    project.picture.transparency = Transparency::OccupancyOrder;
    project
}

fn smooth() -> Project {
    occupancy(scene(Preset::Smooth))
}

/// 20,000 strands of as many segments.
fn many(strands: u32, segments: u32) -> Project {
    let mut project = smooth();
    let groom = &mut project.hair.groom;
    (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (200, strands / 200, segments);
    project
}

fn woman_and_dog(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut rows = Vec::new();
    for (name, scene, published) in
        [("woman", BenchScene::Woman300k, 37.3), ("dog", BenchScene::Fur400k, 17.2)]
    {
        let mut project = occupancy(scene.project());
        project.camera.distance *= 1.3;
        let moment = studio.moment(&project, 40)?;
        let strands = &moment.hair.strands;
        let (count, segments) = (strands.count(), strands.segments());
        studio.draw(name, format!("{count} strands, {segments} segments"), &project, &moment)?;
        let [strands, shadow, draw] = studio.image_ms(&project, &moment)?;
        let ms = strands + shadow + draw;
        rows.push(vec![
            name.to_owned(),
            count.to_string(),
            segments.to_string(),
            format!("{published:.1}"),
            format!("{:.1}", 1e3 / ms.max(1e-9)),
            format!("{:.2}", 1e3 / ms.max(1e-9) / published),
        ]);
        let wanted = if name == "woman" { (20_000, 300_000) } else { (400_000, 2_000_000) };
        studio.check(
            format!("The {name} has the published numbers of strands and segments"),
            format!("{count} and {segments}"),
            (count, segments) == wanted,
        );
    }
    studio.table(
        format!("Images per second. Published: GeForce GTX 280, 800×600. Measured: {}", studio.adapter()),
        &["", "strands", "segments", "published", "measured", "measured / published"],
        rows,
    );
    Ok(())
}

fn transparency(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = many(20_000, 15);
    close_up(&mut project);
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let modes = [
        (Transparency::Exact, "exact order", 4.01),
        (Transparency::OccupancyOrder, "occupancy order", 51.0),
        (Transparency::WeightedAverage, "weighted average", 72.0),
        (Transparency::Opaque, "no transparency", 120.0),
    ];
    let (mut rows, mut errors, mut truth) = (Vec::new(), Vec::new(), None);
    for (mode, name, published) in modes {
        project.picture.transparency = mode;
        let drawn = studio.draw(&mode.to_string(), name, &project, &moment)?;
        let error = truth.as_ref().map_or(Ok(0.0), |truth| flip(truth, &drawn.picture))?;
        let [strands, shadow, draw] = studio.image_ms(&project, &moment)?;
        rows.push(vec![
            name.to_owned(),
            format!("{published:.2}"),
            format!("{:.1}", 1e3 / (strands + shadow + draw).max(1e-9)),
            format!("{draw:.1}"),
            format!("{error:.4}"),
        ]);
        errors.push(error);
        truth.get_or_insert(drawn.picture);
    }
    studio.table(
        format!("Images per second, drawing in ms, and FLIP against exact order. Published: GeForce GTX 280. Measured: {}", studio.adapter()),
        &["", "published", "measured", "drawing, ms", "FLIP"],
        rows,
    );
    studio.check(
        "Occupancy order is closer to exact order than the weighted average and than no transparency",
        format!("FLIP {:.4}, {:.4}, {:.4}", errors[1], errors[2], errors[3]),
        errors[1] < errors[2] && errors[1] < errors[3],
    );
    studio.check(
        "Occupancy order is virtually indistinguishable from exact order: FLIP below 0.01",
        format!("FLIP {:.4}", errors[1]),
        errors[1] < 0.01,
    );
    Ok(())
}

/// The settings of deep opacity maps with so many layers.
fn layers(shadow: &ShadowSettings, layers: u32) -> ShadowSettings {
    let mut shadow = ShadowSettings { method: ShadowMethod::DeepOpacityMaps, ..*shadow };
    shadow.deep_opacity_maps.layers = layers;
    shadow
}

fn beside_layers(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = smooth();
    close_up(&mut project);
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let truth = studio.truth(&project, &moment)?;
    let (mut rows, mut errors) = (Vec::new(), Vec::new());
    for (id, name, shadow) in [
        ("occupancy", "Occupancy maps, 128 slices in 4 slabs", project.shadow),
        ("layers-4", "Deep opacity maps, 4 layers", layers(&project.shadow, 4)),
        ("layers-8", "Deep opacity maps, 8 layers", layers(&project.shadow, 8)),
        ("layers-16", "Deep opacity maps, 16 layers", layers(&project.shadow, 16)),
    ] {
        let shown = Project { shadow, ..project.clone() };
        studio.draw(id, name, &shown, &moment)?;
        let measured = studio.measure(&project, &shadow, &moment)?;
        let error = measured.rmse(&truth);
        let memory = measured.report.memory_bytes as f64 / f64::from(1 << 20);
        rows.push(vec![name.to_owned(), format!("{error:.4}"), format!("{memory:.2} MiB")]);
        errors.push(error);
    }
    studio.table(
        "Transmittance at every strand point against the exact method",
        &["method", "RMSE", "memory"],
        rows,
    );
    studio.check(
        "Occupancy maps are closer to the exact shadow than 4 and than 8 layers",
        format!("RMSE {:.4}, {:.4}, {:.4}", errors[0], errors[1], errors[2]),
        errors[0] < errors[2] && errors[0] < errors[1],
    );
    studio.check(
        "More layers are closer",
        format!("RMSE {:.4}, {:.4}, {:.4}", errors[1], errors[2], errors[3]),
        errors[1] > errors[2] && errors[2] > errors[3],
    );
    Ok(())
}

/// Distance of the stray fragment before the others, as a multiple of the depth of the hair.
const STRAY: f32 = 0.6;

fn visibility(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let project = smooth();
    let moment = studio.moment(&project, 40)?;
    let ray = studio.rays(&project, &moment)?.into_iter().next().unwrap_or_default();
    let (near, far) =
        ray.iter().fold((f32::MAX, f32::MIN), |(near, far), (z, _)| (near.min(*z), far.max(*z)));
    let mut stray = ray.clone();
    stray.push((near - STRAY * (far - near), ray.first().map_or(0.1, |first| first.1)));
    let mut rows = Vec::new();
    let axes = ["depth from the nearest to the farthest fragment", "visibility"];
    for (name, caption, ray) in
        [("stray", "A stray strand meets the light first", &stray), ("hair", "Light enters the hair", &ray)]
    {
        let fragments: Vec<Fragment> = spread(ray);
        let truth = steps(&fragments);
        let curves = [
            ("occupancy and slabs", curve::<Occupancy>(&project.shadow, &fragments)),
            ("4 layers", curve::<Layers>(&layers(&project.shadow, 4), &fragments)),
            ("16 layers", curve::<Layers>(&layers(&project.shadow, 16), &fragments)),
        ];
        let errors = curves.each_ref().map(|(_, values)| rmse(values, &truth, 0.0..1.1));
        rows.push(
            std::iter::once(name.to_owned()).chain(errors.map(|error| format!("{error:.4}"))).collect(),
        );
        let mut shown = vec![named("exact", &truth)];
        shown.extend(curves.iter().map(|(name, values)| named(name, values)));
        studio.plot(format!("{caption}: {} fragments", fragments.len()), axes, shown);
        studio.check(
            format!("{caption}: occupancy maps are closer than 4 layers"),
            format!("RMSE {:.4} and {:.4}", errors[0], errors[1]),
            errors[0] < errors[1],
        );
    }
    studio.table("RMSE of visibility", &["ray", "occupancy and slabs", "4 layers", "16 layers"], rows);
    Ok(())
}

fn stills(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let project = many(20_000, 15);
    for frame in [40, CLOSE_FRAME, 118] {
        let moment = studio.moment(&project, frame)?;
        studio.draw(&frame.to_string(), format!("20,000 strands, frame {frame}"), &project, &moment)?;
    }
    Ok(())
}

fn jitter(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = many(20_000, 15);
    close_up(&mut project);
    project.shadow.occupancy_maps.resolution = 128;
    let moment = studio.moment(&project, CLOSE_FRAME)?;
    let mut fine = project.clone();
    (fine.shadow.occupancy_maps.resolution, fine.shadow.occupancy_maps.filter) =
        (1024, TexelFilter::Bilinear);
    let smooth = studio.drawn(&fine, &moment)?;
    let mut errors = Vec::new();
    for (filter, name) in [(TexelFilter::Nearest, "without"), (TexelFilter::Jitter, "with")] {
        project.shadow.occupancy_maps.filter = filter;
        let caption = format!("A map of 128² {name} jitter");
        let drawn = studio.draw(name, caption, &project, &moment)?;
        errors.push(flip(&smooth.picture, &drawn.picture)?);
    }
    studio.table(
        "FLIP against a map of 1024² with bilinear lookups",
        &["", "FLIP"],
        vec![
            vec!["without jitter".to_owned(), format!("{:.4}", errors[0])],
            vec!["with jitter".to_owned(), format!("{:.4}", errors[1])],
        ],
    );
    Ok(())
}

fn numbers(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    for (strands, published) in [(20_000, 27.6), (10_000, 37.0), (5_000, 60.6)] {
        let project = many(strands, 30);
        let moment = studio.moment(&project, 40)?;
        studio.draw(&strands.to_string(), format!("{strands} strands of 30 segments"), &project, &moment)?;
        let [interpolate, shadow, draw] = studio.image_ms(&project, &moment)?;
        let ms = interpolate + shadow + draw;
        rows.push(vec![
            strands.to_string(),
            format!("{published:.1}"),
            format!("{:.1}", 1e3 / ms.max(1e-9)),
            format!("{:.2}", 1e3 / ms.max(1e-9) / published),
        ]);
        times.push(ms);
    }
    studio.table(
        format!("Images per second. Published: GeForce GTX 280. Measured: {}", studio.adapter()),
        &["strands", "published", "measured", "measured / published"],
        rows,
    );
    Ok(())
}

fn passes(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let backend = studio.backend();
    let request = BenchRequest {
        scenes: vec![BenchScene::Woman300k],
        backends: vec![backend],
        frames: studio.frames(),
        ..BenchRequest::default()
    };
    let report = {
        let mut watch = studio.watch();
        bench(&request, &|_| Ok(()), &mut |what| watch(what))?
    };
    let Some(scene) = report.scenes.first() else { return Ok(()) };
    let rows = scene.stages.iter().filter_map(|stage| {
        let published = stage.published_ms?;
        Some(vec![
            stage.name.clone(),
            format!("{published:.2}"),
            format!("{:.2}", stage.median_ms),
            format!("{:.2}", published / stage.median_ms.max(1e-9)),
        ])
    });
    studio.table(
        format!("Published: GeForce GTX 280. Measured: {}, {}", report.machine, scene.adapter),
        &["stage or pass", "published, ms", "measured, ms", "published / measured"],
        rows.collect(),
    );
    Ok(())
}

fn memory(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut project = many(20_000, 15);
    project.shadow.occupancy_maps.resolution = 512;
    let moment = studio.moment(&project, 40)?;
    let truth = studio.truth(&project, &moment)?;
    let slices = |count: u32| {
        let mut shadow = ShadowSettings { method: ShadowMethod::OpacityMaps, ..project.shadow };
        shadow.opacity_maps.slices = count;
        shadow
    };
    let bits = |count: u32, slabs: u32| {
        let mut shadow = project.shadow;
        (shadow.occupancy_maps.slices, shadow.occupancy_maps.slabs) = (count, slabs);
        shadow
    };
    let (mut rows, mut found) = (Vec::new(), Vec::new());
    for (name, published, shadow) in [
        ("occupancy maps, 128 slices, 4 slabs", "10", bits(128, 4)),
        ("occupancy maps, 256 slices, 8 slabs", "", bits(256, 8)),
        ("occupancy maps, 512 slices, 16 slabs", "", bits(512, 16)),
        ("deep opacity maps, 4 layers", "", layers(&project.shadow, 4)),
        ("deep opacity maps, 16 layers", "18", layers(&project.shadow, 16)),
        ("opacity maps, 128 slices", "130", slices(128)),
        ("opacity maps, 256 slices", "258", slices(256)),
    ] {
        let measured = studio.measure(&project, &shadow, &moment)?;
        let (bytes, error) = (measured.report.memory_bytes as f64, measured.rmse(&truth));
        rows.push(vec![
            name.to_owned(),
            published.to_owned(),
            format!("{:.2}", bytes / 1e6),
            format!("{:.0}", bytes / measured.report.cells_touched.max(1) as f64),
            format!("{error:.4}"),
        ]);
        found.push((bytes, error));
    }
    studio.table(
        "Maps of at most 512² of one light, 20,000 strands; bytes per texel with hair",
        &["map", "published, MB", "ours, MB", "bytes per texel", "RMSE"],
        rows,
    );
    let bytes = |at: usize| found[at].0;
    studio.check(
        "Occupancy maps take less memory than 16 layers, those less than 128 slices, and those less than 256",
        format!(
            "{:.2}, {:.2}, {:.2}, {:.2} MB",
            bytes(0) / 1e6,
            bytes(4) / 1e6,
            bytes(5) / 1e6,
            bytes(6) / 1e6
        ),
        bytes(0) < bytes(4) && bytes(4) < bytes(5) && bytes(5) < bytes(6),
    );
    studio.check(
        "They take over ten times less than 128 slices, as published",
        format!("{:.1} times", bytes(5) / bytes(0)),
        bytes(5) > 10.0 * bytes(0),
    );
    let error = |at: usize| found[at].1;
    studio.check(
        "More slices and slabs are closer to the exact shadow",
        format!("RMSE {:.4}, {:.4}, {:.4}", error(0), error(1), error(2)),
        error(0) > error(1) && error(1) > error(2),
    );
    Ok(())
}
