//! The shape of a figure: the base mesh with its targets, in metres, standing at y = 0.

use anyhow::Context;
use glam::Vec3;

use super::recipe::Recipe;
use super::source::{Base, Source};
use crate::assets::rig;

/// Positions of all vertices of the base mesh, metres.
pub(super) struct Shape {
    /// By vertex, helpers and joint cubes included.
    pub(super) positions: Vec<Vec3>,
    /// Metres per unit of the base mesh.
    pub(super) scale: f32,
}

/// Where the balls of the feet are at rest, which the choreography assumes, metres in front of the origin on a figure of 1.70 m.
const BALLS_Z: f32 = 0.080;

impl Recipe {
    /// The targets with their weights (macro targets as products of their parts).
    fn targets(&self) -> Vec<(String, f32)> {
        let genders = [("female", 1.0 - self.male), ("male", self.male)];
        let ages = [("young", 1.0 - self.old), ("old", self.old)];
        let levels = |value: f32, what: &str| -> Vec<(String, f32)> {
            let (low, high) = (1.0 - 2.0 * value, 2.0 * value - 1.0);
            [("min", low.max(0.0)), ("average", 1.0 - low.abs()), ("max", high.max(0.0))]
                .map(|(level, w)| (format!("{level}{what}"), w))
                .to_vec()
        };
        let mut all = Vec::new();
        for (gender, g) in genders {
            for (age, a) in ages {
                for (people, p) in ["african", "asian", "caucasian"].into_iter().zip(self.ancestry) {
                    all.push((format!("macrodetails/{people}-{gender}-{age}"), g * a * p));
                }
                for (muscle, m) in levels(self.muscle, "muscle") {
                    for (weight, w) in levels(self.weight, "weight") {
                        let built = format!("{gender}-{age}-{muscle}-{weight}");
                        let share = g * a * m * w;
                        all.push((format!("macrodetails/universal-{built}"), share));
                        let ideal = format!("macrodetails/proportions/{built}-idealproportions");
                        all.push((ideal, share * self.ideal));
                    }
                }
            }
        }
        for (name, weight) in self.details {
            if name.contains('*') {
                all.extend(["l", "r"].map(|side| (name.replace('*', side), *weight)));
            } else {
                all.push(((*name).to_owned(), *weight));
            }
        }
        all.retain(|(_, weight)| *weight > 1e-4);
        all
    }

    /// The figure's shape.
    pub(super) fn shape(&self, source: &Source, base: &Base) -> anyhow::Result<Shape> {
        let mut positions = base.positions.clone();
        for (name, weight) in self.targets() {
            for (vertex, moved) in source.target(&name)? {
                *positions
                    .get_mut(vertex as usize)
                    .with_context(|| format!("{name}: no vertex {vertex}"))? += moved * weight;
            }
        }
        // The head's size, about the middle of the neck.
        let neck = base.middle("joint-head", &positions)?;
        for p in &mut positions {
            if p.x.abs() < 1.2 {
                let of_head = lovelock_base::numbers::smoothstep(neck.y - 0.9, neck.y - 0.1, p.y);
                *p = neck + (*p - neck) * (1.0 + (self.head - 1.0) * of_head);
            }
        }
        let body = base.vertices("body")?;
        let heights = || body.iter().map(|v| positions[*v as usize].y);
        let (low, high) = (heights().fold(f32::MAX, f32::min), heights().fold(f32::MIN, f32::max));
        let scale = self.height / (high - low);
        let ball = base.middle("joint-l-foot-1", &positions)?.z * scale;
        let forward = BALLS_Z * self.height / 1.70 - ball;
        for p in &mut positions {
            *p = Vec3::new(p.x * scale, (p.y - low) * scale, p.z * scale + forward);
        }
        let mut shape = Shape { positions, scale };
        shape.relax_hands(source, base)?;
        Ok(shape)
    }
}

/// How far the joints of the fingers bend at rest, degrees: index to little finger, from the knuckle on.
const CURL: [[f32; 3]; 4] = [[10.0, 16.0, 10.0], [16.0, 20.0, 12.0], [20.0, 24.0, 14.0], [24.0, 26.0, 16.0]];

impl Shape {
    /// Bends the fingers as a hand at ease has them.
    fn relax_hands(&mut self, source: &Source, base: &Base) -> anyhow::Result<()> {
        let weights = source.weights()?;
        let before = self.positions.clone();
        for (side, sign) in [("l", 1.0), ("r", -1.0)] {
            let joint =
                |finger: usize, k: usize| base.middle(&format!("joint-{side}-finger-{finger}-{k}"), &before);
            // The fingers bend about the line through the knuckles.
            let axis = (joint(5, 1)? - joint(2, 1)?).normalize_or(Vec3::NEG_Z) * sign;
            for (finger, (name, curl)) in
                ["index", "middle", "ring", "pinky"].into_iter().zip(CURL).enumerate()
            {
                let mut turns = Vec::new();
                let mut whole = glam::Affine3A::IDENTITY;
                for (k, degrees) in curl.into_iter().enumerate() {
                    let at = joint(finger + 2, k + 1)?;
                    let turn = glam::Quat::from_axis_angle(axis, degrees.to_radians());
                    whole = whole
                        * glam::Affine3A::from_translation(at)
                        * glam::Affine3A::from_quat(turn)
                        * glam::Affine3A::from_translation(-at);
                    turns.push(whole);
                }
                for (k, turn) in turns.iter().enumerate() {
                    let bone = format!("{name}_0{}_{side}", k + 1);
                    for (vertex, weight) in weights.get(&bone).into_iter().flatten() {
                        let p = before[*vertex as usize];
                        self.positions[*vertex as usize] += (turn.transform_point3(p) - p) * *weight;
                    }
                }
            }
        }
        Ok(())
    }

    /// The skeleton.
    pub(super) fn rig(&self, source: &Source, base: &Base) -> anyhow::Result<rig::Rig> {
        use super::source::Head;
        let heads = source.heads_of_bones()?;
        let at = |bone: &str| -> anyhow::Result<Vec3> {
            match heads.get(bone).with_context(|| format!("the rig has no bone {bone}"))? {
                Head::Cube { cube_name } => base.middle(cube_name, &self.positions),
                Head::Mean { vertex_indices } => {
                    let sum: Vec3 = vertex_indices.iter().map(|v| self.positions[*v as usize]).sum();
                    Ok(sum / vertex_indices.len() as f32)
                }
            }
        };
        let middle = |bone: &str| at(bone).map(|p| p.with_x(0.0));
        let body = base.vertices("body")?;
        let top = body.iter().map(|v| self.positions[*v as usize]).filter(|p| p.x.abs() < 0.2);
        let crown = top.fold(Vec3::ZERO, |a, b| if b.y > a.y { b } else { a });
        let height = crown.y;
        // The skull turns about the top of the spine, between the ears.
        let skull = body.iter().map(|v| self.positions[*v as usize]).filter(|p| p.y > height - 0.09);
        let (back, front) = skull.fold((f32::MAX, f32::MIN), |(a, b), p| (a.min(p.z), b.max(p.z)));
        let head = Vec3::new(0.0, height - 0.170, 0.5 * (back + front) - 0.012);
        let arms = ["clavicle", "upperarm", "lowerarm", "hand"].map(|bone| at(&format!("{bone}_l")));
        let [clavicle, shoulder, elbow, wrist] = arms;
        let legs = ["thigh", "calf", "foot", "ball"].map(|bone| at(&format!("{bone}_l")));
        let [hip, knee, ankle, toe] = legs;
        let wrist = wrist?;
        let (index, little) = (at("index_01_l")?, at("pinky_01_l")?);
        let palm = (little - wrist).cross(index - wrist).normalize_or(Vec3::NEG_Y);
        Ok(rig::Rig::new(
            &rig::Landmarks {
                hips: middle("pelvis")?,
                back: [middle("spine_01")?, middle("spine_02")?, middle("spine_03")?],
                neck: middle("neck_01")?,
                head,
                arm: [clavicle?, shoulder?, elbow?, wrist],
                leg: [hip?, knee?, ankle?, toe?],
            },
            palm,
        ))
    }
}
