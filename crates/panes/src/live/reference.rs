//! The exact method on the instant that panes are drawn on: what they are measured by.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{HairLook, Strands};
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::{
    Backend, Camera, CpuRenderer, Light, Picture, RayMarkKind, ShadowMethod, ShadowSettings, Transparency,
};
use lovelock_session::snapshot::FrameSnapshot;

use super::round::input_of;

/// Pixels along each edge of a picture that nobody looks at: it is drawn for its transmittance.
const UNSEEN: u32 = 16;

/// The exact method's transmittance and picture. Each is made when it is first asked for, once an instant.
#[derive(Default)]
pub(super) struct ExactReference {
    /// Draws what nobody looks at, for its transmittance and its maps.
    unseen: CpuRenderer,
    seen: CpuRenderer,
    transmittance: Option<(TransmittanceKey, Found<Vec<f32>>)>,
    picture: Option<(PictureKey, Found<Picture>)>,
}

/// Something that was made, or a sentence that says why not.
type Found<T> = Result<Arc<T>, String>;

/// Everything that transmittance depends on.
#[derive(PartialEq)]
struct TransmittanceKey {
    instant: Instant,
    shadow: ShadowSettings,
    look: HairLook,
    light: Light,
}

/// Everything that the picture depends on.
#[derive(PartialEq)]
struct PictureKey {
    instant: Instant,
    project: Project,
    camera: Camera,
    size: [u32; 2],
}

/// A snapshot, which is itself alone.
struct Instant(Arc<FrameSnapshot>);

impl PartialEq for Instant {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl ExactReference {
    /// Whether a contender is the reference itself: it reads as the reference does the very map that the reference reads.
    ///
    /// Settings do not tell: texels are never narrower than strands are wide, so that several resolutions make one map,
    /// and a limit of memory changes none. One map gives one transmittance, `found` and `exact`, to the last bit.
    pub(super) fn is(
        project: &Project,
        (contender, backend): (&Contender, Backend),
        (found, exact): (&[f32], &[f32]),
    ) -> bool {
        let same_bits = || found.iter().map(|t| t.to_bits()).eq(exact.iter().map(|t| t.to_bits()));
        backend == Backend::Cpu
            && contender.shadow.method == ShadowMethod::Exact
            && contender.shadow.exact.filter == project.shadow.exact.filter
            && same_bits()
    }

    /// The exact transmittance of light `light` at every strand point.
    ///
    /// # Errors
    /// A sentence: no such light, or a map that needs too much memory.
    pub(super) fn transmittance(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        strands: &Strands,
        light: usize,
    ) -> Found<Vec<f32>> {
        let Some(light) = project.lights.iter().filter(|light| light.enabled).nth(light) else {
            return Err("no light is on".to_owned());
        };
        let shadow = ShadowSettings { method: ShadowMethod::Exact, ..project.shadow };
        let instant = Instant(Arc::clone(snapshot));
        let key = TransmittanceKey { instant, shadow, look: project.look, light: light.clone() };
        if let Some((held, found)) = &self.transmittance
            && *held == key
        {
            return found.clone();
        }
        let mut unseen = project.clone();
        unseen.lights = vec![light.clone()];
        unseen.shadow = shadow;
        unseen.picture.transparency = Transparency::Opaque;
        let size = [UNSEEN; 2];
        let found = draw(&mut self.unseen, &unseen, snapshot, strands, size, &mut Picture::default());
        let found = found.and_then(|()| self.unseen.transmittance(0).map_err(|error| error.to_string()));
        let found = found.map(Arc::new);
        self.transmittance = Some((key, found.clone()));
        found
    }

    /// The picture with exact shadows and transparency.
    ///
    /// # Errors
    /// A sentence: a size that is not drawn, or a map that needs too much memory.
    pub(super) fn picture(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        strands: &Strands,
        size: [u32; 2],
    ) -> Found<Picture> {
        let mut exact = project.clone();
        exact.shadow.method = ShadowMethod::Exact;
        exact.picture.transparency = Transparency::Exact;
        // The panes themselves do not matter to it.
        exact.compare = lovelock_project::project::CompareSection { panes: Vec::new() };
        let camera = snapshot.camera(&exact.camera);
        let key = PictureKey { instant: Instant(Arc::clone(snapshot)), project: exact, camera, size };
        if let Some((held, found)) = &self.picture
            && *held == key
        {
            return found.clone();
        }
        let mut picture = Picture::default();
        let drawn = draw(&mut self.seen, &key.project, snapshot, strands, size, &mut picture);
        let found = drawn.map(|()| Arc::new(picture));
        self.picture = Some((key, found.clone()));
        found
    }

    /// The steps of transmittance along the light through `p`, of the light and the instant that
    /// [`ExactReference::transmittance`] was last asked for: depth from `p`, metres, and transmittance from there on.
    pub(super) fn steps(&mut self, p: Vec3) -> Vec<(f32, f32)> {
        let found = self.unseen.along_ray(0, p).unwrap_or_default();
        let steps = found.marks.iter().filter(|mark| mark.kind == RayMarkKind::FRAGMENT);
        steps.map(|mark| (mark.start, mark.transmittance)).collect()
    }
}

fn draw(
    renderer: &mut CpuRenderer,
    project: &Project,
    snapshot: &FrameSnapshot,
    strands: &Strands,
    [width, height]: [u32; 2],
    picture: &mut Picture,
) -> Result<(), String> {
    let camera = snapshot.camera(&project.camera);
    let input = input_of(snapshot, project, strands, &camera);
    let drawn = renderer.picture(&input, width, height, picture);
    drawn.map(|_| ()).map_err(|error| error.to_string())
}
