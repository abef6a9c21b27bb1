//! Compares strands of the GPU with those of the CPU, with guides at rest and moved.

use std::mem::offset_of;
use std::sync::{Arc, OnceLock};

use glam::{Affine3A, Quat, Vec3};
use lovelock_base::clock::Stopwatch;
use lovelock_gpu::{
    BufferPool, Gpu, GpuError, GrowBuffer, PassTimer, PooledBuffer, check_shader, layout_in_shader,
    read_buffer, wgpu,
};
use lovelock_groom::{
    GroomSettings, GuideFrame, Guides, Hairstyle, ImportSettings, PlainHead, Preset, StrandSet, Strands,
    Wisp, grow, import, interpolate, load_hair,
};

use super::{Interpolation, Mix, shaders};
use crate::ResidentGuides;

fn device() -> Option<&'static Arc<Gpu>> {
    static DEVICE: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    let open = || Gpu::open().inspect_err(|error| lovelock_testkit::skip_without_adapter(error)).ok();
    DEVICE.get_or_init(open).as_ref()
}

/// An interpolation and its output.
struct Bench {
    gpu: &'static Arc<Gpu>,
    interpolation: Interpolation,
    timer: PassTimer,
    points: GrowBuffer<[f32; 4]>,
    /// Milliseconds of the last run on the device; `None` if it does not measure.
    ms: Option<f64>,
}

impl Bench {
    fn new(gpu: &'static Arc<Gpu>) -> Self {
        Self {
            gpu,
            interpolation: Interpolation::new(gpu).expect("shaders compile"),
            timer: PassTimer::new(gpu).expect("a timer"),
            points: GrowBuffer::new(gpu, "test", wgpu::BufferUsages::STORAGE),
            ms: None,
        }
    }

    /// The points from the device.
    fn run(&mut self, style: &Arc<Hairstyle>, frame: &GuideFrame) -> Result<Vec<[f32; 4]>, GpuError> {
        self.run_with(style, (frame, None))
    }

    /// The same with guides that may be on the device.
    fn run_with(
        &mut self,
        style: &Arc<Hairstyle>,
        frame: (&GuideFrame, Option<&ResidentGuides>),
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        self.points.reserve(self.gpu, style.strands.points());
        let mut commands = self.timer.begin(self.gpu, "test");
        let encoded = self.interpolation.run(self.gpu, &mut commands, style, frame, self.points.raw());
        commands.submit();
        encoded?;
        let mut found = vec![[f32::NAN; 4]; style.strands.points()];
        read_buffer(self.gpu, self.points.raw(), &mut found)?;
        self.gpu.check()?;
        self.ms = self.timer.times(self.gpu).first().map(|time| time.ms);
        Ok(found)
    }
}

fn preset(preset: Preset) -> Arc<Hairstyle> {
    Arc::new(grow(&GroomSettings::preset(preset), &PlainHead.scalp(40), &PlainHead).expect("a preset grows"))
}

fn imported(name: &str) -> Option<Arc<Hairstyle>> {
    let file = load_hair(&lovelock_testkit::data_dir()?.join("hair").join(name)).expect("it is read");
    let style = import(&file, &ImportSettings::default(), &PlainHead.scalp(40));
    Some(Arc::new(style.expect("it is imported")))
}

fn styles() -> Vec<(&'static str, Arc<Hairstyle>)> {
    let mut all: Vec<_> = Preset::ALL.into_iter().map(|which| (which.id(), preset(which))).collect();
    for name in ["yuksel/straight.hair", "tressfx/Ratboy_mohawk.tfx"] {
        all.extend(imported(name).map(|style| (name, style)));
    }
    all
}

/// Seeded random numbers in -1..1 (xorshift).
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn cube(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// The guides at rest on a head in a room, or displaced at random.
fn frame(style: &Hairstyle, random: &mut Random, blown: bool) -> GuideFrame {
    let turn = Quat::from_axis_angle(random.cube().normalize_or(Vec3::Y), 3.0 * random.signed());
    let head = Affine3A::from_rotation_translation(turn, Vec3::new(0.0, 1.5, 0.0) + 0.5 * random.cube());
    let mut frame = GuideFrame::at_rest(&style.guides, head, 0.0);
    let points = style.guides.points_per_guide;
    let (push, wave) = (0.1 * random.cube(), 9.0 * random.cube());
    for g in 0..frame.guides.count() * usize::from(blown) {
        let own = 0.03 * random.cube();
        for p in 0..points {
            let (t, i) = (p as f32 / (points - 1) as f32, g * points + p);
            let shake = t * t * (push + own + 0.05 * (wave * t).map(f32::sin));
            frame.guides.x[i] += shake.x;
            frame.guides.y[i] += shake.y;
            frame.guides.z[i] += shake.z;
        }
    }
    frame
}

/// The largest distance between points of the GPU and the CPU. Both must be NaN if one is.
fn largest_distance(style: &Hairstyle, frame: &GuideFrame, found: &[[f32; 4]]) -> f32 {
    let mut strands = Strands::default();
    interpolate(style, frame, &mut strands);
    assert_eq!(found.len(), strands.points());
    let distance = |(i, &[x, y, z, w]): (usize, &[f32; 4])| {
        assert_eq!(w, 0.0, "point {i}");
        let (expected, found) = (strands.point(i), Vec3::new(x, y, z));
        assert_eq!(expected.is_finite(), found.is_finite(), "point {i}: {expected} and {found}");
        if expected.is_finite() { expected.distance(found) } else { 0.0 }
    };
    found.iter().enumerate().map(distance).fold(0.0, f32::max)
}

/// Metres. Measured: 4.8e-7 on llvmpipe, for heads 2 m from the origin (2^-23 of that is 2.4e-7). Other devices fuse products and
/// divide less exactly.
const TOLERANCE: f32 = 5e-6;

#[test]
fn shaders_are_valid() {
    for (label, source) in shaders() {
        check_shader(&source).unwrap_or_else(|error| panic!("{label}: {error}"));
    }
}

#[test]
fn the_constants_of_mixed_guides_lie_where_the_shader_reads_them() {
    let (_, source) = shaders().into_iter().find(|(label, _)| label == "mix guides").expect("the shader");
    let fields = [offset_of!(Mix, heads), offset_of!(Mix, t), offset_of!(Mix, points_per_guide)];
    let ends = [offset_of!(Mix, guide_points), size_of::<Mix>()];
    assert_eq!(layout_in_shader(&source, "Mix"), [&fields[..], &ends].concat());
}

#[test]
fn points_are_those_of_the_processor() {
    let Some(gpu) = device() else { return };
    let mut bench = Bench::new(gpu);
    let mut random = Random(5);
    for (name, style) in styles() {
        let mut most = 0.0_f32;
        for blown in [false, true, true] {
            let frame = frame(&style, &mut random, blown);
            let found = bench.run(&style, &frame).expect("it runs");
            most = most.max(largest_distance(&style, &frame, &found));
        }
        let frame = frame(&style, &mut random, true);
        let mut strands = Strands::default();
        interpolate(&style, &frame, &mut strands);
        let watch = Stopwatch::start();
        interpolate(&style, &frame, &mut strands);
        println!(
            "{name}, {} points: {most:.2e} m; {:.3} ms on the processor, {:.3?} ms on {}",
            style.strands.points(),
            watch.ms(),
            bench.ms,
            gpu.info.name
        );
        assert!(most < TOLERANCE, "{name}: {most} m");
    }
}

#[test]
fn a_guide_that_moved_a_tenth_of_a_millimetre_is_found() {
    let Some(gpu) = device() else { return };
    let style = preset(Preset::Smooth);
    let frame = frame(&style, &mut Random(9), true);
    let mut other = frame.clone();
    let points = style.guides.points_per_guide;
    other.guides.y[7 * points..8 * points].iter_mut().for_each(|y| *y += 1e-4);
    let found = Bench::new(gpu).run(&style, &other).expect("it runs");
    assert!(largest_distance(&style, &other, &found) < TOLERANCE);
    let missed = largest_distance(&style, &frame, &found);
    assert!(missed > 10.0 * TOLERANCE, "only {missed} m");
}

/// The guides of `frame` in a buffer of the device.
fn resident(gpu: &Arc<Gpu>, pool: &mut BufferPool, frame: &GuideFrame) -> PooledBuffer {
    let Guides { x, y, z, .. } = &frame.guides;
    let all = [&x[..], y, z].concat();
    let held = pool.take(gpu, size_of_val(&all[..]) as u64);
    gpu.upload(held.raw(), 0, &all);
    held
}

#[test]
fn guides_on_the_device_are_those_that_are_uploaded() {
    let Some(gpu) = device() else { return };
    let mut bench = Bench::new(gpu);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let mut pool = BufferPool::new("test", usage);
    let style = preset(Preset::Smooth);
    let mut random = Random(11);
    let [before, now] = [(); 2].map(|()| frame(&style, &mut random, true));
    let [from, to] = [&before, &now].map(|frame| resident(gpu, &mut pool, frame));
    let uploaded = bench.run(&style, &now).expect("it runs");
    // Other guides in memory: they are not used but for the head.
    let mut elsewhere = before.clone();
    elsewhere.world_from_head = now.world_from_head;
    let whole = ResidentGuides::of_step(to.clone());
    assert_eq!(bench.run_with(&style, (&elsewhere, Some(&whole))).expect("it runs"), uploaded);
    assert_ne!(
        bench.run(&style, &elsewhere).expect("it runs"),
        uploaded,
        "control: what is in memory differs"
    );

    let heads = [before.world_from_head, now.world_from_head];
    for (t, end) in [(0.0, &before), (1.0, &now)] {
        let mixed = ResidentGuides::between([(&from, heads[0]), (&to, heads[1])], t);
        let found = bench.run_with(&style, (end, Some(&mixed))).expect("it runs");
        let apart = largest_distance(&style, end, &found);
        assert!(apart < TOLERANCE, "{t}: {apart} m");
    }
    // Hair that moves with the head keeps its shape between two steps.
    let rest = |head| GuideFrame::at_rest(&style.guides, head, 0.0);
    let middle =
        rest(Affine3A::from_rotation_translation(Quat::from_rotation_y(0.3), Vec3::new(0.1, 1.4, 0.2)));
    let ends = heads.map(rest).map(|frame| resident(gpu, &mut pool, &frame));
    let mixed = ResidentGuides::between([(&ends[0], heads[0]), (&ends[1], heads[1])], 0.3);
    let found = bench.run_with(&style, (&middle, Some(&mixed))).expect("it runs");
    let apart = largest_distance(&style, &middle, &found);
    assert!(apart < TOLERANCE, "{apart} m");
    // Held buffers keep their content.
    let _other = resident(gpu, &mut pool, &before);
    assert_eq!(bench.run_with(&style, (&now, Some(&whole))).expect("it runs"), uploaded);
}

/// Three guides in a row, a wisp of them and one without strands, and a strand with points along the guides and beyond them.
fn small(guide: &[Vec3]) -> Hairstyle {
    let mut guides = Guides { points_per_guide: guide.len(), ..Guides::default() };
    for g in 0..3 {
        guides.push(&guide.iter().map(|&p| p + 0.01 * g as f32 * Vec3::X).collect::<Vec<_>>());
    }
    let along = vec![f32::NAN, -1.0, 0.0, 0.3, 1.0, 1.5, 2.0, f32::INFINITY, 1e30];
    let n = along.len();
    Hairstyle {
        wisps: vec![
            Wisp { guides: [2, 1, 0], first_strand: 0, strand_count: 0 },
            Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: 1 },
        ],
        guides,
        strands: StrandSet {
            wisp: vec![1],
            weights: vec![[0.4, 0.9, -0.3]],
            first_point: vec![0, n as u32],
            guide_param: along,
            offset_normal: vec![0.01; n],
            offset_binormal: vec![0.02; n],
            offset_tangent: vec![-0.01; n],
            taper: vec![1.0; n],
            shade: vec![0.5],
            ..StrandSet::default()
        },
        ..Hairstyle::default()
    }
}

#[test]
fn guides_that_fold_vanish_or_are_no_numbers_do_as_on_the_processor() {
    let Some(gpu) = device() else { return };
    let mut bench = Bench::new(gpu);
    let up = Vec3::new(0.0, 0.1, 0.0);
    let shapes = [
        vec![Vec3::ZERO, up],
        vec![Vec3::ZERO, up, 2.0 * up],
        vec![Vec3::ZERO, up, Vec3::ZERO],
        vec![Vec3::ONE; 3],
        vec![up, Vec3::ZERO, up, 2.0 * up, -up],
    ];
    for shape in shapes {
        let style = Arc::new(small(&shape));
        assert_eq!(style.check(), Ok(()));
        let frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        let found = bench.run(&style, &frame).expect("it runs");
        let distance = largest_distance(&style, &frame, &found);
        assert!(distance < TOLERANCE, "{shape:?}: {distance} m");
    }
    // A NaN guide: its wisp becomes NaN, and the others stay the same.
    let style = preset(Preset::Smooth);
    let mut frame = frame(&style, &mut Random(3), true);
    let points = style.guides.points_per_guide;
    frame.guides.x[40 * points..41 * points].fill(f32::NAN);
    frame.guides.y[50 * points + 9] = f32::INFINITY;
    let found = bench.run(&style, &frame).expect("it runs");
    assert!(found.iter().any(|[x, ..]| x.is_nan()));
    assert!(largest_distance(&style, &frame, &found) < TOLERANCE);
}

#[test]
fn a_style_after_a_larger_one_uses_nothing_of_it() {
    let Some(gpu) = device() else { return };
    let mut bench = Bench::new(gpu);
    let (large, small) = (preset(Preset::Curly), Arc::new(small(&[Vec3::ZERO, Vec3::Y, 2.0 * Vec3::Y])));
    for style in [&large, &small, &large] {
        let frame = frame(style, &mut Random(4), true);
        let found = bench.run(style, &frame).expect("it runs");
        assert!(largest_distance(style, &frame, &found) < TOLERANCE);
    }
}

#[test]
fn what_does_not_fit_is_refused_with_words() {
    let Some(gpu) = device() else { return };
    let mut bench = Bench::new(gpu);
    let style = preset(Preset::Smooth);
    let rest = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
    let refused = |bench: &mut Bench, style: &Arc<Hairstyle>, frame: &GuideFrame| {
        let error = bench.run(style, frame).expect_err("it is refused").to_string();
        println!("{error}");
        assert!(gpu.check().is_ok(), "nothing reached the device");
        error
    };
    let mut fewer = rest.clone();
    fewer.guides = Guides { points_per_guide: 31, ..Guides::default() };
    assert!(refused(&mut bench, &style, &fewer).contains("found 0 guides of 31 points"));
    let mut ragged = rest.clone();
    ragged.guides.z.pop();
    refused(&mut bench, &style, &ragged);
    let mut none = rest.clone();
    none.guides.points_per_guide = 0;
    refused(&mut bench, &style, &none);

    let mut broken = Hairstyle::clone(&style);
    broken.wisps[3].guides[1] = u32::MAX;
    assert!(refused(&mut bench, &Arc::new(broken), &rest).contains("wisp 3"));

    // A hairstyle without strands needs no guides.
    let bald = Arc::new(Hairstyle::default());
    assert_eq!(bench.run(&bald, &rest).expect("nothing to do"), Vec::<[f32; 4]>::new());

    // More guides than a binding holds: nothing is allocated for them.
    assert!(super::fits(gpu, "guides", usize::MAX / 16, 4).is_err());
    let most = gpu.most_storage_bytes() / 64;
    assert!(super::fits(gpu, "wisps", most as usize, 64).is_ok());
    assert!(super::fits(gpu, "wisps", most as usize + 1, 64).is_err());

    // A buffer too small for the points.
    let little = GrowBuffer::<[f32; 4]>::new(gpu, "little", wgpu::BufferUsages::STORAGE);
    let mut commands = bench.timer.begin(gpu, "test");
    let encoded = bench.interpolation.run(gpu, &mut commands, &style, (&rest, None), little.raw());
    assert!(encoded.expect_err("too small").to_string().contains("bytes; they need"));
}
