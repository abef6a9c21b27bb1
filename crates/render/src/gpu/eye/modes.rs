//! The passes of each transparency mode.

use lovelock_gpu::ShaderPart;

use super::part;
use crate::Transparency;

/// The result of the fragments of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gpu) enum HairOutput {
    /// Their light, blended by this mode.
    Blended(Transparency),
    /// The depth of the nearest fragment; its bits are in red and green.
    NearestDepth,
}

/// What the threads of a pass iterate over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    /// Every pixel of every segment: the part defines `take`.
    Fragments,
    /// Every pixel of the band: the part defines `pixel_pass`.
    Pixels,
    /// Every pixel of the band, by cooperating groups of 64, with this entry point of the part.
    Groups(&'static str),
}

/// One pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Its name in statistics, `draw/…`.
    pub name: &'static str,
    pub over: Over,
    pub parts: &'static [ShaderPart],
}

/// One transparency mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// Words per pixel.
    pub words: u32,
    /// Whether it lists fragments.
    pub lists: bool,
    pub passes: &'static [Pass],
}

const OCCUPANCY: ShaderPart = part!("occupancy/record.wgsl");
const WEIGHTED: ShaderPart = part!("weighted/record.wgsl");
const OPAQUE: ShaderPart = part!("opaque/record.wgsl");
const SAMPLES: ShaderPart = part!("opaque/samples.wgsl");
const LISTS: ShaderPart = part!("lists/record.wgsl");
const BY_DEPTH: ShaderPart = part!("lists/by_depth.wgsl");
const BY_SEGMENT: ShaderPart = part!("lists/by_segment.wgsl");

const fn fragments(name: &'static str, parts: &'static [ShaderPart]) -> Pass {
    Pass { name, over: Over::Fragments, parts }
}

const fn resolve(parts: &'static [ShaderPart]) -> Pass {
    Pass { name: "draw/resolve", over: Over::Pixels, parts }
}

const COUNT: Pass = fragments("draw/count", &[LISTS, part!("lists/count.wgsl")]);
const ALLOCATE: Pass = Pass {
    name: "draw/allocate",
    over: Over::Groups("allocate"),
    parts: &[LISTS, part!("lists/allocate.wgsl")],
};
const BLEND: Pass =
    Pass { name: "draw/sort-and-blend", over: Over::Pixels, parts: &[LISTS, part!("lists/resolve.wgsl")] };

const OPAQUE_MODE: Mode = Mode {
    words: 8,
    lists: false,
    passes: &[
        fragments("draw/nearest", &[OPAQUE, SAMPLES, part!("opaque/depth.wgsl")]),
        fragments("draw/color", &[OPAQUE, SAMPLES, part!("opaque/color.wgsl")]),
        resolve(&[OPAQUE, part!("opaque/resolve.wgsl")]),
    ],
};

const WEIGHTED_MODE: Mode = Mode {
    words: 5,
    lists: false,
    passes: &[
        fragments("draw/sums", &[WEIGHTED, part!("weighted/sums.wgsl")]),
        resolve(&[WEIGHTED, part!("weighted/resolve.wgsl")]),
    ],
};

const OCCUPANCY_MODE: Mode = Mode {
    words: 18,
    lists: false,
    passes: &[
        fragments("draw/range", &[OCCUPANCY, part!("occupancy/range.wgsl")]),
        fragments("draw/occupancy", &[OCCUPANCY, part!("occupancy/bits.wgsl")]),
        Pass {
            name: "draw/sum-slabs",
            over: Over::Pixels,
            parts: &[OCCUPANCY, part!("occupancy/sums.wgsl")],
        },
        fragments("draw/light", &[OCCUPANCY, part!("occupancy/light.wgsl")]),
        resolve(&[OCCUPANCY, part!("occupancy/resolve.wgsl")]),
    ],
};

const SORTED_MODE: Mode = Mode {
    words: 3,
    lists: true,
    passes: &[
        COUNT,
        ALLOCATE,
        fragments("draw/scatter", &[LISTS, BY_SEGMENT, part!("lists/scatter.wgsl")]),
        BLEND,
    ],
};

const EXACT_MODE: Mode = Mode {
    words: 3,
    lists: true,
    passes: &[
        COUNT,
        ALLOCATE,
        fragments("draw/scatter", &[LISTS, BY_DEPTH, part!("lists/scatter.wgsl")]),
        BLEND,
    ],
};

/// The nearest depth, for the layers of a picture.
const NEAR_MODE: Mode = Mode {
    words: 1,
    lists: false,
    passes: &[
        fragments("draw/nearest-depth", &[part!("near/depth.wgsl")]),
        resolve(&[part!("near/resolve.wgsl")]),
    ],
};

impl Mode {
    pub const fn of(drawn: HairOutput) -> &'static Self {
        match drawn {
            HairOutput::NearestDepth => &NEAR_MODE,
            HairOutput::Blended(transparency) => match transparency {
                Transparency::Opaque => &OPAQUE_MODE,
                Transparency::WeightedAverage => &WEIGHTED_MODE,
                Transparency::OccupancyOrder => &OCCUPANCY_MODE,
                Transparency::Sorted => &SORTED_MODE,
                Transparency::Exact => &EXACT_MODE,
            },
        }
    }
}
