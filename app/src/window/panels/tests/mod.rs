mod every_control;
mod face;
mod layers;
mod one_by_one;
mod portraits;
mod reasons;
mod recording;
mod reveal;
mod scalp;
mod shadow;
mod sound;
mod surroundings;
mod ties;
mod undo;
mod untouched;

use std::sync::{Arc, LazyLock};

use egui::Ui;
use egui_kittest::Harness;
use glam::Vec3;
use lovelock_appearance::environment::Panorama;
use lovelock_groom::{HairShading, HairTie, Preset, TieKind, TieReach};
use lovelock_motion::{ColliderEdit, ColliderEdits};
use lovelock_project::Project;
use lovelock_project::project::{FocusOn, HairSource};
use lovelock_render::{
    ClusterShading, HairDrawing, LocalShadow, MapValue, PassTime, StrandCount, VoxelDeposit,
};
use lovelock_session::stats::{PassHistory, StageHistory, StageTimes};
use lovelock_sound::Sound;
use lovelock_style::operations::{Curl, Lift, Wave};
use lovelock_style::{Layer, Mask, MaskPart, MaskRegion, Operation};

use crate::window::command::Command;
use crate::window::control::section;
use crate::window::pointer_tool::PointerTool;
use crate::window::readings::{Fact, LoadedBody, LoadedHair, LoadedSurroundings, Readings};
use crate::window::recorder::State;
use crate::window::shelf::Panels;
use crate::window::soundtrack::Loaded;
use crate::window::testing::{Shown, screen, unfold};

/// A project, the panels, and what they show besides the project.
pub(crate) struct Bench {
    pub(crate) project: Project,
    pub(crate) panels: Panels,
    pub(crate) tool: PointerTool,
    pub(crate) hair: LoadedHair,
    pub(crate) body: LoadedBody,
    pub(crate) surroundings: LoadedSurroundings,
    pub(crate) sound: Arc<Loaded>,
    pub(crate) stages: StageHistory,
    pub(crate) passes: PassHistory,
    pub(crate) recording: State,
    pub(crate) clip_frames: u64,
    /// What the panels have asked for.
    pub(crate) asked: Vec<Command>,
}

impl Bench {
    pub(crate) fn new(project: Project) -> Self {
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
            panels: Panels::default(),
            tool: PointerTool::default(),
            hair: LoadedHair {
                counts: [134, 3350, 100_500],
                size_m: [0.2, 0.4, 0.3],
                notes: vec!["A note on the hair that is long enough to need a second line.".to_owned()],
            },
            body: LoadedBody {
                clips: vec!["dance".to_owned(), "walk".to_owned()],
                clip: "dance".to_owned(),
                joints: vec!["hips".to_owned(), "hips/spine/neck/head".to_owned()],
                head: "hips/spine/neck/head".to_owned(),
                face: ["Blink", "Mabataki", "an expression of a rather long name"]
                    .map(str::to_owned)
                    .to_vec(),
                notes: Vec::new(),
            },
            surroundings: LoadedSurroundings {
                picture: Some(surroundings()),
                notes: vec!["3 pixels negative: set to 0".to_owned()],
            },
            sound: Arc::new(clicks()),
            stages,
            passes,
            recording: State::Idle,
            clip_frames: 480,
            asked: Vec::new(),
        }
    }

    /// Shows the panel of that title, and takes up the tool that it asks for, as the window does.
    pub(crate) fn show(&mut self, ui: &mut Ui, title: &str) {
        let fact = |name, tip, value: &str| Fact { name, tip, value: value.to_owned() };
        let facts = || {
            let kept = fact("Undo steps", "Projects that undo returns to.", "1.5 of 256 MiB");
            [vec![fact("Picture", "Size of the picture.", "1280 × 720")], vec![kept]]
        };
        // The skin replaces the skull's shape until that shape is edited.
        let is_replaced = |edits: &ColliderEdits, at: usize| {
            at == 2 && edits.of("skull").scale == 1.0 && edits.field.enabled
        };
        let readings = Readings {
            tool: self.tool,
            problems: &[],
            hair: &self.hair,
            body: &self.body,
            surroundings: &self.surroundings,
            take_notes: &[],
            scalp: None,
            has_skull: true,
            colliders: vec!["neck", "upper arm left of a rather long name", "skull"],
            is_replaced: &is_replaced,
            frame: None,
            maps: Some((1 << 21, 0)),
            stages: &self.stages,
            passes: &self.passes,
            facts: &facts,
            pane: None,
            marked_gauge: None,
            sound: Some(&self.sound),
            sound_problem: None,
            duration_secs: 8.0,
            recording: &self.recording,
            film_frames: self.clip_frames,
        };
        let (_, panel) = self.panels.by_title(title).expect("a panel of that title");
        let asked = panel.ui(ui, &mut self.project, &readings);
        if let Some(Command::Use(tool)) = asked {
            self.tool.toggle(tool);
            self.panels.layers.show_mask |= self.tool == PointerTool::Mask;
        }
        self.asked.extend(asked);
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

/// The titles of all panels. That of curves is shown only with curves that play.
pub(super) fn titles() -> impl Iterator<Item = &'static str> {
    static TITLES: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
        let (mut panels, project) = (Panels::default(), Project::default());
        let left = panels.left().map(|panel| (panel.is_shown(&project), panel.title()));
        let right = panels.right().map(|panel| (panel.is_shown(&project), panel.title()));
        left.into_iter().chain(right).filter(|(is_shown, _)| *is_shown).map(|(_, title)| title).collect()
    });
    TITLES.iter().copied()
}

/// A panel with all its sections open.
pub(super) fn panel(title: &'static str, project: Project) -> Harness<'static, Shown<Bench>> {
    let mut harness = screen(Bench::new(project), move |ui, bench: &mut Bench| {
        section(ui, title, true, |ui| bench.show(ui, title));
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
    files.set_backdrop_file("/a/b c/a room of a rather long name that says much.jpg");
    files.set_reference_file("/a/b c/a photograph of a rather long name that says much.png");
    files.camera.turntable = true;
    (files.camera.lens.enabled, files.camera.lens.focus) = (true, FocusOn::Distance);
    files.set_sound_file("/a/b c/a song of a rather long name that says much.flac");
    files.look.shading = HairShading::TwoHighlights;
    files.picture.strands = StrandCount::Fixed;
    files.picture.draw = HairDrawing::Auto;
    files.picture.clusters.shading = ClusterShading::Paper;
    files.picture.clusters.local_shadow = LocalShadow::Layers;
    files.shadow.voxel_map.deposit = VoxelDeposit::PointCount;
    files.picture.map_view.value = MapValue::Density;
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
