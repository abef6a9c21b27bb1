//! Outline of the field for drawing: contours of the surface in slices, moved with the joints.

use glam::{Affine3A, UVec3, Vec3};

use super::{BodyField, FieldPose, FieldWeights};

/// One end of a line at rest: position, outward direction, and slot of its weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    at: Vec3,
    out: Vec3,
    slot: u16,
}

/// Spacing of the contours in layers of the lattice.
const EVERY: u32 = 3;

impl BodyField {
    /// Appends the surface's outline in world space: the ends of straight lines, metres.
    pub fn lines(&self, pose: &FieldPose, lines: &mut Vec<[Vec3; 2]>) {
        let maps: Vec<Affine3A> =
            self.slots.iter().map(|weights| blend(weights, &pose.world_from_rest)).collect();
        let place = |end: &End| {
            maps[usize::from(end.slot)].transform_point3(end.at + end.out * pose.lift + self.rest_from_head)
        };
        lines.extend(self.outline.iter().map(|ends| [place(&ends[0]), place(&ends[1])]));
    }
}

/// Blends the joints' transforms as in skinning.
pub(crate) fn blend(weights: &FieldWeights, maps: &[Affine3A]) -> Affine3A {
    let mut sum = Affine3A::from_mat3(glam::Mat3::ZERO);
    for (&weight, map) in weights.iter().zip(maps) {
        if weight > 0.0 {
            sum.matrix3 += map.matrix3 * weight;
            sum.translation += map.translation * weight;
        }
    }
    sum
}

/// Contours of every few layers along each axis, by marching squares.
pub(super) fn outline(field: &BodyField) -> Vec<[End; 2]> {
    let lattice = field.distances;
    let mut lines = Vec::new();
    for axis in 0..3 {
        let (u, v) = ([1, 2, 0][axis], [2, 0, 1][axis]);
        for layer in (0..lattice.size[axis]).step_by(EVERY as usize) {
            for j in 0..lattice.size[v] - 1 {
                for i in 0..lattice.size[u] - 1 {
                    let corner = |du: u32, dv: u32| {
                        let mut at = UVec3::ZERO;
                        (at[axis], at[u], at[v]) = (layer, i + du, j + dv);
                        (lattice.low + at.as_vec3() * lattice.spacing, field.distance[lattice.index(at)])
                    };
                    let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    let mut crossings = [Vec3::ZERO; 4];
                    let mut count = 0;
                    for k in 0..4 {
                        let ((a, da), (b, db)) = (corners[k], corners[(k + 1) % 4]);
                        if (da < 0.0) != (db < 0.0) {
                            crossings[count] = a.lerp(b, da / (da - db));
                            count += 1;
                        }
                    }
                    for pair in crossings[..count].chunks_exact(2) {
                        lines.push([end(field, pair[0]), end(field, pair[1])]);
                    }
                }
            }
        }
    }
    lines
}

fn end(field: &BodyField, at: Vec3) -> End {
    let node = ((at - field.nodes.low) / field.nodes.spacing).round().as_uvec3().min(field.nodes.size - 1);
    let slot = field.slot_of_node[field.nodes.index(node)];
    let out = field.sample(at).map_or(Vec3::ZERO, |(_, slope)| slope.normalize_or_zero());
    End { at, out, slot }
}
