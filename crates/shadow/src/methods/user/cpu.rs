//! A user's method where the program renders on the CPU: it has no definition there, so it runs on a graphics device of its own, a
//! software one if there is one, and the results come back.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use lovelock_gpu::{Gpu, GpuError, GrowBuffer, PassTimer, read_buffer, read_texture_rgba8, wgpu};

use super::{METHOD, UserMethod};
use crate::methods::voxel_map::longest_strand;
use crate::perspective::GpuLightMaps;
use crate::{
    Bounds, ColumnMap, CpuShadow, GpuShadow, GpuShadowError, GpuShadowInput, GpuStrands, GpuTargets,
    RayStructure, ShadowError, ShadowInput, ShadowMethod, ShadowReport, ShadowSettings,
};

/// The device of all users' methods that do not run on a renderer's.
static DEVICE: Mutex<Option<Arc<Gpu>>> = Mutex::new(None);

/// The device, opened if it is not there or was lost. All maps have one handle, so that they share kernels.
fn device() -> Result<Arc<Gpu>, GpuError> {
    let mut device = DEVICE.lock().unwrap_or_else(PoisonError::into_inner);
    device.take_if(|gpu| gpu.is_lost());
    let gpu = match &mut *device {
        Some(gpu) => gpu,
        none => none.insert(Gpu::open_software().or_else(|_| Gpu::open())?),
    };
    Ok(Arc::clone(gpu))
}

/// The map of a light.
pub(super) struct UserOnDevice {
    method: UserMethod,
    /// The map, while there is one. Lookups take turns.
    running: Mutex<Option<Running>>,
}

struct Running {
    gpu: Arc<Gpu>,
    maps: GpuLightMaps,
    points: GrowBuffer<[f32; 4]>,
    segments: GrowBuffer<u32>,
    asked: GrowBuffer<[f32; 4]>,
    answers: GrowBuffer<u32>,
    report: ShadowReport,
}

impl fmt::Debug for UserOnDevice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("UserOnDevice").field("method", &self.method).finish_non_exhaustive()
    }
}

/// Points that are looked up together.
const POINTS_AT_ONCE: usize = 1 << 20;

impl Running {
    fn new(method: UserMethod) -> Result<Self, GpuShadowError> {
        let gpu = device()?;
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            maps: GpuLightMaps::new(&gpu, ShadowMethod::User(method), METHOD.gpu)?,
            points: GrowBuffer::new(&gpu, "points", storage),
            segments: GrowBuffer::new(&gpu, "segments", storage),
            asked: GrowBuffer::new(&gpu, "asked", storage),
            answers: GrowBuffer::new(&gpu, "answers", storage),
            report: ShadowReport::default(),
            gpu,
        })
    }

    /// Builds the map, once more if the version of the method was refused and there is another one.
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), GpuShadowError> {
        let strands = input.strands;
        let points: Vec<_> = (0..strands.points()).map(|i| padded(strands.point(i))).collect();
        let ends = strands.first_point.windows(2);
        let segments: Vec<u32> = ends.flat_map(|ends| ends[0]..ends[1].saturating_sub(1)).collect();
        let size = (16 * points.len() as u64).max(4 * segments.len() as u64);
        let limit = self.gpu.most_storage_bytes();
        if size > limit {
            return Err(GpuError::Input(format!(
                "its points need {size} bytes, and the device allows {limit}"
            ))
            .into());
        }
        self.points.write(&self.gpu, &points);
        self.segments.write(&self.gpu, &segments);
        let bounds = Bounds::of_strands(input);
        let from = GpuShadowInput {
            strands: GpuStrands {
                points: self.points.raw(),
                point_count: points.len() as u32,
                segments: self.segments.raw(),
                segment_count: segments.len() as u32,
            },
            bounds,
            extent: bounds,
            longest_strand: longest_strand(strands),
            strand_width: input.strand_width,
            extinction_scale: input.extinction_scale,
            light: input.light,
            anchor: input.anchor,
            maps: input.maps,
            projected: None,
            sample_bounds: &[],
            shared_list: None,
        };
        let mut timer = PassTimer::off();
        let mut commands = timer.begin(&self.gpu, "user's method");
        let built = self.maps.build(0, &self.gpu, &mut commands, &from, settings);
        commands.submit();
        built?;
        self.gpu.wait()?;
        self.gpu.check()?;
        self.report = ShadowReport { points_ignored: bounds.ignored, ..self.maps.report(0) };
        Ok(())
    }

    /// Whether a loop of the method was cut off since the last call, and another version is there to try.
    fn settle(&mut self) -> Result<bool, GpuShadowError> {
        let Some(list) = self.maps.list(0) else { return Ok(false) };
        let mut words = vec![0_u32; list.at as usize / 4 + 2];
        read_buffer(&self.gpu, list.buffer, &mut words)?;
        let head = [words[words.len() - 2], words[words.len() - 1]];
        self.maps.settle(&self.gpu, &[head])
    }

    fn look_up(&mut self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) -> Result<(), GpuShadowError> {
        let points: Vec<_> = x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z, 0.0]).collect();
        self.asked.write(&self.gpu, &points);
        self.answers.write(&self.gpu, &vec![u32::MAX; points.len()]);
        let targets = GpuTargets {
            points: self.asked.raw(),
            stride: 1,
            count: points.len() as u32,
            out: self.answers.raw(),
            sum: None,
            byte: None,
            projected: None,
        };
        let mut timer = PassTimer::off();
        let mut commands = timer.begin(&self.gpu, "user's method");
        self.maps.look_up(0, &self.gpu, &mut commands, &targets);
        commands.submit();
        let mut words = vec![0_u32; points.len()];
        read_buffer(&self.gpu, self.answers.raw(), &mut words)?;
        self.gpu.check()?;
        for (out, word) in out.iter_mut().zip(words) {
            *out = (word & 0xff) as f32 / 255.0;
        }
        Ok(())
    }

    fn column_map(&mut self, side: usize) -> Option<ColumnMap> {
        let size = self.maps.columns_size(0);
        if size == 0 {
            return None;
        }
        let texture = self.gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("hair columns"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut timer = PassTimer::off();
        let mut commands = timer.begin(&self.gpu, "user's method");
        let columns = self.maps.columns((0, side), &self.gpu, &mut commands, &view);
        commands.submit();
        let columns = columns?;
        let mut bytes = Vec::new();
        read_texture_rgba8(&self.gpu, &texture, &mut bytes).ok()?;
        let row = |row: usize| {
            let start = 4 * row * size as usize;
            bytes[start..].iter().step_by(4).take(columns.size as usize).map(|byte| f32::from(*byte) / 255.0)
        };
        let transmittance = (0..columns.size as usize).flat_map(row).collect();
        Some(ColumnMap { size: columns.size, transmittance, uv_from_world: columns.uv_from_world })
    }
}

fn padded(p: Vec3) -> [f32; 4] {
    [p.x, p.y, p.z, 0.0]
}

impl UserOnDevice {
    pub(super) fn new(method: UserMethod) -> Self {
        Self { method, running: Mutex::new(None) }
    }

    fn running(&self) -> MutexGuard<'_, Option<Running>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn error(&self, error: GpuShadowError) -> ShadowError {
        match error {
            GpuShadowError::Shadow(error) => error,
            GpuShadowError::Gpu(error) => {
                ShadowError::User { method: self.method, problem: format!("{}: {error}", self.method.id()) }
            }
        }
    }
}

impl CpuShadow for UserOnDevice {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        let mut running = self.running();
        running.take_if(|running| running.gpu.is_lost());
        let mut all = || -> Result<(), GpuShadowError> {
            let running = match &mut *running {
                Some(known) => known,
                none => none.insert(Running::new(self.method)?),
            };
            // A version that fails gives way to the one before it.
            loop {
                running.build(input, settings)?;
                // A fault of a lookup is found here too: a few points near the hair stand for all.
                let near = input.anchor;
                running.look_up(&[near.x], &[near.y], &[near.z], &mut [1.0])?;
                if !running.settle()? {
                    return Ok(());
                }
            }
        };
        let built = all();
        if built.is_err() {
            *running = None;
        }
        drop(running);
        built.map_err(|error| self.error(error))
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        let mut out = [1.0];
        self.transmittance_at(&[p.x], &[p.y], &[p.z], &mut out);
        out[0]
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        out.fill(1.0);
        let mut running = self.running();
        let Some(map) = &mut *running else { return };
        let pieces = x.chunks(POINTS_AT_ONCE).zip(y.chunks(POINTS_AT_ONCE)).zip(z.chunks(POINTS_AT_ONCE));
        for (((x, y), z), out) in pieces.zip(out.chunks_mut(POINTS_AT_ONCE)) {
            // The next build reports what is wrong.
            let failed = map.look_up(x, y, z, out).and_then(|()| map.settle()).is_err();
            if failed {
                *running = None;
                return;
            }
        }
    }

    fn report(&self) -> ShadowReport {
        self.running().as_ref().map_or_else(ShadowReport::default, |running| running.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.column_maps().into_iter().next()
    }

    fn column_maps(&self) -> Vec<ColumnMap> {
        let mut running = self.running();
        let Some(map) = &mut *running else { return Vec::new() };
        (0..map.maps.column_sides(0)).filter_map(|side| map.column_map(side)).collect()
    }

    fn along_ray(&self, _p: Vec3) -> RayStructure {
        RayStructure::default()
    }
}
