//! The simulator.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use lovelock_base::memory::list_bytes;
use lovelock_base::settings::Settings;
use lovelock_groom::{GuideFrame, Hairstyle};
use lovelock_motion::PlacedCollider;
use rayon::prelude::*;

use crate::block::{BendingKey, Block};
use crate::colliders::contact::ContactRules;
use crate::colliders::field::MovingField;
use crate::colliders::shape::Shape;
use crate::colliders::{MovingShape, RestColliders, place, transformed};
use crate::device::{self, DeviceStep, Reads, Stamp, Stamps, StepDevice};
use crate::dispatch::step_block;
use crate::factors::FactorRows;
use crate::grid::DensityGrid;
use crate::hash::Hasher;
use crate::lanes::{Lane, Map, ZERO, at};
use crate::motion::{HeadPose, Substep, rigid_between, substep};
use crate::packing::pack;
use crate::rates::RowRates;
use crate::solver::Plan;
use crate::wake::{Wakes, head_of};
use crate::wind::{WindField, mean_of};
use crate::{BodyPart, InsidePoint, MAX_SUBSTEPS, SimulationSettings, StepInput, StepReport};

/// Steps shorter than this do not advance time: velocities are differences over a step and would be mostly
/// rounding error.
const SHORTEST_SECS: f32 = 1e-6;

/// Wind times closer together than this are treated as equal.
const SAME_WIND_SECS: f64 = 1e-3;

/// Hair in motion: the guides of one hairstyle as chains of rigid links.
///
/// A step depends only on the state, the input and the settings, not on a clock or on the number of threads.
#[derive(Clone, Debug)]
pub struct Simulation {
    style: Arc<Hairstyle>,
    blocks: Vec<Block>,
    /// Block and lane of each guide.
    slots: Vec<(u32, u32)>,
    grid: DensityGrid,
    /// The head at the end of the last step.
    head: HeadPose,
    time_secs: f64,
    colliders: Vec<PlacedCollider>,
    rest_colliders: RestColliders,
    field: Option<MovingField>,
    /// Ties whose strength is still growing after a change of hairstyle.
    tie_blend: Option<TieBlend>,
    /// The guides that were moved from outside since the last change of hairstyle; empty for none.
    moved: Vec<bool>,
    /// Seconds simulated since the last reset, for the wind.
    elapsed_secs: f64,
    /// Distance that the mean wind has carried the air in that time, metres; `None` if it is to be computed
    /// from the current mean wind.
    air_travel: Option<DVec3>,
    /// The number of root links for which the blocks are prepared.
    clamped_links: u32,
    mean_link: f32,
    /// Whether to use the vector instructions of this CPU instead of the baseline; the result is the same,
    /// bit for bit.
    wide: bool,
    /// Whether to skip tests that cannot find a contact; the result is the same, bit for bit.
    culling: bool,
    substeps: Vec<Substep>,
    shapes: Vec<MovingShape>,
    rows: Vec<RowRates>,
    stamps: Stamps,
    /// A step that a device has begun.
    begun: Option<Begun>,
    /// Whether only a device has what moves beside positions and velocities.
    is_partial: bool,
}

impl Simulation {
    /// The memory of the guides that it moves, bytes, without the hairstyle.
    pub fn bytes(&self) -> u64 {
        let of_block = |block: &Block| {
            let rows = [&block.skin, &block.position, &block.velocity, &block.bend, &block.contact_push];
            let lanes = [&block.rest_distance, &block.field_distance, &block.tie_hold];
            rows.map(list_bytes).into_iter().sum::<u64>() + lanes.map(list_bytes).into_iter().sum::<u64>()
        };
        self.blocks.iter().map(of_block).sum::<u64>() + list_bytes(&self.slots)
    }

    /// Creates the hair of `style` at rest, with the head at the world's origin. Call [`Simulation::reset`]
    /// before the first step, or that step counts as a jump.
    pub fn new(style: Arc<Hairstyle>) -> Self {
        let clamped_links = SimulationSettings::default().clamped_links;
        let guides = &style.guides;
        let usable = guides.points_per_guide >= 2;
        let packed = if usable { pack(guides, &style.wisps) } else { Vec::new() };
        let first_free = first_free(clamped_links, guides.points_per_guide);
        let mut slots = vec![(0, 0); if usable { guides.count() } else { 0 }];
        let mut blocks = Vec::with_capacity(packed.len());
        for (b, lanes) in packed.iter().enumerate() {
            for (lane, &guide) in lanes.guides[..lanes.used].iter().enumerate() {
                slots[guide as usize] = (b as u32, lane as u32);
            }
            let mut block = Block::new(guides, lanes, first_free);
            block.tie_hold = crate::ties::rows(&style, &lanes.guides);
            block.factors = FactorRows::of(&style, &lanes.guides);
            block.place_at_rest(&Map::IDENTITY);
            blocks.push(block);
        }
        crate::rope::assign(&style.ropes, &mut blocks);
        // Non-finite guides do not affect the others.
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
            tie_blend: None,
            moved: Vec::new(),
            elapsed_secs: 0.0,
            air_travel: None,
            clamped_links,
            mean_link,
            wide: true,
            culling: true,
            substeps: Vec::new(),
            shapes: Vec::new(),
            rows: Vec::new(),
            stamps: Stamps::new(),
            begun: None,
            is_partial: false,
        }
    }

    /// The hairstyle that is simulated.
    pub fn style(&self) -> &Arc<Hairstyle> {
        &self.style
    }

    /// Places the hair in its rest shape on the head of `input`, at rest.
    pub fn reset(&mut self, input: &StepInput) {
        self.head = HeadPose::new(&input.world_from_head).unwrap_or(self.head);
        self.time_secs = input.time_secs;
        (self.elapsed_secs, self.air_travel) = (0.0, None);
        self.advance_ties(f32::INFINITY);
        self.colliders.clear();
        self.colliders.extend_from_slice(input.colliders);
        self.update_field(input);
        self.find_rest_colliders();
        self.reset_field(input);
        let from_head = self.head.map_from_head(self.head.place);
        self.blocks.par_iter_mut().for_each(|block| block.place_at_rest(&from_head));
        self.stamps.state = Stamp::new();
        (self.begun, self.is_partial) = (None, false);
    }

    /// Treats the colliders of the next step as new ones even if their number is unchanged, so that their
    /// arrangement around the hair at rest is found again.
    pub fn invalidate_colliders(&mut self) {
        self.colliders.clear();
    }

    /// Sets the time of the wind, seconds. The same time gives the same wind, computed as if the current wind
    /// had always blown, unless time continues from the last step. Without this call, time counts from the
    /// last reset.
    pub fn set_wind_secs(&mut self, secs: f64) {
        if secs.is_finite() {
            self.air_travel = self.air_travel.filter(|_| (secs - self.elapsed_secs).abs() < SAME_WIND_SECS);
            self.elapsed_secs = secs;
        }
    }

    /// Advances the hair by `dt_secs`, while the body moves from its last pose to `input`.
    ///
    /// Roots, frames and colliders are interpolated over the substeps. If the motion jumps (see
    /// [`StepInput`]), the hair is moved rigidly with the head, including its velocities, and no time passes.
    /// The same happens if `dt_secs` is not a number or below a microsecond; values above 0.1 s count as 0.1
    /// s.
    pub fn step(&mut self, input: &StepInput, settings: &SimulationSettings, dt_secs: f32) -> StepReport {
        self.step_by(Host::Cpu, input, settings, dt_secs).unwrap_or_default().0
    }

    /// As [`Simulation::step`], with the guides advanced by `device`. If it cannot, the CPU does the whole step; the second
    /// value then says why. Jumps, and hair without guides, need no device.
    pub fn step_on(
        &mut self,
        device: &mut dyn StepDevice,
        input: &StepInput,
        settings: &SimulationSettings,
        dt_secs: f32,
    ) -> (StepReport, Option<String>) {
        self.step_by(Host::Device(device), input, settings, dt_secs).unwrap_or_default()
    }

    /// A step by `host`. `None` if a device has begun it.
    fn step_by(
        &mut self,
        mut host: Host,
        input: &StepInput,
        settings: &SimulationSettings,
        dt_secs: f32,
    ) -> Option<Stepped> {
        debug_assert!(self.begun.is_none(), "a step has begun");
        let settings = settings.clamped();
        let head = HeadPose::new(&input.world_from_head).unwrap_or(self.head);
        let is_step = dt_secs >= SHORTEST_SECS && dt_secs.is_finite();
        let jumped = self.head.jumps_to(&head, self.time_secs, input.time_secs, dt_secs);
        if self.is_partial && !(is_step && !jumped && self.goes_on(&host, input, &settings)) {
            self.complete_on(host.device());
        }
        self.time_secs = input.time_secs;
        let field_changed = self.update_field(input);
        if self.colliders.len() != input.colliders.len() {
            self.colliders.clear();
            self.colliders.extend_from_slice(input.colliders);
            let before = std::mem::replace(&mut self.head, head);
            self.find_rest_colliders();
            self.head = before;
        }
        if self.clamped_links != settings.clamped_links {
            self.clamp_links(settings.clamped_links);
        }
        if jumped || !is_step {
            let report = self.move_with_head(head, input.colliders, jumped);
            self.reset_field(input);
            return Some((report, None));
        }
        let dt_secs = dt_secs.min(0.1);
        self.advance_ties(dt_secs);
        let stepped = match host {
            Host::Device(_) | Host::Ahead(_) if !self.blocks.is_empty() => {
                self.simulate(host, &head, input, &settings, dt_secs, field_changed)
            }
            // The whole step runs inside the thread pool, so that its threads are woken only once.
            _ => rayon::scope(|_| self.simulate(Host::Cpu, &head, input, &settings, dt_secs, field_changed)),
        };
        self.head = head;
        self.colliders.copy_from_slice(input.colliders);
        self.elapsed_secs += f64::from(dt_secs);
        stepped
    }

    /// Simulates the step to `head` and `input`; `field_changed` says whether the field is a new one. `None` if a device has begun it.
    fn simulate(
        &mut self,
        mut host: Host,
        head: &HeadPose,
        input: &StepInput,
        settings: &SimulationSettings,
        dt_secs: f32,
        field_changed: bool,
    ) -> Option<Stepped> {
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
            let now = self.head.interpolate(head, t);
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
        let (grid, blocks, culling) = (&mut self.grid, &self.blocks, self.culling);
        let deposits = matches!(host, Host::Cpu);
        let (field, placed) = (self.field.as_mut(), input.field);
        // The longer task comes first, because the other thread may have to be woken.
        let ((), mut over_dense_cells) = rayon::join(
            || {
                let (Some(field), Some(placed)) = (field, placed) else { return };
                if field_changed {
                    // A new field starts at rest in its current place.
                    field.reset(head, placed.pose);
                }
                field.advance(head, placed.pose, ContactRules::of(settings).reach(), dt_secs, culling);
            },
            || if deposits { grid.update(blocks, &head_from_last, settings.repulsion) } else { 0 },
        );
        let mean_wind = mean_of(&settings.wind).as_dvec3();
        let air_travel = self.air_travel.unwrap_or(mean_wind * self.elapsed_secs);
        self.air_travel = Some(air_travel + mean_wind * f64::from(dt_secs));
        let wind = WindField::new(&settings.wind, self.elapsed_secs, air_travel, origin);
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
        let points = self.style.guides.points_per_guide;
        let along = |i: usize| i as f32 / points.saturating_sub(1).max(1) as f32;
        self.rows.clear();
        self.rows.extend((0..points).map(|i| RowRates::at(along(i), settings, h)));
        let grown = self.tie_blend.as_ref().map_or(1.0, TieBlend::ropes_grown);
        let ropes = crate::rope::current(&self.style.ropes, &self.blocks, rebase, count, h, grown);
        let plan = Plan {
            wide: self.wide,
            settings: *settings,
            h,
            rows: &self.rows,
            ropes: &ropes,
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
            grid: None,
            wind: &wind,
            wakes: &wakes,
        };
        let (before, after) = (self.stamps, Stamp::new());
        self.stamps.state = after;
        let mut refusal = None;
        let reads = host.reads();
        if let Some(device) = host.device() {
            let (blocks, grid) = (&self.blocks, &self.grid);
            let step = DeviceStep { plan: &plan, blocks, grid, stamps: before, after, place: origin };
            let mode = settings.repulsion.mode;
            let begun = Begun { ending: plan.ending(), substeps: count, mode, before: self.head };
            let started = device.begin(&step, reads);
            if started.is_ok() && reads == Reads::Motion {
                self.begun = Some(begun);
                return None;
            }
            let done = started.and_then(|()| device.finish());
            match done.and_then(|out| Ok((device::accept(&mut self.blocks, &begun.ending, out, reads)?, out)))
            {
                Ok((is_whole, out)) => {
                    let measured = Measured::of(out);
                    if !is_whole {
                        self.stamps.state = Stamp::new();
                    }
                    return Some((self.report_of(&begun, &measured), None));
                }
                Err(reason) => {
                    // The device may hold a state under the last stamp that was not accepted.
                    self.stamps.state = Stamp::new();
                    refusal = Some(reason);
                }
            }
            if std::mem::take(&mut self.is_partial) {
                ahead::rebuild(&mut self.blocks, &self.head);
            }
            over_dense_cells = self.grid.update(&self.blocks, &head_from_last, settings.repulsion);
        }
        let plan = Plan { grid: Some(&self.grid), ..plan };
        self.blocks.par_iter_mut().with_max_len(1).for_each(|block| step_block(block, &plan));
        let (hair_volume, hair_volume_at_rest) = (self.grid.volume(), self.grid.volume_at_rest());
        let all = self.outcome(first_free);
        let report =
            StepReport { substeps: count, over_dense_cells, hair_volume, hair_volume_at_rest, ..all };
        Some((report, refusal))
    }

    /// Sums the results of the blocks, always in the same order.
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
        // The points are searched in the one block that holds the maximum.
        let first = first_free.max(1);
        report.worst_stretch_at = stretched.and_then(|block: &Block| block.argmax(first, Block::stretch));
        let speed = |block: &Block, k: usize, i: usize| at(&block.velocity[i], k).length_squared();
        report.fastest_at = quick.and_then(|block: &Block| block.argmax(first, speed));
        let free = self.slots.len() * self.style.guides.points_per_guide.saturating_sub(first_free);
        report.kinetic_energy = (energy / free.max(1) as f64) as f32;
        report.max_speed = fastest.sqrt();
        report
    }

    /// Moves the hair rigidly with the head.
    fn move_with_head(&mut self, head: HeadPose, colliders: &[PlacedCollider], jumped: bool) -> StepReport {
        let turn = rigid_between(&self.head, &head, self.head.place).turn;
        // Both working spaces have their origin at the head.
        let by = Map { turn, shift: Vec3::ZERO };
        self.blocks.par_iter_mut().for_each(|block| block.move_rigidly(&by));
        self.stamps.state = Stamp::new();
        self.head = head;
        self.colliders.copy_from_slice(colliders);
        StepReport { jumped, ..StepReport::default() }
    }

    /// Number of substeps such that no root moves further per substep than half a link, up to
    /// [`MAX_SUBSTEPS`].
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

    /// Finds the arrangement of the colliders around the hair at rest.
    fn find_rest_colliders(&mut self) {
        let head_at_rest = self.field.as_ref().map(MovingField::head_at_rest);
        self.rest_colliders.find(self.head.affine(), &self.colliders, head_at_rest);
        self.measure_rest_distances();
    }

    /// Measures the rest distance of every point to every collider.
    fn measure_rest_distances(&mut self) {
        let shapes: Vec<Option<Shape>> = self.rest_colliders.shapes.iter().map(Shape::new).collect();
        self.stamps.distances = Stamp::new();
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

    /// Writes the current guides to `frame`; allocates only if its size differs.
    pub fn frame(&self, frame: &mut GuideFrame) {
        debug_assert!(self.begun.is_none(), "a step has begun");
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

    /// A fingerprint of positions and velocities. Equal states have equal fingerprints.
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

/// Maps the space whose origin is at `origin` to head space.
fn head_from(head: &HeadPose, origin: Vec3) -> Map {
    let turn = glam::Mat3::from_quat(head.turn.inverse());
    Map { turn, shift: turn * (origin - head.place) }
}

mod ahead;
mod body;
mod restyle;
mod snapshot;

use ahead::{Begun, Host, Measured, Stepped};
pub use body::BodyNow;
use restyle::TieBlend;
pub use snapshot::RestoreError;

#[cfg(test)]
mod tests;
