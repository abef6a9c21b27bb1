//! The keys of a face as tracks.

use std::collections::BTreeMap;

use crate::{FaceTrack, Interpolation, Track};

/// The weights of each morph, linear from key to key, between the first and the last frame of the motion.
pub(super) fn tracks(
    faces: &BTreeMap<String, BTreeMap<u32, f32>>,
    [first, last]: [u32; 2],
) -> Vec<FaceTrack> {
    let tracks =
        faces.iter().filter(|(_, keys)| keys.values().any(|weight| *weight != 0.0)).map(|(name, keys)| {
            let inside = keys.range(first..=last).map(|(&frame, &weight)| (frame, weight));
            let mut all: BTreeMap<u32, f32> = inside.collect();
            // The motion may be shorter than the face.
            for end in [first, last] {
                all.entry(end).or_insert_with(|| weight_at(keys, end));
            }
            let times = all.keys().map(|&frame| (f64::from(frame - first) / 30.0) as f32).collect();
            let values = all.into_values().collect();
            FaceTrack {
                name: name.clone(),
                track: Track { times, values, interpolation: Interpolation::Linear },
            }
        });
    tracks.collect()
}

/// The weight at a frame; constant before the first key and after the last.
fn weight_at(keys: &BTreeMap<u32, f32>, frame: u32) -> f32 {
    match (keys.range(..=frame).next_back(), keys.range(frame..).next()) {
        (Some((&a, &from)), Some((&b, &to))) if b > a => {
            from + (to - from) * ((frame - a) as f32 / (b - a) as f32)
        }
        (Some((_, &weight)), _) | (None, Some((_, &weight))) => weight,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::tracks;

    #[test]
    fn a_face_is_as_long_as_its_motion() {
        let keys = [(0, 0.0), (20, 1.0), (40, 0.5)].into();
        let faces = [("あ".to_owned(), keys), ("い".to_owned(), [(0, 0.0)].into())].into();
        let found = tracks(&faces, [10, 30]);
        assert_eq!(found.len(), 1, "what is always 0 is no track");
        assert_eq!(found[0].track.values, [0.5, 1.0, 0.75]);
        let times: Vec<f32> = [0.0, 10.0, 20.0].map(|frame: f32| frame / 30.0).to_vec();
        assert!(found[0].track.times.iter().zip(times).all(|(found, time)| (found - time).abs() < 1e-6));
        assert_eq!(tracks(&faces, [60, 90])[0].track.values, [0.5, 0.5]);
    }
}
