//! The exact method at the instant of the panes: the reference for their errors.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_groom::{HairLook, Strands};
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::{
    Backend, Camera, CpuRenderer, FrameInput, Gpu, HairDrawing, Light, Picture, RayMarkKind, RenderError,
    Renderer, ShadowMethod, ShadowSettings, Transparency,
};
use lovelock_session::snapshot::FrameSnapshot;

use super::round::input_of;

/// Side length of an image that is rendered only for its transmittance, pixels.
const UNSEEN: u32 = 16;

/// The exact method's transmittance and image, each computed on first use, once per instant.
#[derive(Default)]
pub(super) struct ExactReference {
    /// Renders the image that is only used for its transmittance and maps.
    unseen: CpuRenderer,
    seen: CpuRenderer,
    /// Renders the image for panes on a graphics device.
    seen_on_device: Option<Renderer>,
    transmittance: Option<(TransmittanceKey, OrReason<Vec<f32>>)>,
    /// The image of the CPU, and that of the device.
    pictures: [Option<(PictureKey, OrReason<Picture>)>; 2],
}

/// A result, or a sentence that says why there is none.
type OrReason<T> = Result<Arc<T>, String>;

/// The inputs of the transmittance.
#[derive(PartialEq)]
struct TransmittanceKey {
    instant: Instant,
    shadow: ShadowSettings,
    look: HairLook,
    light: Light,
}

/// The inputs of the image.
#[derive(PartialEq)]
struct PictureKey {
    instant: Instant,
    project: Project,
    camera: Camera,
    size: [u32; 2],
}

/// A snapshot that is compared by identity.
struct Instant(Arc<FrameSnapshot>);

impl PartialEq for Instant {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl ExactReference {
    /// The memory that is kept for the next instant, bytes.
    pub(super) fn bytes(&self) -> u64 {
        let found = self.transmittance.as_ref().and_then(|(_, found)| found.as_ref().ok());
        let pictures = self.pictures.iter().flatten().filter_map(|(_, found)| found.as_ref().ok());
        self.unseen.bytes()
            + self.seen.bytes()
            + self.seen_on_device.as_ref().map_or(0, Renderer::bytes)
            + found.map_or(0, |found| list_bytes(found))
            + pictures.map(|picture| picture.bytes()).sum::<u64>()
    }

    /// Whether a contender is the reference itself, because it reads the same map in the same way.
    ///
    /// Settings cannot decide this: texels are never narrower than strands, so several resolutions give the same map, and a memory
    /// limit changes no map. Equal maps give equal transmittance, `found` and `exact`, bit for bit.
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
    /// A sentence if there is no such light, or the map needs too much memory.
    pub(super) fn transmittance(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        strands: &Strands,
        light: usize,
    ) -> OrReason<Vec<f32>> {
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
        unseen.picture.draw = HairDrawing::Strands;
        unseen.picture.transparency = Transparency::Opaque;
        let size = [UNSEEN; 2];
        let found = draw(&mut self.unseen, &unseen, snapshot, strands, size, &mut Picture::default());
        let found = found.and_then(|()| self.unseen.transmittance(0).map_err(|error| error.to_string()));
        let found = found.map(Arc::new);
        self.transmittance = Some((key, found.clone()));
        found
    }

    /// The image of strands with exact shadows and transparency, rendered on `gpu`, or on the CPU without it: the backend of the pane
    /// that is compared, so that the difference between backends is no error.
    ///
    /// # Errors
    /// A sentence if the size is out of range, or the map needs too much memory.
    pub(super) fn picture(
        &mut self,
        project: &Project,
        snapshot: &Arc<FrameSnapshot>,
        strands: &Strands,
        size: [u32; 2],
        gpu: Option<&Arc<Gpu>>,
    ) -> OrReason<Picture> {
        let mut exact = project.clone();
        exact.shadow.method = ShadowMethod::Exact;
        exact.picture.draw = HairDrawing::Strands;
        exact.picture.transparency = Transparency::Exact;
        // The panes do not affect the reference.
        exact.compare.panes = Vec::new();
        let camera = snapshot.camera(&exact.camera);
        let key = PictureKey { instant: Instant(Arc::clone(snapshot)), project: exact, camera, size };
        let slot = usize::from(gpu.is_some());
        if let Some((held, found)) = &self.pictures[slot]
            && *held == key
        {
            return found.clone();
        }
        let mut picture = Picture::default();
        let drawn = match gpu {
            None => draw(&mut self.seen, &key.project, snapshot, strands, size, &mut picture),
            Some(gpu) => self.draw_on(gpu, &key.project, snapshot, strands, size, &mut picture),
        };
        if drawn.is_err() {
            // Its device may be lost.
            self.seen_on_device = None;
        }
        let found = drawn.map(|()| Arc::new(picture));
        self.pictures[slot] = Some((key, found.clone()));
        found
    }

    fn draw_on(
        &mut self,
        gpu: &Arc<Gpu>,
        project: &Project,
        snapshot: &FrameSnapshot,
        strands: &Strands,
        size: [u32; 2],
        picture: &mut Picture,
    ) -> Result<(), String> {
        let same = |renderer: &Renderer| renderer.gpu().is_some_and(|own| own.is_same_device(gpu));
        let renderer = match self.seen_on_device.take().filter(same) {
            Some(renderer) => renderer,
            None => Renderer::on_device(gpu).map_err(|error| error.to_string())?,
        };
        draw(self.seen_on_device.insert(renderer), project, snapshot, strands, size, picture)
    }

    /// The steps of transmittance along the light through `p`, for the light and the instant of the last call of
    /// [`ExactReference::transmittance`]: depth from `p`, metres, and transmittance from there on.
    pub(super) fn steps(&mut self, p: Vec3) -> Vec<(f32, f32)> {
        let found = self.unseen.along_ray(0, p).unwrap_or_default();
        let steps = found.marks.iter().filter(|mark| mark.kind == RayMarkKind::FRAGMENT);
        steps.map(|mark| (mark.start, mark.transmittance)).collect()
    }
}

/// What renders a reference.
trait Draws {
    fn draw(&mut self, input: &FrameInput, size: [u32; 2], picture: &mut Picture) -> Result<(), RenderError>;
}

impl Draws for CpuRenderer {
    fn draw(&mut self, input: &FrameInput, size: [u32; 2], picture: &mut Picture) -> Result<(), RenderError> {
        self.picture(input, size[0], size[1], picture).map(|_| ())
    }
}

impl Draws for Renderer {
    fn draw(&mut self, input: &FrameInput, size: [u32; 2], picture: &mut Picture) -> Result<(), RenderError> {
        self.picture(input, size[0], size[1], picture).map(|_| ())
    }
}

fn draw(
    renderer: &mut impl Draws,
    project: &Project,
    snapshot: &FrameSnapshot,
    strands: &Strands,
    size: [u32; 2],
    picture: &mut Picture,
) -> Result<(), String> {
    let project = project.compared();
    let camera = snapshot.camera(&project.camera);
    let input = input_of(snapshot, &project, strands, &camera);
    renderer.draw(&input, size, picture).map_err(|error| error.to_string())
}
