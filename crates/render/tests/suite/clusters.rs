//! Hair as clusters: one backend against the other.

use crate::common;

use std::sync::Arc;

use common::{Scene, scene};
use glam::{Affine3A, Vec3};
use lovelock_groom::{GroomSettings, GuideFrame, PlainHead, grow};
use lovelock_render::{Backend, HairDrawing, Light, ShadowMethod, Transparency};
use lovelock_satf::{ClusterShading, ClusterView, LocalShadow, RecordLookup};
use lovelock_testkit::{Flip, flip};

const MEAN: f32 = 0.005;
const P99: f32 = 0.06;

/// A head of 24 clusters around a box.
fn wig() -> Scene {
    let settings = GroomSettings { wisps: 24, strands_per_wisp: 40, ..GroomSettings::default() };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair"));
    let mut scene = scene(&[]);
    scene.guides = Some(GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0));
    (scene.style, scene.look) = (style, settings.look);
    scene.body = Some(common::grid(-0.02, 0.3, 48, Vec3::new(0.35, 0.25, 0.2)));
    scene.shadow.method = ShadowMethod::VoxelMap;
    scene.lights = Light::default_rig();
    scene.camera.target = Vec3::new(0.0, 0.04, 0.0);
    scene.camera.eye = Vec3::new(-0.3, 0.2, 0.75);
    scene.picture.draw = HairDrawing::Clusters;
    scene.picture.strand_opacity = 0.85;
    scene
}

fn compared(scene: &Scene, other: &Scene) -> Option<Flip> {
    let (w, h) = (240, 200);
    let gpu = scene.draw_by(Backend::Gpu, w, h)?;
    let cpu = other.draw_by(Backend::Cpu, w, h)?;
    if let Some(folder) = std::env::var_os("CLUSTER_PICTURES") {
        save(&gpu.rgba, w, h, folder.to_string_lossy().as_ref(), "gpu");
        save(&cpu.rgba, w, h, folder.to_string_lossy().as_ref(), "cpu");
    }
    Some(flip(&gpu.rgba, &cpu.rgba, w, h))
}

/// Whether a test was skipped, or has passed.
fn save(rgba: &[u8], w: u32, h: u32, folder: &str, name: &str) {
    let mut out = format!("P6 {w} {h} 255\n").into_bytes();
    out.extend(rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]));
    std::fs::write(format!("{folder}/{name}.ppm"), out).unwrap();
}

#[test]
fn clusters_look_the_same_on_both_in_every_mode() {
    let mut s = wig();
    for mode in Transparency::ALL {
        s.picture.transparency = mode;
        let Some(difference) = compared(&s, &s) else { return };
        println!("{mode}: {difference:?}");
        assert!(difference.mean < 1.0 || difference.p99 < 1.0, "{mode}: {difference:?}");
    }
}

#[test]
fn every_setting_looks_the_same_on_both() {
    let settings: [(&str, fn(&mut Scene)); 8] = [
        ("outer layers", |s| s.picture.clusters.local_shadow = LocalShadow::Layers),
        ("linear", |s| s.picture.clusters.local_shadow = LocalShadow::Linear),
        ("toward the light", |s| s.picture.clusters.local_shadow = LocalShadow::Directional),
        ("nearest", |s| s.picture.clusters.lookup = RecordLookup::Nearest),
        ("published light", |s| s.picture.clusters.shading = ClusterShading::Paper),
        ("records", |s| s.picture.clusters.view = ClusterView::Records),
        ("shared", |s| s.picture.clusters.macro_tolerance = 0.3),
        ("mixed", |s| {
            s.picture.draw = HairDrawing::Auto;
            s.picture.cluster_size = 70.0;
        }),
    ];
    for (name, change) in settings {
        let mut s = wig();
        change(&mut s);
        let Some(difference) = compared(&s, &s) else { return };
        println!("{name}: {difference:?}");
        assert!(difference.mean < 1.0 || difference.p99 < 1.0, "{name}: {difference:?}");
    }
}

#[test]
fn times() {
    let s = wig();
    for mode in Transparency::ALL {
        let s = Scene { picture: lovelock_render::PictureSettings { transparency: mode, ..s.picture }, ..wig() };
        let Some(stats) = s.passes_by(Backend::Gpu, 640, 480) else { return };
        println!("{mode}: {:?}", stats.passes.iter().map(|p| format!("{} {:.1}", p.name, p.ms)).collect::<Vec<_>>());
        let stats = s.passes_by(Backend::Cpu, 640, 480).unwrap();
        println!("  cpu: {:?}", stats.passes.iter().map(|p| format!("{} {:.1}", p.name, p.ms)).collect::<Vec<_>>());
    }
}

#[test]
fn small_differences_are_found() {
    let controls: [(&str, fn(&mut Scene)); 3] = [
        ("layers", |s| s.picture.clusters.layers = 3),
        ("light", |s| s.lights[0].direction = Vec3::new(-0.62, -0.45, -0.6)),
        ("strands", |s| s.picture.draw = HairDrawing::Strands),
    ];
    for (name, change) in controls {
        let mut s = wig();
        change(&mut s);
        let Some(difference) = compared(&wig(), &s) else { return };
        println!("{name}: {difference:?}");
    }
}
