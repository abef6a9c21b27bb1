//! Weights of a face: those that a user sets, and those of a motion.

mod preset;
mod weights;

pub(crate) use preset::preset_of;
pub use weights::{FaceWeight, FaceWeights};

use crate::{Body, Clip, Expression, ExpressionTrack, FaceTrack, MorphTrack, MotionFile};

/// Names of the weights that a body can be given: its expressions, otherwise its morph targets, each name once, in the order of the file.
pub fn face_names(body: &Body) -> Vec<&str> {
    let mut seen = std::collections::BTreeSet::new();
    let expressions = body.expressions.iter().map(|expression| expression.name.as_str());
    let morphs = body.skin.morphs.iter().map(|morph| morph.name.as_str());
    let names: Vec<&str> = if body.expressions.is_empty() { morphs.collect() } else { expressions.collect() };
    names.into_iter().filter(|name| seen.insert(*name)).collect()
}

/// Weights that are added to those of a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Face {
    added: Vec<(usize, f32)>,
}

impl Face {
    /// The weights of a body for weights by name: of expressions, or of all morph targets with a name that no expression has. Other names
    /// have no effect.
    pub fn new(body: &Body, weights: &FaceWeights) -> Self {
        let mut sums = vec![0.0; body.skin.morphs.len()];
        for (name, &FaceWeight { weight }) in weights.0.iter().filter(|(_, of)| of.weight.is_finite()) {
            let mut is_expression = false;
            for expression in body.expressions.iter().filter(|expression| expression.name == *name) {
                expression.add(weight, &mut sums);
                is_expression = true;
            }
            if !is_expression {
                let named = body.skin.morphs.iter().zip(&mut sums).filter(|(morph, _)| morph.name == *name);
                named.for_each(|(_, sum)| *sum += weight);
            }
        }
        Self { added: sums.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0).collect() }
    }

    /// Adds the weights to those of a pose.
    pub fn apply(&self, morph_weights: &mut [f32]) {
        for &(morph, weight) in &self.added {
            if let Some(sum) = morph_weights.get_mut(morph) {
                *sum += weight;
            }
        }
    }
}

/// What a name of a motion drives.
#[derive(Default)]
struct Place {
    expressions: Vec<usize>,
    morphs: Vec<usize>,
}

impl Place {
    /// The expression with that name, otherwise the morph targets with that name, otherwise the expression of its preset, otherwise the
    /// morph targets of its preset.
    fn of(name: &str, body: &Body) -> Self {
        let preset = preset_of(name);
        let expressions = |fits: &dyn Fn(&Expression) -> bool| Self {
            expressions: body.expressions.iter().position(fits).into_iter().collect(),
            ..Self::default()
        };
        let morphs = |fits: &dyn Fn(&str) -> bool| Self {
            morphs: (0..body.skin.morphs.len()).filter(|&m| fits(&body.skin.morphs[m].name)).collect(),
            ..Self::default()
        };
        let is_preset = |of: Option<&str>| preset.is_some() && of == preset;
        expressions(&|expression| expression.name == name)
            .or_else(|| morphs(&|morph| morph == name))
            .or_else(|| expressions(&|expression| is_preset(expression.preset)))
            .or_else(|| morphs(&|morph| is_preset(preset_of(morph))))
    }

    fn or_else(self, other: impl FnOnce() -> Self) -> Self {
        if self.is_empty() { other() } else { self }
    }

    fn is_empty(&self) -> bool {
        self.expressions.is_empty() && self.morphs.is_empty()
    }
}

/// Gives a clip the face of a motion. A name drives the expression with that name, otherwise the morph targets with that name, otherwise
/// what has the same preset.
pub(crate) fn follow(motion: &MotionFile, body: &Body, clip: &mut Clip) {
    for FaceTrack { name, track } in &motion.faces {
        let Place { expressions, morphs } = Place::of(name, body);
        let tracks = expressions.into_iter();
        clip.expressions
            .extend(tracks.map(|expression| ExpressionTrack { expression, track: track.clone() }));
        let tracks = morphs.into_iter();
        clip.morphs.extend(tracks.map(|first| MorphTrack { first, count: 1, track: track.clone() }));
    }
}

/// Names of weights that a user set and a body does not have, each with the most similar one of [`face_names`], if it has any.
pub fn unknown_faces<'a>(weights: &'a FaceWeights, body: &'a Body) -> Vec<(&'a str, Option<&'a str>)> {
    let is_morph = |name: &str| body.skin.morphs.iter().any(|morph| morph.name == name);
    let names = face_names(body);
    let unknown = weights.0.iter().filter(|(_, of)| of.weight != 0.0);
    let unknown = unknown.map(|(name, _)| name.as_str());
    let unknown = unknown.filter(|name| !names.contains(name) && !is_morph(name));
    let nearest = |name: &str| names.iter().copied().min_by_key(|known| difference(name, known));
    unknown.take(MOST_UNKNOWN).map(|name| (name, nearest(name))).collect()
}

/// The most unknown names that are told.
const MOST_UNKNOWN: usize = 8;

/// How many characters must be changed, added or removed to turn one name into the other, whatever their case (Levenshtein 1966); of the
/// first 80 of each.
fn difference(a: &str, b: &str) -> usize {
    let letters = |name: &str| name.chars().take(80).flat_map(char::to_lowercase).collect::<Vec<char>>();
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let changed = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// Names of a motion's face that a body has no place for.
pub fn unplaced_faces<'a>(motion: &'a MotionFile, body: &Body) -> Vec<&'a str> {
    let names = motion.faces.iter().map(|face| face.name.as_str());
    names.filter(|name| Place::of(name, body).is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::{Face, FaceWeights, difference, face_names, follow, unknown_faces, unplaced_faces};
    use crate::{
        Body, Clip, Expression, FaceTrack, Interpolation, Joint, MorphTarget, MotionFile, Pose, Skeleton,
        SkinData, Track, pose_at,
    };

    fn body() -> Body {
        let morph = |name: &str| MorphTarget { name: name.into(), ..MorphTarget::default() };
        let morphs = ["a", "b", "a"].map(morph).to_vec();
        let (translation, rotation, scale) = (glam::Vec3::ZERO, glam::Quat::IDENTITY, glam::Vec3::ONE);
        let root = Joint { name: "root".into(), parent: None, translation, rotation, scale };
        let mut skeleton = Skeleton { joints: vec![root], ..Skeleton::default() };
        skeleton.update_rest();
        Body { skeleton, skin: SkinData { morphs, ..SkinData::default() }, ..Body::default() }
    }

    #[test]
    fn weights_by_name_move_expressions_or_morph_targets() {
        let mut body = body();
        assert_eq!(face_names(&body), ["a", "b"]);
        let mut wrong = FaceWeights::default();
        wrong.set("a", 1.0);
        wrong.set("bb", 1.0);
        wrong.set("none", 0.0);
        assert_eq!(unknown_faces(&wrong, &body), [("bb", Some("b"))]);
        assert_eq!((difference("kitten", "Sitting"), difference("", "abc"), difference("a", "a")), (3, 3, 0));
        let mut weights = FaceWeights::default();
        for (name, weight) in [("a", 0.5), ("c", 1.0), ("b", f32::NAN)] {
            weights.set(name, weight);
        }
        let mut sums = [0.25, 0.0, 0.0];
        Face::new(&body, &weights).apply(&mut sums);
        assert_eq!(sums, [0.75, 0.0, 0.5]);
        body.expressions = vec![
            Expression { name: "a".into(), morphs: vec![(1, 0.5), (99, 1.0)], ..Expression::default() },
            Expression { name: "c".into(), is_binary: true, morphs: vec![(0, 1.0)], ..Expression::default() },
        ];
        assert_eq!(face_names(&body), ["a", "c"]);
        let mut sums = [0.0; 3];
        weights.set("c", 0.6);
        Face::new(&body, &weights).apply(&mut sums);
        assert_eq!(sums, [1.0, 0.25, 0.0]);
    }

    #[test]
    fn a_face_of_a_motion_goes_to_what_has_its_name_or_its_preset() {
        let mut body = body();
        body.skin.morphs.push(MorphTarget { name: "mouthOpen".into(), ..MorphTarget::default() });
        let blink = Expression {
            name: "zu".into(),
            preset: Some("blink"),
            morphs: vec![(1, 1.0)],
            ..Expression::default()
        };
        body.expressions = vec![blink];
        let track = |end: f32| Track {
            times: [0.0, 1.0].into(),
            values: vec![0.0, end],
            interpolation: Interpolation::Linear,
        };
        let faces = [("b", 0.5), ("まばたき", 1.0), ("あ", 0.25), ("nothing", 1.0)];
        let faces = faces.map(|(name, end)| FaceTrack { name: name.into(), track: track(end) }).to_vec();
        let motion = MotionFile { faces, ..MotionFile::default() };
        assert_eq!(unplaced_faces(&motion, &body), ["nothing"]);
        let mut clip = Clip { duration_secs: 2.0, ..Clip::default() };
        follow(&motion, &body, &mut clip);
        let mut pose = Pose::default();
        pose_at(&body, Some(&clip), 0.5, &mut pose);
        // The morph target `b` of the file, and the expression that moves it; `あ` opens the mouth, by `a` too.
        assert_eq!(pose.morph_weights, [0.125, 0.25 + 0.5, 0.125, 0.125]);
    }
}
