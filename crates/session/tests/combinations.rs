//! Every shadow method with every transparency: all hairstyles on the CPU backend, which needs no adapter, and the default
//! project on the GPU backend compared with the CPU.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_render::{Backend, Picture, Renderer, ShadowMethod, Transparency};
use lovelock_session::engine::Engine;
use lovelock_session::scene::{LoadControl, SceneLoader};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_testkit::{flip, suite::is_long};

const SIZE: (u32, u32) = (96, 72);

/// Camera azimuth for tied hair: from behind, to the left.
const BEHIND: f32 = 2.6;

/// No bound exceeds this fraction of the difference between images with and without shadow.
const BELOW_CONTROL: f32 = 0.7;

/// The project half a second into the dance.
fn instant(name: &str, project: &Project) -> Arc<FrameSnapshot> {
    let cancelled = AtomicBool::new(false);
    let mut silent = |_: &str, _: f32| {};
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut silent };
    let mut access = Access::new();
    if let Some(file) = &project.hair.file {
        access.pick(&file.path);
    }
    let (scene, problems) = SceneLoader::new().load(project, &access, &mut control).expect("a scene");
    assert!(problems.is_empty(), "{name}: {problems:?}");
    let mut engine = Engine::at_rest(Arc::clone(&scene), project.simulation, 1.0 / 60.0);
    engine.follow(project);
    engine.settle();
    engine.advance_to_step(30);
    engine.snapshot()
}

/// Renders one image of it.
fn draw(
    renderer: &mut Renderer,
    snapshot: &FrameSnapshot,
    project: &mut Project,
    method: ShadowMethod,
    transparency: Transparency,
) -> Vec<u8> {
    project.shadow.method = method;
    project.picture.transparency = transparency;
    let camera = snapshot.camera(&project.camera);
    let mut picture = Picture::default();
    let input = snapshot.frame_input(project, &camera);
    renderer.picture(&input, SIZE.0, SIZE.1, &mut picture).expect("a picture");
    picture.rgba
}

/// Renders the project in every combination on the CPU.
fn draw_all(name: &str, mut project: Project) {
    // Fewer and wider strands: the same coverage in less time.
    project.hair.groom.strands_per_wisp = 10;
    project.camera.distance = 0.7;
    if !project.hair.ties.is_empty() {
        // Tied hair is behind the head.
        project.camera.azimuth = BEHIND;
    }
    project = project.compared();
    let snapshot = instant(name, &project);
    let mut renderer = Renderer::open(Backend::Cpu).expect("the processor");
    let mut draw = |method, transparency| draw(&mut renderer, &snapshot, &mut project, method, transparency);
    let truth = draw(ShadowMethod::Exact, Transparency::Exact);
    let unshadowed = draw(ShadowMethod::None, Transparency::Exact);
    let shadow = flip(&truth, &unshadowed, SIZE.0, SIZE.1).mean;
    // Measured 0.087 for a bun, which is small, and more for all else.
    assert!(shadow > 0.08, "{name}: the control, hair without shadow, must differ: {shadow}");
    for transparency in Transparency::ALL {
        let unshadowed = flip(&truth, &draw(ShadowMethod::None, transparency), SIZE.0, SIZE.1).mean;
        // Measured at most 0.055 for the ways that know the order (deep opacity maps on long hair), 0.082 for opaque
        // strands (the same, where leaving the shadow out makes 0.38), and 0.55 of the control's difference for averages, through which the inside shines.
        let bound = match transparency {
            Transparency::OccupancyOrder | Transparency::Sorted | Transparency::Exact => 0.07,
            Transparency::Opaque => 0.09,
            Transparency::WeightedAverage => 0.6 * shadow,
        };
        let bound = bound.min(BELOW_CONTROL * shadow);
        println!("{name}, none, {transparency}: {unshadowed:.4}; bound {bound:.4}");
        assert!(unshadowed > bound, "{name}, control without shadow, {transparency}: {unshadowed}, {bound}");
        for &method in ShadowMethod::ALL.iter().filter(|method| **method != ShadowMethod::None) {
            let picture = draw(method, transparency);
            let difference = flip(&truth, &picture, SIZE.0, SIZE.1).mean;
            println!("{name}, {method}, {transparency}: {difference:.4}; without shadow {shadow:.4}");
            // It takes the density of the hair for known, and has to be nearer than no shadow only.
            let is_approximate = method == ShadowMethod::ApproximateDeep;
            let bound = if is_approximate { BELOW_CONTROL * unshadowed } else { bound };
            assert!(difference < bound, "{name}, {method}, {transparency}: {difference}");
        }
    }
}

#[test]
fn grown_hairstyles_long_suite() {
    for &preset in lovelock_testkit::suite::cases(&[Preset::Smooth, Preset::Curly], &Preset::ALL) {
        let mut project = Project::default();
        project.set_preset(preset);
        draw_all(preset.id(), project);
    }
}

#[test]
fn imported_grooms_long_suite() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let files = ["hair/yuksel/straight.hair", "hair/tressfx/sintel_16pt.tfx"];
    for &file in lovelock_testkit::suite::cases(&files[..1], &files) {
        let mut project = Project::default();
        project.set_hair_file(data.join(file));
        draw_all(file, project);
    }
}

#[test]
fn the_same_by_both_backends() {
    let mut gpu = match Renderer::open(Backend::Gpu) {
        Ok(renderer) => renderer,
        Err(error) => return lovelock_testkit::skip_without_adapter(&error),
    };
    let mut cpu = Renderer::open(Backend::Cpu).expect("the processor");
    let mut project = Project::default().compared();
    project.timeline.preroll_secs = 0.25;
    // From behind: the edges of eyes and face differ as they do in any combination.
    (project.camera.distance, project.camera.azimuth) = (0.6, 2.6);
    let snapshot = instant("default", &project);
    let mut pictures = Vec::new();
    for (i, &method) in ShadowMethod::ALL.iter().enumerate() {
        // Rays take seconds on a software adapter; `agreement.rs` of the renderer has them in the short suite.
        if method == ShadowMethod::RayTraced && !is_long() {
            continue;
        }
        // Every transparency without shadow and with the exact one, which are each other's controls; with the others one in the short suite.
        let is_control = [ShadowMethod::None, ShadowMethod::Exact].contains(&method);
        let (first, every) =
            if is_control || is_long() { (0, 1) } else { (i % Transparency::ALL.len(), usize::MAX) };
        for transparency in Transparency::ALL.into_iter().skip(first).step_by(every) {
            let [by_card, by_processor] = [&mut gpu, &mut cpu]
                .map(|renderer| draw(renderer, &snapshot, &mut project, method, transparency));
            pictures.push((method, transparency, by_card, by_processor));
        }
    }
    let difference = |a: &[u8], b: &[u8]| flip(a, b, SIZE.0, SIZE.1).mean;
    for (method, transparency, by_card, by_processor) in &pictures {
        let same = difference(by_card, by_processor);
        // The control: the processor's picture of another method, without shadow or with it.
        let other = if *method == ShadowMethod::None { ShadowMethod::Exact } else { ShadowMethod::None };
        let (.., by_other) =
            pictures.iter().find(|known| (known.0, known.1) == (other, *transparency)).expect("a picture");
        let control = difference(by_card, by_other);
        println!("{method}, {transparency}: {same:.4}; {other} {control:.4}");
        // Measured on a software adapter: 0.0085 to 0.0153, and 0.0176 to 0.0213 without shadow (at the border of the
        // head's shadow on the hair); the control has 0.25 and more.
        let bound = if *method == ShadowMethod::None { 0.03 } else { 0.02 };
        assert!(same < bound, "{method}, {transparency}: {same}");
        assert!(control > 5.0 * bound, "{method}, {transparency}, the control: {control}");
    }
    // Transparencies are told apart too, where they differ: averages shine through, opaque strands are grainy.
    for other in [Transparency::WeightedAverage, Transparency::Opaque] {
        let of = |wanted| pictures.iter().find(|known| (known.0, known.1) == (ShadowMethod::Exact, wanted));
        let (by_card, by_other) =
            (of(Transparency::Exact).expect("a picture"), of(other).expect("a picture"));
        let control = difference(&by_card.2, &by_other.3);
        println!("exact, exact; exact, {other} {control:.4}");
        assert!(control > 0.02, "the control, {other}: {control}");
    }
}
