//! Figures of Mertens, Kautz, Bekaert, Van Reeth 2004.

use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{ShadowMethod, ShadowSettings};
use lovelock_shadow::methods::density_clustering::Clustering;
use lovelock_shadow::methods::opacity_maps::Slices;
use lovelock_shadow::methods::texels::Fragment;
use lovelock_shadow::{ClusterSeeds, LineFilter, TexelFilter};

use super::bertails::{CLOSE_FRAME, scene, smooth, unshadowed};
use super::curves::{SAMPLES, curve, gaussians, named, rmse, spread, steps};
use super::figures::{Figure, Paper};
use super::studio::Studio;
use crate::bench::BenchScene;

const PAPER: Paper = Paper::Mertens;

/// In the order of the paper.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "mertens-1",
        paper: PAPER,
        title: "Figure 1: frames of an animation.",
        shows: "A hair model of 100 K segments in motion at 6 images per second: one frame without self-shadows, others with them.",
        differs: "Ours is the smooth hairstyle on the shipped dancer.",
        make: frames,
    },
    Figure {
        id: "mertens-5",
        paper: PAPER,
        title: "Figures 4 and 5: four means against eight bins.",
        shows: "Along a ray through bundles of hair, and for depths from 4 and 8 normal distributions, four clusters follow the visibility \
                better than a uniform histogram of eight bins; with more distributions than clusters, seeds moved toward the light help \
                near it.",
        differs: "The ray is the deepest one of our smooth hair instead of square bundles; on a single ray either can be closer. Means of \
                  many rays and of many random sets are tabled beside the drawn ones.",
        make: means_against_bins,
    },
    Figure {
        id: "mertens-6",
        paper: PAPER,
        title: "Figure 6: various models.",
        shows: "Long red hair of 3,600 strands (210 K segments), its close-up, curly hair of 3,900 strands (200 K segments), grass drawn as \
                hair, and the red hair with opacity shadow maps of 256 slices, which are too bright where light enters.",
        differs: "Our opacity maps add no empirical offsets, so with 256 slices they are as near to the exact shadow as clusters.",
        make: models,
    },
    Figure {
        id: "mertens-times",
        paper: PAPER,
        title: "Section 5: rates.",
        shows: "100 K segments at 6 Hz and 200 K at 3 Hz on a Radeon 9800 XT; performance scales linearly with the number of segments.",
        differs: "",
        make: times,
    },
];

/// The settings of the paper: four clusters, uniform seeds, one iteration, pre-filtered lines.
fn clustering(project: &Project) -> Project {
    let mut project = project.clone();
    project.shadow.method = ShadowMethod::DensityClustering;
    let settings = &mut project.shadow.density_clustering;
    (settings.clusters, settings.seeds, settings.steps) = (4, ClusterSeeds::Uniform, 1);
    (settings.prefiltered, settings.line_filter) = (true, LineFilter::Gaussian);
    project
}

fn frames(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let (project, moment) = smooth(studio)?;
    studio.draw("without", "Without self-shadows", &unshadowed(&project), &moment)?;
    let clustered = clustering(&project);
    studio.draw("40", "Density clustering, frame 40", &clustered, &moment)?;
    for frame in [CLOSE_FRAME, 118] {
        let moment = studio.moment(&clustered, frame)?;
        studio.draw(&frame.to_string(), format!("Density clustering, frame {frame}"), &clustered, &moment)?;
    }
    Ok(())
}

/// Fragments per random ray, and their optical depth together.
const FRAGMENTS: usize = 100;
const TOTAL: f32 = 4.0;
/// Random rays of a mean.
const RAYS: u32 = 200;
/// Random rays of the figure.
const SEED: u32 = 11;

/// Settings for the curves: four clusters with these seeds, and eight slices.
fn settings(seeds: ClusterSeeds) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.opacity_maps.slices = 8;
    let clusters = &mut settings.density_clustering;
    (clusters.clusters, clusters.seeds, clusters.steps, clusters.filter) =
        (4, seeds, 1, TexelFilter::Nearest);
    settings
}

/// The truth, four clusters, eight bins, and four clusters from seeds that are moved toward the light.
fn curves(fragments: &[Fragment]) -> [Vec<f32>; 4] {
    let uniform = settings(ClusterSeeds::Uniform);
    [
        steps(fragments),
        curve::<Clustering>(&uniform, fragments),
        curve::<Slices>(&uniform, fragments),
        curve::<Clustering>(&settings(ClusterSeeds::TowardLight), fragments),
    ]
}

/// Fragments of a ray that is compared, at least.
const FEWEST: usize = 16;

/// The whole depth, and the part near the light, where it falls off most.
const ALL: f32 = 1.1;
const NEAR: f32 = 0.25;

fn means_against_bins(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let (project, moment) = smooth(studio)?;
    let rays: Vec<Vec<Fragment>> = studio
        .rays(&project, &moment)?
        .iter()
        .filter(|ray| ray.len() >= FEWEST)
        .map(|ray| spread(ray))
        .collect();
    let Some(ray) = rays.first() else {
        return Err(ProjectError::work("no ray of the figure has much hair"));
    };
    let axes = ["depth from the nearest to the farthest fragment", "visibility"];
    let mut rows: Vec<Vec<String>> = Vec::new();
    let row = |name: String, errors: [f64; 3]| {
        std::iter::once(name).chain(errors.map(|error| format!("{error:.4}"))).collect::<Vec<_>>()
    };
    let errors =
        |found: &[Vec<f32>; 4], within: f32| [1, 2, 3].map(|at| rmse(&found[at], &found[0], 0.0..within));
    let names = ["exact", "4 means", "8 uniform bins", "4 means, seeds toward the light"];
    let shown = |found: &[Vec<f32>; 4], count: usize| -> Vec<_> {
        names.iter().zip(found).take(count).map(|(name, values)| named(name, values)).collect()
    };
    let hair = curves(ray);
    rows.push(row(format!("ray through hair, {} fragments", ray.len()), errors(&hair, ALL)));
    studio.plot(format!("A ray through the smooth hair: {} fragments", ray.len()), axes, shown(&hair, 3));
    let mut of_rays = [0.0; 3];
    for ray in &rays {
        let found = errors(&curves(ray), ALL);
        of_rays.iter_mut().zip(found).for_each(|(sum, error)| *sum += error / rays.len() as f64);
    }
    rows.push(row(format!("{} rays of at least {FEWEST} fragments, mean", rays.len()), of_rays));
    studio.check(
        "On rays through hair four means are closer to the exact visibility than eight bins in the mean",
        format!("RMSE {:.4} and {:.4} over {} rays", of_rays[0], of_rays[1], rays.len()),
        of_rays[0] < of_rays[1],
    );
    for groups in [4, 8] {
        let found = curves(&gaussians(SEED, groups, FRAGMENTS, TOTAL));
        rows.push(row(format!("{groups} normal distributions, as drawn"), errors(&found, ALL)));
        studio.plot(
            format!("{FRAGMENTS} fragments from {groups} normal distributions"),
            axes,
            shown(&found, if groups == 8 { 4 } else { 3 }),
        );
        let (mut sums, mut near) = ([0.0; 3], [0.0; 3]);
        for seed in 0..RAYS {
            let found = curves(&gaussians(1000 + seed, groups, FRAGMENTS, TOTAL));
            for (sums, within) in [(&mut sums, ALL), (&mut near, NEAR)] {
                sums.iter_mut()
                    .zip(errors(&found, within))
                    .for_each(|(sum, error)| *sum += error / f64::from(RAYS));
            }
        }
        rows.push(row(format!("{groups} distributions, mean of {RAYS} sets"), sums));
        rows.push(row(format!("the same over the first {:.0} % of the depth", 100.0 * NEAR), near));
        if groups == 4 {
            studio.check(
                "With as many distributions as clusters four means are closer than eight bins in the mean",
                format!("RMSE {:.4} and {:.4}", sums[0], sums[1]),
                sums[0] < sums[1],
            );
        } else {
            studio.check(
                "With more distributions than clusters, seeds toward the light are closer where light enters",
                format!("RMSE {:.4} and {:.4} over the first {:.0} %", near[2], near[0], 100.0 * NEAR),
                near[2] < near[0],
            );
        }
    }
    studio.table(
        format!("RMSE of visibility at {SAMPLES} depths"),
        &["fragments", "4 means", "8 bins", "4 means toward the light"],
        rows,
    );
    Ok(())
}

/// Long red hair of 3,600 strands of 58 segments.
fn red() -> Project {
    let mut project = scene(Preset::Long);
    let groom = &mut project.hair.groom;
    (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (180, 20, 58);
    (project.look.eumelanin, project.look.pheomelanin) = (0.2, 2.0);
    project.camera.distance = 1.9;
    project.camera.follow_offset.y = -0.12;
    project
}

fn models(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let project = clustering(&red());
    let moment = studio.moment(&project, 0)?;
    let segments = moment.hair.strands.segments();
    studio.draw(
        "red",
        format!("Long red hair, {segments} segments, density clustering"),
        &project,
        &moment,
    )?;
    let mut side = project.clone();
    side.camera.azimuth = 2.2;
    studio.draw("red-back", "The same from behind", &side, &moment)?;
    let mut sliced = side.clone();
    sliced.shadow.method = ShadowMethod::OpacityMaps;
    sliced.shadow.opacity_maps.slices = 256;
    studio.draw("red-slices", "The same with opacity maps of 256 slices", &sliced, &moment)?;
    let mut close = project.clone();
    close.camera.distance = 0.6;
    studio.draw("red-close", "Close-up of the long hair", &close, &moment)?;

    let truth = studio.truth(&project, &moment)?;
    let mut rows = Vec::new();
    let mut errors = Vec::new();
    for (name, shadow) in [
        ("4 clusters", project.shadow),
        ("opacity maps, 8 slices", with_slices(&project, 8)),
        ("opacity maps, 80 slices", with_slices(&project, 80)),
        ("opacity maps, 256 slices", with_slices(&project, 256)),
    ] {
        let measured = studio.measure(&project, &shadow, &moment)?;
        let error = measured.rmse(&truth);
        let memory = measured.report.memory_bytes as f64 / f64::from(1 << 20);
        rows.push(vec![name.to_owned(), format!("{error:.4}"), format!("{memory:.1} MiB")]);
        errors.push((error, memory));
    }
    studio.table("The red hair against the exact shadow", &["method", "RMSE", "memory"], rows);
    studio.check(
        "Four clusters are closer to the exact shadow than a uniform histogram of eight slices",
        format!("RMSE {:.4} and {:.4}", errors[0].0, errors[1].0),
        errors[0].0 < errors[1].0,
    );
    studio.check(
        "They take less memory than 256 slices",
        format!("{:.1} and {:.1} MiB", errors[0].1, errors[3].1),
        errors[0].1 < errors[3].1,
    );

    let mut curly = clustering(&scene(Preset::Curly));
    let groom = &mut curly.hair.groom;
    (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (156, 25, 51);
    let moment = studio.moment(&curly, 0)?;
    let segments = moment.hair.strands.segments();
    studio.draw("curly", format!("Curly hair, {segments} segments, density clustering"), &curly, &moment)?;
    let grass = clustering(&BenchScene::Lawn.project());
    let moment = studio.moment(&grass, 0)?;
    let blades = moment.hair.strands.count();
    studio.draw("grass", format!("Grass drawn as hair, {blades} blades"), &grass, &moment)?;
    Ok(())
}

fn with_slices(project: &Project, slices: u32) -> ShadowSettings {
    let mut shadow = ShadowSettings { method: ShadowMethod::OpacityMaps, ..project.shadow };
    shadow.opacity_maps.slices = slices;
    shadow
}

fn times(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let (hundred, smooth) = smooth(studio)?;
    let red = red();
    let long = studio.moment(&red, 0)?;
    let mut rows = Vec::new();
    for (project, moment, published) in [(&hundred, &smooth, 1e3 / 6.0), (&red, &long, 1e3 / 3.0)] {
        let clustered = clustering(project);
        let [strands, shadow, draw] = studio.image_ms(&clustered, moment)?;
        let ms = strands + shadow + draw;
        rows.push(vec![
            moment.hair.strands.segments().to_string(),
            format!("{published:.0}"),
            format!("{ms:.1}"),
            format!("{shadow:.1}"),
            format!("{:.1}", published / ms.max(1e-9)),
        ]);
    }
    studio.table(
        format!("Published: Radeon 9800 XT and Pentium 4 at 1.3 GHz. Measured: {}", studio.adapter()),
        &["segments", "published, ms", "one image, ms", "of it shadow", "published / measured"],
        rows,
    );
    Ok(())
}
