//! Trimming the motion to a part of its clip.

use super::super::Project;

impl Project {
    /// Trims the motion to the range between the in and out points of recordings (frames of the timeline). Markers, tracks and the sound
    /// keep their places relative to the motion; those outside the range are removed.
    pub fn trim_to_points(&mut self) {
        let fps = self.recording.fps.max(1e-3);
        let first = self.recording.first_frame as f64 / fps;
        let end = self.recording.end_frame.map(|end| end as f64 / fps);
        let speed = f64::from(self.motion.speed);
        let before = f64::from(self.motion.start_secs);
        self.motion.start_secs = (before + first * speed) as f32;
        if let Some(end) = end {
            self.motion.end_secs = Some((before + end * speed) as f32);
        }
        (self.recording.first_frame, self.recording.end_frame) = (0, None);
        self.sound.offset_secs -= first;
        self.timeline.shift(-first, end.map_or(f64::INFINITY, |end| end - first));
    }

    /// Restores the whole clip.
    pub fn trim_nothing(&mut self) {
        let speed = f64::from(self.motion.speed.max(1e-3));
        let shift = f64::from(self.motion.start_secs) / speed;
        (self.motion.start_secs, self.motion.end_secs) = (0.0, None);
        (self.recording.first_frame, self.recording.end_frame) = (0, None);
        self.sound.offset_secs += shift;
        self.timeline.shift(shift, f64::INFINITY);
    }
}

impl super::TimelineSection {
    /// Moves all markers and keys by `secs`, then removes those outside `0..=end_secs`.
    pub fn shift(&mut self, secs: f64, end_secs: f64) {
        let inside = |at: f64| at >= -1e-9 && at <= end_secs + 1e-9;
        self.markers.iter_mut().for_each(|marker| marker.secs += secs);
        self.markers.retain(|marker| inside(marker.secs));
        self.markers.iter_mut().for_each(|marker| marker.secs = marker.secs.max(0.0));
        for track in &mut self.tracks {
            // A track with no key left inside keeps the value that it had there.
            let at_start = track.value_at(-secs);
            let beyond = track.keys.last().is_some_and(|key| key.secs + secs > end_secs + 1e-9);
            let at_end = track.value_at(end_secs - secs).filter(|_| beyond && end_secs.is_finite());
            track.keys.iter_mut().for_each(|key| key.secs += secs);
            track.keys.retain(|key| inside(key.secs));
            track.keys.iter_mut().for_each(|key| key.secs = key.secs.max(0.0));
            if let Some(value) = at_start
                && track.keys.first().is_none_or(|key| key.secs > 0.0)
            {
                track.put(0.0, value);
            }
            if let Some(value) = at_end {
                track.put(end_secs, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sections::Marker;
    use super::*;
    use crate::tracks::{Key, Track};

    #[test]
    fn trimming_keeps_markers_and_keys_at_their_place_in_the_motion() {
        let mut project = Project::default();
        project.motion.speed = 2.0;
        (project.recording.fps, project.recording.first_frame) = (30.0, 60);
        project.recording.end_frame = Some(150);
        let marker = |secs| Marker { secs, name: String::new() };
        project.timeline.markers = vec![marker(1.0), marker(3.0), marker(6.0)];
        let key = |secs: f64| Key { secs, value: vec![secs] };
        project.timeline.tracks =
            vec![Track { keys: vec![key(0.0), key(4.0), key(8.0)], ..Track::new("camera/distance") }];
        let value = |project: &Project, secs| project.timeline.tracks[0].value_at(secs).expect("keys")[0];
        let before = project.clone();
        project.trim_to_points();
        assert_eq!((project.motion.start_secs, project.motion.end_secs), (4.0, Some(10.0)));
        assert_eq!((project.recording.first_frame, project.recording.end_frame), (0, None));
        assert_eq!(project.timeline.markers, [marker(1.0)]);
        assert_eq!(value(&project, 0.0), value(&before, 2.0));
        assert_eq!(value(&project, 2.0), value(&before, 4.0));
        assert!((value(&project, 3.0) - value(&before, 5.0)).abs() < 1e-9, "at the end as well");
        // Again, of what is left: seconds of the clip count from its own start.
        (project.recording.first_frame, project.recording.end_frame) = (30, None);
        project.trim_to_points();
        assert_eq!((project.motion.start_secs, project.motion.end_secs), (6.0, Some(10.0)));
        project.trim_nothing();
        assert_eq!((project.motion.start_secs, project.motion.end_secs), (0.0, None));
        assert_eq!(value(&project, 4.0), value(&before, 4.0));
    }
}
