//! The content of a stage in one file.

use crate::{UsdError, Value};

/// The content of a stage in one file. Prims are numbers that the layer assigns.
pub trait Layer {
    /// The active prims of some types with their types, in the order of their paths.
    ///
    /// # Errors
    /// If the file contradicts itself, as in all methods.
    fn prims(&mut self, types: &[&str]) -> Result<Vec<(usize, String)>, UsdError>;

    /// Number of prims of some types that are not on the stage: inactive ones, classes, and those that are only an `over`, with what is
    /// below them. Prims of variants do not count.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn undefined(&mut self, types: &[&str]) -> Result<usize, UsdError>;

    /// The type of a prim.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn kind(&mut self, prim: usize) -> Result<Option<String>, UsdError>;

    /// The prims of this file that a prim inherits or specializes, strongest first.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn bases(&mut self, prim: usize) -> Result<Vec<usize>, UsdError>;

    /// The prim at a path, active or not.
    fn prim_at(&mut self, path: &str) -> Option<usize>;

    /// The parent of a prim.
    fn parent(&self, prim: usize) -> Option<usize>;

    /// Path of a prim.
    fn path(&self, prim: usize) -> String;

    /// Lets [`Layer::attribute`] return the values at a time code.
    fn set_time(&mut self, time: f64);

    /// The time code that is set.
    fn time(&self) -> Option<f64>;

    /// Value of an attribute at its first time sample or at the time that is set, otherwise its default. `most` limits the length of
    /// compressed arrays.
    ///
    /// Between two samples the value is interpolated as USD does by default: numbers, and arrays of equal length, by straight lines,
    /// quaternions by slerp; integers, tokens, booleans and arrays of different lengths stay until the next sample.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn attribute(&mut self, prim: usize, name: &str, most: usize) -> Result<Option<Value>, UsdError> {
        let around = match self.time() {
            Some(time) => self.around(prim, name, time)?,
            None => Around { before: 0, next: None },
        };
        let Some(value) = self.sample(prim, name, around.before, most)? else {
            return self.default_value(prim, name, most);
        };
        let Some(t) = around.next.filter(|_| value.interpolates()) else { return Ok(Some(value)) };
        // A single integer, and in text a boolean, is a number here; the type of its attribute tells.
        let type_name = self.field(prim, name, "typeName")?;
        let whole = |name: &str| ["int", "u", "bool"].iter().any(|start| name.starts_with(start));
        if matches!(value, Value::Numbers(_)) && type_name.as_ref().and_then(Value::token).is_some_and(whole)
        {
            return Ok(Some(value));
        }
        let next = self.sample(prim, name, around.before + 1, most)?;
        Ok(Some(match next {
            Some(next) => value.toward(&next, t),
            None => value,
        }))
    }

    /// The value of an attribute that is used without samples.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn default_value(&mut self, prim: usize, name: &str, most: usize) -> Result<Option<Value>, UsdError>;

    /// Times at which an attribute has samples, in time codes, ascending; empty without samples.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn sample_times(&mut self, prim: usize, name: &str) -> Result<Vec<f64>, UsdError>;

    /// The samples of an attribute around a time code. Without a copy of all times: players ask for every attribute of every frame.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn around(&mut self, prim: usize, name: &str, time: f64) -> Result<Around, UsdError>;

    /// Value of the sample of a number, as [`Layer::sample_times`] counts them.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn sample(
        &mut self,
        prim: usize,
        name: &str,
        sample: usize,
        most: usize,
    ) -> Result<Option<Value>, UsdError>;

    /// A metadata field of an attribute, such as its interpolation.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn field(&mut self, prim: usize, attribute: &str, field: &str) -> Result<Option<Value>, UsdError>;

    /// The paths that a relationship of a prim points at, or those of the outputs from which an attribute takes its value.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn targets(&mut self, prim: usize, relationship: &str) -> Result<Vec<String>, UsdError>;

    /// A metadata field of the stage.
    ///
    /// # Errors
    /// See [`Layer::prims`].
    fn metadata(&mut self, name: &str) -> Result<Option<Value>, UsdError>;

    /// What the file composes its prims of besides what it states in place, in words; empty if nothing.
    fn arcs(&self) -> Vec<&'static str>;

    /// An error about this file.
    fn malformed(&self, found: String, wanted: &str) -> UsdError;
}

/// The fields with the prims that a prim inherits or specializes.
pub(crate) const BASES: [&str; 2] = ["inheritPaths", "specializes"];

/// What a file composes of, by the fields that it has.
pub(crate) fn arcs_of(has: impl Fn(&str) -> bool) -> Vec<&'static str> {
    let arcs = [
        ("references", "references"),
        ("payload", "payloads"),
        ("subLayers", "sublayers"),
        ("variantSetNames", "variants"),
        (BASES[0], "inherited classes"),
        (BASES[1], "specialized prims"),
    ];
    arcs.into_iter().filter(|(field, _)| has(field)).map(|(_, word)| word).collect()
}

/// What of a file is not read because it composes its prims of it, as a remark; `None` if it does not.
pub fn left_out_arcs(layer: &dyn Layer) -> Option<String> {
    let arcs = layer.arcs();
    let (last, others) = arcs.split_last()?;
    let list =
        if others.is_empty() { (*last).to_owned() } else { format!("{} and {last}", others.join(", ")) };
    let inherits = arcs.iter().any(|arc| arc.starts_with("inherited") || arc.starts_with("specialized"));
    let but =
        if inherits { ", except the visibility and purpose that prims inherit within the file" } else { "" };
    Some(format!("{list} of the file were left out{but}"))
}

/// Nearer to a sample than this, in time codes, a time is that of the sample: times are divided by a rate and multiplied again.
const SAME_CODE: f64 = 1e-6;

/// A time among the samples of an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// The sample at it or before it; the first one for an earlier time.
    pub before: usize,
    /// The part of the way to the next sample, above 0 and below 1, if there is a way to go.
    pub next: Option<f64>,
}

impl Around {
    /// The place of a time among samples, whose times `time_of` gives, ascending.
    pub(crate) fn of<T>(samples: &[T], time: f64, time_of: impl Fn(&T) -> f64) -> Self {
        let before = samples.partition_point(|sample| time_of(sample) <= time + SAME_CODE).saturating_sub(1);
        let next = samples.get(before).zip(samples.get(before + 1)).and_then(|(from, to)| {
            let (from, to) = (time_of(from), time_of(to));
            let t = (time - from) / (to - from);
            (time - from > SAME_CODE && t < 1.0).then_some(t)
        });
        Self { before, next }
    }
}

#[cfg(test)]
mod tests {
    use super::Around;
    use crate::{Layer, Source, Value};

    #[test]
    fn a_time_lies_between_two_samples_or_at_one() {
        let times = [1.0, 3.0, 4.0];
        for (time, before, next) in [
            (-5.0, 0, None),
            (1.0, 0, None),
            (1.5, 0, Some(0.25)),
            (3.0 - 1e-9, 1, None),
            (3.0 + 1e-9, 1, None),
            (3.75, 1, Some(0.75)),
            (9.0, 2, None),
        ] {
            assert_eq!(Around::of(&times, time, |at| *at), Around { before, next }, "{time}");
        }
        assert_eq!(Around::of(&[0.0; 0], 1.0, |at| *at), Around { before: 0, next: None });
        assert_eq!(Around::of(&times, f64::NAN, |at| *at), Around { before: 0, next: None });
    }

    /// Attributes of several types with two samples each, of which one is asked half-way.
    const STAGE: &str = r#"#usda 1.0
def Xform "a"
{
    double3 xformOp:translate.timeSamples = { 0: (0, 2, 4), 10: (1, 4, 8) }
    float xformOp:rotateZ.timeSamples = { 0: 0, 10: 90 }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]
    point3f[] points.timeSamples = { 0: [(0, 0, 0), (1, 1, 1)], 10: [(2, 0, 0), (1, 3, 1)] }
    float[] widths.timeSamples = { 0: [1, 2], 10: [3, 6] }
    point3f[] other.timeSamples = { 0: [(1, 2, 3)], 10: [(4, 5, 6), (7, 8, 9)] }
    int count.timeSamples = { 0: 1, 10: 4 }
    int[] counts.timeSamples = { 0: [1], 10: [4] }
    token kind.timeSamples = { 0: "one", 10: "two" }
    bool on.timeSamples = { 0: 0, 10: 1 }
    quatf turn.timeSamples = { 0: (1, 0, 0, 0), 10: (0, 0, 0, -1) }
    quatf[] turns.timeSamples = { 0: [(1, 0, 0, 0)], 10: [(0, 0, 1, 0)] }
    matrix4d plain.timeSamples = { 0: ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1) ),
        10: ( (3, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (8, 0, 0, 1) ) }
    double still = 7
}
"#;

    fn at(layer: &mut dyn Layer, time: f64, name: &str) -> Value {
        layer.set_time(time);
        let prim = layer.prim_at("/a").expect("a prim");
        layer.attribute(prim, name, 1 << 10).expect(name).expect(name)
    }

    /// The largest difference of the numbers of two values of the same type, each of which must be a number.
    fn off(a: Value, b: Value) -> f32 {
        let numbers = |value: Value| match value {
            Value::Quaternions(turns) => turns.concat(),
            Value::Vectors(vectors) => vectors.into_iter().flat_map(|v| v.to_array()).collect(),
            value => value.into_floats(),
        };
        let (a, b) = (numbers(a), numbers(b));
        assert!(a.len() == b.len() && !a.is_empty());
        assert!(a.iter().chain(&b).all(|number| number.is_finite()), "{a:?} {b:?}");
        a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn values_between_two_samples_are_those_of_usd_in_text_and_crates() {
        let data = openusd::usda::parse(STAGE).expect("a stage");
        let mut bytes = std::io::Cursor::new(Vec::new());
        openusd::usdc::CrateWriter::write(&data, &mut bytes).expect("a crate");
        let bytes = bytes.into_inner();
        let text = crate::open("a.usda", Source::Memory(STAGE.as_bytes()), false).expect("text");
        let binary = crate::open("a.usdc", Source::Memory(&bytes), true).expect("a crate");
        for (mut layer, is_text) in [(text, true), (binary, false)] {
            between(&mut *layer);
            // The writer of the test stores tokens of time samples as strings, which no reader needs.
            if is_text {
                assert_eq!(at(&mut *layer, 9.9, "kind"), Value::Token("one".into()));
                assert_eq!(at(&mut *layer, 10.0, "kind"), Value::Token("two".into()));
            }
        }
    }

    fn between(layer: &mut dyn Layer) {
        let v = glam::Vec3::new;
        let (mut worst, half_turn) = (0.0_f32, std::f64::consts::FRAC_1_SQRT_2);
        let mut matrix = vec![0.0; 16];
        for (place, value) in [(0, 2.0), (5, 1.0), (10, 1.0), (12, 4.0), (15, 1.0)] {
            matrix[place] = value;
        }
        for (name, wanted) in [
            ("xformOp:translate", Value::Numbers(vec![0.5, 3.0, 6.0])),
            ("xformOp:rotateZ", Value::Numbers(vec![45.0])),
            ("points", Value::Vectors(vec![v(1.0, 0.0, 0.0), v(1.0, 2.0, 1.0)])),
            ("widths", Value::Floats(vec![2.0, 4.0])),
            // The shorter way to the other half turn, by half of it: 45 degrees about -Z; the real part comes first.
            ("turn", Value::Numbers(vec![half_turn, 0.0, 0.0, -half_turn])),
            ("turns", Value::Quaternions(vec![[half_turn as f32, 0.0, half_turn as f32, 0.0]])),
            ("plain", Value::Numbers(matrix)),
            ("still", Value::Numbers(vec![7.0])),
        ] {
            let found = at(layer, 5.0, name);
            worst = worst.max(off(found.clone(), wanted));
            // Control: the value that is held until the next sample is another one.
            if name != "still" {
                assert!(off(found, at(layer, 0.0, name)) > 0.2, "{name}");
            }
        }
        println!("largest difference from the values on paper: {worst}");
        assert!(worst < 1e-6, "{worst}");
        for (name, held, next) in [
            (
                "other",
                Value::Vectors(vec![v(1.0, 2.0, 3.0)]),
                Value::Vectors(vec![v(4.0, 5.0, 6.0), v(7.0, 8.0, 9.0)]),
            ),
            ("count", Value::Numbers(vec![1.0]), Value::Numbers(vec![4.0])),
            ("counts", Value::Ints(vec![1]), Value::Ints(vec![4])),
        ] {
            assert_eq!(at(layer, 9.9, name), held, "{name}");
            assert_eq!(at(layer, 10.0, name), next, "{name}");
        }
        // Text gives booleans as numbers.
        let on = at(layer, 0.0, "on");
        assert!(at(layer, 9.9, "on") == on && at(layer, 10.0, "on") != on);
        // A quarter of the way: 22.5 degrees, where straight lines between the components give 18.4.
        let Value::Numbers(turn) = at(layer, 2.5, "turn") else { panic!("a quaternion") };
        let degrees = 2.0 * (-turn[3]).atan2(turn[0]).to_degrees();
        assert!((degrees - 45.0).abs() < 1e-4, "{degrees}");
    }

    #[test]
    fn transforms_between_two_samples_are_interpolated_by_operation() {
        let mut layer = crate::open("a.usda", Source::Memory(STAGE.as_bytes()), false).expect("text");
        let prim = layer.prim_at("/a").expect("a prim");
        let mut turned = |time| {
            layer.set_time(time);
            crate::to_stage(&mut *layer, prim).expect("a transform").transform_point3(glam::DVec3::X)
        };
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let found = turned(5.0);
        assert!(found.abs_diff_eq(glam::DVec3::new(0.5 + half, 3.0 + half, 6.0), 1e-9), "{found}");
        assert!(found.distance(turned(0.0)) > 1.0, "control: held");
    }
}
