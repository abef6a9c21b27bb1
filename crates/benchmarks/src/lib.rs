//! What `cargo xtask count` counts the instructions of: small, fixed inputs of the inner loops.
//!
//! The benchmark `counts` runs each of them once under valgrind. Everything is seeded and runs on one thread, so that a count is the
//! same in every run. It still depends on the compiler, on the C library, and on the vector width that the program chooses at run time.
//! Valgrind has no 512-bit vectors, so the choice is 256 bits on every x86-64 CPU of the last ten years; [`one_thread`] refuses others.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use lovelock_base::simd::Width;
use lovelock_groom::{
    GroomSettings, GuideFrame, HairLook, Hairstyle, PlainHead, Preset, Strands, grow, interpolate,
};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_render::{
    Camera, CpuRenderer, FrameInput, HairPose, Light, Picture, PictureSettings, ShadowMethod, ShadowSettings,
    Transparency,
};
use lovelock_shadow::voxel_map::VoxelMap;
use lovelock_shadow::{CpuShadow, LightFrame, ShadowInput};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};

/// Makes this thread the only worker, until the process ends. Later calls have no effect.
///
/// # Panics
/// If the CPU has no 256-bit vectors.
pub fn one_thread() {
    let width = Width::widest();
    assert!(format!("{width:?}") == "Avx2", "counts are those of 256-bit vectors; this CPU offers {width:?}");
    // An error means that the pool exists already.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
}

/// The published smooth hairstyle with a third of its strands per wisp: 402 guides, 1,072 strands of 30 segments.
pub fn style() -> Arc<Hairstyle> {
    let settings = GroomSettings { strands_per_wisp: 8, ..GroomSettings::preset(Preset::Smooth) };
    Arc::new(grow(&settings, &PlainHead.scalp(48), &PlainHead).expect("a preset grows"))
}

/// Its guides at rest.
pub fn guides(style: &Hairstyle) -> GuideFrame {
    GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0)
}

/// Its strands at rest.
pub fn strands(style: &Hairstyle) -> Strands {
    let mut strands = Strands::default();
    interpolate(style, &guides(style), &mut strands);
    strands
}

/// Strands and the voxel map of their shadow.
#[derive(Debug)]
pub struct Shadowed {
    strands: Strands,
    map: VoxelMap,
    transmittance: Vec<f32>,
}

impl Shadowed {
    /// A map of 128³ cells that has been built once, so that its memory exists.
    pub fn new() -> Self {
        let strands = strands(&style());
        let transmittance = vec![0.0; strands.points()];
        let mut made = Self { strands, map: VoxelMap::default(), transmittance };
        made.build();
        made
    }

    /// Builds the map.
    pub fn build(&mut self) {
        let input = ShadowInput {
            strands: &self.strands,
            strand_width: 80e-6 * 100_000.0 / self.strands.count() as f32,
            extinction_scale: 0.15,
            light: LightFrame::new(Vec3::new(0.4, -1.0, -0.5)),
            anchor: Vec3::ZERO,
            maps: 1,
            projected: None,
        };
        self.map.build(&input, &ShadowSettings::default()).expect("the map fits into memory");
    }

    /// Looks up every point.
    pub fn look_up(&mut self) {
        let Strands { x, y, z, .. } = &self.strands;
        self.map.transmittance_at(x, y, z, &mut self.transmittance);
    }

    /// Mean transmittance of the last lookup.
    pub fn mean(&self) -> f32 {
        self.transmittance.iter().sum::<f32>() / self.transmittance.len() as f32
    }
}

impl Default for Shadowed {
    fn default() -> Self {
        Self::new()
    }
}

/// Hair in motion on a head and a neck.
#[derive(Debug)]
pub struct Moving {
    simulation: Simulation,
    steps: u32,
}

/// The length of a step, seconds.
const STEP_SECS: f32 = 1.0 / 60.0;

impl Moving {
    /// The hairstyle after 20 steps of a turning head.
    pub fn new() -> Self {
        let mut simulation = Simulation::new(style());
        simulation.reset(&StepInput::new(0.0, Affine3A::IDENTITY, &colliders(Affine3A::IDENTITY)));
        let mut made = Self { simulation, steps: 0 };
        for _ in 0..20 {
            made.step();
        }
        made
    }

    /// One step. Returns the number of its substeps.
    pub fn step(&mut self) -> u32 {
        self.steps += 1;
        let time = f64::from(self.steps) * f64::from(STEP_SECS);
        let world_from_head = Affine3A::from_quat(Quat::from_rotation_y(0.5 * (4.0 * time).sin() as f32));
        let colliders = colliders(world_from_head);
        let input = StepInput::new(time, world_from_head, &colliders);
        self.simulation.step(&input, &SimulationSettings::default(), STEP_SECS).substeps
    }
}

impl Default for Moving {
    fn default() -> Self {
        Self::new()
    }
}

/// A head and a neck.
fn colliders(world_from_head: Affine3A) -> [PlacedCollider; 2] {
    let ball = |a: Vec3, b: Vec3, radius: f32| PlacedCollider {
        shape: ColliderShape::Capsule {
            a: world_from_head.transform_point3(a),
            b: world_from_head.transform_point3(b),
            radius_a: radius,
            radius_b: radius,
        },
        world_from_rest: world_from_head,
    };
    let head = Vec3::new(0.0, 0.11, -0.005);
    [ball(head, head, 0.08), ball(Vec3::new(0.0, 0.0, -0.02), Vec3::new(0.0, -0.2, -0.02), 0.06)]
}

/// Hair in front of a camera, without a body and without shadow.
#[derive(Debug)]
pub struct Drawn {
    style: Arc<Hairstyle>,
    strands: Strands,
    look: HairLook,
    lights: Vec<Light>,
    shadow: ShadowSettings,
    settings: PictureSettings,
    renderer: CpuRenderer,
    picture: Picture,
}

impl Drawn {
    /// Drawn once, so that the buffers exist.
    pub fn new(transparency: Transparency) -> Self {
        let style = style();
        let strands = strands(&style);
        let mut made = Self {
            style,
            strands,
            look: HairLook::default(),
            lights: Light::default_rig(),
            shadow: ShadowSettings { method: ShadowMethod::None, ..ShadowSettings::default() },
            settings: PictureSettings { transparency, ground: false, ..PictureSettings::default() },
            renderer: CpuRenderer::default().keeping_nothing(),
            picture: Picture::default(),
        };
        made.draw();
        made
    }

    /// Draws it at 320 by 180 pixels.
    pub fn draw(&mut self) {
        let camera = Camera {
            eye: Vec3::new(0.0, 0.05, -1.2),
            target: Vec3::new(0.0, 0.05, 0.0),
            fov_y: 0.5,
            shear: glam::Vec2::ZERO,
        };
        let input = FrameInput {
            style: &self.style,
            hair: HairPose::Strands(&self.strands),
            guides: None,
            look: self.look,
            body: None,
            world_from_head: Affine3A::IDENTITY,
            lights: &self.lights,
            shadow: &self.shadow,
            camera: &camera,
            picture: &self.settings,
            is_draft: false,
            surroundings: None,
            backdrop: None,
            known: None,
            carried: None,
        };
        self.renderer.picture(&input, 320, 180, &mut self.picture).expect("a picture");
    }

    /// The image.
    pub fn picture(&self) -> &Picture {
        &self.picture
    }
}

/// The strands as a `.hair` file.
pub fn hair_file() -> Vec<u8> {
    let strands = strands(&style());
    let (count, points) = (strands.count() as u32, strands.points() as u32);
    let mut bytes = b"HAIR".to_vec();
    // Strands, points, and arrays of segment counts and points.
    bytes.extend([count, points, 0b11, 0].iter().flat_map(|number| number.to_le_bytes()));
    bytes.resize(128, 0);
    let segments = strands.first_point.windows(2).map(|ends| (ends[1] - ends[0] - 1) as u16);
    bytes.extend(segments.flat_map(u16::to_le_bytes));
    let points = (0..strands.points()).flat_map(|point| strands.point(point).to_array());
    bytes.extend(points.flat_map(f32::to_le_bytes));
    bytes
}

/// The shipped dancer.
pub const DANCER: &[u8] = include_bytes!("../../../assets/dancer.glb");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inputs_do_work() {
        let mut shadowed = Shadowed::new();
        shadowed.look_up();
        assert!((0.1..0.9).contains(&shadowed.mean()), "{}", shadowed.mean());
        let mut moving = Moving::new();
        assert!(moving.step() >= 4);
        let drawn = Drawn::new(Transparency::Sorted);
        let rgba = drawn.picture().rgba.as_chunks::<4>().0;
        let hair = rgba.iter().filter(|pixel| **pixel != rgba[0]).count();
        assert!(hair * 10 > rgba.len(), "{hair} of {} pixels", rgba.len());
    }

    #[test]
    fn the_files_load() {
        let style = style();
        let hair = lovelock_groom::load_hair_bytes("counted.hair", &hair_file()).expect("a sound file");
        assert_eq!((hair.strands(), hair.segments()), (style.strands.count(), style.strands.segments()));
        assert!(hair.dropped.is_empty());
        lovelock_motion::load_character_bytes("dancer.glb", DANCER, None).expect("the shipped dancer");
    }
}
