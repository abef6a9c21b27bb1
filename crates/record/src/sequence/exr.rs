//! `OpenEXR` files: linear light as half floats, with depth and transmittance.

use std::io::Cursor;

use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, SmallVec, Vec2, WritableImage, f16,
};

use crate::FrameRate;

/// A rendered image before tone mapping, rows from the top. Each slice has one item per pixel.
#[derive(Clone, Copy, Debug)]
pub struct FrameLayers<'a> {
    /// Linear red, green and blue in the primaries of sRGB, premultiplied by alpha, and alpha.
    pub light: &'a [[f32; 4]],
    /// Distance of the nearest surface along the camera's axis, in metres.
    pub depth: &'a [f32],
    /// Transmittance of the key light to the hair, 0 to 1.
    pub transmittance: &'a [f32],
}

/// The channels of the file.
#[derive(Debug, Default)]
pub(super) struct Planes {
    halves: [Vec<f16>; 4],
    depth: Vec<f32>,
    transmittance: Vec<f16>,
}

/// The largest half float. Brighter light is clamped to it.
const MAX: f32 = 65_504.0;

impl Planes {
    pub fn new(layers: &FrameLayers) -> Self {
        let half = |v: f32| f16::from_f32(if v.is_nan() { 0.0 } else { v.clamp(-MAX, MAX) });
        let plane = |c: usize| layers.light.iter().map(|pixel| half(pixel[c])).collect();
        Self {
            halves: [plane(0), plane(1), plane(2), plane(3)],
            depth: layers.depth.to_vec(),
            transmittance: layers.transmittance.iter().map(|&t| half(t)).collect(),
        }
    }
}

/// The metadata of the file.
#[derive(Clone, Debug)]
pub(super) struct FrameInfo {
    pub rate: FrameRate,
    pub number: u64,
    /// How the frame was rendered.
    pub comments: String,
}

/// Encodes a frame losslessly, in rows from the top. The same frame gives the same bytes.
///
/// # Errors
/// Errors of the encoder, such as an unsupported size.
pub(super) fn encode(
    planes: Planes,
    [width, height]: [u32; 2],
    info: &FrameInfo,
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
        comments: Text::new_or_none(&info.comments),
        software_name: Text::new_or_none(concat!("Lovelock ", env!("CARGO_PKG_VERSION"))),
        ..LayerAttributes::default()
    };
    attributes.frames_per_second = i32::try_from(info.rate.num).ok().map(|frames| (frames, info.rate.den));
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = Vec2(width as usize, height as usize);
    let layer = Layer::new(size, attributes, encoding, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    // The primaries of sRGB and Rec. 709.
    image.attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    });
    // Only one custom attribute: the library writes several in an order that differs from run to run.
    let number = i32::try_from(info.number).unwrap_or(i32::MAX);
    image.attributes.other.insert(Text::from("frame"), AttributeValue::I32(number));
    let mut file = Cursor::new(std::mem::take(out));
    file.get_mut().clear();
    // Frames are already encoded in parallel.
    let written = image.write().non_parallel().to_buffered(&mut file);
    *out = file.into_inner();
    written
}
