//! Shared by tests, benchmark and examples: the dancer with hair, and hairstyles of plain chains.
#![allow(dead_code, missing_docs, reason = "each user needs only a part")]

pub mod catenary;
pub mod reference;

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{
    GroomSettings, GuideFrame, Guides, HairTie, Hairstyle, ImportSettings, Obstacle, Preset, Scalp,
    StrandSet, grow, import_around, load_hair, tied,
};
use lovelock_motion::{
    Body, BodyField, Clip, Collider, ColliderEdits, FieldPose, PlacedCollider, Pose, RestDistance, Skin,
    SurfaceDistance, backflip, fit_colliders, head_mesh, load_character, load_motion, place_colliders,
    pose_at, retarget,
};
use lovelock_simulation::{PlacedField, Simulation, SimulationSettings, StepInput, StepReport};
use rayon::prelude::*;

/// The step length of the program, seconds.
pub const STEP_SECS: f32 = 1.0 / 60.0;

/// The dancer, her dance and her hair.
pub struct Stage {
    pub body: Arc<Body>,
    pub dance: Arc<Clip>,
    pub colliders: Vec<Collider>,
    pub field: Option<Arc<BodyField>>,
    pub style: Arc<Hairstyle>,
    /// The same hair without ties.
    pub loose: Arc<Hairstyle>,
    pub pose: Pose,
    pub placed: Vec<PlacedCollider>,
    pub field_pose: FieldPose,
}

pub struct RestBody(RestDistance);

impl Obstacle for RestBody {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        self.0.distance(p)
    }
}

/// The dancer without hair, loaded once: her distances and her field take a second.
struct Dancer {
    body: Arc<Body>,
    dance: Arc<Clip>,
    scalp: Scalp,
    obstacle: RestBody,
    field: Option<Arc<BodyField>>,
    colliders: Vec<Collider>,
}

static DANCER: LazyLock<Dancer> = LazyLock::new(|| {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    let character = load_character(&file).expect("the shipped dancer loads");
    let dance = character.clips.iter().find(|c| c.name == "dance").expect("the shipped dancer dances");
    let head = head_mesh(&character.body);
    let scalp = Scalp {
        positions: head.positions,
        normals: head.normals,
        triangles: head.triangles,
        mask: head.scalp,
    };
    let obstacle = RestBody(RestDistance::new(&character.body));
    let field = BodyField::new(&character.body, &obstacle.0).map(Arc::new);
    let colliders = ColliderEdits::default().apply(&fit_colliders(&character.body), field.as_deref());
    Dancer { dance: Arc::clone(dance), scalp, obstacle, field, colliders, body: character.body }
});

impl Stage {
    /// The dancer with a preset as the program shows it: with its ties, if it has any.
    pub fn new(preset: Preset) -> Self {
        Self::of_wisps(preset, GroomSettings::preset(preset).wisps)
    }

    /// The same with another number of wisps.
    pub fn of_wisps(preset: Preset, wisps: u32) -> Self {
        let mut stage = Self::grown(&GroomSettings { wisps, ..GroomSettings::preset(preset) });
        if !preset.ties().is_empty() {
            stage.tie(preset.ties());
        }
        stage
    }

    /// The dancer with a preset's hair, by its name, or with that of a file.
    pub fn named(style: &str, wisps: Option<u32>) -> Self {
        match (Preset::from_id(style), wisps) {
            (Some(preset), None) => Self::new(preset),
            (Some(preset), Some(wisps)) => Self::of_wisps(preset, wisps),
            (None, wisps) => Self::with_file(Path::new(style), wisps.unwrap_or_default()),
        }
    }

    /// The dancer with the hair of a file, in `wisps` wisps; 0 lets the file decide.
    pub fn with_file(hair: &Path, wisps: u32) -> Self {
        let file = load_hair(hair).expect("the hair loads");
        let settings = ImportSettings { wisps, ..ImportSettings::default() };
        Self::with_hair(|scalp, body| {
            import_around(&file, &settings, scalp, Some(body)).expect("the hair fits")
        })
    }

    pub fn grown(groom: &GroomSettings) -> Self {
        Self::with_hair(|scalp, body| grow(groom, scalp, body).expect("the preset grows"))
    }

    fn with_hair(hair: impl FnOnce(&Scalp, &RestBody) -> Hairstyle) -> Self {
        let dancer = &*DANCER;
        let style = Arc::new(hair(&dancer.scalp, &dancer.obstacle));
        Self {
            dance: Arc::clone(&dancer.dance),
            colliders: dancer.colliders.clone(),
            field: dancer.field.clone(),
            loose: Arc::clone(&style),
            style,
            body: Arc::clone(&dancer.body),
            pose: Pose::default(),
            placed: Vec::new(),
            field_pose: FieldPose::default(),
        }
    }

    /// The distance of the dancer at rest.
    pub fn rest_distance() -> &'static RestDistance {
        &DANCER.obstacle.0
    }

    /// Replaces the ties.
    pub fn tie(&mut self, ties: &[HairTie]) {
        self.style = Arc::new(tied(&self.loose, ties, &DANCER.obstacle));
        self.style.check().expect("a tied style is sound");
    }

    /// The body at a time of the dance, or at rest.
    pub fn at(&mut self, time_secs: Option<f64>) -> StepInput<'_> {
        let clip = time_secs.map(|_| &*self.dance);
        let time_secs = time_secs.unwrap_or_default();
        pose_at(&self.body, clip, time_secs, &mut self.pose);
        place_colliders(&self.colliders, &self.body, &self.pose, &mut self.placed);
        let field = self.field.as_ref().map(|field| {
            field.place(&self.body, &self.pose, 0.0, &mut self.field_pose);
            PlacedField { field, pose: &self.field_pose }
        });
        StepInput { field, ..StepInput::new(time_secs, self.pose.world_from_head, &self.placed) }
    }

    /// Changes the motion: `dance`, `backflip`, or a file that is retargeted.
    pub fn play(&mut self, motion: &str) -> Result<(), Box<dyn std::error::Error>> {
        self.dance = match motion {
            "dance" => return Ok(()),
            "backflip" => Arc::new(backflip(&self.body).ok_or("the figure has no limbs")?),
            file => Arc::new(retarget(&load_motion(std::path::Path::new(file))?, &self.body)?),
        };
        Ok(())
    }

    /// The same body without its field: with all of its fitted colliders.
    pub fn without_field(mut self) -> Self {
        self.colliders = fit_colliders(&self.body);
        self.field = None;
        self
    }

    /// Hair at rest on the body at that time.
    pub fn simulation(&mut self, time_secs: Option<f64>) -> Simulation {
        let mut simulation = Simulation::new(Arc::clone(&self.style));
        simulation.reset(&self.at(time_secs));
        simulation
    }
}

/// A hairstyle of bare guides.
pub fn style(guides: &[Vec<Vec3>]) -> Arc<Hairstyle> {
    let mut all = Guides { points_per_guide: guides.first().map_or(2, Vec::len), ..Guides::default() };
    for guide in guides {
        all.push(guide);
    }
    let strands = StrandSet { first_point: vec![0], ..StrandSet::default() };
    Arc::new(Hairstyle { guides: all, strands, ..Hairstyle::default() })
}

/// A straight guide of `links` links from `root` along `direction`.
pub fn straight(root: Vec3, direction: Vec3, links: usize, length: f32) -> Vec<Vec3> {
    (0..=links).map(|i| root + direction * (length * i as f32 / links as f32)).collect()
}

/// A chain only: no stiffness, no drag, no neighbours.
pub fn bare() -> SimulationSettings {
    let mut s = SimulationSettings {
        style_support: 0.0,
        stiffness_root: 0.0,
        stiffness_tip: 0.0,
        bend_damping: 0.0,
        hold: 0.0,
        settle: 0.0,
        drag: 0.0,
        hair_friction: 0.0,
        clamped_links: 0,
        ..SimulationSettings::default()
    };
    s.repulsion.strength = 0.0;
    s.repulsion.cohesion = 0.0;
    s
}

/// A sway of 25 cm at 2.2 Hz with a bob and a spin: roots at 3.5 m/s.
pub fn violent(time: f64) -> Affine3A {
    let t = time as f32 * core::f32::consts::TAU;
    Affine3A::from_rotation_translation(
        Quat::from_rotation_y(1.2 * (1.3 * t).sin()) * Quat::from_rotation_x(0.6 * (2.1 * t).sin()),
        Vec3::new(0.25 * (2.2 * t).sin(), 0.1 * (1.7 * t).sin(), 0.0),
    )
}

/// A head without a body.
pub fn head(time_secs: f64, world_from_head: Affine3A) -> StepInput<'static> {
    StepInput::new(time_secs, world_from_head, &[])
}

/// The current guides.
pub fn frame(simulation: &Simulation) -> GuideFrame {
    let mut frame = GuideFrame::at_rest(&Guides::default(), Affine3A::IDENTITY, 0.0);
    simulation.frame(&mut frame);
    frame
}

/// Distance of every point from the style carried with the head, as a fraction of its guide's length.
pub fn distance_from_style(simulation: &Simulation) -> Vec<f32> {
    let now = frame(simulation);
    let rest = GuideFrame::at_rest(&simulation.style().guides, now.world_from_head, 0.0).guides;
    let n = rest.points_per_guide;
    let mut out = Vec::new();
    for g in 0..rest.count() {
        let length: f32 = (1..n).map(|i| (rest.point(g, i) - rest.point(g, i - 1)).length()).sum();
        out.extend((0..n).map(|i| (now.guides.point(g, i) - rest.point(g, i)).length() / length));
    }
    out
}

/// Relative error of every link's length, computed from the positions.
pub fn stretches(simulation: &Simulation) -> Vec<f32> {
    let (now, rest) = (frame(simulation).guides, &simulation.style().guides);
    let n = rest.points_per_guide;
    let mut out = Vec::with_capacity(rest.count() * n);
    for g in 0..rest.count() {
        for i in 1..n {
            let wanted = (rest.point(g, i) - rest.point(g, i - 1)).length();
            let got = (now.point(g, i) - now.point(g, i - 1)).length();
            out.push((got / wanted - 1.0).abs());
        }
    }
    out
}

/// The largest of them.
pub fn stretch(simulation: &Simulation) -> f32 {
    stretches(simulation).into_iter().fold(0.0, f32::max)
}

/// The larger value of each quantity of two reports.
pub fn worse(a: StepReport, b: StepReport) -> StepReport {
    StepReport {
        substeps: a.substeps.max(b.substeps),
        max_stretch: a.max_stretch.max(b.max_stretch),
        max_penetration_m: a.max_penetration_m.max(b.max_penetration_m),
        deepest: if b.max_penetration_m > a.max_penetration_m { b.deepest } else { a.deepest },
        recovered_guides: a.recovered_guides + b.recovered_guides,
        over_dense_cells: a.over_dense_cells.max(b.over_dense_cells),
        hair_volume: a.hair_volume.min(b.hair_volume),
        hair_volume_at_rest: b.hair_volume_at_rest,
        kinetic_energy: a.kinetic_energy.max(b.kinetic_energy),
        max_speed: a.max_speed.max(b.max_speed),
        jumped: a.jumped || b.jumped,
        ..a
    }
}

/// Penetration of hair into the skin in a frame, beyond that at rest and beyond the allowance for roots that
/// the skin encloses.
pub struct Depths {
    /// Rest depth of every point, metres, guide by guide; 0 outside.
    rest: Vec<f32>,
    pub worst: InSkin,
    /// The same without the allowance for roots.
    pub worst_of_all: InSkin,
    /// Number of points deeper than each of [`Depths::LIMITS`], and the number of all points.
    pub over: [usize; 4],
    pub count: usize,
    /// The deepest point in the skin of arms, hands and lower trunk, which the other numbers leave out.
    pub elsewhere: InSkin,
    /// Which vertices are head, neck, shoulders and upper back.
    region: Vec<bool>,
}

/// A point in the skin.
#[derive(Clone, Copy, Debug, Default)]
pub struct InSkin {
    pub depth: f32,
    pub guide: usize,
    pub point: usize,
    pub step: u32,
    /// World axes, relative to the head joint, metres.
    pub at: Vec3,
}

impl Depths {
    pub const LIMITS: [f32; 4] = [0.0005, 0.001, 0.002, 0.005];

    pub fn new(stage: &Stage) -> Self {
        let (guides, mesh) = (&stage.style.guides, &stage.body.mesh);
        let origin = stage.body.skeleton.rest_position(stage.body.head_joint);
        let rest = SurfaceDistance::new(&mesh.positions, &mesh.triangles);
        let depth = |i: usize| {
            let p = Vec3::new(guides.x[i], guides.y[i], guides.z[i]) + origin;
            (-rest.distance(p)).max(0.0)
        };
        Self {
            rest: (0..guides.x.len()).into_par_iter().map(depth).collect(),
            worst: InSkin::default(),
            worst_of_all: InSkin::default(),
            over: [0; 4],
            count: 0,
            elsewhere: InSkin::default(),
            region: mesh
                .positions
                .iter()
                .map(|p| *p - origin)
                .map(|q| q.y > -0.25 && q.x.abs() < 0.17)
                .collect(),
        }
    }

    /// Measures the hair of a step against the skin at that time.
    pub fn measure(&mut self, stage: &Stage, simulation: &Simulation, surface: &Skin, step: u32) {
        let skin = SurfaceDistance::new(&surface.positions, &stage.body.mesh.triangles);
        let (now, rest) = (frame(simulation), &stage.style.guides);
        let points = rest.points_per_guide;
        let head = Vec3::from(now.world_from_head.translation);
        let found: Vec<[InSkin; 2]> = (0..rest.count() * points)
            .into_par_iter()
            .filter(|i| i % points >= 2)
            .map(|i| {
                let (guide, point) = (i / points, i % points);
                let p = now.guides.point(guide, point);
                let all = -skin.distance(p) - self.rest[i];
                let mut depth = all;
                if all > 0.0 {
                    // The scalp carries the first two points; see `root_penetration` of the contacts.
                    let root = -skin.distance(now.guides.point(guide, 1)) - self.rest[guide * points + 1];
                    let link: f32 =
                        (1..points).map(|k| (rest.point(guide, k) - rest.point(guide, k - 1)).length()).sum();
                    let slope = 0.5 * link / (points - 1) as f32 * (point - 1) as f32;
                    depth -= (root.max(0.0) - slope).max(0.0);
                }
                [depth, all].map(|depth| InSkin { depth, guide, point, step, at: p - head })
            })
            .collect();
        self.count += found.len();
        for [depth, all] in found {
            if depth.depth > 0.0 {
                let p = depth.at + head;
                let away = |v: &usize| surface.positions[*v].distance_squared(p);
                let nearest = (0..self.region.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
                if !nearest.is_some_and(|v| self.region[v]) {
                    if depth.depth > self.elsewhere.depth {
                        self.elsewhere = depth;
                    }
                    continue;
                }
            }
            for (over, limit) in self.over.iter_mut().zip(Self::LIMITS) {
                *over += usize::from(depth.depth > limit);
            }
            if depth.depth > self.worst.depth {
                self.worst = depth;
            }
            if all.depth > self.worst_of_all.depth {
                self.worst_of_all = all;
            }
        }
    }
}

/// The settings of that hairstyle in the program: its own for a preset, the default for hair of a file.
pub fn settings_of(style: &str) -> SimulationSettings {
    Preset::from_id(style).map_or_else(SimulationSettings::default, SimulationSettings::preset)
}
