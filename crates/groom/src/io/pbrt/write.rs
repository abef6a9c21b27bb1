//! Writes hair as curves of pbrt.

use std::fmt::Write as _;

use glam::Vec3;

use crate::io::file::HairFile;

/// Width of hair that states none, metres.
const WIDTH: f32 = 1e-4;

/// One cubic Bézier curve per strand, in metres with Y up. Every segment is a span with its inner control points at
/// thirds, so the curve is the polyline. A curve has a width at its root and at its tip; colours are left to the scene's
/// material.
pub(super) fn write(hair: &HairFile) -> Result<Vec<u8>, String> {
    let mut out = "# Hair, in metres with Y up. Put a material before it.\n".to_owned();
    let failed = |_| "a number cannot be written".to_owned();
    let usual = hair.default_thickness.filter(|width| *width > 0.0).unwrap_or(WIDTH);
    for (strand, [start, end]) in hair.first_point.array_windows().enumerate() {
        let width = |at: u32| hair.thickness.as_ref().map_or(usual, |widths| widths[at as usize]);
        write!(
            out,
            "Shape \"curve\" \"string type\" \"cylinder\" \"float width0\" {} \"float width1\" {} \"point3 P\" [",
            width(*start),
            width(*end - 1)
        )
        .map_err(failed)?;
        let points = hair.strand(strand);
        let mut put = |p: Vec3| write!(out, " {} {} {}", p.x, p.y, p.z).map_err(failed);
        put(points[0])?;
        for [a, b] in points.array_windows() {
            put(a.lerp(*b, 1.0 / 3.0))?;
            put(a.lerp(*b, 2.0 / 3.0))?;
            put(*b)?;
        }
        out.push_str(" ]\n");
    }
    Ok(out.into_bytes())
}
