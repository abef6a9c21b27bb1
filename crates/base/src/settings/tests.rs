use glam::Vec3;

use super::{
    Choices, Part, PartMut, Setting, SettingError, Settings, Unit, Value, entries, find, set, set_value,
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Round,
    LongAndThin,
}

impl Choices for Shape {
    const ALL: &'static [Self] = &[Self::Round, Self::LongAndThin];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Round => ("round", "Round"),
            Self::LongAndThin => ("long-and-thin", "Long and thin"),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Inner {
    angle: f32,
    slices: u32,
    end: Option<u64>,
}

impl Default for Inner {
    fn default() -> Self {
        Self { angle: 0.5, slices: 128, end: None }
    }
}

impl Settings for Inner {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, angle), [-3.0, 3.0], "Angle", "Turns.").unit(Unit::RADIANS).wraps(),
        Setting::one_of(field!(Self, slices), &[128, 256, 512], "Slices", "Cuts."),
        Setting::count(field!(Self, end), [1, 20], "End", "Ends.").or_none("the last one"),
    ];
}

#[derive(Clone, Debug, PartialEq)]
struct Outer {
    length: f32,
    resolution: u32,
    points: u32,
    on: bool,
    shape: Shape,
    color: Vec3,
    way: [f32; 3],
    at: Vec3,
    inner: Inner,
}

impl Default for Outer {
    fn default() -> Self {
        Self {
            length: 0.3,
            resolution: 512,
            points: 0,
            on: true,
            shape: Shape::Round,
            color: Vec3::ONE,
            way: [0.0, 1.0, 0.0],
            at: Vec3::ZERO,
            inner: Inner::default(),
        }
    }
}

impl Settings for Outer {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, length), [0.02, 1.0], "Length", "Longer.")
            .unit(Unit::METRES_AS_CM)
            .symbol("l"),
        Setting::count(field!(Self, resolution), [64, 2048], "Resolution", "Finer.")
            .unit(Unit::TEXELS)
            .step(16),
        Setting::count(field!(Self, points), [4, 64], "Points", "More.").or_zero(),
        Setting::switch(field!(Self, on), "On", "Shines."),
        Setting::choice::<Shape>(field!(Self, shape), "Shape", "Forms."),
        Setting::color(field!(Self, color), "Colour", "Paints."),
        Setting::direction(field!(Self, way), "Way", "Aims."),
        Setting::vector(field!(Self, at), [-1.0, 1.0], "At", ["Left", "Up", "Front"], "Moves."),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![("inner".into(), &self.inner)]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![("inner".into(), &mut self.inner)]
    }

    fn reconcile(&mut self) {
        if !self.on {
            self.points = 0;
        }
    }
}

#[test]
fn clamping_keeps_what_is_in_range_and_replaces_what_is_no_number() {
    let good = Outer { length: 0.02, resolution: 80, points: 5, ..Outer::default() };
    assert_eq!(good.clamped(), good);
    let bad = Outer {
        length: f32::INFINITY,
        resolution: 71,
        points: 1,
        color: Vec3::new(9.0, -1.0, 0.5),
        way: [0.0; 3],
        at: Vec3::new(f32::NAN, -9.0, 0.5),
        inner: Inner { angle: 4.0, slices: 384, end: Some(99) },
        ..Outer::default()
    };
    let clamped = bad.clamped();
    assert_eq!((clamped.length, clamped.resolution, clamped.points), (1.0, 64, 4));
    assert_eq!((clamped.color, clamped.way), (Vec3::new(4.0, 0.0, 0.5), Outer::default().way));
    assert_eq!(clamped.at, Vec3::new(0.0, -1.0, 0.5));
    let angle = (4.0_f32 + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI;
    assert_eq!(clamped.inner, Inner { angle, slices: 256, end: Some(20) });
    let nan = Outer { length: f32::NAN, on: false, points: 9, ..Outer::default() }.clamped();
    assert_eq!((nan.length, nan.points), (0.3, 0));
    for (asked, used) in [(0, 128), (192, 256), (200, 256), (384, 256), (511, 512), (u32::MAX, 512)] {
        assert_eq!(Inner { slices: asked, ..Inner::default() }.clamped().slices, used);
    }
}

#[test]
fn values_are_found_set_and_listed_by_path() {
    let mut outer = Outer::default();
    let paths: Vec<String> = entries(&outer).into_iter().map(|entry| entry.path).collect();
    assert_eq!(paths.len(), 11);
    assert_eq!(paths[0], "length");
    assert_eq!(paths[9], "inner.slices");
    for (path, text) in [
        ("length", "0.25"),
        ("inner.angle", "90°"),
        ("inner.end", "7"),
        ("shape", "LongAndThin"),
        ("on", "off"),
        ("color", "0.5, 0, 1"),
        ("resolution", "128"),
        ("at", "(0.5, -1, 0)"),
    ] {
        set(&mut outer, path, text).unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!(
        (outer.length, outer.shape, outer.on, outer.resolution),
        (0.25, Shape::LongAndThin, false, 128)
    );
    assert_eq!((outer.color, outer.inner.end), (Vec3::new(0.5, 0.0, 1.0), Some(7)));
    assert!((outer.inner.angle - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    set(&mut outer, "inner.end", "none").expect("a value");
    assert_eq!(find(&outer, "inner.end").map(|(_, value)| value), Some(Value::None));
    set(&mut outer, "length", "30 cm").expect("a length with its unit");
    assert_eq!(outer.length, 0.3);
    assert!(!set_value(&mut outer, "inner.nothing", Value::Count(1)));
}

#[test]
fn errors_name_what_was_found_and_what_is_valid() {
    let error = |path: &str, text: &str| set(&mut Outer::default(), path, text).expect_err(text).to_string();
    assert_eq!(error("length", "5"), "length: found 5; must be 0.02 to 1 m");
    assert_eq!(error("shape", "square"), "shape: found square; must be round, long-and-thin");
    assert_eq!(
        error("resolution", "65"),
        "resolution: found 65; must be 64 to 2048 texels, in steps of 16; the nearest are 64 and 80"
    );
    assert_eq!(error("points", "1"), "points: found 1; must be 0, or 4 to 64");
    assert_eq!(error("inner.end", "0"), "inner.end: found 0; must be 1 to 20, or none");
    assert_eq!(error("color", "1, 2"), "color: found 1, 2; must be red, green, blue, each 0 to 4");
    assert_eq!(error("way", "0,0,0"), "way: found 0,0,0; must be x, y, z, not all 0");
    assert_eq!(
        error("inner.slice", "1"),
        "inner.slice: there is no such setting; the nearest is inner.slices"
    );
    assert_eq!(error("angle", "1"), "angle: there is no such setting; the nearest is inner.angle");
    let far = set(&mut Outer::default(), "wind.speed", "1").expect_err("no such setting");
    assert_eq!(far, SettingError::Unknown { path: "wind.speed".to_owned(), nearest: None });
}

#[test]
fn numbers_of_a_value_go_out_and_in() {
    assert_eq!(Value::Count(5).with_numbers(&[6.5]), Some(Value::Count(7)));
    assert_eq!(Value::Count(5).with_numbers(&[-6.5]), Some(Value::Count(0)));
    assert_eq!(Value::Number(5.0).with_numbers(&[f64::NAN]), None);
    assert_eq!(Value::Vector([0.0; 3]).with_numbers(&[1.0, 2.0]), None);
    assert_eq!(Value::Vector([1.0, 2.0, 3.0]).numbers(), [1.0, 2.0, 3.0]);
    assert!(Value::Switch(true).numbers().is_empty());
}

#[test]
fn tooltips_end_in_the_symbol() {
    let infos: Vec<_> = Outer::TABLE.iter().map(|setting| setting.info.tooltip()).collect();
    assert_eq!(infos[0], "Longer. Symbol: l.");
    assert_eq!(infos[1], "Finer.");
}
