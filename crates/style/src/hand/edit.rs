//! What brushes did to one guide and to the strands that follow it.

use glam::{Vec2, Vec3};

use super::place::{direction_of, turn_of};

/// Something that brushes change in strands, with a value at each point of a guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandChannel {
    /// Factor on the distance of strands from the middle of their lock.
    Spread,
    /// Radius of curls, metres.
    Curl,
    /// Turns of the strands about the middle of their lock.
    Twist,
    /// Width of strands relative to the present one.
    Width,
}

impl HandChannel {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Spread, Self::Curl, Self::Twist, Self::Width];

    /// The value that changes nothing.
    pub const fn neutral(self) -> f32 {
        match self {
            Self::Spread | Self::Width => 1.0,
            Self::Curl | Self::Twist => 0.0,
        }
    }

    /// The least and the greatest value.
    pub const fn range(self) -> [f32; 2] {
        match self {
            Self::Spread | Self::Width => [0.0, 4.0],
            Self::Curl => [0.0, 0.1],
            Self::Twist => [-30.0, 30.0],
        }
    }
}

/// What brushes did to one guide and to the strands that follow it.
#[derive(Clone, Debug, PartialEq)]
pub struct HandEdit {
    /// How each link is turned in its frame (see [`super::turned_by`]); empty where none is.
    pub turns: Vec<Vec2>,
    /// The channels of [`HandChannel`] in their order, at each point; empty where neutral.
    pub channels: [Vec<f32>; 4],
    /// Length of a turn of curls, metres.
    pub pitch: f32,
    /// Factor on the length.
    pub length: f32,
    /// The part of the links that a cut left.
    pub kept: f32,
    /// Whether the lock was removed.
    pub removed: bool,
}

impl Default for HandEdit {
    fn default() -> Self {
        Self {
            turns: Vec::new(),
            channels: std::array::from_fn(|_| Vec::new()),
            pitch: Self::PITCH,
            length: 1.0,
            kept: 1.0,
            removed: false,
        }
    }
}

impl HandEdit {
    /// The pitch of curls where none was chosen, metres.
    pub const PITCH: f32 = 0.03;
    /// The range of pitches, metres.
    pub const PITCHES: [f32; 2] = [0.004, 0.5];
    /// The range of factors on the length.
    pub const LENGTHS: [f32; 2] = [0.05, 4.0];

    /// Whether it changes nothing.
    pub fn is_none(&self) -> bool {
        self.turns.is_empty()
            && self.channels.iter().all(Vec::is_empty)
            && self.length == 1.0
            && self.kept == 1.0
            && !self.removed
    }

    /// Leaves out turns and channels that change nothing.
    pub fn tidy(&mut self) {
        if self.turns.iter().all(|turn| *turn == Vec2::ZERO) {
            self.turns.clear();
        }
        for (kind, values) in HandChannel::ALL.into_iter().zip(&mut self.channels) {
            if values.iter().all(|value| *value == kind.neutral()) {
                values.clear();
            }
        }
    }

    /// The turns, one per link, to be changed.
    pub fn turns_mut(&mut self, links: usize) -> &mut [Vec2] {
        self.turns = self.turns_at(links);
        self.turns.resize(links, Vec2::ZERO);
        &mut self.turns
    }

    /// A channel, one value per point, to be changed.
    pub fn channel_mut(&mut self, kind: HandChannel, links: usize) -> &mut [f32] {
        let values = (0..=links).map(|i| self.channel(kind, i as f32 / links.max(1) as f32)).collect();
        let own = &mut self.channels[kind as usize];
        *own = values;
        own
    }

    /// The turns of a guide of so many links; empty where none is turned.
    pub fn turns_at(&self, links: usize) -> Vec<Vec2> {
        let own = &self.turns;
        if own.is_empty() || own.len() == links {
            return own.clone();
        }
        let at = |i: usize| {
            let spot =
                ((i as f32 + 0.5) / links as f32 * own.len() as f32 - 0.5).clamp(0.0, (own.len() - 1) as f32);
            let (low, part) = (spot as usize, spot.fract());
            let next = own[(low + 1).min(own.len() - 1)];
            mixed([(1.0 - part, own[low]), (part, next)].into_iter())
        };
        (0..links).map(at).collect()
    }

    /// A channel at a place along the guide: 0 is the root, 1 the tip.
    pub fn channel(&self, kind: HandChannel, place: f32) -> f32 {
        let values = &self.channels[kind as usize];
        let Some(last) = values.len().checked_sub(1) else { return kind.neutral() };
        let spot = (place * last as f32).clamp(0.0, last as f32);
        let (low, part) = (spot as usize, spot.fract());
        if part == 0.0 { values[low] } else { values[low] + (values[low + 1] - values[low]) * part }
    }

    /// The mean of edits with weights that sum to 1 or less; the rest is no edit.
    pub fn mean(parts: &[(f32, &Self)]) -> Self {
        let rest = 1.0 - parts.iter().map(|(weight, _)| weight).sum::<f32>();
        let links = parts.iter().map(|(_, edit)| edit.links()).max().unwrap_or(0);
        let mut out = Self::default();
        if parts.iter().any(|(_, edit)| !edit.turns.is_empty()) {
            let turns: Vec<(f32, Vec<Vec2>)> =
                parts.iter().map(|(weight, edit)| (*weight, edit.turns_at(links))).collect();
            let of = |i: usize| {
                let own = turns.iter().map(|(w, turns)| (*w, turns.get(i).copied().unwrap_or_default()));
                mixed(own.chain([(rest, Vec2::ZERO)]))
            };
            out.turns = (0..links).map(of).collect();
        }
        for (kind, values) in HandChannel::ALL.into_iter().zip(&mut out.channels) {
            if parts.iter().any(|(_, edit)| !edit.channels[kind as usize].is_empty()) {
                let of = |i: usize| {
                    let place = i as f32 / links.max(1) as f32;
                    let own = parts.iter().map(|(weight, edit)| weight * edit.channel(kind, place));
                    own.sum::<f32>() + rest * kind.neutral()
                };
                *values = (0..=links).map(of).collect();
            }
        }
        let mean = |of: fn(&Self) -> f32, neutral: f32| {
            neutral + parts.iter().map(|(weight, edit)| weight * (of(edit) - neutral)).sum::<f32>()
        };
        out.length = mean(|edit| edit.length, 1.0);
        out.kept = mean(|edit| edit.kept, 1.0);
        let curled = parts.iter().filter(|(_, edit)| !edit.channels[HandChannel::Curl as usize].is_empty());
        let (sum, weight) = curled.fold((0.0, 0.0), |(s, w), (part, edit)| (s + part * edit.pitch, w + part));
        out.pitch = if weight > 0.0 { sum / weight } else { Self::PITCH };
        let removed = parts.iter().filter(|(_, edit)| edit.removed).map(|(weight, _)| weight);
        out.removed = removed.sum::<f32>() > 0.5;
        out.tidy();
        out
    }

    /// The same on the other side of the head.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mut out = self.clone();
        for turn in &mut out.turns {
            turn.x = -turn.x;
        }
        for twist in &mut out.channels[HandChannel::Twist as usize] {
            *twist = -*twist;
        }
        out
    }

    /// The links that it was made for; 0 where it changes no link or point.
    pub fn links(&self) -> usize {
        let points = self.channels.iter().map(|values| values.len().saturating_sub(1)).max();
        self.turns.len().max(points.unwrap_or(0))
    }
}

/// The mean direction of turns, as a turn.
fn mixed(parts: impl Iterator<Item = (f32, Vec2)> + Clone) -> Vec2 {
    if parts.clone().all(|(weight, turn)| weight == 0.0 || turn == Vec2::ZERO) {
        return Vec2::ZERO;
    }
    let sum: Vec3 = parts.map(|(weight, turn)| direction_of(turn) * weight).sum();
    sum.try_normalize().map_or(Vec2::ZERO, turn_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(links: usize) -> HandEdit {
        HandEdit {
            turns: (0..links).map(|i| Vec2::new(0.1, 0.02 * i as f32)).collect(),
            ..HandEdit::default()
        }
    }

    #[test]
    fn edits_of_other_counts_of_links_keep_their_places() {
        let edit = turned(30);
        for links in [1, 10, 31, 60] {
            let turns = edit.turns_at(links);
            assert_eq!(turns.len(), links);
            for (i, turn) in turns.iter().enumerate() {
                let wanted = (0.02 * ((i as f32 + 0.5) / links as f32 * 30.0 - 0.5)).clamp(0.0, 0.58);
                assert!(turn.distance(Vec2::new(0.1, wanted)) < 2e-3, "{links} {i}: {turn} {wanted}");
            }
        }
    }

    #[test]
    fn means_fade_to_no_edit() {
        let edit = HandEdit { length: 2.0, ..turned(8) };
        let half = HandEdit::mean(&[(0.25, &edit), (0.25, &edit)]);
        assert!((half.length - 1.5).abs() < 1e-6);
        for (half, whole) in half.turns.iter().zip(&edit.turns) {
            assert!(half.distance(*whole * 0.5) < 1e-3, "{half} {whole}");
        }
        assert!(HandEdit::mean(&[]).is_none() && HandEdit::mean(&[(0.5, &HandEdit::default())]).is_none());
        // Hair that is turned round entirely keeps a side.
        let round = HandEdit { turns: vec![Vec2::new(3.1, 0.0)], ..HandEdit::default() };
        let other = HandEdit { turns: vec![Vec2::new(-3.1, 0.0)], ..HandEdit::default() };
        let mean = HandEdit::mean(&[(0.6, &round), (0.4, &other)]);
        assert!(mean.turns[0].length() > 3.0, "{}", mean.turns[0]);
    }
}
