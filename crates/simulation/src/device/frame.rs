//! What all guides share in a step, as one list of numbers.

use super::DeviceStep;
use crate::colliders::MovingShape;
use crate::colliders::shape::Shape;
use crate::lanes::Map;
use glam::Vec3;

/// Numbers of the wind: its mean, and per wave the amplitude, the wave vector and the phase.
pub const FRAME_WAVES: usize = 3 + 9 * 7;

/// Where the parts of a frame begin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameOffsets {
    /// The rates of each point of a guide: cohesion, lock friction, drag, hair friction, and the angular frequencies of
    /// stiffness and hold.
    pub rows: u32,
    /// The colliders of each substep: kind (0 none, 1 capsule, 2 ellipsoid), 1 on the head, the corners of the box, the map
    /// from a position to the velocity of the surface, and 15 numbers of the shape.
    pub shapes: u32,
    /// The wind.
    pub wind: u32,
    /// The direction against the wind and the strength of wakes, then the solids: centre, reach, kind and shape.
    pub solids: u32,
    /// Number of solids.
    pub solid_count: u32,
    /// The middle lines of ropes: first point, number of points, cohesion, friction, least radius.
    pub lines: u32,
    /// Number of middle lines.
    pub line_count: u32,
    /// The points of all middle lines: position and velocity.
    pub line_points: u32,
    /// Whether there is any wind.
    pub windy: bool,
}

fn map(out: &mut Vec<f32>, map: &Map) {
    out.extend(map.turn.to_cols_array());
    out.extend(map.shift.to_array());
}

fn shape(out: &mut Vec<f32>, shape: Option<&Shape>) {
    let mut numbers = [0.0; 15];
    let mut next = numbers.iter_mut();
    let mut put = |v: &[f32]| v.iter().zip(next.by_ref()).for_each(|(v, to)| *to = *v);
    match shape {
        None => {}
        Some(&Shape::Capsule { a, axis, inv_axis_squared, lean, radius_a, radius_change }) => {
            for v in [a, axis] {
                put(&v.to_array());
            }
            put(&[inv_axis_squared, lean, radius_a, radius_change]);
        }
        Some(&Shape::Ellipsoid { centre, axes: [x, y, z], radii, .. }) => {
            for v in [centre, x, y, z, radii] {
                put(&v.to_array());
            }
        }
    }
    out.extend(numbers);
}

fn kind(shape: Option<&Shape>) -> f32 {
    match shape {
        None => 0.0,
        Some(Shape::Capsule { .. }) => 1.0,
        Some(Shape::Ellipsoid { .. }) => 2.0,
    }
}

fn collider(out: &mut Vec<f32>, mover: &MovingShape) {
    out.extend([kind(mover.shape.as_ref()), f32::from(u8::from(mover.on_head))]);
    for corner in [mover.min, mover.max] {
        out.extend(corner.to_array());
    }
    map(out, &mover.velocity_at);
    shape(out, mover.shape.as_ref());
}

impl DeviceStep<'_> {
    /// Writes the maps and rates of the step: the map from head space to the working space of the last step (columns, then
    /// the shift), its inverse, the substeps, and the parts that the result locates. A substep is the head's map, its
    /// rotation as a quaternion, and the map from a position to the velocity of a point that moves with the head.
    pub fn write_frame(&self, out: &mut Vec<f32>) -> FrameOffsets {
        let plan = self.plan;
        out.clear();
        for part in [&plan.last_head, &plan.head_from_last] {
            map(out, part);
        }
        for substep in plan.substeps {
            map(out, &substep.head);
            out.extend(substep.head_turn.numbers());
            map(out, &substep.rigid);
        }
        let mut at = FrameOffsets { rows: out.len() as u32, ..FrameOffsets::default() };
        let points = self.points();
        for (i, row) in plan.rows.iter().enumerate() {
            let along = i as f32 / points.saturating_sub(1).max(1) as f32;
            out.extend([row.cohesion, row.lock_friction, row.drag, row.hair_friction]);
            out.extend(plan.bending.frequencies_at(along));
        }
        at.shapes = out.len() as u32;
        for mover in plan.shapes {
            collider(out, mover);
        }
        at.wind = out.len() as u32;
        at.windy = plan.wind.blows();
        plan.wind.write(out);
        at.solids = out.len() as u32;
        at.solid_count = plan.wakes.write(out, |out, centre: Vec3, reach, solid: &Shape| {
            out.extend(centre.to_array());
            out.extend([reach, kind(Some(solid))]);
            shape(out, Some(solid));
        });
        at.lines = out.len() as u32;
        at.line_count = plan.ropes.len() as u32;
        let mut first = 0;
        for line in plan.ropes {
            let (count, [cohesion, friction, least_radius]) = line.numbers();
            out.extend([first as f32, count as f32, cohesion, friction, least_radius]);
            first += count;
        }
        at.line_points = out.len() as u32;
        for line in plan.ropes {
            line.write_points(out);
        }
        at
    }
}
