//! The hierarchy in the memory of the GPU, and the passes that make it.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, read_buffer, wgpu};

use super::super::hierarchy::{LEAF, LEAST, places};
use super::FRAME;
use crate::gpu::{Buffer, GpuShadowInput, fits_device, wgsl};
use crate::{ShadowError, ShadowMethod};

const KEYS: ShaderPart = wgsl!("methods/ray_traced/gpu/", "keys.wgsl");
const SORT: ShaderPart = wgsl!("methods/ray_traced/gpu/", "sort.wgsl");
const LEAVES: ShaderPart = wgsl!("methods/ray_traced/gpu/", "leaves.wgsl");
const JOIN: ShaderPart = wgsl!("methods/ray_traced/gpu/", "join.wgsl");

/// The names of the passes in statistics, with their parts.
const PASSES: [(&str, &[ShaderPart]); 4] = [
    ("shadow/keys", &[FRAME, KEYS]),
    ("shadow/sort", &[SORT]),
    ("shadow/leaves", &[FRAME, LEAVES]),
    ("shadow/join", &[JOIN]),
];

/// Words of a key, of the ends of a segment, and of a node.
const KEY_WORDS: u64 = 2;
const END_WORDS: u64 = 8;
const NODE_WORDS: u64 = 8;

/// Twin of `SortUniform` in sort.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct SortUniform {
    count: u32,
    first_block: u32,
    last_block: u32,
    reach: u32,
}

/// Twin of `LevelUniform` in join.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct LevelUniform {
    nodes: u32,
    unused: [u32; 3],
}

#[derive(Debug)]
pub(super) struct Tree {
    make_keys: Kernel,
    sort_far: Kernel,
    sort_near: Kernel,
    make_leaves: Kernel,
    join: Kernel,
    keys: Buffer,
    ends: Buffer,
    nodes: Buffer,
}

/// Words of keys, ends and nodes for so many places.
fn words(places: u64) -> [u64; 3] {
    [KEY_WORDS * places, END_WORDS * places, NODE_WORDS * (2 * places / LEAF as u64)]
}

/// The steps of the sorting network: blocks of which length, and how far apart the keys of a step are; `None` for all steps within
/// the memory of a workgroup.
fn steps(count: u32) -> Vec<(u32, Option<u32>)> {
    let near = LEAST as u32;
    let mut steps = vec![(near, None)];
    let mut block = 2 * near;
    while block <= count {
        let mut reach = block / 2;
        while reach >= near {
            steps.push((block, Some(reach)));
            reach /= 2;
        }
        steps.push((block, None));
        block *= 2;
    }
    steps
}

impl Tree {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let kernel = |pass: usize, entry| {
            let (name, parts) = PASSES[pass];
            Kernel::new(gpu, name, &ShaderSource::new(parts), entry)
        };
        Ok(Self {
            make_keys: kernel(0, "make_keys")?,
            sort_far: kernel(1, "sort_far")?,
            sort_near: kernel(1, "sort_near")?,
            make_leaves: kernel(2, "make_leaves")?,
            join: kernel(3, "join_boxes")?,
            keys: Buffer::new(gpu, "keys of segments"),
            ends: Buffer::new(gpu, "sorted segments"),
            nodes: Buffer::new(gpu, "boxes"),
        })
    }

    pub fn shaders() -> Vec<(String, ShaderSource)> {
        PASSES.iter().map(|(name, parts)| ((*name).to_owned(), ShaderSource::new(parts))).collect()
    }

    /// The memory for so many segments, bytes.
    pub fn needed_bytes(segments: u32) -> u64 {
        4 * words(places(u64::from(segments))).iter().sum::<u64>()
    }

    /// Makes room for so many segments.
    ///
    /// # Errors
    /// They need more than the limit, or than the device has.
    pub fn make_room(&mut self, gpu: &Gpu, segments: u32, limit_bytes: u64) -> Result<(), ShadowError> {
        let (method, needed_bytes) = (ShadowMethod::RayTraced, Self::needed_bytes(segments));
        if needed_bytes > limit_bytes {
            return Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps: 1 });
        }
        let [keys, ends, nodes] = words(places(u64::from(segments)));
        fits_device(gpu, method, 4 * ends.max(nodes))?;
        self.keys.fit(gpu, keys);
        self.ends.fit(gpu, ends);
        self.nodes.fit(gpu, nodes);
        Ok(())
    }

    /// Encodes making the hierarchy of so many places.
    pub fn build(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        uniform: &wgpu::Buffer,
        (input, places): (&GpuShadowInput, u32),
    ) {
        let run = |commands: &mut Commands,
                   (pass, kernel): (usize, &Kernel),
                   constants: Option<&wgpu::Buffer>,
                   threads: u32| {
            let mut resources = vec![
                (0, uniform.as_entire_binding()),
                (1, input.strands.points.as_entire_binding()),
                (2, input.strands.segments.as_entire_binding()),
                (3, self.keys.raw().as_entire_binding()),
                (4, self.ends.raw().as_entire_binding()),
                (5, self.nodes.raw().as_entire_binding()),
            ];
            resources.extend(constants.map(|buffer| (7, buffer.as_entire_binding())));
            let group = kernel.bind(gpu, &resources);
            commands.compute(PASSES[pass].0, |pass| kernel.run(pass, &group, u64::from(threads)));
        };
        run(commands, (0, &self.make_keys), None, places);
        for (block, reach) in steps(places) {
            let first_block = if block == LEAST as u32 { 2 } else { block };
            let uniform =
                SortUniform { count: places, first_block, last_block: block, reach: reach.unwrap_or(0) };
            let constants = commands.constants("sorting", &uniform);
            let kernel = if reach.is_some() { &self.sort_far } else { &self.sort_near };
            run(commands, (1, kernel), Some(&constants), places / 2);
        }
        let mut nodes = places / LEAF as u32;
        run(commands, (2, &self.make_leaves), None, nodes);
        while nodes > 1 {
            nodes /= 2;
            let uniform = LevelUniform { nodes, unused: [0; 3] };
            let constants = commands.constants("level", &uniform);
            run(commands, (3, &self.join), Some(&constants), nodes);
        }
    }

    /// The bindings of segments and nodes.
    pub fn resources(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(4, self.ends.raw().as_entire_binding()), (5, self.nodes.raw().as_entire_binding())]
    }

    pub fn memory_bytes(&self) -> u64 {
        self.ends.bytes() + self.nodes.bytes()
    }

    pub fn scratch_bytes(&self) -> u64 {
        self.keys.bytes()
    }

    /// Frees its memory.
    pub fn free(&mut self, gpu: &Gpu) {
        for buffer in [&mut self.keys, &mut self.ends, &mut self.nodes] {
            buffer.fit(gpu, 0);
        }
    }

    /// The words of the sorted segments and of the boxes.
    pub fn words(&self, gpu: &Gpu, places: u32) -> Result<Vec<u32>, GpuError> {
        let [_, ends, nodes] = words(u64::from(places));
        let mut all = vec![0; ends as usize];
        read_buffer(gpu, self.ends.raw(), &mut all)?;
        let mut boxes = vec![0; nodes as usize];
        read_buffer(gpu, self.nodes.raw(), &mut boxes)?;
        // Nothing lies at 0.
        all.extend(boxes.get(NODE_WORDS as usize..).unwrap_or_default());
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The network as the shaders run it.
    fn sorted(mut keys: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
        let count = keys.len() as u32;
        let mut compare = |low: u32, reach: u32, block: u32| {
            let (a, b) = (keys[low as usize], keys[(low + reach) as usize]);
            if (b < a) == (low & block == 0) {
                keys.swap(low as usize, (low + reach) as usize);
            }
        };
        for (last, reach) in steps(count) {
            let mut block = if last == LEAST as u32 { 2 } else { last };
            while block <= last {
                let mut at = reach.unwrap_or((block / 2).min(64));
                loop {
                    for i in 0..count / 2 {
                        compare((i / at) * 2 * at + i % at, at, block);
                    }
                    at /= 2;
                    if reach.is_some() || at == 0 {
                        break;
                    }
                }
                block *= 2;
            }
        }
        keys
    }

    #[test]
    fn the_network_sorts() {
        let mut random = lovelock_base::random::SplitMix64::new(3);
        for count in [128, 256, 1024, 4096] {
            let keys: Vec<_> = (0..count).map(|i| ((random.unit() * 300.0) as u32, i)).collect();
            let mut expected = keys.clone();
            expected.sort_unstable();
            assert_eq!(sorted(keys), expected, "{count}");
        }
    }

    #[test]
    fn twins_of_the_numbers_of_the_cpu() {
        assert!(FRAME.text.contains(&format!("const LEAF: u32 = {LEAF}u;")));
        assert!(SORT.text.contains(&format!("array<vec2u, {LEAST}>")));
    }
}
