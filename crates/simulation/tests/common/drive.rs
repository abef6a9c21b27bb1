//! Bytes interpreted as actions on a simulation: settings, motions and edits in any order and with any
//! numbers.
//!
//! Shared by the fuzz target (`fuzz/`) and the tests; depends only on glam, groom, motion and simulation.
#![allow(dead_code, missing_docs, reason = "every user takes its part")]

#[path = "any.rs"]
mod any;
#[path = "edited_hair.rs"]
mod edited_hair;
#[path = "figure.rs"]
mod figure;

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides};
use lovelock_motion::{
    Collider, ColliderEdit, ColliderEdits, FieldPose, PlacedCollider, Pose, place_colliders,
};
use lovelock_simulation::{BodyPart, PlacedField, Simulation, SimulationSettings, StepInput};

use any::{Bytes, any_collider, any_colliders, any_head, any_settings, one_setting, style};
use edited_hair::EditedHair;
use figure::{Bends, FIGURE, Figure};

/// Counts of what a drive has covered, so that a test can check that drives cover everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coverage {
    pub steps: u32,
    pub jumps: u32,
    pub recovered: u32,
    pub styles: u32,
    pub resets: u32,
    pub restored: u32,
    pub refused: u32,
    pub fastest: f32,
    /// Steps with the field of a figure, and those in which hair was in its skin.
    pub with_field: u32,
    pub in_skin: u32,
    /// Steps with points in skin that is folded over itself.
    pub folded: u32,
    /// Ties that gather hair, cuts that cut some, and changes of hair length, all during motion.
    pub tied: u32,
    pub cut: u32,
    pub regrown: u32,
    /// Changes of the field's lift, of the colliders of the figure, and of the bend of its joints.
    pub lifted: u32,
    pub edited: u32,
    pub bent: u32,
}

impl Coverage {
    /// Adds the counts of another drive.
    pub fn add(&mut self, other: &Self) {
        for (mine, more) in [
            (&mut self.steps, other.steps),
            (&mut self.jumps, other.jumps),
            (&mut self.recovered, other.recovered),
            (&mut self.styles, other.styles),
            (&mut self.resets, other.resets),
            (&mut self.restored, other.restored),
            (&mut self.refused, other.refused),
            (&mut self.with_field, other.with_field),
            (&mut self.in_skin, other.in_skin),
            (&mut self.folded, other.folded),
            (&mut self.tied, other.tied),
            (&mut self.cut, other.cut),
            (&mut self.regrown, other.regrown),
            (&mut self.lifted, other.lifted),
            (&mut self.edited, other.edited),
            (&mut self.bent, other.bent),
        ] {
            *mine += more;
        }
        self.fastest = self.fastest.max(other.fastest);
    }
}

/// Largest number of actions per drive, so that every input ends soon.
const MAX_ACTIONS: u32 = 120;

/// A figure, or bare colliders, around a head.
struct TestBody {
    /// Whether there is a figure.
    figure: bool,
    bends: Bends,
    /// A joint at an arbitrary transform.
    astray: Option<(usize, Affine3A)>,
    edits: ColliderEdits,
    /// The colliders of the figure after the edits.
    used: Vec<Collider>,
    /// Colliders that belong to no figure.
    loose: Vec<PlacedCollider>,
    pose: Pose,
    placed: Vec<PlacedCollider>,
    field: FieldPose,
}

impl TestBody {
    fn new() -> Self {
        Self {
            figure: false,
            bends: Bends::default(),
            astray: None,
            edits: ColliderEdits::default(),
            used: ColliderEdits::default().apply(&FIGURE.colliders, Some(&FIGURE.field)),
            loose: Vec::new(),
            pose: Pose::default(),
            placed: Vec::new(),
            field: FieldPose::default(),
        }
    }

    fn edit(&mut self, input: &mut Bytes) {
        let names = FIGURE.colliders.len().max(1);
        let collider = FIGURE.colliders.get(input.byte() as usize % names);
        let mut edit = ColliderEdit::default();
        (edit.enabled, edit.scale) = (!input.byte().is_multiple_of(3), input.number());
        edit.offset = input.vector().to_array();
        if let Some(collider) = collider {
            self.edits.shapes.insert(collider.name.clone(), edit);
        }
        self.edits.field.enabled = !input.byte().is_multiple_of(4);
        self.used = self.edits.apply(&FIGURE.colliders, Some(&FIGURE.field));
    }

    fn bend(&mut self, input: &mut Bytes) {
        let mut turn = |most: f32| {
            let axis = Vec3::new(input.unit() - 0.5, input.unit() - 0.5, input.unit() - 0.5);
            Quat::from_axis_angle(axis.normalize_or(Vec3::X), most * input.unit())
        };
        let (neck, nod, shoulder) = (turn(0.8), turn(0.8), turn(2.5));
        self.bends = Bends { neck, nod, shoulder };
    }

    /// Identifies the field by its lift.
    fn key(&self) -> Option<u32> {
        (self.figure && self.edits.field.enabled).then(|| self.edits.field.lift_m().to_bits())
    }

    fn input(&mut self, time_secs: f64, head: Affine3A) -> StepInput<'_> {
        if !self.figure {
            return StepInput::new(time_secs, head, &self.loose);
        }
        Figure::pose(head, &self.bends, &mut self.pose);
        if let Some((joint, place)) = self.astray {
            self.pose.world_from_joint[joint] = place;
        }
        place_colliders(&self.used, &FIGURE.body, &self.pose, &mut self.placed);
        self.placed.extend_from_slice(&self.loose);
        let field = self.edits.field.enabled.then(|| {
            FIGURE.field.place(&FIGURE.body, &self.pose, self.edits.field.lift_m(), &mut self.field);
            PlacedField { field: &FIGURE.field, pose: &self.field }
        });
        // Any shapes may shelter from the wind.
        StepInput { field, sheltering: &self.loose, ..StepInput::new(time_secs, head, &self.placed) }
    }
}

/// A saved state, and the field at that time.
struct Saved {
    bytes: Vec<u8>,
    field: Option<u32>,
}

impl Saved {
    /// Restores it, possibly after damaging its bytes.
    fn restore(
        &self,
        simulation: &mut Simulation,
        field: Option<u32>,
        input: &mut Bytes,
        coverage: &mut Coverage,
    ) {
        let mut bytes = self.bytes.clone();
        let hurt = input.byte().is_multiple_of(2);
        if hurt {
            let at = (input.byte() as usize * 257 + input.byte() as usize) % bytes.len();
            bytes[at] ^= input.byte() | 1;
            if at.is_multiple_of(5) {
                bytes.truncate(at);
            }
        }
        let before = simulation.state_hash();
        // The body is not part of a state; on another body the restore may succeed or fail.
        let same = field == self.field;
        match simulation.restore(&bytes) {
            Ok(()) => {
                assert!(!hurt && (!same || simulation.save() == bytes), "a damaged state was accepted");
                coverage.restored += 1;
            }
            Err(error) => {
                assert!((hurt || !same) && before == simulation.state_hash(), "{error}");
                coverage.refused += 1;
            }
        }
    }
}

/// Performs the actions that `bytes` describe on a simulation.
///
/// # Panics
/// If a point is not finite or far from the head, a report contains NaN, or a saved and restored state
/// differs.
pub fn drive(bytes: &[u8]) -> Coverage {
    let mut input = Bytes(bytes);
    let mut coverage = Coverage::default();
    let mut hair = EditedHair::new(style(&mut input));
    let mut simulation = Simulation::new(hair.result());
    let mut settings = SimulationSettings::default();
    let mut body = TestBody::new();
    let (mut time_secs, mut head, mut dt) = (0.0, Affine3A::IDENTITY, 1.0 / 60.0);
    let mut saved: Option<Saved> = None;
    let mut field = body.key();
    for _ in 0..MAX_ACTIONS {
        if input.0.is_empty() {
            break;
        }
        match input.byte() % 32 {
            0 => settings = any_settings(&mut input),
            1 => one_setting(&mut input, &mut settings),
            2 => body.loose = any_colliders(&mut input),
            3 => {
                let at = input.byte() as usize;
                if let Some(collider) = body.loose.get_mut(at % 4) {
                    *collider = any_collider(&mut input);
                }
            }
            4 => {
                hair = if input.byte().is_multiple_of(3) {
                    EditedHair::new(style(&mut input))
                } else {
                    EditedHair::grown(&mut input)
                };
                simulation.set_style(hair.result());
                coverage.styles += 1;
                saved = None;
            }
            5 => {
                simulation.reset(&body.input(time_secs, head));
                coverage.resets += 1;
            }
            6 => saved = Some(Saved { bytes: simulation.save(), field }),
            7 => {
                if let Some(saved) = &saved {
                    saved.restore(&mut simulation, field, &mut input, &mut coverage);
                }
            }
            8 => dt = input.number(),
            9 => time_secs = f64::from(input.number()),
            10 => head = any_head(&mut input),
            11 | 12 => {
                body.bend(&mut input);
                coverage.bent += u32::from(body.figure);
            }
            13 => {
                let joint = input.byte() as usize % 4;
                body.astray = (!input.byte().is_multiple_of(4)).then(|| (joint, any_head(&mut input)));
            }
            14 | 15 => {
                let (tied, cut) = if input.byte().is_multiple_of(2) {
                    (hair.tie(&mut input), false)
                } else {
                    (false, hair.cut(&mut input, &simulation))
                };
                if tied || cut {
                    simulation.set_style(hair.result());
                    saved = None;
                }
                coverage.tied += u32::from(tied);
                coverage.cut += u32::from(cut);
            }
            16 => {
                if hair.regrow(&mut input) {
                    simulation.set_style(hair.result());
                    coverage.regrown += 1;
                    saved = None;
                }
            }
            17 => {
                body.edits.field.lift = 0.1 * input.number();
                coverage.lifted += u32::from(body.figure);
            }
            18 => {
                body.edit(&mut input);
                if input.byte().is_multiple_of(2) {
                    simulation.invalidate_colliders();
                }
                coverage.edited += u32::from(body.figure);
            }
            19 | 20 => body.figure = !input.byte().is_multiple_of(4),
            21 => simulation.set_wind_secs(f64::from(input.number())),
            22 => simulation.set_contact_culling(input.byte().is_multiple_of(2)),
            _ => {
                dt = if dt > 0.0 && dt < 1.0 { dt } else { 1.0 / 60.0 };
                head = next_head(&mut input, head);
            }
        }
        time_secs += f64::from(dt);
        let at = body.input(time_secs, head);
        coverage.with_field += u32::from(at.field.is_some());
        let report = simulation.step(&at, &settings, dt);
        field = body.key();
        coverage.steps += 1;
        coverage.jumps += u32::from(report.jumped);
        coverage.recovered += report.recovered_guides;
        coverage.fastest = coverage.fastest.max(report.max_speed);
        coverage.folded += u32::from(report.unsure_points > 0);
        coverage.in_skin += u32::from(report.deepest.is_some_and(|d| d.within == BodyPart::Field));
        assert!(report.substeps <= lovelock_simulation::MAX_SUBSTEPS);
        // Stretch and speed may be large if a setting asks for it, but they are numbers.
        let numbers = [report.max_stretch, report.max_penetration_m, report.kinetic_energy, report.max_speed];
        assert!(numbers.iter().all(|v| !v.is_nan()), "{report:?}");
        let mut frame = GuideFrame::at_rest(&Guides::default(), Affine3A::IDENTITY, 0.0);
        simulation.frame(&mut frame);
        assert!(is_sound(&frame), "a point is not finite after {report:?}");
    }
    coverage
}

/// Whether every point is finite and within reach of the head.
pub fn is_sound(frame: &GuideFrame) -> bool {
    let place = Vec3::from(frame.world_from_head.translation);
    let (g, size) = (&frame.guides, place.abs().max_element());
    // The simulator itself treats a guide as lost 320 m from the head; a distant head adds rounding.
    let near =
        |v: f32, at: f32| v.is_finite() && (v - at).abs() < 320.0 * (g.points_per_guide as f32).sqrt() + size;
    (0..g.x.len()).all(|i| near(g.x[i], place.x) && near(g.y[i], place.y) && near(g.z[i], place.z))
}

/// A plausible next pose of a head.
fn next_head(input: &mut Bytes, head: Affine3A) -> Affine3A {
    let signed = |input: &mut Bytes| 2.0 * input.unit() - 1.0;
    let (turn, axis) = (0.4 * signed(input), input.byte());
    let axis = [Vec3::X, Vec3::Y, Vec3::Z][axis as usize % 3];
    let by = 0.1 * Vec3::new(signed(input), signed(input), signed(input));
    Affine3A::from_translation(by) * head * Affine3A::from_quat(Quat::from_axis_angle(axis, turn))
}
