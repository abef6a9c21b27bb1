mod every_control;
mod layers;
mod one_by_one;
mod reasons;
mod recording;
mod reveal;
mod scalp;
mod sound;
mod surroundings;
mod ties;
mod undo;
mod untouched;

use std::sync::Arc;

use egui::Ui;
use egui_kittest::Harness;
use glam::Vec3;
use lovelock_appearance::environment::Panorama;
use lovelock_groom::{HairShading, HairTie, Preset, TieKind, TieReach};
use lovelock_motion::ColliderEdit;
use lovelock_project::Project;
use lovelock_project::project::HairSource;
use lovelock_render::{ClusterShading, HairDrawing, LocalShadow, PassTime, StrandCount, VoxelDeposit};
use lovelock_session::stats::{PassHistory, StageHistory, StageTimes};
use lovelock_sound::Sound;
use lovelock_style::operations::{Curl, Lift, Wave};
use lovelock_style::{Layer, Mask, MaskPart, MaskRegion, Operation};

use super::recording::State;
use crate::window::control::section;
use crate::window::overlay::scalp::ScalpTool;
use crate::window::pointer_tool::PointerTool;
use crate::window::soundtrack::Loaded;
use crate::window::testing::{Shown, screen, unfold};

/// A project and the other data that the panels show.
#[derive(Clone)]
pub(super) struct Bench {
    pub(super) project: Project,
    pub(super) selected_light: usize,
    pub(super) hair: super::hair::LoadedHair,
    pub(super) body: super::body::LoadedBody,
    pub(super) surroundings: super::surroundings::LoadedSurroundings,
    pub(super) sound: Arc<Loaded>,
    pub(super) stages: StageHistory,
    pub(super) passes: PassHistory,
    pub(super) clip_frames: u64,
    pub(super) colliders: super::colliders::Shown,
    pub(super) selected_tie: usize,
    pub(super) layers: super::layers::LayersView,
    pub(super) pointer_tool: PointerTool,
    pub(super) scalp: ScalpTool,
    pub(super) styles: crate::window::styles::Browser,
    pub(super) kept: crate::window::styles::Kept,
}

impl Bench {
    pub(super) fn new(project: Project) -> Self {
        let mut stages = StageHistory::new(8);
        stages.push(StageTimes { draw: 3.25, ..StageTimes::default() });
        let mut passes = PassHistory::new(8);
        let pass = |name: &str, ms| PassTime { name: name.to_owned(), ms };
        passes.push(&[
            pass("interpolate", 0.5),
            pass("shadow/range", 1.25),
            pass("shadow/occupancy", 2.5),
            pass("draw/body-depth", 4.75),
            pass("draw/sort-and-blend", 8.5),
        ]);
        Self {
            project,
            selected_light: 0,
            hair: super::hair::LoadedHair {
                counts: [134, 3350, 100_500],
                size_m: [0.2, 0.4, 0.3],
                notes: vec!["A note on the hair that is long enough to need a second line.".to_owned()],
            },
            body: super::body::LoadedBody {
                clips: vec!["dance".to_owned(), "walk".to_owned()],
                clip: "dance".to_owned(),
                joints: vec!["hips".to_owned(), "hips/spine/neck/head".to_owned()],
                head: "hips/spine/neck/head".to_owned(),
                notes: Vec::new(),
            },
            surroundings: super::surroundings::LoadedSurroundings {
                picture: Some(surroundings()),
                notes: vec!["3 pixels negative: set to 0".to_owned()],
            },
            sound: Arc::new(clicks()),
            stages,
            passes,
            clip_frames: 480,
            colliders: super::colliders::Shown::default(),
            selected_tie: 0,
            layers: super::layers::LayersView::default(),
            pointer_tool: PointerTool::default(),
            scalp: ScalpTool::default(),
            styles: crate::window::styles::Browser::default(),
            kept: crate::window::styles::Kept::default(),
        }
    }
}

/// A picture of the surroundings with a warm lamp at the figure's left, +X.
pub(super) fn surroundings() -> Arc<Panorama> {
    let lamp = |at: usize| if at % 16 == 4 && at / 16 == 3 { Vec3::new(90.0, 60.0, 30.0) } else { Vec3::ONE };
    let pixels: Vec<Vec3> = (0..16 * 8).map(lamp).collect();
    Arc::new(Panorama::from_pixels(16, 8, &pixels).expect("a picture"))
}

/// Clicks, two per second for eight seconds.
pub(crate) fn clicks() -> Loaded {
    let value = |i: usize| if i % 24_000 < 400 { (i * 7919 % 20_000) as i16 - 10_000 } else { 0 };
    Loaded::of(Sound::new((0..8 * 48_000).map(value).collect(), 1), None)
}

pub(super) type Show = fn(&mut Ui, &mut Bench);

/// Every panel, inside a section as in the window.
pub(super) const PANELS: [(&str, Show); 14] = [
    ("Hairstyle", |ui, b| {
        crate::window::styles::ui(ui, &mut b.project, &mut b.styles, &mut b.kept);
        super::hair::ui(ui, &mut b.project, &b.hair);
    }),
    ("Simulation", |ui, b| {
        super::simulation::ui(
            ui,
            &mut b.project.simulation,
            &b.project.hair.simulation(),
            &mut b.project.timeline,
            [Vec3::X, Vec3::Y, Vec3::Z],
        );
    }),
    ("Body and motion", |ui, b| {
        super::body::ui(ui, &mut b.project, &b.body);
    }),
    ("Scalp", |ui, b| {
        super::scalp::ui(ui, &mut b.project.body.scalp, (&mut b.scalp, &mut b.pointer_tool), true);
    }),
    ("Colliders", |ui, b| {
        let edits = &mut b.project.body.colliders;
        // The skin replaces the skull's shape until that shape is edited.
        let skull = edits.of("skull").scale == 1.0 && edits.field.enabled;
        let shapes = [("neck", false), ("upper arm left of a rather long name", false), ("skull", skull)];
        let fitted = shapes.map(|(name, spared)| super::colliders::Fitted { name, spared });
        super::colliders::ui(ui, edits, &fitted, &mut b.colliders);
    }),
    ("Layers", |ui, b| {
        super::layers::ui(ui, &mut b.project.hair.stack, &mut b.layers, &mut b.pointer_tool);
    }),
    ("Ties and scissors", |ui, b| {
        super::ties::ui(ui, &mut b.project.hair, &mut b.selected_tie, None);
        super::ties::scissors(ui, &mut b.project.hair.cut, &mut b.pointer_tool);
    }),
    ("Shadow", |ui, b| {
        let default = b.project.hair.groom.look;
        super::shadow::ui(ui, &mut b.project.shadow, (&mut b.project.look, &default), Some(1 << 21), false);
    }),
    ("Light", |ui, b| {
        super::light::ui(ui, &mut b.project.lights, &mut b.selected_light, [Vec3::X, Vec3::Y, Vec3::Z]);
        super::surroundings::ui(ui, &mut b.project, &b.surroundings);
    }),
    ("Look", |ui, b| {
        let default = b.project.hair.groom.look;
        super::look::hair(ui, &mut b.project.look, &default, &mut b.project.picture, false);
    }),
    ("Picture", |ui, b| super::look::picture(ui, &mut b.project.picture, false)),
    ("Sound", |ui, b| {
        super::sound::ui(ui, &mut b.project, Some(&b.sound), 8.0);
    }),
    ("Recording", |ui, b| {
        super::recording::ui(ui, &mut b.project.recording, &State::Idle, b.clip_frames);
    }),
    ("Statistics", |ui, b| {
        let (name, tip, value) = ("Picture", "Size of the picture.", "1280 × 720".to_owned());
        let kept = super::statistics::Fact {
            name: "Undo steps",
            tip: "Projects that undo returns to.",
            value: "1.5 of 256 MiB".to_owned(),
        };
        let facts = [super::statistics::Fact { name, tip, value }];
        super::statistics::ui(ui, &b.stages, &b.passes, [&facts, &[kept]]);
    }),
];

/// A panel with all its sections open.
pub(super) fn panel(title: &'static str, project: Project) -> Harness<'static, Shown<Bench>> {
    let show = PANELS.iter().find(|(name, _)| *name == title).expect("a panel of that title").1;
    let mut harness = screen(Bench::new(project), move |ui, bench: &mut Bench| {
        section(ui, title, true, |ui| show(ui, bench));
    });
    unfold(&mut harness);
    harness
}

/// Projects that together show every control.
pub(super) fn projects() -> Vec<(&'static str, Project)> {
    let mut projects: Vec<_> = Preset::ALL
        .into_iter()
        .map(|preset| {
            let mut project = Project::default();
            project.set_preset(preset);
            (preset.id(), project)
        })
        .collect();
    // A stack with everything that a list of layers shows.
    let tied = &mut projects[3].1.hair.stack;
    for operation in [Operation::from(Wave::default()), Lift::default().into(), Curl::default().into()] {
        tied.push(Layer::of(operation));
    }
    tied.layers[1].mask = Mask::of(MaskPart::region(MaskRegion::Crown));
    tied.make_group(&[2, 3], "A group");
    let mut files = Project::default();
    files.set_hair_file("/a/b c/straight.hair");
    files.set_body_file("/a/b c/a character of a rather long name that says much.glb");
    files.set_motion_file("/a/b c/ü.bvh");
    files.set_surroundings_file("/a/b c/a panorama of a rather long name that says much.exr");
    files.set_sound_file("/a/b c/a song of a rather long name that says much.flac");
    files.look.shading = HairShading::KajiyaKay;
    files.picture.strands = StrandCount::Fixed;
    files.picture.draw = HairDrawing::Auto;
    files.picture.clusters.shading = ClusterShading::Paper;
    files.picture.clusters.local_shadow = LocalShadow::Layers;
    files.shadow.voxel_map.deposit = VoxelDeposit::PointCount;
    let patch = HairTie { reach: TieReach::InSphere, sphere_at_ring: false, ..HairTie::default() };
    files.hair.ties.push(HairTie { kind: TieKind::Bun, ..patch });
    files
        .body
        .colliders
        .shapes
        .insert("neck".to_owned(), ColliderEdit { scale: 1.2, ..ColliderEdit::default() });
    assert_eq!(files.hair.source, HairSource::File);
    projects.push(("files", files));
    projects
}
