//! Writes strands as a binary PLY file.

use std::fmt::Write as _;

use super::METRES_Y_UP;
use crate::io::bytes::triple_bytes;
use crate::io::file::HairFile;

/// Writes metres, Y up: the points with their colours and widths, the segments as edges, which programs that know no strands show, and the
/// number of segments of each strand.
pub(super) fn write(hair: &HairFile) -> Result<Vec<u8>, String> {
    let mut head = format!("ply\nformat binary_little_endian 1.0\ncomment {METRES_Y_UP}\n");
    let most = hair.first_point.array_windows().map(|[a, b]| b - a).max().unwrap_or_default();
    if most > 65_536 {
        return Err(format!("a strand has {most} points; .ply of strands holds at most 65536 per strand"));
    }
    let mut line = |text: std::fmt::Arguments<'_>| {
        writeln!(head, "{text}").map_err(|_| "the header cannot be written".to_owned())
    };
    line(format_args!(
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z",
        hair.points.len()
    ))?;
    if hair.colours.is_some() {
        line(format_args!("property uchar red\nproperty uchar green\nproperty uchar blue"))?;
    }
    if hair.thickness.is_some() {
        line(format_args!("property float thickness"))?;
    }
    line(format_args!("element strand {}\nproperty ushort nsegs", hair.strands()))?;
    line(format_args!(
        "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header",
        hair.segments()
    ))?;
    let mut out = head.into_bytes();
    for (i, point) in hair.points.iter().enumerate() {
        out.extend(triple_bytes(*point));
        if let Some(colours) = &hair.colours {
            out.extend(colours[i].map(|value| (255.0 * value.clamp(0.0, 1.0)).round() as u8));
        }
        if let Some(widths) = &hair.thickness {
            out.extend(widths[i].to_le_bytes());
        }
    }
    for [a, b] in hair.first_point.array_windows() {
        out.extend(((b - a - 1) as u16).to_le_bytes());
    }
    for &[start, end] in hair.first_point.array_windows() {
        for point in start + 1..end {
            out.extend((point - 1).to_le_bytes());
            out.extend(point.to_le_bytes());
        }
    }
    Ok(out)
}
