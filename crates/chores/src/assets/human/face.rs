//! What the face does: morph targets from the package's actions, and their weights during a clip.

use std::collections::BTreeMap;

use glam::Vec3;

use super::refine::Refined;
use super::source::{Source, Target};
use super::surface::{MORPHS, Surface};
use crate::assets::dance::{RATE, head_turn};
use crate::assets::score::Score;

/// How far closed lids stay outside of the eyeball, metres.
const CLEAR: f32 = 0.0006;
/// How long the lids take to close and to open again, seconds.
const CLOSES_SECS: f32 = 0.085;
const OPENS_SECS: f32 = 0.150;

/// The actions of each morph target but the last one.
const ACTIONS: [[&str; 2]; 5] = [
    ["eyeBlinkLeft", "eyeBlinkRight"],
    ["eyeLookOutLeft", "eyeLookInRight"],
    ["eyeLookInLeft", "eyeLookOutRight"],
    ["eyeLookUpLeft", "eyeLookUpRight"],
    ["eyeLookDownLeft", "eyeLookDownRight"],
];

/// Adds the morph targets to the skin. `scale` is metres per unit of the package; `eye` the middle of the left eyeball.
pub(super) fn add(
    skin: &mut Surface,
    refined: &Refined,
    source: &Source,
    scale: f32,
    (eye, radius): (Vec3, f32),
) -> anyhow::Result<()> {
    for (morph, names) in ACTIONS.iter().enumerate() {
        let mut moved: BTreeMap<u32, Vec3> = BTreeMap::new();
        for name in names {
            let target: Target = source.action(name)?;
            for (vertex, by) in target {
                *moved.entry(vertex).or_default() += by * scale;
            }
        }
        let moves = refined.values(|v| moved.get(&v).copied().unwrap_or_default());
        for (vertex, by) in skin.vertices.iter_mut().zip(moves) {
            vertex.moves[morph] = if by.length() < 2e-5 { Vec3::ZERO } else { by };
        }
    }
    // Lids go straight from open to closed, which is through the ball: the last target keeps them outside.
    for vertex in &mut skin.vertices {
        let middle = eye * Vec3::new(vertex.place.x.signum(), 1.0, 1.0);
        let least = radius + CLEAR;
        let open = vertex.place.distance(middle);
        if open > 1.8 * radius || vertex.moves[0].length() < 3e-4 {
            continue;
        }
        let outside = |p: Vec3, least: f32| {
            let away = p - middle;
            away.normalize_or(Vec3::Z) * (least - away.length()).max(0.0)
        };
        let closed = vertex.place + vertex.moves[0];
        // The inner side of the lids stays where it is relative to the ball.
        vertex.moves[0] += outside(closed, least.min(open));
        let half = vertex.place + 0.5 * vertex.moves[0];
        let wanted = open.min((vertex.place + vertex.moves[0]).distance(middle));
        vertex.moves[MORPHS.len() - 1] = outside(half, wanted);
    }
    Ok(())
}

/// The weights of the morph targets at each key of a clip, with the first one repeated at the end.
pub(super) fn weights(score: &Score) -> Vec<[f32; MORPHS.len()]> {
    let length = score.beats * score.beat_secs;
    let frames = (length * RATE).round() as usize;
    (0..=frames)
        .map(|frame| {
            let secs = (frame % frames) as f32 / RATE;
            let closed = score
                .blinks
                .iter()
                .map(|beat| {
                    let since =
                        (secs - beat * score.beat_secs + 0.5 * length).rem_euclid(length) - 0.5 * length;
                    let t = if since < 0.0 { 1.0 + since / CLOSES_SECS } else { 1.0 - since / OPENS_SECS };
                    let t = t.clamp(0.0, 1.0);
                    t * t * (3.0 - 2.0 * t)
                })
                .fold(0.0, f32::max);
            // The eyes go where the head will be, a moment ahead of it.
            let (ahead, now) = (head_turn(score, secs + 0.22), head_turn(score, secs - 0.04));
            let [left, down] = [ahead[0] - now[0], ahead[1] - now[1]].map(|degrees| degrees / 60.0);
            let side = |v: f32| v.clamp(0.0, 0.45);
            [
                closed,
                side(left),
                side(-left),
                side(-0.6 * down),
                side(0.6 * down),
                4.0 * closed * (1.0 - closed),
            ]
        })
        .collect()
}
