//! Hair at one instant with lights: the input of every shadow method.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::Strands;
use lovelock_project::Project;
use lovelock_render::{Camera, FrameInput, HairPose, Light, light_frame};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_shadow::ShadowInput;

/// Hair in the light of one lamp, with the settings of a project.
#[derive(Clone, Copy, Debug)]
pub(super) struct LitHair<'a> {
    pub hair: &'a Hair,
    pub project: &'a Project,
    pub light: &'a Light,
}

impl<'a> LitHair<'a> {
    /// The input of a shadow method.
    pub(super) fn shadow_input(self) -> ShadowInput<'a> {
        self.hair.shadow_input(self.project, self.light)
    }
}

/// Hair at one instant, interpolated once for all uses.
#[derive(Debug)]
pub struct Hair {
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Its strands, world space.
    pub strands: Strands,
    /// The camera of the project at that instant.
    pub camera: Camera,
}

impl Hair {
    /// Interpolates the strands of an instant, seen by the camera of `project`.
    pub fn new(snapshot: Arc<FrameSnapshot>, project: &Project) -> Self {
        let mut strands = Strands::default();
        snapshot.interpolate(&mut strands);
        let camera = snapshot.camera(&project.camera);
        Self { snapshot, strands, camera }
    }

    /// The render input with the settings of `project`.
    pub fn frame_input<'a>(&'a self, project: &'a Project) -> FrameInput<'a> {
        FrameInput {
            hair: HairPose::Strands(&self.strands),
            ..self.snapshot.measured_input(project, &self.camera)
        }
    }

    /// The input of a shadow map for `light`, as in rendering.
    pub fn shadow_input(&self, project: &Project, light: &Light) -> ShadowInput<'_> {
        let anchor = self.head();
        ShadowInput {
            strands: &self.strands,
            strand_width: self.snapshot.look(project).shadow_width(self.snapshot.scene.style.strands.count()),
            extinction_scale: project.look.extinction_scale,
            light: light_frame(light, anchor),
            anchor,
            maps: 1,
            projected: None,
        }
    }

    /// The origin of the head, world space, metres.
    pub(super) fn head(&self) -> Vec3 {
        self.snapshot.guides.world_from_head.translation.into()
    }

    /// The head's transform, with the grid of maps moved by `shift`, metres in world space.
    pub(super) fn head_moved_by(&self, shift: Vec3) -> Affine3A {
        let mut head = self.snapshot.guides.world_from_head;
        head.translation += glam::Vec3A::from(shift);
        head
    }
}

/// The enabled lights, as in rendering.
pub fn lights(project: &Project) -> Vec<Light> {
    Light::enabled(&project.lights).collect()
}
