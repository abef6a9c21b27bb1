//! The GPU renderer.

mod false_colors;
mod flight;
mod inspect;
mod layers;
mod picture;
mod seen;

use std::sync::Arc;

use lovelock_gpu::{Commands, Gpu, PassTime, PassTimer, Readback, wgpu};
use lovelock_shadow::{GpuList, SUM_WORDS, ShadowMethod};

use super::carried::CarriedBuffers;
use super::clusters::{Clusters, RibLighting};
use super::eye::{Area, Eye, HairOutput, Lists, too_large};
use super::false_colors::FalseColors;
use super::frame_resources::FrameResources;
use super::ground::{CELL, Ground};
use super::hair::{HairBuffers, PointShading};
use super::layers::LayerBuffers;
use super::light_buffers::LightBuffers;
use super::pipelines::Pipelines;
use super::present::MAX_LISTS;
use super::screen::{Screen, ScreenInput};
use super::shadow::GpuShadowStage;
use super::skin_shadow::SkinShadow;
use super::surface::SurfaceBuffers;
use super::targets::Targets;
use crate::backdrop::{Backdrop, LaidBackdrop};
use crate::clusters::{of_casters, without_strands};
use crate::cpu::encode;
use crate::image::DeviceImage;
use crate::light_view::{bounding_sphere, light_views};
use crate::shadow_look::has_soft_skin;
use crate::standing::layer_of;
use crate::textures::BodyTextures;
use crate::uniform::{FrameUniform, LightMaps, PlainBackground};
use crate::{FrameInput, FrameStats, Light, MAX_LIGHTS, RenderError};
use flight::Flights;
pub use flight::{Finished, MAX_IN_FLIGHT};
pub use picture::PendingPicture;
use seen::{SeenHair, eye_input};

/// The most attempts to render a frame whose lists were too short. Each attempt has longer lists or half as many rows per band.
const MAX_ATTEMPTS: u32 = 16;

/// Renders pictures on a GPU. Keeps buffers from picture to picture.
#[derive(Debug)]
pub struct GpuRenderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    timer: PassTimer,
    shadow: GpuShadowStage,
    hair: HairBuffers,
    /// Hair that the skin carries, beside it.
    carried: CarriedBuffers,
    /// Hair that is drawn as clusters, beside strands or in their place.
    clusters: Clusters,
    surface: SurfaceBuffers,
    skin: SkinShadow,
    ground: Ground,
    light: LightBuffers,
    eye: Eye,
    linear: wgpu::Sampler,
    compare: wgpu::Sampler,
    uniform: wgpu::Buffer,
    uniform_group: wgpu::BindGroup,
    targets: Option<Targets>,
    screen: Screen,
    backdrop: Backdrop,
    /// The picture behind the figure in the last image.
    behind: Option<Arc<LaidBackdrop>>,
    layers: LayerBuffers,
    false_colors: FalseColors,
    /// Uniform of the last frame.
    last: FrameUniform,
    /// Where its hair is.
    seen: SeenHair,
    /// Readbacks of finished pictures.
    readbacks: Vec<Readback>,
    numbers: Vec<u8>,
    heads: Vec<u8>,
    flights: Flights,
    /// The bytes of an image of which layers alone are wanted.
    spare: Vec<u8>,
    /// Whether the last picture was completed.
    is_whole: bool,
}

impl GpuRenderer {
    /// Compiles kernels and pipelines.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        // What other renderers on the same device do is not counted here.
        let gpu = gpu.handle();
        let pipelines = gpu.checked(|| Pipelines::new(&gpu))??;
        let device = &gpu.device;
        let linear = wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        };
        let uniform = gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<FrameUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ok(Self {
            timer: PassTimer::new(&gpu)?,
            shadow: GpuShadowStage::new(&gpu),
            hair: HairBuffers::new(&gpu)?,
            carried: CarriedBuffers::new(&gpu),
            clusters: Clusters::default(),
            surface: SurfaceBuffers::new(&gpu, &pipelines),
            skin: SkinShadow::new(&gpu)?,
            ground: Ground::new(&gpu),
            light: LightBuffers::new(&gpu),
            eye: Eye::new(&gpu)?,
            compare: device.create_sampler(&wgpu::SamplerDescriptor {
                compare: Some(wgpu::CompareFunction::LessEqual),
                ..linear
            }),
            linear: device.create_sampler(&linear),
            uniform_group: device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("frame"),
                layout: &pipelines.uniform_layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
            }),
            uniform,
            targets: None,
            screen: Screen::new(&gpu),
            backdrop: Backdrop::default(),
            behind: None,
            layers: LayerBuffers::new(&gpu),
            false_colors: FalseColors::new(&gpu),
            last: FrameUniform::default(),
            seen: SeenHair::default(),
            readbacks: Vec::new(),
            numbers: Vec::new(),
            heads: Vec::new(),
            flights: Flights::default(),
            spare: Vec::new(),
            is_whole: false,
            pipelines,
            gpu,
        })
    }

    /// The device in use.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// The lists of the frame that was drawn last.
    fn lists_of_frame(&self) -> ListsOfFrame {
        let mut maps = [None; MAX_LIGHTS];
        maps.iter_mut().zip(self.shadow.lists()).for_each(|(room, list)| *room = Some(list.room));
        ListsOfFrame { eye: self.eye.lists(), method: self.shadow.method(), maps }
    }

    /// Takes the heads of the lists of a finished frame. Returns whether it must be drawn again, because `lists` were too short for it;
    /// later frames have longer ones.
    fn settle(&mut self, lists: &ListsOfFrame, heads: &[[u32; 2]; MAX_LISTS]) -> Result<bool, RenderError> {
        let gpu = Arc::clone(&self.gpu);
        let [image, maps @ ..] = heads;
        let count = lists.maps.iter().flatten().count();
        let short = |(head, room): (&[u32; 2], &Option<u64>)| {
            room.is_some_and(|room| GpuList::fragments(*head) > room)
        };
        let maps_were_short = maps.iter().zip(&lists.maps).any(short);
        // Both are asked, so that both grow at once.
        let again = [
            self.shadow.settle(&gpu, lists.method, &maps[..count])?,
            self.eye.settle(&gpu, *image, lists.eye)?,
        ];
        Ok(maps_were_short || again != [false, false])
    }

    /// Statistics of the last picture without its whole time, its traffic and its mean transmittance.
    fn stats(&self, passes: Vec<PassTime>) -> FrameStats {
        let of = |stage: &str| {
            passes
                .iter()
                .filter(|pass| pass.name.starts_with(stage))
                .map(|pass| pass.ms)
                .fold(0.0, |sum, ms| sum + ms)
        };
        FrameStats {
            interpolate_ms: of("interpolate"),
            shadow_ms: of("shadow/"),
            segments: if self.seen.has_strands { u64::from(self.hair.drawn().segment_count) } else { 0 },
            shadow_bytes: self.shadow.memory_bytes(),
            shadow_fallbacks: self.shadow.fallbacks(),
            draw_bytes: self.eye.memory_bytes()
                + self.hair.memory_bytes()
                + self.carried.memory_bytes()
                + self.clusters.memory_bytes()
                + self.screen.memory_bytes()
                + self.targets.as_ref().map_or(0, Targets::memory_bytes),
            mean_transmittance: 1.0,
            passes,
            ..FrameStats::default()
        }
    }

    /// Encodes a whole picture and submits it. Returns the buffer of what the frame reports, if it goes to a texture and has something to report.
    fn draw(
        &mut self,
        gpu: &Gpu,
        mut commands: Commands,
        input: &FrameInput,
        width: u32,
        height: u32,
        output: Output,
    ) -> Result<Option<wgpu::Buffer>, RenderError> {
        let has_materials = input.body.is_some_and(|(body, _)| BodyTextures::are_in(body));
        self.fit(gpu, [width, height], has_materials)?;
        self.behind = self.backdrop.follow(input, [width, height], encode);
        let clusters = self.clusters.follow(input, height);
        let picture = without_strands(input.picture);
        let casters = clusters.as_ref().filter(|(_, share)| *share >= 1.0);
        let casters = casters.map(|(hair, _)| of_casters(input, hair, &picture));
        let input = casters.as_ref().unwrap_or(input);
        self.hair.write(gpu, &mut commands, input, height)?;
        let stored = without_strands(input.picture);
        let of_carried = input.of_carried(&stored).filter(|_| casters.is_none());
        self.carried.write(gpu, &mut commands, (of_carried.as_ref(), height), &mut self.hair)?;
        self.clusters.write(gpu, &mut commands, input, height)?;
        self.light.write(gpu, &mut commands, input);
        self.surface.write(gpu, &self.pipelines, input)?;
        let looked_up = (self.carried.hair(), self.surface.vertices());
        self.shadow.run(gpu, &mut commands, input, &mut self.hair, looked_up)?;
        self.clusters.look_up(gpu, &mut commands, &mut self.shadow);
        let is_soft = has_soft_skin(input, self.hair.portion().is_some());
        if is_soft && let (Some((body, _)), Some(vertices)) = (input.body, self.surface.vertices()) {
            self.skin.run(gpu, &mut commands, body, &vertices);
        }

        let maps = self.light_maps(input);
        let last_layer = |(k, map): (usize, &LightMaps)| layer_of(k, map.body_views().len().max(1) - 1);
        let layers = maps.iter().enumerate().map(last_layer).max().map_or(0, |last| last + 1);
        self.surface.fit_depth(gpu, &self.pipelines, layers);
        let uniform = FrameUniform::new(
            input,
            self.hair.portion(),
            self.light.light(),
            (width, height),
            &maps,
            self.surface.texels,
        );
        gpu.upload(&self.uniform, 0, &[uniform]);
        if let Some(of_carried) = &of_carried {
            let (light, texels) = (self.light.light(), self.surface.texels);
            let uniform = FrameUniform::new(of_carried, None, light, (width, height), &maps, texels);
            self.carried.write_uniform(gpu, &uniform);
        }
        let (scene_light, texels) = (self.light.light(), self.surface.texels);
        self.clusters.write_uniform(gpu, input, scene_light, (width, height), &maps, texels);
        self.last = uniform;
        let seen = self.seen_hair(input, &uniform, [width, height]);
        self.seen = seen;
        let Some(targets) = &self.targets else { return Err(RenderError::NoPicture) };
        let frame = FrameResources {
            uniform: &self.uniform,
            body_depth: self.surface.depth(),
            columns: self.shadow.columns_view(),
            linear: &self.linear,
            compare: &self.compare,
            ambient: self.light.cells(),
        };
        for (k, map) in maps.iter().enumerate() {
            // From within a closed body, triangles that face away are nearest.
            let behind = !map.standing.is_standing();
            for (side, view) in map.body_views().iter().enumerate() {
                let of = (layer_of(k, side), *view);
                self.surface.draw_depth(gpu, &self.pipelines, &mut commands, of, behind);
            }
        }
        self.draw_body(gpu, &mut commands, targets);
        let lit = self.pipelines.lit.of(gpu, self.shadow.light_set())?;
        let shading = PointShading { kernels: lit, model: input.look.shading, tables: self.light.tables() };
        if seen.has_strands {
            self.hair.shade(gpu, "draw/points", shading, &mut commands, &frame)?;
            self.carried.shade(gpu, shading, &mut commands, &frame, &self.hair)?;
        }
        let lighting = RibLighting {
            shading,
            rib_light: &self.pipelines.rib_light,
            lights: self.shadow.light_set(),
            area: seen.area.edges(),
            scale: uniform.pixels_per_metre,
            nearest: seen.nearest_rib,
        };
        self.clusters.place(gpu, &mut commands, &frame, &lighting)?;
        if input.picture.ground {
            self.ground.run(gpu, lit, &mut commands, &frame);
        }
        let blended = HairOutput::Blended(seen.transparency);
        let eye = eye_input(
            &seen,
            (&self.hair, &self.carried),
            self.clusters.drawn(&mut commands),
            targets,
            &uniform,
            blended,
        );
        self.eye.draw(gpu, &mut commands, &eye)?;
        let area = seen.area;
        let body = input.body.map_or(&[][..], |(_, skin)| &skin.positions);
        let figure = area.with(Area::of_points(input.camera, [width, height], body));
        let screen = ScreenInput {
            targets,
            corners: self.ground.corners(),
            area,
            hair: self.eye.layer(),
            figure: figure.widened(CELL, [width, height]),
            background: PlainBackground::of(&uniform, self.behind.as_ref().map_or(0, |behind| behind.number)),
            materials: self.surface.materials(),
            picture: self.behind.as_deref(),
        };
        self.screen.run(gpu, &self.pipelines.screen, lit, &mut commands, &frame, &screen)?;
        let report = self.encode_output(gpu, &mut commands, output, u64::from(width) * u64::from(height));
        commands.submit();
        Ok(report)
    }

    /// Fits what depends on the size of the image.
    fn fit(&mut self, gpu: &Gpu, [width, height]: [u32; 2], has_materials: bool) -> Result<(), RenderError> {
        let bytes = 4 * u64::from(width) * u64::from(height);
        if bytes > gpu.most_storage_bytes() {
            return Err(too_large(gpu, bytes).into());
        }
        let is_fit =
            |t: &Targets| (t.width, t.height) == (width, height) && (t.materials.is_some() || !has_materials);
        if !self.targets.as_ref().is_some_and(is_fit) {
            // The old ones are freed when the bind groups of the last frames are.
            self.targets = None;
            self.targets = Some(Targets::new(gpu, [width, height], has_materials));
        }
        self.ground.fit(gpu, width, height);
        self.screen.fit(gpu, width, height);
        Ok(())
    }

    /// The placement of the maps of each light that is on.
    fn light_maps(&self, input: &FrameInput) -> Vec<LightMaps> {
        let sphere = bounding_sphere(input.body.map_or(&[], |(_, skin)| &skin.positions));
        let map = |(slot, light): (usize, Light)| {
            let mut maps = light_views(&light, &self.shadow.frame(slot), sphere, self.surface.texels);
            maps.columns_from_world = self.shadow.columns_from_world(slot, 0);
            maps.standing.column_sides = self.shadow.column_sides(slot) as u32;
            for (side, matrix) in maps.standing.columns_from_world.iter_mut().enumerate() {
                *matrix = self.shadow.columns_from_world(slot, side);
            }
            maps
        };
        Light::enabled(input.lights).enumerate().map(map).collect()
    }

    /// Encodes where the finished image goes. Returns the buffer of what the frame reports, as [`GpuRenderer::draw`].
    fn encode_output(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        output: Output,
        pixels: u64,
    ) -> Option<wgpu::Buffer> {
        let image_list = self.eye.list().map(|(buffer, room)| GpuList { buffer, at: 0, room });
        let lists: Vec<_> = std::iter::once(image_list).chain(self.shadow.lists().map(Some)).collect();
        let present = &self.pipelines.present;
        present.collect(commands.encoder(), &lists);
        match output {
            Output::Memory { readback, pixels: back } => {
                let wanted = [
                    (self.screen.pixels(), if back { 4 * pixels } else { 0 }),
                    (self.shadow.sum(), 4 * SUM_WORDS),
                    (present.heads(), present.heads().size()),
                ];
                readback.copy(gpu, commands.encoder(), &wanted);
                None
            }
            Output::Texture { shown, before, measured, report } => {
                present.show(gpu, commands, self.screen.pixels(), (shown, before), &lists);
                let sum = (measured && self.shadow.has_light()).then(|| self.shadow.sum());
                // Where no list can be too short and nothing is measured, nothing is read back.
                let told = measured || lists.iter().any(Option::is_some);
                told.then(|| flight::report(gpu, commands.encoder(), present.heads(), sum, report))
            }
        }
    }

    /// Draws the attributes of the body per sample, for shading later.
    fn draw_body(&self, gpu: &Gpu, commands: &mut Commands, targets: &Targets) {
        // Samples without depth are never read. Clearing them is slow on software adapters, but on a GPU it is faster than loading.
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let load = if gpu.is_software() { wgpu::LoadOp::Load } else { clear };
        let target = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })
        };
        let mut attachments = vec![target(&targets.normals), target(&targets.colors)];
        if self.surface.materials().is_some() {
            attachments.extend(targets.materials.iter().flatten().map(target));
        }
        let descriptor = wgpu::RenderPassDescriptor {
            color_attachments: &attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        };
        commands.render("draw/body", &descriptor, |pass| {
            self.surface.draw(&self.pipelines, pass, &self.uniform_group);
        });
    }
}

/// The lists with which a frame was drawn.
#[derive(Clone, Copy, Debug)]
struct ListsOfFrame {
    eye: Option<Lists>,
    method: ShadowMethod,
    /// The fragments that fit into the list of the map of each light; the lights without a list come last.
    maps: [Option<u64>; MAX_LIGHTS],
}

/// Where a finished picture goes.
enum Output<'a> {
    /// To memory, if `pixels`, with what the frame reports.
    Memory { readback: &'a mut Readback, pixels: bool },
    /// Into the texture `shown`, or that of the image `before` if a list was too short. `report` is a spare buffer for what the frame
    /// reports.
    Texture {
        shown: &'a DeviceImage,
        before: Option<&'a DeviceImage>,
        measured: bool,
        report: Option<wgpu::Buffer>,
    },
}

/// The sum of the words of [`GpuShadowStage::sum`].
fn number_of_bytes(bytes: &[u8]) -> f64 {
    let words = bytes.as_chunks::<4>().0.iter();
    words.map(|&bytes| f64::from(u32::from_le_bytes(bytes))).fold(0.0, |sum, word| sum + word)
}
