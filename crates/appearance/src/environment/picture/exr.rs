//! The `OpenEXR` picture format, read block by block: memory holds one block and the reduced picture.

use std::io::{BufRead, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::reader::{ChunksReader as _, Reader};
use exr::compression::Compression;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::f16;

use super::{NewReducer, Reducer};
use crate::environment::error::{MAX_BLOCK_BYTES, MAX_HEIGHT, MAX_WIDTH, Problem};

/// What a file must have.
const WANTED: &str = "a flat layer with the channels R, G and B at full resolution";

/// The sizes among the eight-byte numbers at the start of a DWA block. Before them is its version, after them the coder
/// of its coefficients.
const DWA_SIZES: std::ops::Range<usize> = 1..10;

/// Reads the first flat layer with the channels R, G and B.
pub(super) fn read(content: impl BufRead + Seek, reducer: NewReducer<'_>) -> Result<Reducer, Problem> {
    // Files may come from anywhere, and assertions of the decoder may fail on damaged ones.
    catch_unwind(AssertUnwindSafe(|| read_blocks(content, reducer))).unwrap_or_else(|_| {
        Err(Problem::Damaged { found: "pixel data that cannot be decoded".to_owned(), wanted: WANTED })
    })
}

fn read_blocks(mut content: impl BufRead + Seek, reducer: NewReducer<'_>) -> Result<Reducer, Problem> {
    if is_deep(content.fill_buf()?) {
        return Err(deep());
    }
    let reader = Reader::read_from_buffered(content, false).map_err(|error| problem(error, "the header"))?;
    for header in reader.headers() {
        check_memory(header)?;
    }
    let layers = reader.headers().iter().enumerate();
    let found = layers.filter(|(_, header)| !header.deep).find_map(|(at, h)| Some((at, Colours::find(h)?)));
    let Some((layer, colours)) = found else { return Err(no_colours(reader.headers())) };

    let header = &reader.headers()[layer];
    let window = header.shared_attributes.display_window;
    let mut reducer = reducer(window.size.width() as u64, window.size.height() as u64)?;
    let place = |data: i32, display: i32| i64::from(data) - i64::from(display);
    let corner = [
        place(header.own_attributes.layer_position.x(), window.position.x()),
        place(header.own_attributes.layer_position.y(), window.position.y()),
    ];

    let mut chunks = reader.all_chunks(false).map_err(|error| problem(error, "the table of blocks"))?;
    let meta = chunks.meta_data().clone();
    let total = chunks.expected_chunk_count();
    for at in 0..total {
        let progress = || format!("block {} of {total}", at + 1);
        let Some(chunk) = chunks.read_next_chunk() else { break };
        let chunk = chunk.map_err(|error| problem(error, &progress()))?;
        if chunk.layer_index == layer && is_full_size(&chunk) {
            let block = decompress(chunk, &meta).map_err(|error| problem(error, &progress()))?;
            add(&mut reducer, &colours, &block, corner);
        }
    }
    Ok(reducer)
}

/// Whether the flags of the file say that it holds deep data. They are asked before the decoder is, which refuses
/// such a file without saying so in a way that a program can read.
fn is_deep(start: &[u8]) -> bool {
    start.get(5).is_some_and(|flags| flags & 0b1000 != 0)
}

fn deep() -> Problem {
    Problem::Variant { found: "deep data".to_owned(), wanted: WANTED }
}

/// Refuses what would need much memory: blocks of every layer are read, if only to skip them.
fn check_memory(header: &Header) -> Result<(), Problem> {
    let size = [header.layer_size.width() as u64, header.layer_size.height() as u64];
    if size[0] > u64::from(MAX_WIDTH) || size[1] > u64::from(MAX_HEIGHT) {
        return Err(Problem::TooLarge { width: size[0], height: size[1] });
    }
    let lines = header.compression.scan_lines_per_block() as u64;
    let [width, height] = match header.blocks {
        BlockDescription::ScanLines => [size[0], lines],
        BlockDescription::Tiles(tiles) => [tiles.tile_size.width() as u64, tiles.tile_size.height() as u64],
    };
    let bytes = width.saturating_mul(height).saturating_mul(header.channels.bytes_per_pixel as u64);
    if bytes > MAX_BLOCK_BYTES { Err(Problem::BlockTooLarge(bytes)) } else { Ok(()) }
}

/// Where the colours are in the pixels of a layer.
struct Colours {
    /// Of red, green and blue: bytes of all channels before it, per pixel, and its type.
    channels: [(usize, SampleType); 3],
    bytes_per_pixel: usize,
}

impl Colours {
    fn find(header: &Header) -> Option<Self> {
        let mut channels = [None; 3];
        let mut before = 0;
        for channel in &header.channels.list {
            let colour = ["R", "G", "B"].iter().position(|name| channel.name.eq(name));
            // A channel of fewer samples shifts all after it.
            if channel.sampling != Vec2(1, 1) {
                return None;
            }
            if let Some(colour) = colour {
                channels[colour] = Some((before, channel.sample_type));
            }
            before += channel.sample_type.bytes_per_sample();
        }
        let [r, g, b] = channels;
        Some(Self { channels: [r?, g?, b?], bytes_per_pixel: before })
    }
}

fn no_colours(headers: &[Header]) -> Problem {
    if headers.iter().all(|header| header.deep) {
        return deep();
    }
    let channels = headers.iter().flat_map(|header| &header.channels.list);
    let names: Vec<String> = channels
        .take(12)
        .map(|channel| match channel.sampling {
            Vec2(1, 1) => channel.name.to_string(),
            Vec2(x, y) => format!("{} (every {x} x {y} pixels)", channel.name),
        })
        .collect();
    Problem::Variant { found: format!("the channels {}", names.join(", ")), wanted: WANTED }
}

/// Whether a block belongs to the picture and not to its smaller copies.
fn is_full_size(chunk: &Chunk) -> bool {
    match &chunk.compressed_block {
        CompressedBlock::Tile(tile) => tile.coordinates.level_index == Vec2(0, 0),
        _ => true,
    }
}

fn decompress(chunk: Chunk, meta: &MetaData) -> Result<UncompressedBlock, Error> {
    if asks_for_too_much(&chunk, &meta.headers[chunk.layer_index])? {
        return Err(Error::Invalid("sizes in a DWA block far above its pixels".into()));
    }
    UncompressedBlock::decompress_chunk(chunk, meta, false)
}

/// Whether a DWA block announces more data than its pixels can have.
///
/// The decoder (exr 1.74.2) allocates what such a block announces, and memory that is not there ends the program. The
/// other compressions are bounded by the size of the block.
fn asks_for_too_much(chunk: &Chunk, header: &Header) -> Result<bool, Error> {
    if !matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        return Ok(false);
    }
    let content = match &chunk.compressed_block {
        CompressedBlock::Tile(tile) => &tile.compressed_pixels_le,
        CompressedBlock::ScanLine(lines) => &lines.compressed_pixels_le,
        _ => return Ok(false),
    };
    let indices = header.get_block_data_indices(&chunk.compressed_block)?;
    let area = header.get_absolute_block_pixel_coordinates(indices)?.size.area();
    let bytes = area * header.channels.bytes_per_pixel;
    // Stored as it is, without sizes.
    if content.len() == bytes {
        return Ok(false);
    }
    // Coefficients come in squares of 8 x 8, so a block one pixel wide has up to 4 per byte of its pixels; the constant
    // is for blocks smaller than a square.
    let limit = 4 * bytes as u64 + (1 << 16);
    let sizes = content.chunks_exact(8).take(DWA_SIZES.end).skip(DWA_SIZES.start);
    Ok(sizes.filter_map(|size| size.try_into().ok()).any(|size| u64::from_le_bytes(size) > limit))
}

/// Adds the rows of a block; `corner` is that of the data in the display window.
fn add(reducer: &mut Reducer, colours: &Colours, block: &UncompressedBlock, corner: [i64; 2]) {
    let width = block.index.pixel_size.width();
    let x = block.index.pixel_position.x() as i64 + corner[0];
    // The left part of the block may lie outside of the window.
    let skipped = usize::try_from(-x).unwrap_or(0).min(width);
    let rows = block.data.chunks_exact((colours.bytes_per_pixel * width).max(1));
    for (row, bytes) in rows.take(block.index.pixel_size.height()).enumerate() {
        let Ok(y) = usize::try_from(block.index.pixel_position.y() as i64 + corner[1] + row as i64) else {
            continue;
        };
        // Inside of a row, each channel has its samples together.
        let value = |(before, kind): (usize, SampleType), at: usize| {
            sample(bytes, before * width + at * kind.bytes_per_sample(), kind)
        };
        let pixels = (skipped..width).map(|at| colours.channels.map(|channel| value(channel, at)));
        reducer.add(x.max(0) as usize, y, pixels);
    }
}

/// One sample, in the byte order of the machine.
fn sample(bytes: &[u8], at: usize, kind: SampleType) -> f32 {
    let four = || bytes.get(at..at + 4).and_then(|four| four.try_into().ok()).unwrap_or([0; 4]);
    match kind {
        SampleType::F16 => {
            let two = bytes.get(at..at + 2).and_then(|two| two.try_into().ok()).unwrap_or([0; 2]);
            f16::from_ne_bytes(two).to_f32()
        }
        SampleType::F32 => f32::from_ne_bytes(four()),
        SampleType::U32 => u32::from_ne_bytes(four()) as f32,
    }
}

/// An error of the decoder, met at `place`.
fn problem(error: Error, place: &str) -> Problem {
    match error {
        Error::Io(error) => Problem::Io(error),
        Error::NotSupported(what) if what.contains("deep") => deep(),
        Error::NotSupported(what) => Problem::Variant { found: format!("{what} in {place}"), wanted: WANTED },
        // The decoder's words for an early end of the file.
        Error::Invalid(what) if what.contains("missing bytes") => {
            Problem::CutShort { found: format!("the file's end in {place}"), wanted: "all blocks".to_owned() }
        }
        other => Problem::Damaged { found: format!("{other} in {place}"), wanted: WANTED },
    }
}
