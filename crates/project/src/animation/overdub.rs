//! Writes keys for controls that are moved during playback.

use super::leaf::{changed, is_held, numbers_at, set_all};
use crate::project::Project;
use crate::tracks::{Key, STACK_TARGET, Track, curve};

/// Distance between the written part of a track and the keys that keep the rest of the track unchanged, seconds.
const EDGE_SECS: f64 = 1.0 / 60.0;

/// Longest step back in time that counts as backward playback and not as a jump, seconds.
const BACKWARDS_SECS: f64 = 0.5;

/// A wheel or key that rests this long is released, seconds.
const REST_SECS: f64 = 0.4;

/// Number of new keys after which they are thinned during a recording pass: about forty seconds.
const MAX_RAW: usize = Track::MAX_KEYS / 8;
/// Maximum number of written keys; beyond it they are thinned to half as many.
const MAX_WRITTEN: usize = Track::MAX_KEYS / 2;

/// The time of a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time of the timeline, seconds.
    pub secs: f64,
    /// Whether playback runs.
    pub playing: bool,
    /// Whether the pointer holds the control, which then stays active until it is released. A control that is moved by a wheel
    /// or key stays active until it has rested for a while.
    pub held: bool,
    /// Time of a clock that also runs while playback is paused, seconds.
    pub clock_secs: f64,
}

/// A control that is being moved while its track is written.
#[derive(Clone, Debug)]
struct Touch {
    target: String,
    /// The track before this pass; no keys if there was no track.
    before: Vec<Key>,
    /// [`Track::held`].
    held: bool,
    /// Start and end of the written part, seconds.
    from: f64,
    to: f64,
    /// Time of the last change, and the time of the key before the first change (`None` after backward playback).
    last: f64,
    start: Option<f64>,
    written: Vec<Key>,
    /// Number of leading written keys that have been thinned already.
    settled: usize,
    value: Vec<f64>,
    /// Whether the pointer holds the control, as opposed to a wheel or key.
    gripped: bool,
    /// Time of the last movement by [`Moment::clock_secs`].
    moved_secs: f64,
}

/// Records tracks: turns moved controls into keys.
#[derive(Clone, Debug, Default)]
pub struct Overdub {
    armed: bool,
    /// The only target that is recorded; all if `None`.
    only: Option<String>,
    touches: Vec<Touch>,
    refused: Option<String>,
}

impl Overdub {
    /// Whether controls that are moved during playback write keys.
    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// Sets whether controls that are moved from now on write keys. Controls that are held continue until they are released.
    pub fn set_armed(&mut self, armed: bool) {
        (self.armed, self.only) = (armed, None);
    }

    /// From now on the control of `target` alone writes keys: during playback a track, and while paused a key where it is moved.
    pub fn arm_only(&mut self, target: String) {
        (self.armed, self.only) = (true, Some(target));
    }

    /// The only target that writes keys, if not all do.
    pub fn only(&self) -> Option<&str> {
        self.only.as_deref()
    }

    /// Releases all held controls without writing a key, because their tracks were undone.
    pub fn let_go(&mut self) {
        self.touches.clear();
    }

    /// The targets that are being written.
    pub fn writes(&self) -> impl Iterator<Item = &str> + Clone {
        self.touches.iter().map(|touch| touch.target.as_str())
    }

    /// The label of a control that was moved although its track plays. Returned once.
    pub fn take_refused(&mut self) -> Option<String> {
        self.refused.take()
    }

    /// The project as it is shown: values of the timeline, except for held controls.
    pub fn shown(&self, base: &Project, secs: f64) -> Project {
        let mut shown = base.at(secs);
        if !self.touches.is_empty() {
            set_all(
                &mut shown,
                self.touches.iter().map(|touch| (touch.target.as_str(), touch.value.clone())),
            );
        }
        shown
    }

    /// The project after a pass of the interface in which `shown` became `edited`. Changes of written tracks become keys, and the
    /// project's own values of all tracked targets are restored.
    pub fn edit(&mut self, base: &Project, shown: &Project, mut edited: Project, now: Moment) -> Project {
        drop_tracks_of_removed(shown, &mut edited);
        if !self.armed && self.touches.is_empty() && !base.is_animated() {
            return edited;
        }
        let moved = changed(shown, &edited);
        // Removing a track also ends its recording.
        self.touches.retain(|touch| {
            touch.before.is_empty() || edited.timeline.tracks.iter().any(|track| track.target == touch.target)
        });
        let tracked: Vec<String> =
            base.timeline.tracks.iter().filter(|track| track.is_active()).map(|t| t.target.clone()).collect();
        let writes = self.armed && now.playing;
        let mut keep: Vec<String> = tracked.clone();
        for (target, value) in moved {
            let chosen = self.only.as_ref().is_none_or(|only| *only == target);
            let is_tracked = tracked.contains(&target);
            let held = self.touches.iter_mut().find(|touch| touch.target == target);
            if let Some(touch) = held {
                touch.value = unwrapped(&target, value, Some(&touch.value));
                (touch.gripped, touch.moved_secs) = (touch.gripped || now.held, now.clock_secs);
            } else if writes && chosen && has_room(&edited, &target) {
                let from = numbers_at(shown, &target).unwrap_or_else(|| value.clone());
                self.touches.push(Touch::begin(&edited, target.clone(), now, from, value));
                keep.push(target);
            } else if is_tracked && !now.playing {
                let before = numbers_at(shown, &target);
                if let Some(track) = edited.timeline.tracks.iter_mut().find(|t| t.target == target) {
                    let value = unwrapped(&target, value, before.as_ref());
                    track.put(now.secs, value);
                }
            } else if self.only.as_ref() == Some(&target) && !now.playing {
                // The first key of the control that is recorded alone.
                if edited.set_key(&target, now.secs, value) {
                    keep.push(target);
                }
            } else if is_tracked {
                let label = Track::new(target).label_in(&edited.hair.stack);
                self.refused.get_or_insert(label);
            }
        }
        for touch in &mut self.touches {
            keep.push(touch.target.clone());
            touch.go_on(&mut edited, now);
        }
        self.touches.retain(|touch| !touch.ends(now));
        let own = keep.iter().filter_map(|target| Some((target.as_str(), numbers_at(base, target)?)));
        let own: Vec<_> = own.collect();
        set_all(&mut edited, own);
        edited
    }
}

/// Removes the tracks of layers and groups that an edit has removed: a later layer may get the number of one of them.
fn drop_tracks_of_removed(before: &Project, edited: &mut Project) {
    let (before, after) = (&before.hair.stack, &edited.hair.stack);
    if !edited.timeline.tracks.iter().any(|track| track.target.starts_with(STACK_TARGET)) {
        return;
    }
    let layers = before.layers.iter().filter(|layer| after.layer(layer.id).is_none());
    let groups = before.groups.iter().filter(|group| after.group(group.id).is_none());
    let gone: Vec<String> = layers
        .map(|layer| format!("{STACK_TARGET}{}/", layer.id))
        .chain(groups.map(|group| format!("{STACK_TARGET}group{}/", group.id)))
        .collect();
    if !gone.is_empty() {
        edited.timeline.tracks.retain(|track| !gone.iter().any(|of| track.target.starts_with(of)));
    }
}

/// Whether the project has a track for the target, or room for another track.
fn has_room(project: &Project, target: &str) -> bool {
    let tracks = &project.timeline.tracks;
    tracks.len() < Track::MAX || tracks.iter().any(|track| track.target == target)
}

/// Unwraps an angle, so that it continues from the previous one without a jump of a full turn.
fn unwrapped(target: &str, mut value: Vec<f64>, before: Option<&Vec<f64>>) -> Vec<f64> {
    use std::f64::consts::TAU;
    if target == "camera/azimuth"
        && let (Some(now), Some(before)) = (value.first_mut(), before.and_then(|before| before.first()))
    {
        *now += TAU * ((before - *now) / TAU).round();
    }
    value
}

impl Touch {
    /// Starts recording a control that had the value `from`.
    fn begin(project: &Project, target: String, now: Moment, from: Vec<f64>, value: Vec<f64>) -> Self {
        let secs = now.secs;
        let track = project.timeline.tracks.iter().find(|track| track.target == target);
        let before = track.map_or_else(Vec::new, |track| track.keys.clone());
        let held = is_held(project, &target);
        let value = unwrapped(&target, value, Some(&from));
        // A key with the old value, so that the track does not ramp from the key before it.
        let start = Key { secs: (secs - EDGE_SECS).max(0.0), value: from };
        let (at, first) = (start.secs, Some(start.secs));
        Self {
            target,
            before,
            held,
            from: at,
            to: at,
            last: secs,
            start: first,
            written: vec![start],
            settled: 0,
            value,
            gripped: now.held,
            moved_secs: now.clock_secs,
        }
    }

    /// Whether the control is released at `now`.
    fn ends(&self, now: Moment) -> bool {
        let lasts = if self.gripped { now.held } else { now.clock_secs - self.moved_secs < REST_SECS };
        !(lasts && now.playing)
    }

    /// Writes the value at `now`, and merges the written keys into the track.
    fn go_on(&mut self, project: &mut Project, now: Moment) {
        if now.secs < self.last && self.last - now.secs < BACKWARDS_SECS {
            self.go_back(now.secs);
            return self.put(project, now);
        }
        // The loop restarted: finish the written part and begin a new one at the start.
        if now.secs < self.last {
            let track = self.joined(true);
            *self = Self {
                before: track,
                from: now.secs,
                to: now.secs,
                last: now.secs,
                start: None,
                written: Vec::new(),
                settled: 0,
                target: std::mem::take(&mut self.target),
                value: std::mem::take(&mut self.value),
                ..*self
            };
        }
        // Keep keys apart even if time passes slowly: drop the last key while it is too close to the one before it.
        let apart = |a: &Key, secs: f64| secs - a.secs >= Track::NEAREST_SECS;
        let crowded = match self.written.as_slice() {
            [] => false,
            [only] => !apart(only, now.secs),
            // Two changes at the same time are merged.
            [.., before, last] => !apart(before, last.secs) || last.secs >= now.secs,
        };
        if crowded {
            self.written.pop();
        }
        self.make_room();
        self.written.push(Key { secs: now.secs.max(self.from), value: self.value.clone() });
        (self.to, self.last) = (self.to.max(now.secs), now.secs);
        self.put(project, now);
    }

    /// Handles backward playback: the written part grows at its start.
    fn go_back(&mut self, secs: f64) {
        if let Some(start) = self.start.take() {
            self.written.retain(|key| key.secs != start);
            (self.from, self.to) = (self.last, self.last);
        }
        self.written.retain(|key| key.secs >= secs + Track::NEAREST_SECS);
        if self.written.len() >= MAX_WRITTEN {
            self.written = curve::thinned_to(&self.written, MAX_WRITTEN / 2);
        }
        self.settled = 0;
        self.written.insert(0, Key { secs, value: self.value.clone() });
        (self.from, self.last) = (self.from.min(secs), secs);
    }

    /// Thins the written keys when there are many, so that a pass can last for minutes.
    fn make_room(&mut self) {
        self.settled = self.settled.min(self.written.len());
        if self.written.len() - self.settled >= MAX_RAW {
            self.written = self.thinned();
            self.settled = self.written.len();
        }
        if self.written.len() >= MAX_WRITTEN {
            self.written = curve::thinned_to(&self.written, MAX_WRITTEN / 2);
            self.settled = self.written.len();
        }
    }

    /// The written keys after thinning. Keys that were thinned before are kept, so that errors do not accumulate.
    fn thinned(&self) -> Vec<Key> {
        let (settled, new) = self.written.split_at(self.settled.saturating_sub(1).min(self.written.len()));
        [settled.to_vec(), curve::thinned(new)].concat()
    }

    /// Merges the written keys into the project's track.
    fn put(&self, project: &mut Project, now: Moment) {
        let keys = self.joined(self.ends(now));
        let tracks = &mut project.timeline.tracks;
        // In range, so that saving and loading changes nothing.
        let Some(track) = (Track { keys, held: self.held, ..Track::new(self.target.clone()) }).in_range()
        else {
            return;
        };
        match tracks.iter_mut().find(|track| track.target == self.target) {
            Some(old) => *old = track,
            None => tracks.push(track),
        }
    }

    /// The old track with the written part in its place. `ended` thins the written keys.
    fn joined(&self, ended: bool) -> Vec<Key> {
        let written = if ended { self.thinned() } else { self.written.clone() };
        if self.before.is_empty() {
            return written;
        }
        let edge =
            |secs: f64| curve::value_at(&self.before, secs, self.held).map(|value| Key { secs, value });
        let (from, to) = (self.from, self.to);
        let mut keys: Vec<Key> =
            self.before.iter().filter(|key| key.secs < from - EDGE_SECS).cloned().collect();
        if self.before.first().is_some_and(|key| key.secs < from) {
            keys.extend(edge(from - 0.5 * EDGE_SECS).filter(|key| key.secs >= 0.0));
        }
        keys.extend(written);
        if self.before.last().is_some_and(|key| key.secs > to + EDGE_SECS) {
            keys.extend(edge(to + EDGE_SECS));
        }
        keys.extend(self.before.iter().filter(|key| key.secs > to + 1.5 * EDGE_SECS).cloned());
        keys.truncate(Track::MAX_KEYS);
        keys
    }
}
