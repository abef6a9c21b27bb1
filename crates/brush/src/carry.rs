//! Carrying a change of moving hair back to the rest shape.

use glam::{Quat, Vec3};
use lovelock_base::numbers::smoothstep;
use lovelock_groom::Guides;
use lovelock_style::hand::{
    HandChannel, HandEdit, hand_input, link_frames, relength, resampled, smallest_turn, turn_to, turned_by,
};

use crate::chain::{along, directions, lengths, mean_turn};

/// Links that turned less than this keep their edit, as a difference of directions.
const STILL: f32 = 1e-6;

/// Part of the links of a guide, to either side of a link, over which turns of flying hair are averaged.
const AVERAGED: f32 = 0.2;
/// A link flies if the links around it are turned from their mean by more than the first angle, and wholly from the second on, radians.
const FLIES: [f32; 2] = [0.35, 0.9];
/// A link that the brush turns by this angle takes part wholly, radians.
const TURNED: f32 = 0.02;

/// The links around each that are averaged.
fn around(i: usize, count: usize) -> std::ops::Range<usize> {
    let reach = (AVERAGED * count as f32).ceil() as usize;
    i.saturating_sub(reach)..(i + reach + 1).min(count)
}

/// What turns each link at rest as a change of the seen hair wants it: from `before` to `after`, the seen hair being at rest turned by
/// `turns`.
///
/// Where hair is bent evenly, that is the turn by which the changed shape comes back exactly in the same pose. Where hair flies, links beside
/// each other are turned to very different sides for an instant. There it is the mean of what the links around would do, seen through the
/// mean of their turns: by their own turns they would fold against each other at rest. Links that the brush hardly turned stay.
fn turns_at_rest(rest: &[Vec3], turns: &[Quat], [before, after]: [&[Vec3]; 2]) -> Vec<Quat> {
    let count = rest.len();
    let still = |i: usize| before[i].distance_squared(after[i]) < STILL * STILL;
    let exact = |i: usize| {
        if still(i) {
            return Quat::IDENTITY;
        }
        smallest_turn(rest[i], (turns[i].inverse() * after[i]).normalize_or(rest[i]))
    };
    let mean = |turns: &[Quat]| mean_turn(turns.iter().map(|turn| (1.0, *turn)));
    let means: Vec<Quat> = (0..count).map(|i| mean(&turns[around(i, count)])).collect();
    let through_mean = |i: usize| means[i].inverse() * smallest_turn(before[i], after[i]) * means[i];
    let even: Vec<Quat> = (0..count).map(through_mean).collect();
    let of = |i: usize| {
        let near = around(i, count);
        let most = near.clone().map(|j| turns[j].angle_between(means[i])).fold(0.0, f32::max);
        let own = smoothstep(0.0, TURNED, before[i].angle_between(after[i]));
        let flies = own * smoothstep(FLIES[0], FLIES[1], most);
        if flies > 0.0 { exact(i).slerp(mean(&even[near]), flies) } else { exact(i) }
    };
    (0..count).map(of).collect()
}

/// How each link at rest is turned in motion. Each turn is that of the link before, and the smallest one from there, as the simulation
/// carries a motion over to another hairstyle.
pub(crate) fn link_turns(rest: &[Vec3], moved: &[Vec3]) -> Vec<Quat> {
    let mut turn = Quat::IDENTITY;
    let pairs = directions(rest).into_iter().zip(directions(moved));
    pairs
        .map(|(rest, moved)| {
            turn = (smallest_turn((turn * rest).normalize_or(rest), moved) * turn).normalize();
            turn
        })
        .collect()
}

/// One guide: its edit in the layer, and its shapes in head space.
#[derive(Clone, Debug)]
pub(crate) struct CarriedGuide<'a> {
    pub guide: usize,
    /// The direction of its root from the middle of the head.
    pub outward: Vec3,
    /// The guides that the layer gets.
    pub below: &'a Guides,
    /// Its points at rest after all layers, without the cut part.
    pub rest: Vec<Vec3>,
    /// Its points as they are seen.
    pub seen: Vec<Vec3>,
    /// Its edit in the layer.
    pub edit: HandEdit,
}

impl CarriedGuide<'_> {
    /// The input of the layer with the length of the edit.
    fn input(&self) -> Option<Vec<Vec3>> {
        hand_input(self.below, self.guide, self.edit.length)
    }

    /// The points that the layer makes of its input, before a cut.
    fn output(&self, input: &[Vec3]) -> Vec<Vec3> {
        let turns = self.edit.turns_at(input.len() - 1);
        let frames = link_frames(input, self.outward);
        let own = directions(input);
        let turned = |i: usize| turns.get(i).map_or(own[i], |turn| turned_by(frames[i], *turn));
        let ways: Vec<Vec3> = (0..frames.len()).map(turned).collect();
        along(input[0], &ways, &lengths(input))
    }

    /// The seen guide takes other places. `factor` is that on its length.
    ///
    /// A motion turns each link at rest to the seen one. What it turns to the new place of the link becomes the link at rest, evenly along
    /// hair that flies.
    pub fn move_to(&mut self, seen: &[Vec3], factor: f32) -> Option<()> {
        let input = self.input()?;
        let output = directions(&self.output(&input));
        let count = (self.seen.len().min(self.rest.len()) - 1).min(output.len());
        let turns = link_turns(&self.rest, &self.seen);
        let [before, after, mut rest] = [&self.seen, &seen.to_vec(), &self.rest].map(|p| directions(p));
        let mut ways = output;
        let still = (0..count).all(|i| before[i].distance_squared(after[i]) < STILL * STILL);
        if still && factor == 1.0 {
            return Some(());
        }
        let seen_ways = [&before[..count], &after[..count]];
        for (i, turn) in turns_at_rest(&rest[..count], &turns[..count], seen_ways).into_iter().enumerate() {
            if turn != Quat::IDENTITY {
                ways[i] = turn * ways[i];
                rest[i] = (turn * rest[i]).normalize_or(rest[i]);
            }
        }
        let links: Vec<f32> = lengths(&self.rest).iter().map(|link| link * factor).collect();
        self.rest = along(self.rest[0], &rest, &links);
        self.seen = seen.to_vec();
        self.set_length(self.edit.length * factor);
        self.turn_to(&ways)
    }

    /// The guide becomes longer or shorter at its end. Hair that was cut grows from the cut on.
    pub fn relength(&mut self, factor: f32) -> Option<()> {
        let input = self.input()?;
        let links = input.len() - 1;
        let kept = self.edit.kept;
        let length = (self.edit.length * kept * factor).clamp(HandEdit::LENGTHS[0], HandEdit::LENGTHS[1]);
        let factor = length / (self.edit.length * kept);
        let mut output = self.output(&input);
        let link = |points: &[Vec3]| points[0].distance(points[1]);
        let before = [&self.seen, &self.rest].map(|points| link(points) / link(&input));
        if kept < 1.0 {
            let whole = lengths(&output).iter().sum::<f32>() * kept;
            for points in [&mut output, &mut self.seen, &mut self.rest] {
                let part = whole / lengths(points).iter().sum::<f32>().max(1e-6);
                *points = resampled(points, part, links);
            }
        }
        for points in [&mut output, &mut self.seen, &mut self.rest] {
            relength(points, factor);
        }
        // The links of all shapes are those of the input by the same factors as before.
        let new = link(&hand_input(self.below, self.guide, length)?);
        for (points, part) in [&mut self.seen, &mut self.rest].into_iter().zip(before) {
            let ways = directions(points);
            *points = along(points[0], &ways, &vec![new * part; ways.len()]);
        }
        for kind in HandChannel::ALL {
            if !self.edit.channels[kind as usize].is_empty() {
                let at = |i: usize| (i as f32 / links as f32 * kept * factor).min(1.0);
                let values: Vec<f32> = (0..=links).map(|i| self.edit.channel(kind, at(i))).collect();
                self.edit.channels[kind as usize] = values;
            }
        }
        self.edit.kept = 1.0;
        self.set_length(length);
        self.turn_to(&directions(&output))
    }

    /// The guide ends at a place, in links.
    pub fn cut(&mut self, at: f32) -> Option<()> {
        let links = (self.input()?.len() - 1) as f32;
        self.edit.kept = self.edit.kept.min((at / links).clamp(0.0, 1.0));
        // The link after the cut stays, as a cut of the style leaves it.
        let end = at.ceil() as usize + 2;
        self.seen.truncate(end);
        self.rest.truncate(end);
        Some(())
    }

    /// The guide takes another edit of the layer; what is seen turns with it.
    pub fn take(&mut self, edit: HandEdit) -> Option<()> {
        let before = directions(&self.output(&self.input()?));
        let factor = edit.length / self.edit.length;
        self.edit = edit;
        let after = directions(&self.output(&self.input()?));
        if factor != 1.0 {
            relength(&mut self.seen, factor);
            relength(&mut self.rest, factor);
        }
        let turns = link_turns(&self.rest, &self.seen);
        let [mut seen, mut rest] = [&self.seen, &self.rest].map(|points| directions(points));
        for i in 0..seen.len().min(rest.len()).min(before.len()) {
            rest[i] = smallest_turn(before[i], after[i]) * rest[i];
            seen[i] = turns[i] * rest[i];
        }
        self.seen = along(self.seen[0], &seen, &lengths(&self.seen));
        self.rest = along(self.rest[0], &rest, &lengths(&self.rest));
        Some(())
    }

    fn set_length(&mut self, length: f32) {
        // Rounding of a stretched link is no change of length.
        self.edit.length = if (length - 1.0).abs() < 1e-5 { 1.0 } else { length };
    }

    /// The edit turns the links of its input to these directions.
    fn turn_to(&mut self, ways: &[Vec3]) -> Option<()> {
        let input = self.input()?;
        let frames = link_frames(&input, self.outward);
        let own = directions(&input);
        let turns = self.edit.turns_mut(frames.len());
        for (i, way) in ways.iter().enumerate().take(frames.len()) {
            let still = own[i].distance_squared(*way) < STILL * STILL;
            turns[i] = if still { glam::Vec2::ZERO } else { turn_to(frames[i], *way) };
        }
        self.edit.tidy();
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sharpest bend between two links at rest after all seen links from the tenth on were turned by the same angle, while every other
    /// link is turned by `angle` to one side and the others to the other. The links are straight at rest.
    fn sharpest_bend(angle: f32, is_even: bool) -> f32 {
        let rest = vec![Vec3::NEG_Y; 30];
        let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let turns: Vec<Quat> = (0..30).map(|i| Quat::from_rotation_z(angle * sign(i))).collect();
        let before: Vec<Vec3> = turns.iter().zip(&rest).map(|(turn, rest)| *turn * *rest).collect();
        let combed = Quat::from_axis_angle(Vec3::new(1.0, 1.0, 0.0).normalize_or(Vec3::X), 0.8);
        let after: Vec<Vec3> =
            before.iter().enumerate().map(|(i, way)| if i < 10 { *way } else { combed * *way }).collect();
        let made: Vec<Vec3> = if is_even {
            let made = turns_at_rest(&rest, &turns, [&before, &after]);
            assert!(made[..10].iter().all(|turn| *turn == Quat::IDENTITY), "the root stays");
            made.iter().zip(&rest).map(|(turn, rest)| *turn * *rest).collect()
        } else {
            turns.iter().zip(&after).map(|(turn, way)| turn.inverse() * *way).collect()
        };
        assert!(made[25].angle_between(rest[25]) > 0.1, "the combed links turn at rest");
        made[12..].windows(2).map(|pair| pair[0].angle_between(pair[1])).fold(0.0, f32::max)
    }

    #[test]
    fn links_that_fly_to_opposite_sides_do_not_fold_at_rest() {
        let [even, exact] = [true, false].map(|is_even| sharpest_bend(1.0, is_even));
        println!("evenly {even} rad, each by its own turn {exact} rad");
        assert!(even < 0.1 && exact > 0.6, "{even} {exact}");
        // Hair that is hardly bent is carried back exactly.
        let [even, exact] = [true, false].map(|is_even| sharpest_bend(0.1, is_even));
        assert!((even - exact).abs() < 1e-5, "{even} {exact}");
    }
}
