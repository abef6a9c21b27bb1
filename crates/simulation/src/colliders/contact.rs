//! Follow the leader around obstacles: the placement pass, which gives every link its exact length and keeps
//! every point outside every collider.

use glam::Vec3;

use super::MovingShape;
use super::boxes::{Boxes, bounds};
use super::field::{FieldRow, MovingField, PlaneRow};
use crate::SimulationSettings;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, choose, direction_or, greater, lesser, put};
use crate::motion::Substep;

/// The rules for contacts in one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRules {
    /// Distance that hair keeps from surfaces, metres.
    pub(crate) margin: f32,
    /// Fraction of its rest height that a point keeps above the head's colliders.
    pub(crate) layering: f32,
    /// Friction coefficient of the head.
    pub(crate) skin_friction: f32,
    /// Friction coefficient of the rest of the body.
    pub(crate) cloth_friction: f32,
    /// Length of the substep, seconds.
    pub(crate) h: f32,
}

/// Radius of the sphere that approximates the field's surface at a contact, metres: nearly a plane.
const CONTACT_RADIUS: f32 = 1.0;

/// Height above the head up to which layers keep their order, metres.
pub(crate) const LAYER_HEIGHT: f32 = 0.025;

/// Subtracted from a point's own rest clearance, so that rounding does not create a contact, metres.
const SLACK: f32 = 1e-4;

/// Iterations over the colliders of a point; the later ones resolve conflicts between the push-outs of the
/// earlier.
const ITERATIONS: usize = 4;

/// From this iteration on, a point that is still pushed lies between two colliders. Margin and layering are
/// dropped there, so that the surfaces themselves are not violated.
const BARE_FROM: usize = 2;

/// After the first iteration, smaller penetrations than this are left, metres.
const TOLERANCE: f32 = 1e-5;

/// The constants of contacts by name, for other devices.
pub(super) const CONSTANTS: [(&str, f64); 8] = [
    ("CONTACT_RADIUS", CONTACT_RADIUS as f64),
    ("LAYER_HEIGHT", LAYER_HEIGHT as f64),
    ("SLACK", SLACK as f64),
    ("ITERATIONS", ITERATIONS as f64),
    ("BARE_FROM", BARE_FROM as f64),
    ("TOLERANCE", TOLERANCE as f64),
    ("EXIT_SLOPE", EXIT_SLOPE as f64),
    ("LEAST_GUESSED_DEPTH", LEAST_GUESSED_DEPTH as f64),
];

impl ContactRules {
    /// The rules that follow from the settings, with a time step of a second.
    pub(crate) fn of(settings: &SimulationSettings) -> Self {
        let SimulationSettings { skin_margin: margin, layering, .. } = *settings;
        let (skin_friction, cloth_friction) = (settings.friction, settings.cloth_friction);
        Self { margin, layering, skin_friction, cloth_friction, h: 1.0 }
    }

    /// The largest distance that any point keeps from a surface, metres.
    pub(crate) fn reach(&self) -> f32 {
        self.margin + self.layering * LAYER_HEIGHT
    }

    /// The same for one collider: layering applies only to the head.
    #[inline(always)]
    fn reach_of(&self, mover: &MovingShape) -> f32 {
        if mover.on_head { self.reach() } else { self.margin }
    }

    /// The friction coefficient of a surface of which the share `head` belongs to the head. Only the first of the
    /// iterations over the colliders of a point rubs.
    #[inline(always)]
    fn friction(&self, head: f32, iteration: usize) -> f32 {
        let both = self.cloth_friction + (self.skin_friction - self.cloth_friction) * head;
        if iteration == 0 { both } else { 0.0 }
    }

    /// The same rules without margin and layering.
    #[inline(always)]
    fn bare(&self) -> Self {
        Self { margin: 0.0, layering: 0.0, ..*self }
    }

    /// The distance to the surface that is allowed in each lane, given its rest distance `rest`.
    #[inline(always)]
    fn allowed(&self, on_head: bool, rest: &Lane) -> Lane {
        let keep = if on_head { self.layering } else { 0.0 };
        let mut out = ZERO;
        for k in 0..LANES {
            let height = lesser(greater(rest[k], 0.0), LAYER_HEIGHT);
            out[k] = lesser(rest[k] - SLACK, self.margin + keep * height);
        }
        out
    }
}

/// The colliders that a block may touch in a substep, and the rest distance of each point to them.
#[derive(Clone, Copy)]
pub(crate) struct Near<'a> {
    pub(crate) shapes: &'a [MovingShape],
    /// Indices of the colliders that are near, in order.
    pub(crate) active: &'a [u32],
    /// The boxes of those.
    pub(crate) boxes: &'a Boxes,
    /// Signed rest distance of point `i` to collider `c` at `c * points + i`.
    pub(crate) rest_distance: &'a [Lane],
    pub(crate) points: usize,
    /// The last point that the scalp carries.
    pub(crate) carried: usize,
    /// How much deeper than at rest that point is inside each of the active colliders, metres; see
    /// [`root_penetration`].
    pub(crate) root_penetration: &'a [Lane],
    /// Mean link length of each guide, metres.
    pub(crate) link: &'a Lane,
    /// Factors on the friction of each point; empty where all are 1.
    pub(crate) friction: &'a [Lane],
    /// The field of head and shoulders.
    pub(crate) field: Option<NearField<'a>>,
}

/// The field in a substep, and the rest distance of each point to it.
#[derive(Clone, Copy)]
pub(crate) struct NearField<'a> {
    pub(crate) moving: &'a MovingField,
    pub(crate) substep: &'a Substep,
    /// Fraction of the step that has passed.
    pub(crate) passed: f32,
    pub(crate) rest_distance: &'a [Lane],
    /// How much deeper than at rest the last carried point is inside, metres; see [`root_penetration`].
    pub(crate) root_penetration: Lane,
}

impl NearField<'_> {
    #[inline(always)]
    fn row(&self, placed: &Lane3, reach: f32, planes: &mut PlaneRow) -> Option<FieldRow> {
        self.moving.row(placed, self.substep, self.passed, reach, planes)
    }
}

/// How much deeper than at rest points carried by the scalp are inside the field, metres. This happens when
/// neck and shoulders move under roots that the head carries.
#[inline(always)]
pub(crate) fn field_root_penetration(
    carried: &Lane3,
    moving: &MovingField,
    substep: &Substep,
    passed: f32,
    rest: &Lane,
    planes: &mut PlaneRow,
) -> Lane {
    let mut out = ZERO;
    if let Some(row) = moving.row(carried, substep, passed, LAYER_HEIGHT, planes) {
        for k in 0..LANES {
            out[k] = greater(lesser(rest[k], 0.0) - row.distance[k], 0.0);
        }
    }
    out
}

/// Sine of the angle at which a guide leaves a collider that encloses its root.
const EXIT_SLOPE: f32 = 0.5;

/// How much deeper than at rest points carried by the scalp are inside a collider, metres.
///
/// Only the head carries the scalp, so when the head bends over the neck, the body's own shapes may enclose
/// roots. Hair there cannot be outside; it leaves along a slope instead of being bent straight up.
#[inline(always)]
pub(crate) fn root_penetration(carried: &Lane3, mover: &MovingShape, rest: &Lane) -> Lane {
    let mut out = ZERO;
    if let (Some(shape), false) = (mover.shape, mover.on_head) {
        let now = shape.nearest(carried, &ZERO3).distance;
        for k in 0..LANES {
            out[k] = greater(lesser(rest[k], 0.0) - now[k], 0.0);
        }
    }
    out
}

impl Near<'_> {
    /// The factors on the friction of a point.
    #[inline(always)]
    fn friction(&self, point: usize) -> Lane {
        if self.friction.is_empty() { Lane::splat(1.0) } else { self.friction[point] }
    }

    fn rest(&self, collider: u32, point: usize) -> &Lane {
        &self.rest_distance[collider as usize * self.points + point]
    }

    /// The distance to the surface of the `n`-th active collider that is allowed in each lane of a point.
    #[inline(always)]
    fn allowed(&self, n: usize, point: usize, rules: &ContactRules) -> Lane {
        let c = self.active[n];
        let mut out = rules.allowed(self.shapes[c as usize].on_head, self.rest(c, point));
        self.lower_by_slope(&mut out, &self.root_penetration[n], point);
        out
    }

    /// The same for the field. Layering applies only to skin that moves with the head.
    #[inline(always)]
    fn allowed_by_field(
        &self,
        field: &NearField,
        row: &FieldRow,
        point: usize,
        rules: &ContactRules,
    ) -> Lane {
        let rest = &field.rest_distance[point];
        let mut out = ZERO;
        for k in 0..LANES {
            let height = lesser(greater(rest[k], 0.0), LAYER_HEIGHT);
            out[k] = lesser(rest[k] - SLACK, rules.margin + rules.layering * row.head[k] * height);
        }
        self.lower_by_slope(&mut out, &field.root_penetration, point);
        out
    }

    /// Lets the points of a guide whose root is enclosed leave along a slope.
    #[inline(always)]
    fn lower_by_slope(&self, allowed: &mut Lane, root_penetration: &Lane, point: usize) {
        for k in 0..LANES {
            allowed[k] -=
                greater(root_penetration[k] - EXIT_SLOPE * self.link[k] * (point - self.carried) as f32, 0.0);
        }
    }
}

/// Places point `i` at its link's length from `before` in the direction of `wanted`, outside the colliders.
///
/// `was` is its position at the start of the substep, for friction; `fallback` is the direction of the link
/// then.
#[inline(always)]
pub(crate) fn place_point(
    point: usize,
    before: &Lane3,
    wanted: &Lane3,
    was: &Lane3,
    fallback: &Lane3,
    length: &Lane,
    near: &Near,
    rules: &ContactRules,
    planes: &mut PlaneRow,
) -> PlacedPoint {
    let mut placed = ZERO3;
    for k in 0..LANES {
        let from = at(before, k);
        let (d, _) = direction_or(at(wanted, k) - from, at(fallback, k));
        put(&mut placed, k, from + d * length[k]);
    }
    let free = placed;
    if near.active.is_empty() && near.field.is_none() {
        return PlacedPoint { placed, free, touched: false };
    }
    let mut touched = false;
    for iteration in 0..ITERATIONS {
        let rules = if iteration < BARE_FROM { *rules } else { rules.bare() };
        let enough = if iteration == 0 { 0.0 } else { TOLERANCE };
        let mut pushed =
            push_out_of_field(point, before, was, length, near, &rules, iteration, planes, &mut placed);
        let (min, max) = bounds(&placed);
        for n in near.boxes.near(min, max, rules.reach()) {
            let mover = &near.shapes[near.active[n] as usize];
            let Some(shape) = mover.shape else { continue };
            if shape.surely_beyond(&placed, rules.reach_of(mover)) {
                continue;
            }
            let allowed = near.allowed(n, point, &rules);
            if shape.each_surely_beyond(&placed, &allowed) {
                continue;
            }
            let mut along = ZERO3;
            for k in 0..LANES {
                put(&mut along, k, at(&placed, k) - at(before, k));
            }
            let nearest = shape.nearest(&placed, &along);
            if !any_deeper(&allowed, &nearest.distance, enough) {
                continue;
            }
            pushed = true;
            let friction = rules.friction(if mover.on_head { 1.0 } else { 0.0 }, iteration);
            let rub = near.friction(point);
            for k in 0..LANES {
                let depth = allowed[k] - nearest.distance[k];
                let (p, from, l) = (at(&placed, k), at(before, k), length[k]);
                let centre = at(&nearest.centre, k);
                let (friction, moving) = (friction * rub[k], mover.velocity_at.apply(p));
                let slid = slide(p, at(was, k), centre, depth, friction, moving, rules.h);
                let out = push_out(from, slid, l, centre, nearest.radius[k] + allowed[k]);
                let touching = depth > 0.0;
                put(&mut placed, k, choose(touching, out, p));
            }
        }
        if !pushed {
            break;
        }
        touched = true;
    }
    PlacedPoint { placed, free, touched }
}

/// The result of [`place_point`] for a row of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedPoint {
    pub(crate) placed: Lane3,
    /// The positions without any obstacle.
    pub(crate) free: Lane3,
    /// Whether any lane was pushed; if not, all are outside.
    pub(crate) touched: bool,
}

/// Pushes the lanes of a point out of the field; returns whether any was inside.
#[inline(always)]
fn push_out_of_field(
    point: usize,
    before: &Lane3,
    was: &Lane3,
    length: &Lane,
    near: &Near,
    rules: &ContactRules,
    iteration: usize,
    planes: &mut PlaneRow,
    placed: &mut Lane3,
) -> bool {
    let Some(field) = &near.field else { return false };
    let Some(row) = field.row(placed, rules.reach(), planes) else { return false };
    let allowed = near.allowed_by_field(field, &row, point, rules);
    let enough = if iteration == 0 { 0.0 } else { TOLERANCE };
    if !any_deeper(&allowed, &row.distance, enough) {
        return false;
    }
    let rub = near.friction(point);
    for k in 0..LANES {
        let friction = rules.friction(row.head[k], iteration) * rub[k];
        let depth = allowed[k] - row.distance[k];
        let (p, from, l) = (at(placed, k), at(before, k), length[k]);
        // The sphere that approximates the surface.
        let centre = p - at(&row.normal, k) * (row.distance[k] + CONTACT_RADIUS);
        let velocity = row.velocity(k, p, field.substep);
        let slid = slide(p, at(was, k), centre, depth, friction, velocity, rules.h);
        let out = push_out(from, slid, l, centre, CONTACT_RADIUS + allowed[k]);
        let touching = depth > 0.0;
        put(placed, k, choose(touching, out, p));
    }
    true
}

/// Whether any lane is closer than allowed by more than `enough`, metres.
#[inline(always)]
fn any_deeper(allowed: &Lane, distance: &Lane, enough: f32) -> bool {
    let mut any = false;
    for k in 0..LANES {
        any |= allowed[k] - distance[k] > enough;
    }
    any
}

/// Coulomb friction: the velocity along the surface, relative to the surface, loses `friction` times the
/// velocity that the push-out removes perpendicular to it, and at most all of itself.
#[inline(always)]
fn slide(p: Vec3, was: Vec3, centre: Vec3, depth: f32, friction: f32, surface: Vec3, h: f32) -> Vec3 {
    let (normal, _) = direction_or(p - centre, Vec3::Y);
    let relative = p - was - surface * h;
    let tangential = relative - normal * relative.dot(normal);
    let size = tangential.length_squared().sqrt();
    let lost = lesser(1.0, friction * greater(depth, 0.0) / (size + 1e-9));
    p - tangential * lost
}

/// The point on the sphere at distance `length` from `from` whose direction is closest to that of `p`.
///
/// With `D = |c - from|` and `e = (c - from) / D` the angle at `from` in the triangle of the three lengths is
/// `cos g = (l^2 + D^2 - R^2) / (2 l D)`. Where the triangle does not close, `from` is so deep inside that
/// the link cannot reach the surface, and it points straight out.
#[inline(always)]
pub(crate) fn push_out(from: Vec3, p: Vec3, length: f32, centre: Vec3, radius: f32) -> Vec3 {
    let to_centre = centre - from;
    let (e, distance) = direction_or(to_centre, Vec3::NEG_Y);
    let (d, _) = direction_or(p - from, -e);
    let across = d - e * d.dot(e);
    let aside = if e.x * e.x < 0.5 { Vec3::X } else { Vec3::Y };
    let aside = aside - e * aside.dot(e);
    let (across, _) = direction_or(across, aside);
    let cos = (length * length + distance * distance - radius * radius) / (2.0 * length * distance + 1e-20);
    let cos = lesser(greater(cos, -1.0), 1.0);
    let sin = greater(1.0 - cos * cos, 0.0).sqrt();
    let (turned, _) = direction_or(e * cos + across * sin, d);
    from + turned * length
}

/// Penetration of a row of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depths {
    /// The largest penetration in each lane, metres; 0 outside.
    pub(crate) depth: Lane,
    /// The collider with that penetration; [`FIELD`] for the field.
    pub(crate) collider: [u32; LANES],
    /// Whether the lane is inside the field at an unknown depth.
    pub(crate) is_unsure: [bool; LANES],
}

/// Stands for the field in place of a collider index.
pub(crate) const FIELD: u32 = u32::MAX;

/// Guessed penetrations below this count as outside, metres.
const LEAST_GUESSED_DEPTH: f32 = 1e-3;

/// Penetration of the lanes of point `i` into the colliders and the field.
#[inline(always)]
pub(crate) fn penetration(
    point: usize,
    placed: &Lane3,
    near: &Near,
    rules: &ContactRules,
    planes: &mut PlaneRow,
) -> Depths {
    let mut worst = Depths { depth: ZERO, collider: [FIELD; LANES], is_unsure: [false; LANES] };
    // Measured against the surface, or against the rest distance where that is smaller.
    let bare = rules.bare();
    if let Some(field) = &near.field
        && let Some(row) = field.row(placed, rules.reach(), planes)
    {
        let allowed = near.allowed_by_field(field, &row, point, &bare);
        for k in 0..LANES {
            // The depth inside guessed skin is itself a guess.
            let depth = greater(0.0, allowed[k] - row.distance[k]);
            worst.depth[k] = depth * (1.0 - row.guess[k]);
            worst.is_unsure[k] = row.guess[k] > 0.0 && depth > LEAST_GUESSED_DEPTH;
        }
    }
    let (min, max) = bounds(placed);
    for n in near.boxes.near(min, max, rules.reach()) {
        let c = near.active[n];
        let mover = &near.shapes[c as usize];
        let Some(shape) = mover.shape else { continue };
        if shape.surely_beyond(placed, bare.reach_of(mover)) {
            continue;
        }
        let nearest = shape.nearest(placed, &ZERO3);
        let allowed = near.allowed(n, point, &bare);
        for k in 0..LANES {
            let depth = allowed[k] - nearest.distance[k];
            if depth > worst.depth[k] {
                (worst.depth[k], worst.collider[k]) = (depth, c);
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests;
