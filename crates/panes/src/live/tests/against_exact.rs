//! Panes held against the exact method.

use super::*;

/// The exact transmittance of the first light, by the engine's renderer.
fn exact(rig: &Rig) -> Vec<f32> {
    let mut project = rig.project.compared();
    project.shadow.method = ShadowMethod::Exact;
    let camera = rig.snapshot.camera(&project.camera);
    let mut renderer = CpuRenderer::default();
    let input = rig.snapshot.frame_input(&project, &camera);
    renderer.picture(&input, 32, 32, &mut Picture::default()).expect("a picture");
    renderer.transmittance(0).expect("transmittance")
}

#[test]
fn errors_are_those_against_the_exact_method_and_it_is_not_held_against_itself() {
    let mut rig = on_processor(&[ShadowMethod::None, ShadowMethod::Exact, ShadowMethod::Exact]);
    rig.project.compare.panes[2].shadow.exact.filter = lovelock_render::TexelFilter::Nearest;
    rig.draw(rig.request(&[0, 1, 2]));
    let truth = exact(&rig);
    // A pane without shadow is wrong by all the light that hair takes.
    let lost =
        |power: i32| truth.iter().map(|&t| f64::from(1.0 - t).powi(power)).sum::<f64>() / truth.len() as f64;
    let LiveError::Measured { rmse, bias, p99 } = rig.pane(0).error else {
        panic!("{:?}", rig.pane(0).error)
    };
    assert!((rmse - lost(2).sqrt()).abs() < 1e-6 && (bias - lost(1)).abs() < 1e-6, "{rmse} {bias}");
    assert!(p99 >= rmse && p99 <= 1.0 && bias > 0.1);
    assert_eq!(rig.pane(1).error, LiveError::Reference);
    let other = rig.pane(2).error.rmse().expect("another map is not the reference");
    assert!(other > 0.0 && other < rmse, "{other}");

    let view = LiveView { measures: false, ..LiveView::default() };
    rig.draw(LiveRequest { view, ..rig.request(&[0]) });
    assert_eq!(rig.pane(0).error, LiveError::NotMeasured, "nobody asked");
    // A light that there is not has no error, and the picture comes all the same.
    let view = LiveView { light: 77, ..LiveView::default() };
    rig.draw(LiveRequest { view, ..rig.request(&[0]) });
    assert_eq!((rig.pane(0).problem.clone(), rig.pane(0).error.clone()), (None, LiveError::NotMeasured));
}

#[test]
fn the_reference_is_known_by_its_map_whatever_its_resolution_is_called() {
    let mut rig = on_processor(&[ShadowMethod::Exact; 4]);
    // Strands so wide that a map of any resolution above the least has texels as wide as they are.
    rig.project.look.diameter = 0.02;
    rig.project.shadow.exact.resolution = 512;
    let panes = &mut rig.project.compare.panes;
    panes[0].shadow.exact.resolution = 2048;
    panes[1].shadow.exact.memory_limit_bytes = 1 << 30;
    panes[2].shadow.exact.filter = lovelock_render::TexelFilter::Nearest;
    rig.draw(rig.request(&[0, 1, 2]));
    assert_eq!(rig.pane(0).error, LiveError::Reference, "another resolution, one map");
    assert_eq!(rig.pane(1).error, LiveError::Reference, "another limit, one map");
    let other = rig.pane(2).error.rmse().expect("another filter reads another value");
    assert!(other > 0.0, "{other}");
    // With fine strands, each of which stands for few hairs, the resolutions make two maps.
    rig.project.look.diameter = Project::default().look.diameter;
    rig.project.look.real_hairs = 100.0;
    rig.project.compare.panes[3].shadow.exact.resolution = 64;
    rig.draw(rig.request(&[3]));
    let other = rig.pane(3).error.rmse().expect("another map is not the reference");
    // More than rounding would give.
    assert!(other > 1e-4, "{other}");
}

#[test]
fn a_reference_that_does_not_fit_is_refused_with_the_number_and_the_panes_come() {
    let mut rig = on_processor(&[ShadowMethod::None]);
    // Strands so thin that a map of the largest resolution is needed, which is more than the least limit.
    rig.project.look.diameter = 17e-6;
    rig.project.look.real_hairs = 1.0;
    rig.project.shadow.exact.resolution = *lovelock_render::TEXEL_RESOLUTIONS.end();
    rig.project.shadow.exact.memory_limit_bytes = 1;
    rig.draw(rig.request(&[0]));
    let pane = rig.pane(0);
    assert_eq!(pane.problem, None);
    let LiveError::Refused(why) = &pane.error else { panic!("{:?}", pane.error) };
    assert!(why.contains("MiB"), "{why}");
    assert!(pane.colors_problem.is_none() && !pane.image.is_empty(), "no colours were asked for");
    // Under a scale of colours there is the reason and no picture, and what the pane took all the same.
    for shows in [LiveShows::TransmittanceError, LiveShows::PictureError] {
        let view = LiveView { shows, ..LiveView::default() };
        rig.draw(LiveRequest { view, ..rig.request(&[0]) });
        let pane = rig.pane(0);
        assert_eq!(pane.colors_problem.as_ref(), Some(why));
        assert!(pane.problem.is_none() && pane.image.is_empty() && pane.times.whole > 0.0);
    }
}

#[test]
fn an_error_that_was_measured_stays_where_the_picture_alone_cannot_be_compared() {
    let mut rig = on_processor(&[ShadowMethod::None]);
    rig.project.compare.panes[0].scale = 0.1;
    let view = LiveView { shows: LiveShows::PictureError, ..LiveView::default() };
    // The pane is small enough, the picture that it is held against is not.
    let width = lovelock_render::MAX_SIDE + 8;
    rig.draw(LiveRequest { width, view, ..rig.request(&[0]) });
    let pane = rig.pane(0);
    assert!(pane.error.rmse().is_some() && pane.problem.is_none(), "{:?}", pane.error);
    assert!(
        pane.colors_problem.as_ref().is_some_and(|why| why.contains("8192")),
        "{:?}",
        pane.colors_problem
    );
    assert!(pane.image.is_empty() && pane.flip.is_none());
}

#[test]
fn colours_are_on_hair_alone_and_stronger_where_the_error_is_larger() {
    let rig = on_processor(&[ShadowMethod::None, ShadowMethod::Exact]);
    rig.draw(LiveRequest { width: 160, height: 120, ..rig.request(&[0]) });
    let plain = pixels(&rig.pane(0));
    let view = |largest| LiveView { shows: LiveShows::TransmittanceError, largest, ..LiveView::default() };
    let drawn = |largest: f32| {
        rig.draw(LiveRequest { width: 160, height: 120, view: view(largest), ..rig.request(&[0, 1]) });
        [pixels(&rig.pane(0)), pixels(&rig.pane(1))]
    };
    let colored = |picture: &Picture| {
        let strong = |pixel: &&[u8]| pixel[..3].iter().max().unwrap() - pixel[..3].iter().min().unwrap() > 40;
        picture.rgba.chunks_exact(4).filter(strong).count()
    };
    let [wrong, right] = drawn(1.0);
    let grey = |pixel: &[u8]| pixel[0] == pixel[1] && pixel[1] == pixel[2];
    assert!(grey(&wrong.rgba[..4]) && !grey(&plain.rgba[..4]), "no hair in the corner: it is grey");
    assert!(colored(&wrong) > 100, "{}", colored(&wrong));
    // The exact method has no error: all of its hair has the first colour, which is dark violet.
    let first = lovelock_metrics::ColorMap::Viridis.at(0.0);
    assert!(right.rgba.chunks_exact(4).any(|pixel| pixel[..3] == first));
    assert!(!right.rgba.chunks_exact(4).any(|pixel| pixel[1] > 120 && pixel[0] < 160 && pixel[2] < 160));
    let [half, _] = drawn(2.0);
    let green =
        |picture: &Picture| picture.rgba.chunks_exact(4).map(|pixel| u64::from(pixel[1])).sum::<u64>();
    assert!(green(&half) < green(&wrong), "a wider scale has weaker colours");
}

#[test]
fn the_picture_of_the_reference_differs_from_none_but_itself() {
    let mut rig = on_processor(&[ShadowMethod::None, ShadowMethod::Exact]);
    rig.project.compare.panes[1].transparency = lovelock_render::Transparency::Exact;
    let view = LiveView { shows: LiveShows::PictureError, ..LiveView::default() };
    rig.draw(LiveRequest { width: 96, height: 72, view, ..rig.request(&[0, 1]) });
    let flip = |index| rig.pane(index).flip.expect("a mean");
    assert_eq!(rig.pane(1).flip, None, "the reference is not held against itself");
    assert!(
        pixels(&rig.pane(1))
            .rgba
            .chunks_exact(4)
            .all(|pixel| pixel[..3] == lovelock_metrics::ColorMap::Magma.at(0.0))
    );
    assert!(flip(0) > 0.005, "{}", flip(0));
    assert_ne!(pixels(&rig.pane(0)), pixels(&rig.pane(1)));
}

#[test]
fn a_pane_of_clusters_is_compared_by_its_image_and_has_no_error_of_transmittance() {
    let mut rig = on_processor(&[ShadowMethod::Exact, ShadowMethod::Exact]);
    for pane in &mut rig.project.compare.panes {
        pane.transparency = lovelock_render::Transparency::Exact;
    }
    rig.project.compare.panes[0].draw = HairDrawing::Clusters;
    rig.draw(rig.request(&[0, 1]));
    assert_eq!(rig.pane(0).error, LiveError::NotMeasured);
    assert_eq!(rig.pane(1).error, LiveError::Reference);
    assert!(!rig.pane(0).image.is_empty() && rig.pane(0).problem.is_none());
    assert!(rig.pane(0).settings_label().starts_with("clusters · "), "{}", rig.pane(0).settings_label());

    let view = LiveView { shows: LiveShows::TransmittanceError, ..LiveView::default() };
    rig.draw(LiveRequest { view, ..rig.request(&[0, 1]) });
    let pane = rig.pane(0);
    assert!(pane.colors_problem.as_ref().is_some_and(|why| why.contains("clusters")), "{pane:?}");
    assert!(pane.image.is_empty() && pane.problem.is_none());
    assert!(rig.pane(1).colors_problem.is_none());

    // The project itself draws clusters: the reference stays one of strands.
    rig.project.picture.draw = HairDrawing::Clusters;
    let view = LiveView { shows: LiveShows::PictureError, ..LiveView::default() };
    rig.draw(LiveRequest { view, ..rig.request(&[0, 1]) });
    let pane = rig.pane(0);
    assert!(pane.flip.is_some_and(|flip| flip > 1e-4), "{:?}", pane.flip);
    assert!(!pane.image.is_empty() && pane.colors_problem.is_none());
    assert_eq!((rig.pane(1).flip, &rig.pane(1).error), (None, &LiveError::Reference), "it is the reference");
}

#[test]
fn statistics_count_the_clusters() {
    let rig = on_processor(&[ShadowMethod::None]);
    let mut project = rig.project.clone();
    let camera = rig.snapshot.camera(&project.camera);
    let mut renderer = CpuRenderer::default();
    let mut draw = |project: &Project| {
        let input = rig.snapshot.frame_input(project, &camera);
        renderer.picture(&input, 64, 48, &mut Picture::default()).expect("a picture").clusters
    };
    assert_eq!(draw(&project), None, "strands");
    project.picture.draw = HairDrawing::Clusters;
    let stats = draw(&project).expect("clusters");
    assert_eq!(stats.clusters, rig.snapshot.scene.style.wisps.len() as u64);
    assert!((1..=stats.clusters).contains(&stats.macro_clusters), "{stats:?}");
    assert!(stats.volumes >= stats.clusters && stats.bytes > 0, "{stats:?}");
    project.picture.clusters.macro_tolerance = 1.0;
    let shared = draw(&project).expect("clusters");
    assert!(shared.macro_clusters < stats.clusters && shared.bytes < shared.bytes_unshared, "{shared:?}");
}
