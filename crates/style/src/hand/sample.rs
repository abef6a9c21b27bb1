//! An edit as a layer keeps it: in whole steps, so that files, mirroring and undo keep every byte.

use glam::Vec2;
use lovelock_base::numbers::within;

use super::edit::{HandChannel, HandEdit};
use super::place::HandPlace;

/// Steps of turns, per radian.
const TURN: f32 = 10_000.0;
/// Steps of the reach, per unit of direction.
const REACH: f32 = 50_000.0;
/// Steps of length and of the part that is kept.
const PART: f32 = 8_000.0;
/// Steps of the pitch, per metre.
const PITCH: f32 = 50_000.0;

/// Steps of a channel.
const fn steps(kind: HandChannel) -> f32 {
    match kind {
        HandChannel::Spread | HandChannel::Width => 8_000.0,
        HandChannel::Curl => 200_000.0,
        HandChannel::Twist => 1_000.0,
    }
}

/// The edit of one place. Whole numbers are steps of the constants above.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct HandSample {
    pub place: HandPlace,
    /// The distance between roots when it was made.
    pub reach: u16,
    pub turns: Vec<[i16; 2]>,
    pub channels: [Vec<i16>; 4],
    /// Pitch, length and the part that is kept.
    pub numbers: [u16; 3],
    pub removed: bool,
}

impl HandSample {
    /// The most links.
    pub const MAX_LINKS: usize = 1024;

    /// An edit in whole steps.
    pub fn of(place: HandPlace, spacing: f32, edit: &HandEdit) -> Self {
        let turn = |turn: &Vec2| turn.to_array().map(|v| step(v * TURN));
        let mut turns: Vec<[i16; 2]> = edit.turns.iter().take(Self::MAX_LINKS).map(turn).collect();
        if turns.iter().all(|turn| *turn == [0; 2]) {
            turns.clear();
        }
        let channels = HandChannel::ALL.map(|kind| {
            let [low, high] = kind.range();
            let one = |value: &f32| step(within(*value, low, high, kind.neutral()) * steps(kind));
            let values: Vec<i16> =
                edit.channels[kind as usize].iter().take(Self::MAX_LINKS + 1).map(one).collect();
            let neutral = step(kind.neutral() * steps(kind));
            if values.iter().all(|value| *value == neutral) { Vec::new() } else { values }
        });
        let whole = |value: f32, range: [f32; 2], neutral: f32, steps: f32| {
            (within(value, range[0], range[1], neutral) * steps).round() as u16
        };
        let numbers = [
            whole(edit.pitch, HandEdit::PITCHES, HandEdit::PITCH, PITCH),
            whole(edit.length, HandEdit::LENGTHS, 1.0, PART),
            whole(edit.kept, [0.0, 1.0], 1.0, PART),
        ];
        let reach = whole(spacing, [0.0, 1.0], 0.1, REACH);
        Self { place, reach, turns, channels, numbers, removed: edit.removed }
    }

    /// The edit.
    pub fn edit(&self) -> HandEdit {
        let [pitch, length, kept] = self.numbers.map(f32::from);
        HandEdit {
            turns: self.turns.iter().map(|t| Vec2::from_array(t.map(|v| f32::from(v) / TURN))).collect(),
            channels: HandChannel::ALL.map(|kind| {
                self.channels[kind as usize].iter().map(|v| f32::from(*v) / steps(kind)).collect()
            }),
            pitch: pitch / PITCH,
            length: length / PART,
            kept: kept / PART,
            removed: self.removed,
        }
    }

    /// The distance between roots when it was made.
    pub fn spacing(&self) -> f32 {
        f32::from(self.reach) / REACH
    }

    /// The same on the other side of the head.
    pub fn mirrored(&self) -> Self {
        let mut out = self.clone();
        out.place = self.place.mirrored();
        for turn in &mut out.turns {
            turn[0] = turn[0].saturating_neg();
        }
        for twist in &mut out.channels[HandChannel::Twist as usize] {
            *twist = twist.saturating_neg();
        }
        out
    }
}

fn step(value: f32) -> i16 {
    // The lowest number has no opposite.
    within(value.round(), -32_767.0, 32_767.0, 0.0) as i16
}
