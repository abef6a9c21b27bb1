//! Frames as `OpenEXR` files: linear light in half floats with depth and transmittance beside it.

use std::io::Cursor;

use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, SmallVec, Vec2, WritableImage, f16,
};

use crate::FrameRate;

/// A picture as numbers, rows from the top, one item a pixel in each list.
#[derive(Clone, Copy, Debug)]
pub struct FrameLayers<'a> {
    /// Red, green and blue of linear light in the primaries of sRGB, multiplied by alpha; and alpha.
    pub light: &'a [[f32; 4]],
    /// Distance of the nearest surface along the camera's axis, metres.
    pub depth: &'a [f32],
    /// How much of the key light reaches the hair, 0 to 1.
    pub transmittance: &'a [f32],
}

/// The same as the file holds it, in the order of the channels.
#[derive(Debug, Default)]
pub(super) struct Planes {
    halves: [Vec<f16>; 4],
    depth: Vec<f32>,
    transmittance: Vec<f16>,
}

/// The largest half float; what is brighter is as bright.
const MOST: f32 = 65_504.0;

impl Planes {
    pub fn new(layers: &FrameLayers) -> Self {
        let half = |v: f32| f16::from_f32(if v.is_nan() { 0.0 } else { v.clamp(-MOST, MOST) });
        let plane = |c: usize| layers.light.iter().map(|pixel| half(pixel[c])).collect();
        Self {
            halves: [plane(0), plane(1), plane(2), plane(3)],
            depth: layers.depth.to_vec(),
            transmittance: layers.transmittance.iter().map(|&t| half(t)).collect(),
        }
    }
}

/// What the file says of itself beside its pixels.
#[derive(Clone, Debug)]
pub(super) struct Head {
    pub rate: FrameRate,
    pub number: u64,
    /// What drew it, in words.
    pub comments: String,
}

/// Codes a frame: lossless, in rows from the top, the same bytes each time.
///
/// # Errors
/// What the coder says, such as a size that it does not take.
pub(super) fn code(
    planes: Planes,
    [width, height]: [u32; 2],
    head: &Head,
    out: &mut Vec<u8>,
) -> Result<(), exr::error::Error> {
    let Planes { halves: [r, g, b, a], depth, transmittance } = planes;
    let half = |name: &str, samples| AnyChannel::new(name, FlatSamples::F16(samples));
    let channels: SmallVec<[_; 4]> = SmallVec::from_vec(vec![
        half("R", r),
        half("G", g),
        half("B", b),
        half("A", a),
        AnyChannel::new("Z", FlatSamples::F32(depth)),
        half("transmittance.Y", transmittance),
    ]);
    let mut attributes = LayerAttributes {
        comments: Text::new_or_none(&head.comments),
        software_name: Text::new_or_none(concat!("Lovelock ", env!("CARGO_PKG_VERSION"))),
        ..LayerAttributes::default()
    };
    attributes.frames_per_second = i32::try_from(head.rate.num).ok().map(|frames| (frames, head.rate.den));
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = Vec2(width as usize, height as usize);
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    // Those of sRGB and Rec. 709.
    image.attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    });
    // One alone: several of one's own are written in an order that changes from run to run.
    let number = i32::try_from(head.number).unwrap_or(i32::MAX);
    image.attributes.other.insert(Text::from("frame"), AttributeValue::I32(number));
    let mut file = Cursor::new(std::mem::take(out));
    file.get_mut().clear();
    // Frames are coded beside each other already.
    let written = image.write().non_parallel().to_buffered(&mut file);
    *out = file.into_inner();
    written
}
