//! Drafts: images that a better one follows soon.

use crate::common;

use common::{Scene, tuft_scene};
use lovelock_render::{CpuRenderer, FrameInput, FrameStats, Picture, ShadowMethod};

const SIDE: u32 = 128;

fn drawn(renderer: &mut CpuRenderer, scene: &Scene, is_draft: bool) -> (Picture, FrameStats) {
    let mut picture = Picture::default();
    let input = FrameInput { is_draft, ..scene.input() };
    let stats = renderer.picture(&input, SIDE, SIDE, &mut picture).expect("a picture");
    (picture, stats)
}

#[test]
fn fewer_strands_cast_the_shadows_of_a_draft_of_much_hair() {
    // 164,000 points, of which a draft takes half.
    let mut scene = tuft_scene(4000);
    scene.shadow.method = ShadowMethod::VoxelMap;
    let mut renderer = CpuRenderer::default();
    let mut found = |scene: &Scene, is_draft: bool| {
        let (picture, stats) = drawn(&mut renderer, scene, is_draft);
        let is_kept = stats.kept.iter().any(|pass| pass.name == "shadow/build");
        (renderer.transmittance(0).expect("a light"), picture, is_kept)
    };
    let (draft, ..) = found(&scene, true);
    let (exact, picture, is_kept) = found(&scene, false);
    assert!(!is_kept, "the map of a draft serves no better image");
    assert!(picture == drawn(&mut CpuRenderer::default(), &scene, false).0);
    let (finer, _, is_kept) = found(&scene, true);
    assert!(is_kept && finer == exact, "a map of all strands serves a draft");
    // Control: every strand stands for itself alone.
    scene.look.extinction_scale *= 0.5;
    let (control, ..) = found(&scene, true);
    let off = |other: &[f32]| {
        let sum: f32 = exact.iter().zip(other).map(|(a, b)| (a - b).abs()).sum();
        sum / exact.len() as f32
    };
    println!("off by {}, control {}", off(&draft), off(&control));
    assert!(off(&draft) > 0.0 && off(&draft) < 0.4 * off(&control));
}
