//! The simulator.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use lovelock_groom::{GuideFrame, Hairstyle};
use lovelock_motion::PlacedCollider;
use rayon::prelude::*;

use crate::block::{BendingKey, Block};
use crate::colliders::contact::ContactRules;
use crate::colliders::field::MovingField;
use crate::colliders::shape::Shape;
use crate::colliders::{MovingShape, RestColliders, place, transformed};
use crate::dispatch::step_block;
use crate::grid::DensityGrid;
use crate::hash::Hasher;
use crate::lanes::{Lane, Map, ZERO, at};
use crate::motion::{HeadPose, Substep, rigid_between, substep};
use crate::rest::blocks_of;
use crate::solver::Plan;
use crate::wake::{Wakes, head_of};
use crate::wind::{WindField, mean_of};
use crate::{BodyPart, InsidePoint, MAX_SUBSTEPS, SimulationSettings, StepInput, StepReport};

/// In less than this no time passes: velocities are differences over a step, and rounding would be all of them.
const SHORTEST_SECS: f32 = 1e-6;

/// Times of the wind that are nearer to each other than this are the same.
const SAME_SECS: f64 = 1e-3;

/// Hair in motion: the guides of one hairstyle as chains of rigid links.
///
/// A step depends on the state, the input and the settings alone: not on a clock, and not on how many threads
/// share the work.
#[derive(Clone, Debug)]
pub struct Simulation {
    style: Arc<Hairstyle>,
    blocks: Vec<Block>,
    /// Block and lane of each guide.
    slots: Vec<(u32, u32)>,
    grid: DensityGrid,
    /// The body at the end of the last step.
    head: HeadPose,
    time_secs: f64,
    colliders: Vec<PlacedCollider>,
    rest_colliders: RestColliders,
    field: Option<MovingField>,
    /// Ties that are taking hold.
    taking_hold: Option<TakingHold>,
    /// Simulated since the last reset, for the wind.
    elapsed_secs: f64,
    /// How far the mean wind has carried the air in that time, metres; `None` for as far as the present one would have.
    air_way: Option<DVec3>,
    /// The links at the root that the blocks are prepared for.
    clamped_links: u32,
    mean_link: f32,
    /// Whether to use the instructions of this processor and not those of every one; the bits are the same.
    wide: bool,
    /// Whether to leave out tests that cannot find a contact; the bits are the same.
    spare: bool,
    substeps: Vec<Substep>,
    shapes: Vec<MovingShape>,
}

impl Simulation {
    /// Hair of `style` at rest on a head at the world's origin. Call [`Simulation::reset`] before the first
    /// step, or that step is taken for a jump.
    pub fn new(style: Arc<Hairstyle>) -> Self {
        let clamped_links = SimulationSettings::default().clamped_links;
        let guides = &style.guides;
        let usable = guides.points_per_guide >= 2;
        let cut = if usable { blocks_of(guides) } else { Vec::new() };
        let first_free = first_free(clamped_links, guides.points_per_guide);
        let mut slots = vec![(0, 0); if usable { guides.count() } else { 0 }];
        let mut blocks = Vec::with_capacity(cut.len());
        for (b, (lanes, used)) in cut.into_iter().enumerate() {
            for (lane, &guide) in lanes[..used].iter().enumerate() {
                slots[guide as usize] = (b as u32, lane as u32);
            }
            let mut block = Block::new(guides, lanes, used, first_free);
            block.held = crate::ties::rows(&style, &lanes);
            block.place_at_rest(&Map::IDENTITY);
            blocks.push(block);
        }
        // A guide that is not a number says nothing about the others.
        let known = || blocks.iter().flat_map(|b| &b.rest.mean_link[..b.used]).filter(|l| l.is_finite());
        let mean_link = known().sum::<f32>() / known().count().max(1) as f32;
        let grid = DensityGrid::new(&blocks);
        Self {
            style,
            blocks,
            slots,
            grid,
            head: HeadPose::IDENTITY,
            time_secs: 0.0,
            colliders: Vec::new(),
            rest_colliders: RestColliders::default(),
            field: None,
            taking_hold: None,
            elapsed_secs: 0.0,
            air_way: None,
            clamped_links,
            mean_link,
            wide: true,
            spare: true,
            substeps: Vec::new(),
            shapes: Vec::new(),
        }
    }

    /// The hairstyle that is simulated.
    pub fn style(&self) -> &Arc<Hairstyle> {
        &self.style
    }

    /// Carries the rest shape to the head of `input`, without motion.
    pub fn reset(&mut self, input: &StepInput) {
        self.head = HeadPose::new(&input.world_from_head).unwrap_or(self.head);
        self.time_secs = input.time_secs;
        (self.elapsed_secs, self.air_way) = (0.0, None);
        self.take_hold(f32::INFINITY);
        self.colliders.clear();
        self.colliders.extend_from_slice(input.colliders);
        self.meet_field(input);
        self.learn_colliders();
        self.reset_field(input);
        let from_head = self.head.map_from_head(self.head.place);
        self.blocks.par_iter_mut().for_each(|block| block.place_at_rest(&from_head));
    }

    /// Takes the colliders of the next step for other ones, as many as they are: how they lie around the hair at rest is
    /// found anew.
    pub fn forget_colliders(&mut self) {
        self.colliders.clear();
    }

    /// Tells the wind what time it is, seconds: the same wind blows at the same time, as if it had blown like this until
    /// then, unless time only goes on. Without it, time counts from the last reset.
    pub fn set_wind_secs(&mut self, secs: f64) {
        if secs.is_finite() {
            self.air_way = self.air_way.filter(|_| (secs - self.elapsed_secs).abs() < SAME_SECS);
            self.elapsed_secs = secs;
        }
    }

    /// Moves on by `dt_secs`, while the body moves from where it was to `input`.
    ///
    /// Roots, frames and colliders are taken through the substeps in between. Where the motion jumps (see
    /// [`StepInput`]) hair is carried along with the head, velocities and all, and time stands still. So it is
    /// where `dt_secs` is not a number or below a microsecond; one above 0.1 s counts as 0.1 s.
    pub fn step(&mut self, input: &StepInput, settings: &SimulationSettings, dt_secs: f32) -> StepReport {
        let settings = settings.clamped();
        let head = HeadPose::new(&input.world_from_head).unwrap_or(self.head);
        let jumped = self.head.jumps_to(&head, self.time_secs, input.time_secs, dt_secs);
        self.time_secs = input.time_secs;
        let met = self.meet_field(input);
        if self.colliders.len() != input.colliders.len() {
            self.colliders.clear();
            self.colliders.extend_from_slice(input.colliders);
            let before = std::mem::replace(&mut self.head, head);
            self.learn_colliders();
            self.head = before;
        }
        if self.clamped_links != settings.clamped_links {
            self.clamp_links(settings.clamped_links);
        }
        if jumped || !(dt_secs >= SHORTEST_SECS && dt_secs.is_finite()) {
            let report = self.carry_to(head, input.colliders, jumped);
            self.reset_field(input);
            return report;
        }
        let dt_secs = dt_secs.min(0.1);
        self.take_hold(dt_secs);
        // All of it by the threads that share the work: they are woken once.
        let report = rayon::scope(|_| self.simulate(&head, input, &settings, dt_secs, met));
        self.head = head;
        self.colliders.copy_from_slice(input.colliders);
        self.elapsed_secs += f64::from(dt_secs);
        report
    }

    /// The step to `head` and `input`; `met` says whether the field has only just been taken up.
    fn simulate(
        &mut self,
        head: &HeadPose,
        input: &StepInput,
        settings: &SimulationSettings,
        dt_secs: f32,
        met: bool,
    ) -> StepReport {
        let colliders = input.colliders;
        let origin = head.place;
        let rebase = self.head.place - origin;
        let count = self.substeps_for(head, settings.substeps);
        let h = dt_secs / count as f32;
        self.substeps.clear();
        self.shapes.clear();
        let mut before = self.head;
        for s in 0..count {
            let t = (s + 1) as f32 / count as f32;
            let now = self.head.toward(head, t);
            self.substeps.push(substep(&before, &now, origin, h));
            place(
                &self.rest_colliders,
                &self.colliders,
                colliders,
                t,
                dt_secs,
                origin,
                &now.affine(),
                &mut self.shapes,
            );
            before = now;
        }
        let head_from_last = head_from(&self.head, self.head.place);
        let (grid, blocks, spare) = (&mut self.grid, &self.blocks, self.spare);
        let (field, placed) = (self.field.as_mut(), input.field);
        // What takes longer first: the other thread may have to be woken.
        let ((), over_dense_cells) = rayon::join(
            || {
                let (Some(field), Some(placed)) = (field, placed) else { return };
                if met {
                    // It begins where it is.
                    field.reset(head, placed.pose);
                }
                field.advance(head, placed.pose, ContactRules::of(settings).reach(), dt_secs, spare);
            },
            || grid.update(blocks, &head_from_last, settings.repulsion),
        );
        let mean_wind = mean_of(&settings.wind).as_dvec3();
        let way = self.air_way.unwrap_or(mean_wind * self.elapsed_secs);
        self.air_way = Some(way + mean_wind * f64::from(dt_secs));
        let wind = WindField::new(&settings.wind, self.elapsed_secs, way, origin);
        let shelter = if wind.blows() { settings.wind.sheltering } else { 0.0 };
        let along = Vec3::from_array(settings.wind.direction);
        let here = Affine3A::from_rotation_translation(self.head.turn, self.head.place - origin);
        let alone = shelter > 0.0 && input.sheltering.is_empty();
        let head_in_field = self.field.as_ref().filter(|_| alone);
        let head_in_field = head_in_field.and_then(|_| head_of(&self.style.scalp, &here));
        let solids = self.shapes[..colliders.len()].iter().filter_map(|mover| mover.shape);
        let here = Affine3A::from_translation(-origin);
        let others = input.sheltering.iter().filter_map(|c| Shape::new(&transformed(&c.shape, &here)));
        let wakes = Wakes::new(solids.chain(head_in_field).chain(others), along, shelter);
        let first_free = first_free(self.clamped_links, self.style.guides.points_per_guide);
        let plan = Plan {
            wide: self.wide,
            settings: *settings,
            h,
            first_free,
            rebase,
            carry_all: rigid_between(&self.head, head, origin),
            head_from_last,
            last_head: self.head.map_from_head(self.head.place),
            substeps: &self.substeps,
            shapes: &self.shapes,
            shapes_per_substep: colliders.len(),
            field: self.field.as_ref(),
            rules: ContactRules { h, ..ContactRules::of(settings) },
            bending: BendingKey::new(settings, h, first_free),
            grid: &self.grid,
            wind: &wind,
            wakes: &wakes,
        };
        self.blocks.par_iter_mut().with_max_len(1).for_each(|block| step_block(block, &plan));
        let (hair_volume, hair_volume_at_rest) = (self.grid.volume(), self.grid.volume_at_rest());
        let all = self.outcome(first_free);
        StepReport { substeps: count, over_dense_cells, hair_volume, hair_volume_at_rest, ..all }
    }

    /// Sums up the blocks, always in the same order.
    fn outcome(&self, first_free: usize) -> StepReport {
        let mut report = StepReport::default();
        let (mut energy, mut fastest) = (0.0, 0.0_f32);
        let (mut stretched, mut quick) = (None, None);
        for block in &self.blocks {
            let out = &block.outcome;
            if out.max_stretch > report.max_stretch {
                (report.max_stretch, stretched) = (out.max_stretch, Some(block));
            }
            if out.deepest.metres > report.max_penetration_m {
                report.max_penetration_m = out.deepest.metres;
                report.deepest = Some(InsidePoint {
                    guide: out.deepest_guide,
                    point: out.deepest.point,
                    depth_m: out.deepest.metres,
                    within: BodyPart::of(out.deepest.collider),
                });
            }
            report.unsure_points += out.unsure;
            report.unsure_at = report.unsure_at.or(out.first_unsure);
            report.recovered_guides += out.recovered;
            report.recovered_at = report.recovered_at.or(out.first_recovered.map(|lane| block.guides[lane]));
            energy += out.energy;
            if out.max_speed_squared > fastest {
                (fastest, quick) = (out.max_speed_squared, Some(block));
            }
        }
        // Where it is, is looked for in one block alone.
        let first = first_free.max(1);
        report.worst_stretch_at = stretched.and_then(|block: &Block| block.most(first, Block::stretch));
        let speed = |block: &Block, k: usize, i: usize| at(&block.velocity[i], k).length_squared();
        report.fastest_at = quick.and_then(|block: &Block| block.most(first, speed));
        let free = self.slots.len() * self.style.guides.points_per_guide.saturating_sub(first_free);
        report.kinetic_energy = (energy / free.max(1) as f64) as f32;
        report.max_speed = fastest.sqrt();
        report
    }

    /// Moves the hair rigidly with the head.
    fn carry_to(&mut self, head: HeadPose, colliders: &[PlacedCollider], jumped: bool) -> StepReport {
        let turn = rigid_between(&self.head, &head, self.head.place).turn;
        // Both working spaces have their origin at the head.
        let by = Map { turn, shift: Vec3::ZERO };
        self.blocks.par_iter_mut().for_each(|block| block.carry(&by));
        self.head = head;
        self.colliders.copy_from_slice(colliders);
        StepReport { jumped, ..StepReport::default() }
    }

    /// No root may move further in a substep than half a link, as far as the most substeps allow.
    fn substeps_for(&self, head: &HeadPose, asked: u32) -> u32 {
        let (turn, there) = (self.head.affine(), head.affine());
        let mut furthest = 0.0_f32;
        for block in &self.blocks {
            for k in 0..block.used {
                let root = at(&block.rest.position[0], k);
                let moved = there.transform_point3(root) - turn.transform_point3(root);
                furthest = furthest.max(moved.length_squared());
            }
        }
        let half_links = 2.0 * furthest.sqrt() / self.mean_link.max(1e-4);
        asked.max(half_links.ceil().min(MAX_SUBSTEPS as f32) as u32)
    }

    /// Finds how the colliders lie around the hair at rest.
    fn learn_colliders(&mut self) {
        let head_at_rest = self.field.as_ref().map(MovingField::head_at_rest);
        self.rest_colliders.find(self.head.affine(), &self.colliders, head_at_rest);
        self.learn_rest_distances();
    }

    /// Measures how far every point at rest is from every collider at rest.
    fn learn_rest_distances(&mut self) {
        let shapes: Vec<Option<Shape>> = self.rest_colliders.shapes.iter().map(Shape::new).collect();
        self.blocks.par_iter_mut().for_each(|block| {
            let points = block.points();
            block.rest_distance.clear();
            block.rest_distance.resize(shapes.len() * points, ZERO);
            for (c, shape) in shapes.iter().enumerate() {
                for i in 0..points {
                    let row = block.rest.position[i];
                    let distance = shape.as_ref().map(|s| s.nearest(&row, &crate::lanes::ZERO3).distance);
                    block.rest_distance[c * points + i] = distance.unwrap_or(Lane::splat(f32::MAX));
                }
            }
        });
    }

    /// Writes the guides as they are now into `frame`, without allocating where it already fits.
    pub fn frame(&self, frame: &mut GuideFrame) {
        frame.time_secs = self.time_secs;
        frame.world_from_head = self.head.affine();
        let points = self.style.guides.points_per_guide;
        frame.guides.points_per_guide = points;
        let total = self.style.guides.x.len();
        for axis in [&mut frame.guides.x, &mut frame.guides.y, &mut frame.guides.z] {
            axis.resize(total, 0.0);
        }
        for (guide, &(block, lane)) in self.slots.iter().enumerate() {
            let rows = &self.blocks[block as usize].position;
            for (i, row) in rows.iter().enumerate() {
                let p = at(row, lane as usize) + self.head.place;
                let to = guide * points + i;
                (frame.guides.x[to], frame.guides.y[to], frame.guides.z[to]) = (p.x, p.y, p.z);
            }
        }
    }

    /// A fingerprint of positions and velocities: equal states have equal ones.
    pub fn state_hash(&self) -> u64 {
        let mut hasher = Hasher::default();
        for v in self.head.place.to_array() {
            hasher.add(v.to_bits());
        }
        for &(block, lane) in &self.slots {
            let block = &self.blocks[block as usize];
            for row in block.position.iter().chain(&block.velocity) {
                for axis in row {
                    hasher.add(axis[lane as usize].to_bits());
                }
            }
        }
        hasher.finish()
    }
}

/// The first point that the scalp does not carry.
fn first_free(clamped_links: u32, points: usize) -> usize {
    (1 + clamped_links as usize).min(points)
}

/// From the space whose origin is at `origin` to head space.
fn head_from(head: &HeadPose, origin: Vec3) -> Map {
    let turn = glam::Mat3::from_quat(head.turn.inverse());
    Map { turn, shift: turn * (origin - head.place) }
}

mod body;
mod restyle;
mod snapshot;

use restyle::TakingHold;
pub use snapshot::RestoreError;

#[cfg(test)]
mod tests;
