//! Serialisation of the state: [`Simulation::save`] and [`Simulation::restore`].
//!
//! Little-endian: the four bytes `LLWS`, the version (u32), a fingerprint of the rest guides (u64), the
//! state, and a fingerprint of everything before it (u64). Data that follows from style and state is
//! recomputed.

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use lovelock_motion::{ColliderShape, FIELD_JOINTS, PlacedCollider};

use super::{Simulation, first_free};
use crate::block::Block;
use crate::colliders::field::{Joints, MovingField, PlaneRow};
use crate::device::Stamps;
use crate::hash::Hasher;
use crate::lanes::{LANES, Lane, Lane3, ZERO3};
use crate::motion::HeadPose;
use crate::rest::RestShape;

const MAGIC: [u8; 4] = *b"LLWS";

/// Incremented whenever the meaning of the bytes changes.
const VERSION: u32 = 6;

/// The largest number of colliders in a valid state.
const MAX_COLLIDERS: u32 = 4096;

/// Why a saved state cannot be restored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are not a saved state.
    #[error(
        "simulation state: found the bytes {found:02x?} at the start; a saved state starts with {MAGIC:02x?}"
    )]
    Foreign {
        /// The first bytes, at most four.
        found: Vec<u8>,
    },
    /// The state was written by another version of the program.
    #[error("simulation state: found version {found}; this program reads version {VERSION}")]
    Version {
        /// The version found in the bytes.
        found: u32,
    },
    /// The state belongs to other guides.
    #[error(
        "simulation state: it belongs to another hairstyle; restore it with the hairstyle it was saved with"
    )]
    Style,
    /// The state was saved with a field of the body that this simulation does not have.
    #[error("simulation state: it was saved with another body; reset the simulation on that body first")]
    Body,
    /// The bytes are truncated, too long or modified.
    #[error("simulation state: damaged: {problem}")]
    Damaged {
        /// What was found and what was expected.
        problem: String,
    },
}

impl Simulation {
    /// Serialises the state. A simulation restored from it with [`Simulation::restore`] continues with the
    /// same bits.
    ///
    /// The state does not include settings, style and the body's field. Restore it with the same style, after
    /// a [`Simulation::reset`] on the same body.
    pub fn save(&self) -> Vec<u8> {
        if self.is_partial {
            let mut whole = self.clone();
            whole.complete(None);
            return whole.save();
        }
        let mut out = Writer(Vec::with_capacity(self.blocks.len() * 5 * LANES * 3 * 4 * 32));
        out.0.extend_from_slice(&MAGIC);
        out.u32(VERSION);
        out.u64(self.fingerprint());
        out.floats(&self.head.turn.to_array());
        out.floats(&self.head.place.to_array());
        out.u64(self.time_secs.to_bits());
        out.u64(self.elapsed_secs.to_bits());
        out.u32(u32::from(self.air_travel.is_some()));
        for distance in self.air_travel.unwrap_or_default().to_array() {
            out.u64(distance.to_bits());
        }
        out.u32(self.clamped_links);
        out.u32(self.colliders.len() as u32);
        for collider in &self.colliders {
            out.affine(&collider.world_from_rest);
            out.shape(&collider.shape);
        }
        out.u32(self.rest_colliders.shapes.len() as u32);
        for (shape, on_head) in self.rest_colliders.shapes.iter().zip(&self.rest_colliders.on_head) {
            out.shape(shape);
            out.u32(u32::from(*on_head));
        }
        out.u32(self.field.as_ref().map_or(0, MovingField::weightings));
        for joint in self.field.iter().flat_map(|field| field.joints().all()) {
            out.affine(joint);
        }
        for rows in self.blocks.iter().flat_map(rows_of) {
            for axis in rows.iter().flatten() {
                out.floats(&axis[..]);
            }
        }
        if self.field.is_some() {
            for axis in self.blocks.iter().flat_map(|block| &block.skin).flatten() {
                out.floats(&axis[..]);
            }
        }
        out.u32(u32::from(self.tie_blend_state().is_some()));
        if let Some((grown_secs, had_ropes, held, from)) = self.tie_blend_state() {
            out.floats(&[grown_secs]);
            out.u32(u32::from(had_ropes));
            out.floats(held);
            for axis in from.iter().flatten().flatten() {
                out.floats(&axis[..]);
            }
        }
        out.u64(sum(&out.0));
        out.0
    }

    /// Restores the state in `bytes`, which must be saved from a simulation of the same guides.
    ///
    /// # Errors
    /// [`RestoreError`]; the simulation is then unchanged.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), RestoreError> {
        let mut input = Reader(bytes);
        match input.take::<4>() {
            Ok(MAGIC) => {}
            _ => return Err(RestoreError::Foreign { found: bytes[..bytes.len().min(4)].to_vec() }),
        }
        let version = input.u32()?;
        if version != VERSION {
            return Err(RestoreError::Version { found: version });
        }
        if input.u64()? != self.fingerprint() {
            return Err(RestoreError::Style);
        }
        let Some((held, check)) = bytes.split_last_chunk::<8>() else { return Err(truncated()) };
        if u64::from_le_bytes(*check) != sum(held) {
            return Err(damaged("the checksum does not match"));
        }
        let mut next = self.clone();
        next.advance_ties(f32::INFINITY);
        let turn = Quat::from_array(input.floats()?);
        let place = Vec3::from_array(input.floats()?);
        if !(turn.is_finite() && place.is_finite() && (turn.length_squared() - 1.0).abs() < 1e-3) {
            return Err(damaged("the head pose is not a rigid transform"));
        }
        next.head = HeadPose { turn, place };
        next.time_secs = f64::from_bits(input.u64()?);
        next.elapsed_secs = f64::from_bits(input.u64()?);
        let blown = input.u32()? != 0;
        let distance = [input.u64()?, input.u64()?, input.u64()?].map(f64::from_bits);
        next.air_travel = blown.then_some(DVec3::from_array(distance));
        if !distance.iter().all(|distance| distance.is_finite()) {
            return Err(damaged("the distance travelled by the wind is not finite"));
        }
        next.clamped_links = input.u32()?;
        if next.clamped_links > 2 {
            return Err(damaged("it clamps more than two links per guide"));
        }
        next.colliders.clear();
        for _ in 0..input.count(MAX_COLLIDERS)? {
            let world_from_rest = input.affine()?;
            next.colliders.push(PlacedCollider { shape: input.shape()?, world_from_rest });
        }
        let rest = &mut next.rest_colliders;
        rest.shapes.clear();
        rest.on_head.clear();
        for _ in 0..input.count(MAX_COLLIDERS)? {
            rest.shapes.push(input.shape()?);
            rest.on_head.push(input.u32()? != 0);
        }
        if rest.shapes.len() != next.colliders.len() {
            return Err(damaged("the numbers of colliders at rest and in motion differ"));
        }
        let weightings = input.u32()?;
        if weightings == 0 {
            next.field = None;
        } else {
            let mut joints = [Affine3A::IDENTITY; FIELD_JOINTS];
            for joint in &mut joints {
                *joint = input.affine()?;
            }
            let field = next.field.as_mut().filter(|field| field.weightings() == weightings);
            field.ok_or(RestoreError::Body)?.set_joints(Joints::new(joints));
        }
        let (guides, clamped_links) = (&self.style.guides, next.clamped_links);
        let first_free = first_free(clamped_links, guides.points_per_guide);
        for block in &mut next.blocks {
            if clamped_links != self.clamped_links {
                block.rest = RestShape::new(guides, &block.lanes(), first_free);
            }
            block.coupled.invalidate_factor();
            for rows in rows_of_mut(block) {
                for axis in rows.iter_mut().flatten() {
                    *axis = Lane(input.floats()?);
                }
            }
            block.has_contact_push = block.any_contact_push();
        }
        for row in next.blocks.iter_mut().flat_map(|block| &mut block.skin) {
            *row = PlaneRow::NO_SKIN;
            if weightings > 0 {
                for axis in row {
                    *axis = Lane(input.floats()?);
                }
            }
        }
        if input.u32()? != 0 {
            let [grown_secs] = input.floats()?;
            let had_ropes = input.u32()? != 0;
            let mut held = vec![0.0; guides.x.len()];
            for hold in &mut held {
                [*hold] = input.floats()?;
            }
            let mut from = vec![vec![ZERO3; guides.points_per_guide]; next.blocks.len()];
            for axis in from.iter_mut().flatten().flatten() {
                *axis = Lane(input.floats()?);
            }
            next.restore_tie_blend(grown_secs, had_ropes, held, from);
        }
        if input.0.len() != 8 {
            return Err(damaged("there are bytes after its end"));
        }
        next.measure_rest_distances();
        next.measure_field_distances();
        (next.stamps, next.is_partial) = (Stamps::new(), false);
        *self = next;
        Ok(())
    }
}

impl Simulation {
    /// A fingerprint of the guides at rest and of the lanes that hold them.
    fn fingerprint(&self) -> u64 {
        let guides = &self.style.guides;
        let mut hasher = Hasher::default();
        hasher.add(guides.points_per_guide as u32);
        hasher.add(guides.x.len() as u32);
        for v in [&guides.x, &guides.y, &guides.z].into_iter().flatten() {
            hasher.add(v.to_bits());
        }
        for block in &self.blocks {
            hasher.add(block.locks as u32);
            block.guides.iter().for_each(|guide| hasher.add(*guide));
        }
        hasher.finish()
    }
}

/// The part of a block that is state, not working memory.
fn rows_of(block: &Block) -> [&[Lane3]; 5] {
    [&block.position, &block.velocity, &block.bend, &block.contact_push, &block.coupled.directions]
}

fn rows_of_mut(block: &mut Block) -> [&mut [Lane3]; 5] {
    let directions = &mut block.coupled.directions;
    [&mut block.position, &mut block.velocity, &mut block.bend, &mut block.contact_push, directions]
}

fn sum(bytes: &[u8]) -> u64 {
    let mut hasher = Hasher::default();
    hasher.add(bytes.len() as u32);
    let (words, rest) = bytes.as_chunks::<4>();
    for word in words {
        hasher.add(u32::from_le_bytes(*word));
    }
    for byte in rest {
        hasher.add(u32::from(*byte));
    }
    hasher.finish()
}

fn damaged(problem: &str) -> RestoreError {
    RestoreError::Damaged { problem: problem.to_owned() }
}

fn truncated() -> RestoreError {
    damaged("it is truncated")
}

struct Writer(Vec<u8>);

impl Writer {
    fn u32(&mut self, v: u32) {
        self.0.extend_from_slice(&v.to_le_bytes());
    }

    fn u64(&mut self, v: u64) {
        self.0.extend_from_slice(&v.to_le_bytes());
    }

    fn floats(&mut self, values: &[f32]) {
        for v in values {
            self.u32(v.to_bits());
        }
    }

    fn affine(&mut self, m: &Affine3A) {
        self.floats(&m.to_cols_array());
    }

    fn shape(&mut self, shape: &ColliderShape) {
        match *shape {
            ColliderShape::Capsule { a, b, radius_a, radius_b } => {
                self.u32(0);
                self.floats(&[a.x, a.y, a.z, b.x, b.y, b.z, radius_a, radius_b]);
            }
            ColliderShape::Ellipsoid { from_unit } => {
                self.u32(1);
                self.affine(&from_unit);
            }
        }
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], RestoreError> {
        let (head, rest) = self.0.split_first_chunk::<N>().ok_or_else(truncated)?;
        self.0 = rest;
        Ok(*head)
    }

    fn u32(&mut self) -> Result<u32, RestoreError> {
        self.take().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, RestoreError> {
        self.take().map(u64::from_le_bytes)
    }

    fn floats<const N: usize>(&mut self) -> Result<[f32; N], RestoreError> {
        let mut out = [0.0; N];
        for v in &mut out {
            *v = f32::from_bits(self.u32()?);
        }
        Ok(out)
    }

    fn count(&mut self, most: u32) -> Result<u32, RestoreError> {
        let count = self.u32()?;
        if count > most {
            return Err(damaged(&format!("found {count} colliders; must be at most {most}")));
        }
        Ok(count)
    }

    fn affine(&mut self) -> Result<Affine3A, RestoreError> {
        let m: [f32; 12] = self.floats()?;
        let column = |c: usize| Vec3A::new(m[3 * c], m[3 * c + 1], m[3 * c + 2]);
        Ok(Affine3A { matrix3: Mat3A::from_cols(column(0), column(1), column(2)), translation: column(3) })
    }

    fn shape(&mut self) -> Result<ColliderShape, RestoreError> {
        match self.u32()? {
            0 => {
                let [ax, ay, az, bx, by, bz, radius_a, radius_b] = self.floats()?;
                let (a, b) = (Vec3::new(ax, ay, az), Vec3::new(bx, by, bz));
                Ok(ColliderShape::Capsule { a, b, radius_a, radius_b })
            }
            1 => Ok(ColliderShape::Ellipsoid { from_unit: self.affine()? }),
            other => Err(damaged(&format!("found collider kind {other}; must be 0 or 1"))),
        }
    }
}
