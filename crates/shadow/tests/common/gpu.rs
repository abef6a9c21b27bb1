//! The device of the tests, and maps that are built on it.
#![allow(dead_code, unreachable_pub, missing_docs)] // A module of tests, each of which uses its part.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::Vec3;
use lovelock_gpu::{Gpu, GrowBuffer, PassTime, PassTimer, read_buffer, wgpu};
use lovelock_groom::Strands;
use lovelock_shadow::{
    Bounds, GpuShadow, GpuShadowError, GpuShadowInput, GpuStrands, GpuTargets, LightFrame, ShadowError,
    ShadowInput, ShadowMethod, ShadowSettings, gpu_shadow, voxel_map::longest_strand,
};

/// The device that all tests of a process share; `None` without an adapter. A test keeps it until its thread ends, because the uniforms of a
/// handle belong to one frame at a time, and an error of the device goes to the first caller that looks for it.
pub fn device() -> Option<&'static Arc<Gpu>> {
    static DEVICE: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    static TURN: Mutex<()> = Mutex::new(());
    thread_local!(static HAS_TURN: RefCell<Option<MutexGuard<'static, ()>>> = const { RefCell::new(None) });
    HAS_TURN.with_borrow_mut(|turn| {
        turn.get_or_insert_with(|| TURN.lock().unwrap_or_else(PoisonError::into_inner));
    });
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

pub fn buffer<T: bytemuck::Pod>(gpu: &Gpu, items: &[T]) -> GrowBuffer<T> {
    let mut buffer = GrowBuffer::new(gpu, "test", wgpu::BufferUsages::STORAGE);
    buffer.write(gpu, items);
    buffer
}

fn padded(p: Vec3) -> [f32; 4] {
    [p.x, p.y, p.z, 0.0]
}

/// Strands in GPU memory.
pub struct Uploaded {
    points: GrowBuffer<[f32; 4]>,
    segments: GrowBuffer<u32>,
}

impl Uploaded {
    pub fn new(gpu: &Gpu, strands: &Strands) -> Self {
        let points: Vec<_> = (0..strands.points()).map(|i| padded(strands.point(i))).collect();
        let ends = strands.first_point.windows(2);
        let segments: Vec<u32> = ends.flat_map(|ends| ends[0]..ends[1].saturating_sub(1)).collect();
        Self { points: buffer(gpu, &points), segments: buffer(gpu, &segments) }
    }

    /// The input of a build.
    pub fn input(&self, input: &ShadowInput) -> GpuShadowInput<'_> {
        GpuShadowInput {
            strands: GpuStrands {
                points: self.points.raw(),
                point_count: self.points.len() as u32,
                segments: self.segments.raw(),
                segment_count: self.segments.len() as u32,
            },
            bounds: Bounds::of_strands(input),
            extent: Bounds::of_strands(&ShadowInput { light: LightFrame::WORLD, ..*input }),
            longest_strand: longest_strand(input.strands),
            strand_width: input.strand_width,
            extinction_scale: input.extinction_scale,
            light: input.light,
            anchor: input.anchor,
            maps: input.maps,
            sample_bounds: &[],
            shared_list: None,
            projected: None,
        }
    }
}

/// A method with its maps.
pub struct Built {
    gpu: &'static Arc<Gpu>,
    pub shadow: Box<dyn GpuShadow>,
    timer: PassTimer,
    /// Times of the last build or lookup.
    pub passes: Vec<PassTime>,
}

impl Built {
    /// A method without a map.
    pub fn empty(gpu: &'static Arc<Gpu>, method: ShadowMethod) -> Self {
        let shadow = gpu_shadow(method, gpu).expect("shaders compile");
        let timer = PassTimer::new(gpu).expect("a timer");
        Self { gpu, shadow, timer, passes: Vec::new() }
    }

    /// Builds the map of `input` on the device.
    pub fn try_new(
        gpu: &'static Arc<Gpu>,
        method: ShadowMethod,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<Self, ShadowError> {
        let mut built = Self::empty(gpu, method);
        built.build(0, input, settings)?;
        Ok(built)
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

    /// Builds the map of a slot. Returns the number of attempts.
    pub fn build(
        &mut self,
        slot: usize,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<u32, ShadowError> {
        let strands = Uploaded::new(self.gpu, input.strands);
        let lights = input.light.samples(input.anchor);
        let bounds: Vec<_> =
            lights.iter().map(|&light| Bounds::of_strands(&ShadowInput { light, ..*input })).collect();
        let input = GpuShadowInput { sample_bounds: &bounds, ..strands.input(input) };
        self.build_from(slot, &input, settings)
    }

    /// The heads of the lists of all maps.
    fn heads(&self) -> Vec<[u32; 2]> {
        let lists = (0..).map_while(|slot| self.shadow.list(slot));
        lists
            .map(|list| {
                let mut words = vec![0; list.at as usize / 4 + 2];
                read_buffer(self.gpu, list.buffer, &mut words).expect("read back");
                [words[words.len() - 2], words[words.len() - 1]]
            })
            .collect()
    }

    /// As [`Built::build`], of strands that are there.
    pub fn build_from(
        &mut self,
        slot: usize,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<u32, ShadowError> {
        for times in 1..=2 {
            let mut commands = self.timer.begin(self.gpu, "test");
            let done = self.shadow.build(slot, self.gpu, &mut commands, input, settings);
            commands.submit();
            self.gpu.check().expect("the device takes it");
            match done {
                Ok(()) => {}
                Err(GpuShadowError::Shadow(error)) => return Err(error),
                Err(error) => panic!("{error}"),
            }
            let wait = wgpu::PollType::wait_indefinitely();
            self.gpu.device.poll(wait).expect("the device is there");
            self.passes = self.timer.times(self.gpu);
            let heads = self.heads();
            match self.shadow.settle(self.gpu, &heads) {
                Ok(false) => return Ok(times),
                Ok(true) => {}
                Err(GpuShadowError::Shadow(error)) => return Err(error),
                Err(error) => panic!("{error}"),
            }
        }
        panic!("the second build has the room that the first one asked for");
    }

    /// Takes the heads of all maps after a lookup, as a frame does.
    pub fn settle(&mut self) -> Result<bool, ShadowError> {
        let heads = self.heads();
        match self.shadow.settle(self.gpu, &heads) {
            Ok(again) => Ok(again),
            Err(GpuShadowError::Shadow(error)) => Err(error),
            Err(error) => panic!("{error}"),
        }
    }

    /// The words of the first map.
    pub fn words(&self) -> Vec<u32> {
        self.shadow.map_words(0, self.gpu).expect("read back")
    }

    /// Transmittance at points from the first map, rounded to 8 bits as in pictures.
    pub fn look_up(&mut self, at: &[Vec3]) -> Vec<f32> {
        let words = self.ask_slots(&[0], at);
        words.into_iter().map(|word| (word & 0xff) as f32 / 255.0).collect()
    }

    /// The words that lookups of several maps write.
    pub fn ask_slots(&mut self, slots: &[usize], at: &[Vec3]) -> Vec<u32> {
        let points: Vec<_> = at.iter().map(|&p| padded(p)).collect();
        let (points, out) = (buffer(self.gpu, &points), buffer(self.gpu, &vec![0_u32; at.len()]));
        let targets = GpuTargets {
            points: points.raw(),
            stride: 1,
            count: at.len() as u32,
            out: out.raw(),
            sum: None,
            byte: None,
            projected: None,
        };
        let mut commands = self.timer.begin(self.gpu, "test");
        for &slot in slots {
            self.shadow.look_up(slot, self.gpu, &mut commands, &targets);
        }
        commands.submit();
        self.gpu.check().expect("the device takes it");
        let mut words = vec![0_u32; at.len()];
        read_buffer(self.gpu, out.raw(), &mut words).expect("read back");
        self.passes = self.timer.times(self.gpu);
        words
    }
}
