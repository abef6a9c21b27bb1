//! Fine strands on the GPU: their list is uploaded when it changes, and a kernel makes their points in each frame.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, ShaderPart, ShaderSource, wgpu};
use lovelock_groom::Hairstyle;
use lovelock_groom::fine::{FineStrand, FineStrands};

const GROW: ShaderPart =
    ShaderPart { name: "crates/render/src/gpu/fine/grow.wgsl", text: include_str!("grow.wgsl") };

/// Twin of `Grow` in grow.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct GrowUniform {
    strands: u32,
    points: u32,
    reach: f32,
    pad: u32,
}

/// A [`FineStrand`] as words.
type StrandWords = [u32; 6];

/// The composed shaders with their labels.
pub(in crate::gpu) fn shaders() -> Vec<(String, ShaderSource)> {
    vec![("fine strands".to_owned(), ShaderSource::new(&[GROW]))]
}

/// The list of the current hairstyle, and the points of the last frame.
#[derive(Debug)]
pub(in crate::gpu) struct FineBuffers {
    kernel: Kernel,
    uniform: wgpu::Buffer,
    list: GrowBuffer<StrandWords>,
    first_point: GrowBuffer<u32>,
    points: GrowBuffer<[f32; 4]>,
    asked: GrowBuffer<[f32; 4]>,
}

impl FineBuffers {
    /// Compiles the kernel.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            kernel: Kernel::new(gpu, "fine strands", &ShaderSource::new(&[GROW]), "grow_points")?,
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("fine strands"),
                size: size_of::<GrowUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            list: GrowBuffer::new(gpu, "list of fine strands", storage),
            first_point: GrowBuffer::new(gpu, "first points of stored strands", storage),
            points: GrowBuffer::new(gpu, "points of fine strands", storage),
            asked: GrowBuffer::new(gpu, "places of lookups", storage),
        })
    }

    /// Uploads a list that has changed.
    pub fn follow(&mut self, gpu: &Gpu, style: &Hairstyle, fine: &FineStrands) {
        let words: Vec<StrandWords> = fine.strands.iter().map(words_of).collect();
        self.list.write(gpu, &words);
        self.first_point.write(gpu, &style.strands.first_point);
    }

    /// Encodes making the points of the first `count` strands from the `stored` ones, and the places at which their shadows are looked
    /// up, which are up to `reach` metres apart.
    pub fn run(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        (count, points): (usize, usize),
        reach: f32,
        stored: &wgpu::Buffer,
    ) {
        let all = count * points;
        self.points.reserve(gpu, all);
        self.asked.reserve(gpu, all);
        // Both fit, because the points fit a buffer.
        let uniform = GrowUniform { strands: count as u32, points: points as u32, reach, pad: 0 };
        gpu.upload(&self.uniform, 0, &[uniform]);
        let resources = [
            (0, self.uniform.as_entire_binding()),
            (1, self.list.raw().as_entire_binding()),
            (2, self.first_point.raw().as_entire_binding()),
            (3, stored.as_entire_binding()),
            (4, self.points.raw().as_entire_binding()),
            (5, self.asked.raw().as_entire_binding()),
        ];
        let group = self.kernel.bind(gpu, &resources);
        commands.compute("interpolate/fine", |pass| self.kernel.run(pass, &group, all as u64));
    }

    /// The points, strand after strand.
    pub fn points(&self) -> &wgpu::Buffer {
        self.points.raw()
    }

    /// The places at which the shadows of the points are looked up.
    pub fn asked(&self) -> &wgpu::Buffer {
        self.asked.raw()
    }

    /// GPU memory in use, bytes.
    pub fn bytes(&self) -> u64 {
        self.list.raw().size()
            + self.first_point.raw().size()
            + self.points.raw().size()
            + self.asked.raw().size()
    }
}

fn words_of(strand: &FineStrand) -> StrandWords {
    let [a, b, c] = strand.parents;
    let [near, far] = strand.weights.map(|weights| u32::from_le_bytes(weights.map(|w| w as u8)));
    let length = u32::from(strand.length) | u32::from(strand.shade) << 16 | u32::from(strand.is_short) << 24;
    [a, b, c, near, far, length]
}
