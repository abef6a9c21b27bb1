//! The surface that hair curves are attached to, as in Blender: each root has coordinates in the texture of a mesh of the same file.
//!
//! A root lies where these coordinates are on the mesh. Curves that were exported beside their surface, for example by another transform, are
//! moved there, each as a whole.

use glam::{DMat4, Vec2, Vec3};
use lovelock_base::words::counted;
use lovelock_usd::Value;

use super::stage::Stage;
use crate::io::HairFileError;
use crate::io::file::{Bounds, RawHair};

/// The most meshes, triangles, and triangles in all cells that are looked at.
const MOST_MESHES: usize = 64;
const MOST_TRIANGLES: usize = 1 << 21;
const MOST_ENTRIES: usize = 1 << 23;
/// Cells along each side of the texture.
const CELLS: usize = 128;
/// Roots by which a mesh is judged.
const JUDGED: usize = 2048;
/// The part of the roots that must lie on the mesh, and their greatest mean distance from it, as a fraction of the size of all roots: beyond it,
/// the curves belong to another surface.
const FOUND: f32 = 0.9;
const FAR: f32 = 0.2;
/// Roots closer than this to their place stay, as a fraction of the size of all roots.
const NEAR: f32 = 1e-4;
/// Coordinates of a mesh's texture.
const COORDINATES: [&str; 4] = ["primvars:st", "primvars:UVMap", "primvars:uv", "primvars:map1"];

/// Triangles of a mesh, found by their place in the texture.
struct Surface {
    triangles: Vec<([Vec2; 3], [Vec3; 3])>,
    /// Triangles of each cell are `inside[first[cell]..first[cell + 1]]`.
    first: Vec<u32>,
    inside: Vec<u32>,
}

/// Moves strands so that their roots lie where their coordinates say, if a mesh of the stage has these coordinates.
pub(super) fn attach(
    layer: &mut Stage<'_>,
    metres_from_stage: DMat4,
    raw: &mut RawHair,
) -> Result<(), HairFileError> {
    let strands = raw.point_counts.len();
    if raw.marks.root_uvs.len() != strands {
        return Ok(());
    }
    let ends =
        raw.point_counts.iter().scan(0, |end, &count| Some(std::mem::replace(end, *end + count as usize)));
    // A strand without points has no root.
    let roots: Vec<(usize, usize)> = ends
        .zip(0..strands)
        .filter(|&(first, strand)| raw.point_counts[strand] > 0 && raw.points[first].is_finite())
        .collect();
    let mut bounds = Bounds::EMPTY;
    for &(first, _) in &roots {
        bounds.include(raw.points[first]);
    }
    let size = bounds.size().max_element();
    let mut best: Option<(f32, String, Surface)> = None;
    for mesh in layer.meshes()?.into_iter().take(MOST_MESHES) {
        let to_metres = metres_from_stage * layer.transform(mesh)?;
        let Some(surface) = Surface::read(layer, mesh, to_metres)? else { continue };
        let judged = roots.iter().step_by(roots.len().div_ceil(JUDGED).max(1));
        let (mut seen, mut found, mut sum) = (0, 0, 0.0);
        for &(first, strand) in judged {
            seen += 1;
            if let Some(place) = surface.place(raw.marks.root_uvs[strand], raw.points[first]) {
                found += 1;
                sum += place.distance(raw.points[first]);
            }
        }
        let mean = sum / found as f32;
        let fits = found as f32 >= FOUND * seen as f32 && mean <= FAR * size;
        if fits && best.as_ref().is_none_or(|(least, ..)| mean < *least) {
            best = Some((mean, layer.path(mesh), surface));
        }
    }
    let Some((_, path, surface)) = best else { return Ok(()) };
    let (mut moved, mut farthest) = (0, 0.0_f32);
    for (first, strand) in roots {
        let Some(place) = surface.place(raw.marks.root_uvs[strand], raw.points[first]) else { continue };
        let shift = place - raw.points[first];
        if shift.length() > NEAR * size && shift.length() <= 2.0 * FAR * size {
            raw.points[first..first + raw.point_counts[strand] as usize]
                .iter_mut()
                .for_each(|point| *point += shift);
            (moved, farthest) = (moved + 1, farthest.max(shift.length()));
        }
    }
    raw.notes.push(if moved == 0 {
        format!("The roots lie on {path}, where their coordinates are.")
    } else {
        let roots = counted(moved, "root was", "roots were");
        format!(
            "{roots} moved by up to {:.1} mm to where their coordinates are on {path}.",
            1000.0 * farthest
        )
    });
    Ok(())
}

impl Surface {
    /// The triangles of a mesh in metres; `None` for a mesh without coordinates, or with too many triangles.
    fn read(layer: &mut Stage<'_>, mesh: usize, to_metres: DMat4) -> Result<Option<Self>, HairFileError> {
        let mut list = |name: &str| layer.attribute(mesh, name, 8 * MOST_TRIANGLES);
        let mut coordinates = None;
        for name in COORDINATES {
            if coordinates.is_none()
                && let Some(values) = list(name)?
            {
                coordinates =
                    Some((values.into_vectors(), list(&format!("{name}:indices"))?.map(Value::into_ints)));
            }
        }
        let Some((values, indices)) = coordinates else { return Ok(None) };
        let points = list("points")?.map_or_else(Vec::new, Value::into_vectors);
        let counts = list("faceVertexCounts")?.map_or_else(Vec::new, Value::into_ints);
        let corners = list("faceVertexIndices")?.map_or_else(Vec::new, Value::into_ints);
        let picked = |at: usize| match &indices {
            None => values.get(at),
            Some(indices) => values.get(usize::try_from(*indices.get(at)?).ok()?),
        };
        let given = indices.as_ref().map_or(values.len(), Vec::len);
        let corner = |at: usize| -> Option<(Vec2, Vec3)> {
            let vertex = usize::try_from(*corners.get(at)?).ok()?;
            // One for each corner of a face, or one for each vertex.
            let uv = picked(if given == corners.len() { at } else { vertex })?.truncate();
            let place = to_metres.transform_point3(points.get(vertex)?.as_dvec3()).as_vec3();
            (uv.is_finite() && place.is_finite()).then_some((uv, place))
        };
        let mut triangles = Vec::new();
        let mut start = 0_usize;
        for &count in &counts {
            let count = usize::try_from(count).unwrap_or_default();
            for k in 2..count.min(corners.len().saturating_sub(start)) {
                if let (Some(a), Some(b), Some(c)) = (corner(start), corner(start + k - 1), corner(start + k))
                {
                    triangles.push(([a.0, b.0, c.0], [a.1, b.1, c.1]));
                }
            }
            start = start.saturating_add(count);
            if triangles.len() > MOST_TRIANGLES {
                return Ok(None);
            }
        }
        Ok(Self::of(triangles))
    }

    fn of(triangles: Vec<([Vec2; 3], [Vec3; 3])>) -> Option<Self> {
        let mut first = vec![0_u32; CELLS * CELLS + 1];
        let mut entries = 0;
        for (uv, _) in &triangles {
            for cell in cells(uv) {
                first[cell + 1] += 1;
                entries += 1;
            }
            if entries > MOST_ENTRIES {
                return None;
            }
        }
        for cell in 0..CELLS * CELLS {
            first[cell + 1] += first[cell];
        }
        let (mut inside, mut next) = (vec![0; entries], first.clone());
        for ((uv, _), triangle) in triangles.iter().zip(0_u32..) {
            for cell in cells(uv) {
                inside[next[cell] as usize] = triangle;
                next[cell] += 1;
            }
        }
        (!triangles.is_empty()).then_some(Self { triangles, first, inside })
    }

    /// The point with these coordinates; of several, the nearest one to a root.
    fn place(&self, uv: [f32; 2], root: Vec3) -> Option<Vec3> {
        let uv = Vec2::from(uv);
        if !uv.is_finite() {
            return None;
        }
        let cell = row(uv.y) * CELLS + row(uv.x);
        let candidates = &self.inside[self.first[cell] as usize..self.first[cell + 1] as usize];
        let places = candidates.iter().filter_map(|&triangle| {
            let ([a, b, c], [p, q, r]) = self.triangles[triangle as usize];
            let area = (b - a).perp_dot(c - a);
            let (v, w) = ((uv - a).perp_dot(c - a) / area, (b - a).perp_dot(uv - a) / area);
            let is_inside = v >= -1e-4 && w >= -1e-4 && v + w <= 1.0 + 1e-4;
            is_inside.then(|| p + v * (q - p) + w * (r - p))
        });
        places.min_by(|a, b| a.distance_squared(root).total_cmp(&b.distance_squared(root)))
    }
}

/// The row of cells of a coordinate. Those outside of the texture belong to its edge.
fn row(coordinate: f32) -> usize {
    ((coordinate * CELLS as f32).max(0.0) as usize).min(CELLS - 1)
}

/// The cells that a triangle may touch.
fn cells(uv: &[Vec2; 3]) -> impl Iterator<Item = usize> + use<> {
    let (low, high) = (uv[0].min(uv[1]).min(uv[2]), uv[0].max(uv[1]).max(uv[2]));
    let (left, right) = (row(low.x), row(high.x));
    (row(low.y)..=row(high.y)).flat_map(move |y| (left..=right).map(move |x| y * CELLS + x))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::load_hair_bytes;

    /// Strands over a plane from (0, 0) to (0.2, 0.2), whose coordinates are those of the plane, moved by `x` and `y`.
    fn stage(x: f32, y: f32, mesh: &str) -> String {
        let roots: Vec<[f32; 2]> =
            (0..100).map(|i| [0.05 + 0.1 * (i % 10) as f32, 0.05 + 0.1 * (i / 10) as f32]).collect();
        let point = |[u, v]: &[f32; 2], out: f32| format!("({}, {}, {})", 0.2 * u + x, y + out, 0.2 * v);
        let points: Vec<String> = roots.iter().flat_map(|uv| [point(uv, 0.0), point(uv, 0.1)]).collect();
        let uvs: Vec<String> = roots.iter().map(|[u, v]| format!("({u}, {v})")).collect();
        format!(
            "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\n{mesh}def BasisCurves \"a\"\n{{\nuniform token type = \"linear\"\n\
             int[] curveVertexCounts = [{}]\npoint3f[] points = [{}]\n\
             texCoord2f[] primvars:surface_uv_coordinate = [{}] (\n interpolation = \"uniform\"\n)\n}}\n",
            vec!["2"; 100].join(", "),
            points.join(", "),
            uvs.join(", ")
        )
    }

    const PLANE: &str = "def Mesh \"head\"\n{\nint[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2, 3]\n\
        point3f[] points = [(0, 0, 0), (0.2, 0, 0), (0.2, 0, 0.2), (0, 0, 0.2)]\n\
        texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (\n interpolation = \"faceVarying\"\n)\n}\n";

    #[test]
    fn roots_lie_where_their_coordinates_are_on_the_surface() {
        let hair = |x, y, mesh: &str| load_hair_bytes("a.usda", stage(x, y, mesh).as_bytes()).expect("hair");
        let still = hair(0.0, 0.0, PLANE);
        assert!(still.notes.iter().any(|note| note.contains("The roots lie on /head")), "{:?}", still.notes);
        let moved = hair(0.01, 0.02, PLANE);
        assert!(
            moved.notes.iter().any(|note| note.contains("100 roots were moved by up to 22.4 mm")),
            "{:?}",
            moved.notes
        );
        let off = moved.points.iter().zip(&still.points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off < 1e-6, "{off}");
        // Negative controls: no surface, one without coordinates, and one that is far away.
        let (without, shifted) = (hair(0.01, 0.02, ""), still.points[0] + Vec3::new(0.01, 0.02, 0.0));
        assert!(without.points[0].distance(shifted) < 1e-6);
        let plain = hair(0.01, 0.02, &PLANE.replace("primvars:st", "primvars:other"));
        assert!(plain.points[0].distance(shifted) < 1e-6);
        let far = hair(3.0, 0.0, PLANE);
        assert!(
            far.points[0].x > 3.0 && far.notes.iter().all(|note| !note.contains("/head")),
            "{:?}",
            far.notes
        );
    }
}
