//! Renders the panes of one instant.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::{
    Camera, DeviceImages, Finished, FrameInput, FrameStats, HairPose, Image, Light, MapValue, RayStructure,
    RenderError, ValueRenderer, light_frame,
};
use lovelock_session::render_thread::Adapter;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_shadow::{ShadowInput, cpu_shadow};

use super::probes::{Probes, curve, way_at};
use super::reference::ExactReference;
use super::renderers::{Broken, Renderers, device_is_gone};
use super::takes::PaneTakes;
use crate::probe::LiveProbe;
use crate::request::{LiveError, LivePane, LiveRequest, LiveTimes};

/// Renders panes and keeps the state that the next instant needs.
pub(super) struct Rounds {
    pub(super) renderers: Renderers,
    pub(super) strands: Strands,
    /// The instant of `strands`.
    strands_of: Option<Arc<FrameSnapshot>>,
    /// The last request, whose images the user saw when choosing hair.
    shown: Option<LiveRequest>,
    pub(super) values: ValueRenderer,
    pub(super) reference: ExactReference,
    probes: Probes,
    pub(super) takes: PaneTakes,
    /// The textures of each pane on the window's device.
    textures: Vec<Option<DeviceImages>>,
}

/// How long [`Rounds::finish`] waits at a time.
const PATIENCE: Duration = Duration::from_millis(20);

/// Takes the statistics of an image.
pub(super) fn take_stats(pane: &mut LivePane, stats: &FrameStats) {
    pane.times = LiveTimes::of(stats);
    (pane.shadow_bytes, pane.draw_bytes) = (stats.shadow_bytes, stats.draw_bytes);
    pane.shadow_fallbacks = stats.shadow_fallbacks;
}

impl Rounds {
    /// Renders with `renderers`.
    pub(super) fn new(renderers: Renderers) -> Self {
        Self {
            renderers,
            strands: Strands::default(),
            strands_of: None,
            shown: None,
            values: ValueRenderer::default(),
            reference: ExactReference::default(),
            probes: Probes::default(),
            takes: PaneTakes::default(),
            textures: Vec::new(),
        }
    }

    /// Gives back everything that is kept for further rounds.
    pub(super) fn rest(&mut self) {
        self.renderers.close();
        (self.strands, self.strands_of, self.shown) = (Strands::default(), None, None);
        (self.values, self.reference) = (ValueRenderer::default(), ExactReference::default());
        (self.probes, self.takes) = (Probes::default(), PaneTakes::default());
        self.textures = Vec::new();
    }

    /// The memory that is kept for further rounds, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.renderers.bytes()
            + self.strands.bytes()
            + self.values.bytes()
            + self.reference.bytes()
            + self.takes.bytes()
            + self.textures.iter().flatten().map(DeviceImages::bytes).sum::<u64>()
    }

    /// Starts a round: interpolates the strands of its instant once for all panes.
    pub(super) fn begin(&mut self, request: &LiveRequest) {
        if let (Some(place), Some(shown)) = (request.probe, &self.shown) {
            self.probes.choose(&mut self.values, place, shown, &self.strands);
        }
        let same = |held: &Arc<FrameSnapshot>| Arc::ptr_eq(held, &request.snapshot);
        if !self.strands_of.as_ref().is_some_and(same) {
            self.strands_of = None;
            request.snapshot.interpolate(&mut self.strands);
            self.strands_of = Some(Arc::clone(&request.snapshot));
        }
        self.takes.begin(request);
        self.renderers.keep(request.project.compare.panes.len());
        self.shown = Some(request.clone());
    }

    /// Renders one pane of the round.
    pub(super) fn pane(&mut self, request: &LiveRequest, index: usize) -> (LivePane, Option<Broken>) {
        let project = &request.project;
        let contender = project.compare.panes.get(index).cloned().unwrap_or_default();
        // The snapshot of the pane's own take, whose head may be elsewhere.
        let own = self.takes.instant(index);
        let (snapshot, unplayable) = match own {
            Some(Ok((snapshot, _))) => (snapshot, None),
            Some(Err(why)) => (&request.snapshot, Some(why.to_owned())),
            None => (&request.snapshot, None),
        };
        let camera = snapshot.camera(&project.camera);
        let mut pane = LivePane {
            contender: contender.clone(),
            project: Arc::clone(project),
            asked_size: [request.width, request.height],
            image: Image::default(),
            problem: None,
            colors_problem: None,
            camera,
            step: snapshot.step,
            time_secs: snapshot.time_secs,
            times: LiveTimes::default(),
            shadow_bytes: 0,
            shadow_fallbacks: 0,
            draw_bytes: 0,
            adapter: Adapter { name: String::new(), backend: contender.backend, software: true },
            error: LiveError::NotMeasured,
            flip: None,
            shows: request.view.shows,
        };
        if unplayable.is_some() {
            pane.problem = unplayable;
            return (pane, None);
        }
        // A panic while rendering costs the device and one image, but not the window.
        let drawn = catch_unwind(AssertUnwindSafe(|| self.draw(request, index, &contender, &mut pane)));
        let broken = match drawn {
            Ok(Ok(())) => {
                self.renderers.worked(index);
                None
            }
            Ok(Err(error)) => {
                pane.problem = Some(error.to_string());
                device_is_gone(&error).then(|| self.renderers.broke(index))
            }
            Err(_) => {
                pane.problem =
                    Some("rendering stopped unexpectedly; the renderer is opened again".to_owned());
                Some(self.renderers.broke(index))
            }
        };
        if pane.problem.is_some() {
            pane.image = Image::default();
        }
        (pane, broken)
    }

    fn draw(
        &mut self,
        request: &LiveRequest,
        index: usize,
        contender: &Contender,
        pane: &mut LivePane,
    ) -> Result<(), RenderError> {
        let window_device = self.renderers.window.clone();
        let renderer = self.renderers.of_pane(index, contender)?;
        let (name, backend) = (renderer.adapter().to_owned(), renderer.backend());
        pane.adapter = Adapter { name, backend, software: renderer.is_software() };
        let mut project = contender.applied_to(&request.project).compared();
        if request.view.shows.colors().is_some() {
            // Errors are those of the hair.
            project.picture.map_view.value = MapValue::None;
        }
        let shared = (&request.snapshot, &self.strands);
        let (snapshot, strands) = self.takes.instant(index).and_then(Result::ok).unwrap_or(shared);
        let input = input_of(snapshot, &project, strands, &pane.camera);
        let size = pixels(request, contender);
        if self.textures.len() <= index {
            self.textures.resize_with(index + 1, || None);
        }
        if request.view.measures && request.view.shows.colors().is_some() {
            let mut textures = self.textures[index].take();
            let window = window_device.images(&mut textures);
            let drawn = self.draw_errors(request, index, (&project, size), pane, window);
            self.textures[index] = textures;
            return drawn;
        }
        let window = window_device.images(&mut self.textures[index]);
        // The image stays where it is drawn.
        let (image, stats) = renderer.image(&input, size, true, window)?;
        pane.image = image;
        take_stats(pane, &stats);
        if renderer.in_flight() > 0 {
            // Its time is known when the device has finished it: see `Rounds::finish`.
            pane.times = LiveTimes { whole: 0.0, ..pane.times };
        }
        if request.view.measures && contender.draws_strands() {
            // A missing light has no transmittance, and the image does not need it.
            let found = renderer.transmittance(request.view.light).map_err(|error| error.to_string());
            let _ = found.and_then(|found| self.measure(request, index, &found, pane));
        }
        Ok(())
    }

    /// Waits until the device has finished the image of a pane. Returns what it tells, with whether any of its images must be rendered
    /// again; `None` if it was finished before.
    pub(super) fn finish(&mut self, index: usize) -> Option<Finished> {
        let renderer = self.renderers.last(index)?;
        let mut found: Option<Finished> = None;
        while renderer.in_flight() > 0 {
            match renderer.finished() {
                Ok(Some(done)) => {
                    let again = done.again || found.is_some_and(|found| found.again);
                    found = Some(Finished { again, ..done });
                }
                Ok(None) => renderer.wait_for_oldest(PATIENCE),
                // The next image of the pane reports the error.
                Err(_) => return None,
            }
        }
        found
    }

    /// The light along the ray through the chosen hair in the panes of the round.
    pub(super) fn probe(&mut self, request: &LiveRequest) -> Option<LiveProbe> {
        request.probe?;
        let light = enabled(&request.project).nth(request.view.light)?;
        let mut probe = self.probes.follow(&request.snapshot, &self.strands, light)?;
        if let Some(hair) = &mut probe.hair {
            let (project, snapshot) = (&request.project, &request.snapshot);
            let exact = self.reference.transmittance(project, snapshot, &self.strands, request.view.light);
            if exact.is_ok() {
                hair.steps = self.reference.steps(hair.position);
            }
            for &pane in &request.panes {
                // The hair of another take is not the chosen one, and other strands shadow clusters.
                let draws_strands = project.compare.panes.get(pane).is_none_or(Contender::draws_strands);
                if self.takes.instant(pane).is_some() || !draws_strands {
                    continue;
                }
                let Some(renderer) = self.renderers.last(pane) else { continue };
                // A pane that could not be rendered has no maps; the pane itself reports why.
                let strands = &self.strands;
                let definition = || kept(project, snapshot, strands, pane, light, hair.position);
                if let Ok(curve) =
                    curve(renderer, (request.view.light, way_at(light, hair.position)), hair, definition)
                {
                    hair.curves.push((pane, curve));
                }
            }
        }
        Some(probe)
    }
}

/// What a pane's method stores along the light through `p`, by its CPU definition.
fn kept(
    project: &Project,
    snapshot: &FrameSnapshot,
    strands: &Strands,
    pane: usize,
    light: &Light,
    p: Vec3,
) -> Result<RayStructure, RenderError> {
    let drawn = project.compare.panes.get(pane).cloned().unwrap_or_default().applied_to(project);
    let anchor = snapshot.guides.world_from_head.translation.into();
    let input = ShadowInput {
        strands,
        strand_width: snapshot.look(project).shadow_width(strands.count()),
        extinction_scale: project.look.extinction_scale,
        light: light_frame(&light.normalized(), anchor),
        anchor,
        maps: enabled(project).count() as u32,
        projected: None,
    };
    let mut map = cpu_shadow(drawn.shadow.method);
    map.build(&input, &drawn.shadow)?;
    Ok(map.along_ray(p))
}

/// The lights that are on.
fn enabled(project: &Project) -> impl Iterator<Item = &Light> {
    project.lights.iter().filter(|light| light.enabled)
}

/// The render input of an instant with interpolated strands.
pub(super) fn input_of<'a>(
    snapshot: &'a FrameSnapshot,
    project: &'a Project,
    strands: &'a Strands,
    camera: &'a Camera,
) -> FrameInput<'a> {
    FrameInput { hair: HairPose::Strands(strands), ..snapshot.frame_input(project, camera) }
}

/// The size at which a pane is rendered.
fn pixels(request: &LiveRequest, contender: &Contender) -> [u32; 2] {
    let scale = if contender.scale.is_finite() { contender.scale.clamp(0.1, 1.0) } else { 1.0 };
    [request.width, request.height].map(|side| ((side as f32 * scale).round() as u32).max(16))
}
