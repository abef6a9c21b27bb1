//! Strokes on hair of a plain head.

mod back_to_rest;
mod bounds;
mod each_tool;

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GroomSettings, GuideFrame, Guides, Hairstyle, NoObstacle, Obstacle, PlainHead, grow};
use lovelock_style::hand::HandEdits;
use lovelock_style::operations::Hand;
use lovelock_style::{Layer, apply_layer};

use crate::{Brush, BrushSettings, BrushSurroundings, StrokeSample, Tool};

fn hair(seed: u32, wisps: u32) -> Arc<Hairstyle> {
    let settings =
        GroomSettings { seed, wisps, strands_per_wisp: 4, length: 0.3, ..GroomSettings::default() };
    Arc::new(grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair"))
}

/// A movement in a straight line over the hair on the wearer's left.
fn samples(from: Vec3, to: Vec3, count: usize) -> Vec<StrokeSample> {
    let at = |i: usize| from.lerp(to, i as f32 / (count - 1) as f32);
    (0..count)
        .map(|i| StrokeSample {
            position: at(i),
            view: Vec3::NEG_X,
            drag: if i > 0 { at(i) - at(i - 1) } else { Vec3::ZERO },
            pressure: 1.0,
            time_secs: i as f64 / 60.0,
        })
        .collect()
}

/// From the front to the back over the hair beside the left ear.
fn across() -> Vec<StrokeSample> {
    samples(Vec3::new(0.1, 0.08, 0.05), Vec3::new(0.1, 0.08, -0.07), 24)
}

fn brush() -> BrushSettings {
    BrushSettings { radius: 0.05, strength: 0.8, ..BrushSettings::default() }
}

/// What a stroke does to hair that does not move by itself.
struct Stroked {
    frame: GuideFrame,
    edits: HandEdits,
    touched: Vec<bool>,
}

fn stroked(
    tool: (Tool, bool),
    settings: &BrushSettings,
    style: &Arc<Hairstyle>,
    samples: &[StrokeSample],
    obstacle: &dyn Obstacle,
) -> Stroked {
    let frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    stroked_in(tool, settings, style, frame, samples, obstacle)
}

fn stroked_in(
    (tool, inverted): (Tool, bool),
    settings: &BrushSettings,
    style: &Arc<Hairstyle>,
    mut frame: GuideFrame,
    samples: &[StrokeSample],
    obstacle: &dyn Obstacle,
) -> Stroked {
    let mut edits = HandEdits::default();
    let mut brush = Brush::new(tool, inverted, settings, [style, style], &edits, &[]).expect("a stroke");
    for sample in samples {
        brush.stroke_to(&mut frame, &BrushSurroundings { obstacle }, sample);
    }
    brush.write(&mut edits);
    Stroked { frame, edits, touched: brush.touched().to_vec() }
}

fn applied(edits: &HandEdits, style: &Hairstyle, obstacle: &dyn Obstacle) -> Hairstyle {
    let after = apply_layer(&Layer::of(Hand { edits: edits.clone() }), 1.0, style, obstacle);
    let after = after.unwrap_or_else(|| style.clone());
    after.check().expect("sound");
    after
}

/// The largest distance between points of two sets of guides, metres.
fn apart(a: &Guides, b: &Guides) -> f32 {
    let points = a.points_per_guide;
    (0..a.count() * points)
        .map(|i| a.point(i / points, i % points).distance(b.point(i / points, i % points)))
        .fold(0.0, f32::max)
}

fn length(guides: &Guides, guide: usize) -> f32 {
    (1..guides.points_per_guide).map(|i| guides.point(guide, i).distance(guides.point(guide, i - 1))).sum()
}

/// The mean of a value over the touched guides.
fn mean(touched: &[bool], of: impl Fn(usize) -> f32) -> f32 {
    let guides: Vec<usize> = (0..touched.len()).filter(|guide| touched[*guide]).collect();
    assert!(guides.len() > 3, "{} guides are touched", guides.len());
    guides.iter().map(|guide| of(*guide)).sum::<f32>() / guides.len() as f32
}

/// The mean height of the lower half of a guide over the body.
fn height(guides: &Guides, guide: usize, from: usize) -> f32 {
    let points = from..guides.points_per_guide;
    let count = points.len() as f32;
    points.map(|i| PlainHead.distance(guides.point(guide, i)).0).sum::<f32>() / count
}

const FREE: NoObstacle = NoObstacle;
