//! The device of the tests, and maps that are built on it.
#![allow(dead_code, unreachable_pub, missing_docs)] // A module of tests, each of which uses its part.

use std::sync::{Arc, OnceLock};

use glam::Vec3;
use lovelock_gpu::{Gpu, GrowBuffer, PassTime, PassTimer, read_buffer, wgpu};
use lovelock_shadow::{
    Bounds, GpuShadow, GpuShadowInput, GpuStrands, GpuTargets, ShadowError, ShadowInput, ShadowMethod,
    ShadowSettings, gpu_shadow, voxel_map::longest_strand,
};

/// The device that all tests of a process share; none where there is no adapter.
pub fn device() -> Option<&'static Arc<Gpu>> {
    static DEVICE: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    DEVICE
        .get_or_init(|| match Gpu::open() {
            Ok(gpu) => Some(gpu),
            Err(error) => {
                lovelock_testkit::skip_without_adapter(&error);
                None
            }
        })
        .as_ref()
}

fn buffer<T: bytemuck::Pod>(gpu: &Gpu, items: &[T]) -> GrowBuffer<T> {
    let mut buffer = GrowBuffer::new(&gpu.device, "test", wgpu::BufferUsages::STORAGE);
    buffer.write(&gpu.device, &gpu.queue, items);
    buffer
}

fn padded(p: Vec3) -> [f32; 4] {
    [p.x, p.y, p.z, 0.0]
}

/// A method with one map.
pub struct Built {
    gpu: &'static Arc<Gpu>,
    pub shadow: Box<dyn GpuShadow>,
    timer: PassTimer,
    pub passes: Vec<PassTime>,
}

impl Built {
    /// Builds the map of `input` on the device.
    pub fn try_new(
        gpu: &'static Arc<Gpu>,
        method: ShadowMethod,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<Self, ShadowError> {
        let strands = input.strands;
        let points: Vec<_> = (0..strands.points()).map(|i| padded(strands.point(i))).collect();
        let ends = strands.first_point.windows(2);
        let segments: Vec<u32> = ends.flat_map(|ends| ends[0]..ends[1].saturating_sub(1)).collect();
        let (points, segments) = (buffer(gpu, &points), buffer(gpu, &segments));
        let input = GpuShadowInput {
            strands: GpuStrands {
                points: points.raw(),
                point_count: points.len() as u32,
                segments: segments.raw(),
                segment_count: segments.len() as u32,
            },
            bounds: Bounds::of_strands(input),
            longest_strand: longest_strand(strands),
            strand_width: input.strand_width,
            light: input.light,
            anchor: input.anchor,
            maps: input.maps,
        };
        let shadow = gpu_shadow(method, gpu).expect("shaders compile");
        let timer = PassTimer::new(gpu).expect("a timer");
        let mut built = Self { gpu, shadow, timer, passes: Vec::new() };
        loop {
            let mut commands = built.timer.begin(gpu, "test");
            built.shadow.build(0, gpu, &mut commands, &input, settings)?;
            let commands = commands.finish();
            built.timer.submit(gpu, commands);
            gpu.check().expect("the device takes it");
            if !built.shadow.settle(gpu).expect("it fits") {
                return Ok(built);
            }
        }
    }

    /// As [`Built::try_new`], of a map that fits.
    pub fn new(
        gpu: &'static Arc<Gpu>,
        method: ShadowMethod,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Self {
        Self::try_new(gpu, method, input, settings).expect("it fits")
    }

    /// The map's words.
    pub fn words(&self) -> Vec<u32> {
        self.shadow.map_words(0, self.gpu).expect("read back")
    }

    /// Transmittance at some points, rounded to 8 bits as pictures have it.
    pub fn ask(&mut self, at: &[Vec3]) -> Vec<f32> {
        let points: Vec<_> = at.iter().map(|&p| padded(p)).collect();
        let (points, out) = (buffer(self.gpu, &points), buffer(self.gpu, &vec![0_u32; at.len()]));
        let targets =
            GpuTargets { points: points.raw(), stride: 1, count: at.len() as u32, out: out.raw(), sum: None };
        let mut commands = self.timer.begin(self.gpu, "test");
        self.shadow.ask(0, self.gpu, &mut commands, &targets);
        let commands = commands.finish();
        self.timer.submit(self.gpu, commands);
        let mut words = vec![0_u32; at.len()];
        read_buffer(self.gpu, out.raw(), &mut words).expect("read back");
        self.passes = self.timer.times(self.gpu);
        words.into_iter().map(|word| (word & 0xff) as f32 / 255.0).collect()
    }
}
