//! One instant of the scene, ready for rendering.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::carried::SkinHair;
use lovelock_groom::{GuideFrame, HairLook, Strands, interpolate};
use lovelock_motion::{Pose, Skin, skin};
use lovelock_project::Project;
use lovelock_project::project::CameraSection;
use lovelock_render::{Camera, CarriedHair, FrameInput, HairPose, ResidentGuides};
use lovelock_simulation::{InsidePoint, StepReport};

use crate::scene::{Figure, Lens, Scene, camera_at};
use crate::stats::StageTimes;
use crate::totals::Totals;

/// One instant of the scene: everything that rendering needs, and measurements of the simulation.
#[derive(Clone, Debug)]
pub struct FrameSnapshot {
    /// The scene.
    pub scene: Arc<Scene>,
    /// Steps since the engine started; increases from snapshot to snapshot during playback.
    pub step: u64,
    /// Time of the scene, seconds; keeps increasing when the clip loops.
    pub time_secs: f64,
    /// Position on the timeline, seconds from the start of the clip or of the played take.
    pub position_secs: f64,
    /// Length of the timeline, seconds; 0 if the body is at rest.
    pub duration_secs: f64,
    /// The pose of the joints.
    pub pose: Pose,
    /// The surface of the body.
    pub skin: Skin,
    /// The guides, world space.
    pub guides: GuideFrame,
    /// The same guides on the graphics device of the window, if it simulates them.
    pub resident: Option<ResidentGuides>,
    /// Brows and lashes, world space; empty if the scene has none.
    pub skin_strands: Strands,
    /// The strands, world space, where they do not follow the guides: those of a cache of curves.
    pub strands: Option<Strands>,
    /// Measurements of the last step.
    pub report: StepReport,
    /// The deepest point of the style at rest inside the body, if any.
    pub rest_inside: Option<InsidePoint>,
    /// Whether a graphics device simulated the last step.
    pub on_device: bool,
    /// Why the CPU simulates although a graphics device was chosen.
    pub device_refusal: Option<Arc<str>>,
    /// Measurements since the hair was last settled.
    pub totals: Totals,
    /// Times of `motion` and `simulate` for this instant; the renderer measures the other stages.
    pub times: StageTimes,
}

impl FrameSnapshot {
    /// A snapshot of this scene to be filled: hair and body at rest, at the start of the timeline.
    pub(crate) fn empty(scene: &Arc<Scene>) -> Self {
        let guides = scene.style.guides.clone();
        Self {
            scene: Arc::clone(scene),
            step: 0,
            time_secs: 0.0,
            position_secs: 0.0,
            duration_secs: 0.0,
            pose: Pose::default(),
            skin: Skin::default(),
            skin_strands: Strands::default(),
            guides: GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides },
            resident: None,
            strands: None,
            report: StepReport::default(),
            rest_inside: None,
            on_device: false,
            device_refusal: None,
            totals: Totals::default(),
            times: StageTimes::default(),
        }
    }

    /// Moves the surface of the body, and the hair that it carries, into the pose of the snapshot.
    pub(crate) fn follow_pose(&mut self) {
        skin(&self.scene.body, &self.pose, &mut self.skin);
        match &self.scene.skin_hair {
            Some(hair) => hair.place(&self.skin.positions, &mut self.skin_strands),
            None => self.skin_strands = Strands::default(),
        }
    }

    /// Interpolates the strands on the CPU, or copies those that are given. Rendering does not need this.
    pub fn interpolate(&self, strands: &mut Strands) {
        if let Some(given) = &self.strands {
            strands.clone_from(given);
            return;
        }
        interpolate(&self.scene.style, &self.guides, strands);
    }

    /// The camera at this instant.
    pub fn camera(&self, section: &CameraSection) -> Camera {
        camera_at(section, &self.scene, self.time_secs)
    }

    /// The lens of a camera at this instant; `None` if it has no depth of field.
    pub fn lens(&self, section: &CameraSection, camera: &Camera) -> Option<Lens> {
        let figure = Figure {
            body: &self.scene.body,
            positions: &self.skin.positions,
            world_from_head: self.guides.world_from_head,
            skull: self.scene.skull,
        };
        Lens::of(section, camera, &figure)
    }

    /// Colour and width of the hair on this head: settings are those on the shipped dancer's.
    pub fn look(&self, project: &Project) -> HairLook {
        HairLook { diameter: project.look.diameter * self.scene.hair_scale, ..project.look }
    }

    /// Colour and width of brows and lashes.
    pub fn skin_look(&self, project: &Project, hair: &SkinHair) -> HairLook {
        project.body.brows.look(&project.look, hair.width, hair.count())
    }

    /// The input of a renderer for this instant, with the settings of `project`.
    pub fn frame_input<'a>(&'a self, project: &'a Project, camera: &'a Camera) -> FrameInput<'a> {
        FrameInput {
            style: &self.scene.style,
            hair: match (&self.strands, &self.resident) {
                (Some(strands), _) => HairPose::Strands(strands),
                (None, Some(resident)) => HairPose::Resident(&self.guides, resident),
                (None, None) => HairPose::Guides(&self.guides),
            },
            guides: Some(&self.guides),
            look: self.look(project),
            body: Some((&self.scene.body, &self.skin)),
            world_from_head: self.guides.world_from_head,
            lights: &project.lights,
            shadow: &project.shadow,
            camera,
            picture: &project.picture,
            is_draft: false,
            surroundings: self.scene.surroundings.light.as_ref(),
            backdrop: self.scene.surroundings.backdrop.as_ref(),
            known: None,
            carried: self.scene.skin_hair.as_ref().map(|hair| CarriedHair {
                style: &hair.style,
                strands: &self.skin_strands,
                look: self.skin_look(project, hair),
            }),
        }
    }

    /// The input of a renderer for measurements of the hairstyle: without brows and lashes.
    pub fn measured_input<'a>(&'a self, project: &'a Project, camera: &'a Camera) -> FrameInput<'a> {
        FrameInput { carried: None, ..self.frame_input(project, camera) }
    }
}

/// Snapshots for reuse once they are no longer shared, so that frames do not allocate.
#[derive(Debug, Default)]
pub(crate) struct SnapshotPool {
    given_out: Vec<Arc<FrameSnapshot>>,
}

impl SnapshotPool {
    /// Number of snapshots in use at a time: one that is published, and one or two that are being rendered.
    const MAX: usize = 6;

    /// Fills an unused snapshot, or a new one, with an instant of `scene`, and returns it.
    pub(crate) fn make(
        &mut self,
        scene: &Arc<Scene>,
        fill: impl FnOnce(&mut FrameSnapshot),
    ) -> Arc<FrameSnapshot> {
        // Of another scene, which it would keep until it is used again.
        self.given_out.retain(|held| Arc::strong_count(held) > 1 || Arc::ptr_eq(&held.scene, scene));
        let free = self.given_out.iter_mut().position(|held| Arc::get_mut(held).is_some());
        let mut snapshot = match free {
            Some(i) => self.given_out.swap_remove(i),
            None => Arc::new(FrameSnapshot::empty(scene)),
        };
        match Arc::get_mut(&mut snapshot) {
            Some(inner) => {
                if !Arc::ptr_eq(&inner.scene, scene) {
                    inner.scene = Arc::clone(scene);
                }
                fill(inner);
            }
            None => unreachable!("the snapshot is new or not shared"),
        }
        if self.given_out.len() < Self::MAX {
            self.given_out.push(Arc::clone(&snapshot));
        }
        snapshot
    }
}
