//! Figures and the table of Xu et al.: hair as clusters.

use std::fmt::Write;

use glam::Vec3;
use lovelock_groom::{Facing, HairShading, Preset};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_project::project::{CameraMode, MotionSource};
use lovelock_render::{ClusterShading, HairDrawing, LocalShadow};

use super::figures::{Figure, Paper};
use super::studio::{Studio, brightness};

const PAPER: Paper = Paper::Xu;

/// In the order of the paper.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        id: "xu-4",
        paper: PAPER,
        title: "Figure 4: one cluster with and without effects.",
        shows: "A cluster by Scheuermann's algorithm, by the method without the secondary highlight, without self-shadows, and with both: \
                shadows give it depth, the second highlight colour.",
        differs: "Scheuermann's algorithm is not part of this program; in its place stand the strands of the cluster.",
        make: effects,
    },
    Figure {
        id: "xu-5",
        paper: PAPER,
        title: "Figure 5: a head.",
        shows: "A whole head by Scheuermann's algorithm and by the method.",
        differs: "In place of Scheuermann's algorithm stand the strands of the same hair. The printed primary highlight has the colour of the \
                  light, so clusters are greyer than strands.",
        make: head,
    },
    Figure {
        id: "xu-6",
        paper: PAPER,
        title: "Figure 6: four clusters.",
        shows: "Four clusters of different geometry and density, with 15, 15, 10 and 15 layers and 3, 3, 2 and 3 K strands.",
        differs: "The geometries are our own.",
        make: four_clusters,
    },
    Figure {
        id: "xu-7",
        paper: PAPER,
        title: "Figure 7: heads of few clusters.",
        shows: "Heads of 17, 12, 4 and 6 clusters with 51, 60, 60 and 60 layers in all.",
        differs: "Our locks follow three guides each, so a quarter of a head is one smooth lock, with gaps beside it; heads of 4 and 6 clusters \
                  come from straight strands in a file. The head of 12 clusters has 12,000 strands instead of 20,000.",
        make: heads,
    },
    Figure {
        id: "xu-8",
        paper: PAPER,
        title: "Figure 8: moving clusters.",
        shows: "40 clusters with 80 layers in all for 21,000 strands, animated at 11 to 13 frames per second.",
        differs: "",
        make: moving,
    },
    Figure {
        id: "xu-table",
        paper: PAPER,
        title: "Table 1: times.",
        shows: "Index, maps, texture mapping, lighting and shadows of each of these hairs on a Pentium 4 of 3 GHz with a GeForce 6600 GT.",
        differs: "The index is found once per hairstyle, and maps are read while layers are drawn, so only whole images compare.",
        make: table,
    },
];

/// The published light and shadow of clusters with so many layers.
fn published(mut project: Project, layers: u32) -> Project {
    project.picture.draw = HairDrawing::Clusters;
    let clusters = &mut project.picture.clusters;
    clusters.layers = layers;
    clusters.shading = ClusterShading::Paper;
    clusters.local_shadow = LocalShadow::Exponential;
    project
}

/// The text of a USD file with strands of so many points each, metres, Y up.
fn usd(counts: &[u32], points: &[Vec3]) -> String {
    let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
    let mut text = String::new();
    for (at, p) in points.iter().enumerate() {
        let comma = if at == 0 { "" } else { ", " };
        let _ = write!(text, "{comma}({:.5}, {:.5}, {:.5})", p.x, p.y, p.z);
    }
    format!(
        "#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\ndef BasisCurves \"hair\" {{\n    uniform token type = \"linear\"\n    \
         int[] curveVertexCounts = [{}]\n    point3f[] points = [{text}]\n    float[] widths = [0.0001] ( interpolation = \
         \"constant\" )\n}}\n",
        counts.join(", ")
    )
}

/// The shape of a lock.
struct Lock {
    name: &'static str,
    strands: u32,
    /// Largest radius, metres, and how much narrower it is across.
    wide: (f32, f32),
    /// How far it swings aside, metres, and how far it turns about itself, radians.
    swing: (f32, f32),
}

/// Four locks; the first is that of figure 4.
const LOCKS: [Lock; 4] = [
    Lock { name: "a", strands: 3000, wide: (0.021, 0.7), swing: (0.05, 0.8) },
    Lock { name: "b", strands: 3000, wide: (0.026, 0.45), swing: (0.0, 0.2) },
    Lock { name: "c", strands: 2000, wide: (0.014, 1.0), swing: (0.09, 0.4) },
    Lock { name: "d", strands: 3000, wide: (0.023, 0.6), swing: (0.03, 4.0) },
];

/// Segments of each strand.
const SEGMENTS: u32 = 24;

impl Lock {
    /// The points of its strands, which hang from y = 2.05 m beside the head.
    fn points(&self) -> Vec<Vec3> {
        let strands = 0..self.strands;
        strands.flat_map(|strand| (0..=SEGMENTS).map(move |at| self.point(strand, at))).collect()
    }

    fn point(&self, strand: u32, at: u32) -> Vec3 {
        let (strand, share) = (strand as f32, (strand as f32 + 0.5) / self.strands as f32);
        let mut angle = 2.399_963 * strand;
        angle += 0.05 * (11.0 * angle).sin();
        let end = 1.0 - 0.15 * (0.618_034 * strand).fract();
        let t = at as f32 / SEGMENTS as f32;
        let bulge = if t < 0.35 { 0.6 + 0.4 * t / 0.35 } else { 1.0 - 0.8 * (t - 0.35) };
        let radius = self.wide.0 * bulge * share.sqrt();
        let turned = angle + self.swing.1 * t;
        let fine = 0.0006 * t * (9.0 * t + strand).sin();
        Vec3::new(
            0.05 + self.swing.0 * t * (5.0 * t).sin() + radius * turned.cos() + fine,
            2.05 - 0.26 * t * end,
            0.02 * t * t + self.wide.1 * radius * turned.sin() + fine,
        )
    }

    /// A project with this lock alone beside the body.
    fn project(&self, studio: &Studio<'_>) -> Result<Project, ProjectError> {
        let file = studio.file(&format!("lock-{}.usda", self.name));
        write_whole(&file, usd(&vec![SEGMENTS + 1; self.strands as usize], &self.points()).as_bytes())?;
        let mut project = Project::default();
        project.compare.shading = HairShading::KajiyaKayPublished;
        let mut project = project.compared();
        project.set_hair_file(&file);
        let import = &mut project.hair.import;
        (import.facing, import.fit_scale, import.snap_roots, import.wisps) = (Facing::PlusZ, false, false, 1);
        import.placement.offset_m = Vec3::new(-0.5, 0.3, 0.0);
        project.look.real_hairs = self.strands as f32;
        project.motion.source = MotionSource::Rest;
        project.timeline.preroll_secs = 0.0;
        project.picture.ground = false;
        let camera = &mut project.camera;
        (camera.mode, camera.fixed_target) = (CameraMode::Fixed, Vec3::new(-0.46, 1.90, 0.0));
        (camera.azimuth, camera.distance) = (0.0, 0.62);
        Ok(project)
    }
}

/// The strength of the second highlight at which it is visible on one lock.
const SECOND: f32 = 1.5;

fn effects(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let strands = LOCKS[0].project(studio)?;
    let moment = studio.moment(&strands, 0)?;
    studio.draw("strands", "The strands of the lock", &strands, &moment)?;
    let mut all = published(strands, 15);
    all.picture.clusters.secondary = SECOND;
    let mut plain = all.clone();
    plain.picture.clusters.secondary = 0.0;
    let without = studio.draw("no-second", "Without the second highlight", &plain, &moment)?;
    let mut lit = all.clone();
    lit.picture.clusters.shadow_strength = 0.0;
    let bright = studio.draw("no-shadow", "Without own shadow", &lit, &moment)?;
    let whole = studio.draw("all", "With both", &all, &moment)?;
    let [without, bright, whole] = [without, bright, whole].map(|drawn| brightness(&drawn.picture));
    studio.check(
        "The second highlight adds light, the own shadow takes some",
        format!("mean grey values {without:.2} without the highlight, {bright:.2} without shadow, {whole:.2} with both"),
        without < whole && whole < bright,
    );
    Ok(())
}

/// Smooth hair of `wisps` locks with so many strands each, seen near the head.
fn hair(wisps: u32, strands: u32) -> Project {
    let mut project = Project::default();
    project.set_preset(Preset::Smooth);
    project.compare.shading = HairShading::KajiyaKayPublished;
    let mut project = project.compared();
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (wisps, strands);
    project.camera.distance = 1.2;
    project
}

/// The heads of figure 7 that grow as locks: clusters, strands of each, layers of each.
const GROWN: [(u32, u32, u32); 2] = [(17, 824, 3), (12, 1000, 5)];

/// Those of fewer clusters than grow, from strands in a file: clusters, strands in all, layers of each.
const GATHERED: [(u32, u32, u32); 2] = [(4, 20_000, 15), (6, 9_000, 10)];

/// Wisps of the hair in those files, and segments of a strand.
const WISPS: u32 = 40;
const FEW: u32 = 12;

/// A head whose locks grow.
fn grown((wisps, strands, layers): (u32, u32, u32)) -> Project {
    let mut project = published(hair(wisps, strands), layers);
    project.motion.source = MotionSource::Rest;
    project.timeline.preroll_secs = 0.0;
    project
}

/// A head whose straight strands come from a file and are gathered into so few locks.
fn gathered(
    studio: &mut Studio<'_>,
    (wisps, strands, layers): (u32, u32, u32),
) -> Result<Project, ProjectError> {
    let mut straight = grown((WISPS, strands / WISPS, layers));
    let groom = &mut straight.hair.groom;
    (groom.wave, groom.frizz, groom.segments_per_strand) = (0.0, 0.0, FEW);
    let moment = studio.moment(&straight, 0)?;
    let all = &moment.hair.strands;
    let points: Vec<Vec3> = (0..all.points()).map(|at| all.point(at)).collect();
    let counts: Vec<u32> = all.first_point.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let file = studio.file(&format!("strands-{strands}.usda"));
    write_whole(&file, usd(&counts, &points).as_bytes())?;
    let mut project = straight;
    project.set_hair_file(&file);
    project.hair.import.wisps = wisps;
    project.hair.import.facing = Facing::PlusZ;
    Ok(project)
}

fn head(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let clusters = moving_hair();
    let mut strands = clusters.clone();
    strands.picture.draw = HairDrawing::Strands;
    let moment = studio.moment(&strands, 0)?;
    studio.draw("strands", "21,000 strands", &strands, &moment)?;
    studio.draw("clusters", "The same hair as 40 clusters with all effects", &clusters, &moment)?;
    Ok(())
}

/// Layers of each of [`LOCKS`].
const LAYERS: [u32; 4] = [15, 15, 10, 15];

fn four_clusters(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    for (lock, layers) in LOCKS.iter().zip(LAYERS) {
        let mut project = published(lock.project(studio)?, layers);
        project.picture.clusters.secondary = SECOND;
        let moment = studio.moment(&project, 0)?;
        let caption = format!("Cluster {}: {} strands in {layers} layers", lock.name, lock.strands);
        let drawn = studio.draw(lock.name, caption, &project, &moment)?;
        let clusters = drawn.stats.clusters.as_ref().map_or(0, |stats| stats.clusters);
        studio.check(
            format!("Lock {} is drawn as one cluster", lock.name),
            format!("{clusters} clusters"),
            clusters == 1,
        );
    }
    Ok(())
}

fn heads(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let mut all: Vec<_> = GROWN.map(|head| (head, head.0 * head.1, grown(head))).into();
    for head in GATHERED {
        all.push((head, head.1, gathered(studio, head)?));
    }
    for ((wisps, _, layers), strands, project) in all {
        let moment = studio.moment(&project, 0)?;
        let caption = format!("{wisps} clusters, {strands} strands, {layers} layers each");
        let drawn = studio.draw(&wisps.to_string(), caption, &project, &moment)?;
        let found = drawn.stats.clusters.as_ref().map_or(0, |stats| stats.clusters);
        studio.check(
            format!("The head is drawn as {wisps} clusters"),
            format!("{found} clusters"),
            found == u64::from(wisps),
        );
    }
    Ok(())
}

/// The hair of figure 8.
fn moving_hair() -> Project {
    let mut project = published(hair(40, 525), 2);
    project.camera.distance = 1.4;
    project
}

fn moving(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    let project = moving_hair();
    for frame in [45, 60, 75, 90] {
        let moment = studio.moment(&project, frame)?;
        studio.draw(&frame.to_string(), format!("Frame {frame}"), &project, &moment)?;
    }
    Ok(())
}

fn table(studio: &mut Studio<'_>) -> Result<(), ProjectError> {
    // The rows of the table, figure by figure: index, maps, texture mapping, light and shadow in ms, and frames per second.
    const LOCK_TIMES: [([f64; 5], f64); 4] = [
        ([5.0, 29.0, 2.6, 0.3, 0.2], 27.0),
        ([5.0, 28.0, 1.9, 0.2, 0.1], 28.0),
        ([4.0, 14.0, 1.7, 0.1, 0.1], 42.0),
        ([5.0, 31.0, 2.0, 0.2, 0.2], 26.0),
    ];
    const GROWN_TIMES: [([f64; 5], f64); 2] =
        [([28.0, 44.0, 4.5, 0.2, 0.2], 13.0), ([36.0, 39.0, 6.9, 0.5, 0.5], 12.0)];
    const GATHERED_TIMES: [([f64; 5], f64); 2] =
        [([35.0, 61.0, 3.5, 0.3, 0.3], 10.0), ([29.0, 36.0, 5.2, 0.7, 0.3], 14.0)];
    let mut rows = Vec::new();
    let mut all = Vec::new();
    for ((lock, layers), (times, rate)) in LOCKS.iter().zip(LAYERS).zip(LOCK_TIMES) {
        all.push((format!("lock {}", lock.name), published(lock.project(studio)?, layers), times, rate));
    }
    for (head, (times, rate)) in GROWN.into_iter().zip(GROWN_TIMES) {
        all.push((format!("{} clusters", head.0), grown(head), times, rate));
    }
    for (head, (times, rate)) in GATHERED.into_iter().zip(GATHERED_TIMES) {
        all.push((format!("{} clusters", head.0), gathered(studio, head)?, times, rate));
    }
    all.push(("40 clusters".to_owned(), moving_hair(), [36.0, 43.0, 4.3, 0.6, 0.4], 12.0));
    for (name, project, published, rate) in all {
        let moment = studio.moment(&project, 0)?;
        let [ribs, shadow, draw] = studio.image_ms(&project, &moment)?;
        let ms = ribs + shadow + draw;
        let sum: f64 = published.iter().sum();
        rows.push(vec![
            name,
            published.map(|ms| ms.to_string()).join(", "),
            format!("{sum:.0}"),
            format!("{:.0}", 1e3 / rate),
            format!("{ribs:.1}, {shadow:.1}, {draw:.1}"),
            format!("{ms:.1}"),
            format!("{:.2}", 1e3 / rate / ms.max(1e-9)),
        ]);
    }
    studio.table(
        format!(
            "Milliseconds. Published: Pentium 4 at 3 GHz, GeForce 6600 GT. Measured: {}",
            studio.adapter()
        ),
        &[
            "",
            "published: index, maps, mapping, light, shadow",
            "their sum",
            "published frame",
            "ours: ribs, shadow map, drawing",
            "our image",
            "published frame / ours",
        ],
        rows,
    );
    Ok(())
}
