//! What an import must preserve: placed strands come back, expressed by guides.

use std::f32::consts::PI;
use std::path::PathBuf;

use glam::{Affine3A, Quat, Vec3};
use lovelock_base::settings::Settings;

use super::orientation::Orientation;
use super::*;
use crate::{GuideFrame, PlainHead, Strands, Unit, UpAxis, interpolate, load_hair, load_hair_bytes};

/// The folder of real files, or `None` after printing a message.
fn data_dir() -> Option<PathBuf> {
    let folder = std::env::var_os("LOVELOCK_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no data folder");
    None
}

/// A `.hair` file of these strands, Z up.
fn hair(strands: &[Vec<Vec3>]) -> HairFile {
    let points: usize = strands.iter().map(Vec::len).sum();
    let mut bytes = b"HAIR".to_vec();
    bytes.extend([strands.len() as u32, points as u32, 3, 0].iter().flat_map(|n| n.to_le_bytes()));
    bytes.resize(128, 0);
    bytes.extend(strands.iter().flat_map(|strand| (strand.len() as u16 - 1).to_le_bytes()));
    bytes.extend(strands.iter().flatten().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
    load_hair_bytes("test.hair", &bytes).expect("a sound file")
}

/// Wavy strands on the upper half of a ball of the given radius, Z up, the face toward +Y.
fn wavy_cap(strands: usize, radius: f32) -> Vec<Vec<Vec3>> {
    (0..strands)
        .map(|i| {
            // Points spread evenly over a ball's cap by the golden angle.
            let height = 1.0 - i as f32 / strands as f32;
            let angle = i as f32 * PI * (3.0 - 5.0_f32.sqrt());
            let across = (1.0 - height * height).sqrt();
            let out = Vec3::new(across * angle.cos(), across * angle.sin(), height);
            let points = 3 + i % 14;
            (0..points)
                .map(|k| {
                    let t = k as f32 / (points - 1) as f32 * (0.6 + 0.4 * (i % 7) as f32 / 6.0);
                    let wave = Vec3::new((9.0 * t).sin(), (9.0 * t).cos() - 1.0, 0.0) * 0.05;
                    radius * (out * (1.0 + 0.2 * t) - Vec3::Z * t * t + wave)
                })
                .collect()
        })
        .collect()
}

/// The largest distance of a point from its position in `groom`, as a fraction of its strand's length.
fn worst_error(style: &Hairstyle, order: &[u32], groom: &PlacedGroom) -> f32 {
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let mut worst = 0.0_f32;
    for (strand, &source) in order.iter().enumerate() {
        let wanted = groom.strand(source as usize);
        let first = style.strands.first_point[strand] as usize;
        assert_eq!(style.strands.first_point[strand + 1] as usize - first, wanted.len());
        let length = length(wanted);
        for (k, point) in wanted.iter().enumerate() {
            worst = worst.max(strands.point(first + k).distance(*point) / length);
        }
    }
    worst
}

/// Imports onto a plain head, checks the result, and returns the largest error of a point at rest.
fn reconstruct(file: &HairFile, settings: &ImportSettings) -> (Hairstyle, f32) {
    let scalp = PlainHead.scalp(24);
    let groom = place(file, settings, &scalp, None).expect("a place on the head");
    let (style, order, _) = hairstyle_of(file, settings, &scalp, &groom);
    style.check().expect("a sound hairstyle");
    assert_eq!(style.strands.count(), file.strands());
    let mut seen = order.clone();
    seen.sort_unstable();
    assert!(seen.iter().copied().eq(0..file.strands() as u32), "every strand once");
    for weights in &style.strands.weights {
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{weights:?}");
        assert!(weights.iter().all(|w| (-0.501..=1.501).contains(w)), "{weights:?}");
    }
    let error = worst_error(&style, &order, &groom);
    (style, error)
}

#[test]
fn strands_come_back_at_rest_whatever_the_groom() {
    for (strands, wisps) in [(1, 0), (2, 0), (3, 0), (5, 5), (40, 3), (900, 0), (900, 4096)] {
        let file = hair(&wavy_cap(strands, 20.0));
        let settings = ImportSettings { wisps, ..ImportSettings::default() };
        let (style, error) = reconstruct(&file, &settings);
        // Single precision at 0.2 m is 1.5e-8 m, and the shortest strands here are some centimetres long.
        assert!(error < 2e-5, "{strands} strands in {} wisps: {error}", style.wisps.len());
        for wisp in &style.wisps {
            let [a, b, c] = wisp.guides.map(|guide| style.guides.point(guide as usize, 0));
            assert!(a.distance(b) > 1e-5 && b.distance(c) > 1e-5 && c.distance(a) > 1e-5, "guides apart");
        }
    }
}

#[test]
fn a_changed_offset_is_seen_by_the_error() {
    // The negative control of the other tests.
    let file = hair(&wavy_cap(60, 20.0));
    let (scalp, settings) = (PlainHead.scalp(24), ImportSettings::default());
    let groom = place(&file, &settings, &scalp, None).expect("a place on the head");
    let (mut style, order, _) = hairstyle_of(&file, &settings, &scalp, &groom);
    style.strands.offset_normal[100] += 0.002;
    assert!(worst_error(&style, &order, &groom) > 0.01);
}

#[test]
fn real_grooms_come_back_at_rest() {
    let Some(data) = data_dir() else { return };
    for name in [
        "yuksel/straight.hair",
        "tressfx/sintel_16pt.tfx",
        "broken/variable_odd.hair",
        "tressfx/Ratboy_mohawk.tfx",
        "broken/tiny_units.hair",
    ] {
        let file = load_hair(&data.join("hair").join(name)).expect(name);
        let (style, error) = reconstruct(&file, &ImportSettings::default());
        println!("{name}: {} wisps, worst error {error:.2e} of a strand's length", style.wisps.len());
        assert!(error < 1e-3, "{name}: {error}");
    }
}

#[test]
fn all_strands_follow_a_turn_of_the_head_rigidly() {
    let file = hair(&wavy_cap(200, 20.0));
    let (scalp, settings) = (PlainHead.scalp(24), ImportSettings::default());
    let groom = place(&file, &settings, &scalp, None).expect("a place on the head");
    let (style, order, _) = hairstyle_of(&file, &settings, &scalp, &groom);
    let turn =
        Affine3A::from_rotation_translation(Quat::from_euler(glam::EulerRot::XYZ, 0.4, 2.0, -0.7), Vec3::ONE);
    let mut strands = Strands::default();
    interpolate(&style, &GuideFrame::at_rest(&style.guides, turn, 0.0), &mut strands);
    for (strand, &source) in order.iter().enumerate() {
        let first = style.strands.first_point[strand] as usize;
        for (k, point) in groom.strand(source as usize).iter().enumerate() {
            let wanted = turn.transform_point3(*point);
            // One or two metres from the origin, single precision is 1.2e-7 m, and frames add a few roundings.
            assert!(strands.point(first + k).distance(wanted) < 5e-6);
        }
    }
}

#[test]
fn guides_are_equally_spaced_and_rooted_in_the_skin() {
    let file = hair(&wavy_cap(300, 20.0));
    let (style, _) = reconstruct(&file, &ImportSettings::default());
    let whole = surface::Surface::whole(&style.scalp).expect("a scalp");
    for guide in 0..style.guides.count() {
        let points: Vec<Vec3> =
            (0..style.guides.points_per_guide).map(|i| style.guides.point(guide, i)).collect();
        let mean = length(&points) / (points.len() - 1) as f32;
        let uneven = points.array_windows().map(|[a, b]| (a.distance(*b) / mean - 1.0).abs());
        let uneven = uneven.fold(0.0, f32::max);
        // The iterations stop at 1e-4; a strand of three points with a sharp bend may use all of them.
        assert!(uneven < 1e-3, "{uneven}");
        // Repeated guides are 1.5 mm from the strand that they repeat.
        assert!(whole.closest(points[0]).distance(points[0]) < 2e-3);
    }
}

#[test]
fn roots_reach_the_skin_and_strands_keep_their_shape() {
    let file = hair(&wavy_cap(500, 20.0));
    let scalp = PlainHead.scalp(24);
    let groom = place(&file, &ImportSettings::default(), &scalp, None).expect("a place on the head");
    let whole = surface::Surface::whole(&scalp).expect("a scalp");
    let orientation = Orientation::resolve(&file, &ImportSettings::default());
    for strand in 0..groom.strands() {
        let placed = groom.strand(strand);
        assert!(whole.closest(placed[0]).distance(placed[0]) < 1e-4, "a root off the skin");
        let scaled = |i: usize| groom.fitted_scale * orientation.head_axes_from_file(file.strand(strand)[i]);
        for i in 1..placed.len() {
            assert!((placed[i] - placed[0]).distance(scaled(i) - scaled(0)) < 1e-6, "a shape changed");
        }
    }
}

#[test]
fn a_groom_made_on_the_scalp_is_put_back_where_it_was() {
    // Roots on the skin, written in centimetres about another origin and with Z up.
    let scalp = PlainHead.scalp(24);
    let strands: Vec<Vec<Vec3>> = (0..scalp.positions.len())
        .filter(|&v| scalp.mask[v] > 0.9)
        .map(|v| (0..5).map(|k| scalp.positions[v] + 0.02 * k as f32 * scalp.normals[v]).collect())
        .collect();
    let to_file = |p: &Vec3| 100.0 * (Vec3::new(-p.x, p.z, p.y) + Vec3::new(0.05, 0.02, -0.03));
    let file = hair(&strands.iter().map(|strand| strand.iter().map(to_file).collect()).collect::<Vec<_>>());
    let settings = ImportSettings { unit: Unit::Centimetre, up: UpAxis::Z, ..ImportSettings::default() };
    let groom = place(&file, &settings, &scalp, None).expect("a place on the head");
    assert!((groom.fitted_scale - 1.0).abs() < 0.03, "{}", groom.fitted_scale);
    let error = strands.iter().enumerate().map(|(i, strand)| groom.strand(i)[0].distance(strand[0]));
    let mean = error.sum::<f32>() / strands.len() as f32;
    // A head is nearly round, so a fit of points may slide along it by a few millimetres.
    assert!(mean < 0.006, "{mean}");
}

#[test]
fn strands_that_begin_inside_of_the_head_move_out_and_a_note_says_so() {
    let scalp = PlainHead.scalp(24);
    let grown: Vec<usize> = (0..scalp.positions.len()).filter(|&v| scalp.mask[v] > 0.9).collect();
    let strands = |depth: f32| -> Vec<Vec<Vec3>> {
        let strand = |(i, &v): (usize, &usize)| {
            let inward = if i % 10 == 0 { depth } else { 0.0 };
            let root = scalp.positions[v] - inward * scalp.normals[v];
            let points = (0..5).map(|k| root + 0.02 * k as f32 * scalp.normals[v]);
            points.map(|p| Vec3::new(-p.x, p.z, p.y)).collect()
        };
        grown.iter().enumerate().map(strand).collect()
    };
    let settings = ImportSettings {
        unit: Unit::Metre,
        up: UpAxis::Z,
        facing: crate::Facing::PlusY,
        fit_scale: false,
        ..ImportSettings::default()
    };
    for body in [None, Some(&PlainHead as &dyn Obstacle)] {
        let file = hair(&strands(0.02));
        let (style, notes) = import_noted(&file, &settings, &scalp, body).expect("a place on the head");
        style.check().expect("whole");
        let groom = place(&file, &settings, &scalp, body).expect("a place on the head");
        let (inside, depth) = groom.inside;
        let deep = grown.len().div_ceil(10);
        assert!(inside.abs_diff(deep) <= deep / 4, "{inside} of {deep}");
        assert!((0.012..0.03).contains(&depth), "{depth} m");
        assert!(notes.len() == 1 && notes[0].contains("inside of the head"), "{notes:?}");
        let skin = super::surface::Surface::whole(&scalp).expect("triangles");
        let off = (0..groom.strands()).map(|s| groom.strand(s)[0].distance(skin.closest(groom.strand(s)[0])));
        assert!(off.fold(0.0, f32::max) < 1e-4, "roots are on the skin");
    }
    // Negative control: strands that begin on the skin.
    let (_, notes) =
        import_noted(&hair(&strands(0.0)), &settings, &scalp, None).expect("a place on the head");
    assert!(notes.is_empty(), "{notes:?}");
}

#[test]
fn a_strip_of_hair_lands_on_the_head() {
    // A mohawk: a strip a centimetre wide over the crown, forehead to nape.
    let strands: Vec<Vec<Vec3>> = (0..300)
        .map(|i| {
            let angle = 0.9 - 2.6 * (i / 3) as f32 / 99.0;
            let out = Vec3::new(0.0, angle.sin(), angle.cos());
            let root = Vec3::new((i % 3) as f32 * 0.5 - 0.5, 0.0, 0.0) + 9.5 * out;
            (0..6).map(|k| root + 1.5 * k as f32 * out).collect()
        })
        .collect();
    let file = hair(&strands);
    let settings = ImportSettings { unit: Unit::Centimetre, ..ImportSettings::default() };
    let scalp = PlainHead.scalp(24);
    let groom = place(&file, &settings, &scalp, None).expect("a place on the head");
    assert!((0.7..1.3).contains(&groom.fitted_scale), "{}", groom.fitted_scale);
    assert!(groom.mean_root_gap_m < 0.012, "{}", groom.mean_root_gap_m);
    let sideways = (0..300).map(|i| groom.strand(i)[0].x).fold(0.0_f32, |a, x| a.max(x.abs()));
    assert!(sideways < 0.01, "{sideways}");
}

#[test]
fn a_body_pushes_strands_out_and_leaves_roots_alone() {
    let strands: Vec<Vec<Vec3>> = wavy_cap(200, 20.0)
        .into_iter()
        .map(|strand| {
            strand.iter().map(|p| strand[0] + (*p - strand[0]) * Vec3::new(1.0, 1.0, 1.5)).collect()
        })
        .collect();
    let file = hair(&strands);
    let (scalp, settings) = (PlainHead.scalp(24), ImportSettings::default());
    let deepest = |groom: &PlacedGroom| {
        (0..groom.strands())
            .flat_map(|strand| groom.strand(strand)[1..].to_vec())
            .map(|p| PlainHead.distance(p).0)
            .fold(0.0, f32::min)
    };
    let free = place(&file, &settings, &scalp, None).expect("a place on the head");
    let pushed = place(&file, &settings, &scalp, Some(&PlainHead)).expect("a place on the head");
    // The rounded joints of the head leave up to a millimetre after the last push.
    let (free_depth, pushed_depth) = (deepest(&free), deepest(&pushed));
    assert!(free_depth < -0.01 && pushed_depth > -0.001, "{free_depth} {pushed_depth}");
    for strand in 0..free.strands() {
        assert_eq!(free.strand(strand)[0], pushed.strand(strand)[0]);
    }
}

#[test]
fn wrong_signs_of_a_body_do_not_move_strands_far() {
    // Small spots around the head where the distance wrongly indicates the deep inside.
    struct Faulty;
    impl crate::Obstacle for Faulty {
        fn distance(&self, p: Vec3) -> (f32, Vec3) {
            let (distance, outward) = PlainHead.distance(p);
            let wrong = distance > 0.004 && (p * 700.0).map(f32::sin).element_product() > 0.4;
            if wrong { (-distance, -outward) } else { (distance, outward) }
        }
    }
    // Hair that stands on end, so that it is well outside except at the skin.
    let spikes: Vec<Vec<Vec3>> = wavy_cap(400, 20.0)
        .iter()
        .map(|strand| (0..12).map(|k| strand[0] * (1.0 + 0.05 * k as f32)).collect())
        .collect();
    let (file, scalp, settings) = (hair(&spikes), PlainHead.scalp(24), ImportSettings::default());
    let sound = place(&file, &settings, &scalp, Some(&PlainHead)).expect("a place on the head");
    let faulty = place(&file, &settings, &scalp, Some(&Faulty)).expect("a place on the head");
    let torn = sound.points.iter().zip(&faulty.points).filter(|(a, b)| a.distance(**b) > 0.01).count();
    let met = sound.points.iter().filter(|&&p| crate::Obstacle::distance(&Faulty, p).0 < -0.01).count();
    assert!(met > 20 && torn == 0, "{torn} of {met}");
}

#[test]
fn the_same_file_gives_the_same_hairstyle_for_any_number_of_threads() {
    let file = hair(&wavy_cap(1500, 20.0));
    let scalp = PlainHead.scalp(24);
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| import(&file, &ImportSettings::default(), &scalp).expect("an import"))
    };
    let one = with_threads(1);
    for threads in [2, 8] {
        let more = with_threads(threads);
        assert_eq!((&one.wisps, &one.guides, &one.strands), (&more.wisps, &more.guides, &more.strands));
    }
    let settings = ImportSettings { seed: 1, ..ImportSettings::default() };
    let other = import(&file, &settings, &scalp).expect("an import");
    assert_ne!(one.strands, other.strands, "the seed plays a part");
}

#[test]
fn settings_out_of_range_are_brought_back() {
    let wild = ImportSettings {
        wisps: u32::MAX,
        points_per_guide: 1,
        placement: Placement {
            scale: f32::NAN,
            turn: Vec3::splat(f32::INFINITY),
            offset_m: Vec3::splat(-9.0),
        },
        ..ImportSettings::default()
    };
    let tame = wild.clamped();
    assert_eq!((tame.wisps, tame.points_per_guide, tame.placement.scale), (4096, 4, 1.0));
    assert_eq!((tame.placement.turn, tame.placement.offset_m), (Vec3::splat(PI), Vec3::splat(-0.5)));
    let file = hair(&wavy_cap(30, 20.0));
    let (_, error) = reconstruct(&file, &wild);
    assert!(error < 1e-3, "{error}");
}

#[test]
fn absurd_sizes_and_missing_scalps_are_refused() {
    let file = hair(&wavy_cap(30, 20.0));
    let scalp = PlainHead.scalp(24);
    for unit in [Unit::Custom(1e10), Unit::Custom(1e-9)] {
        let settings = ImportSettings { unit, ..ImportSettings::default() };
        let error = import(&file, &settings, &scalp).expect_err("no such hair");
        assert!(matches!(error, ImportError::Size { .. }), "{error}");
    }
    let error = import(&file, &ImportSettings::default(), &Scalp::default()).expect_err("no scalp");
    assert!(matches!(error, ImportError::NoScalp { .. }));
}

#[test]
fn colour_and_shade_come_from_the_file() {
    let Some(data) = data_dir() else { return };
    let file = load_hair(&data.join("hair/yuksel/straight.hair")).expect("a sound file");
    let style = import(&file, &ImportSettings::default(), &PlainHead.scalp(24)).expect("an import");
    println!("{:?}", style.look);
    // The file's colour is a light blond.
    assert!(style.look.eumelanin < 0.5 && style.look.pheomelanin < 1.0);
    assert!(style.strands.shade.iter().all(|shade| (0.0..=1.0).contains(shade)));
    assert_eq!(style.name, "straight");
}

#[test]
fn strands_follow_their_guides() {
    // A breeze that bends hair sideways, more the farther it hangs down: strands must move like the space around them,
    // although only guides are moved.
    let breeze = |p: Vec3| {
        let hang = (0.2 - p.y).max(0.0);
        p + Vec3::new(0.8 * hang * hang, 0.0, 0.3 * hang * hang)
    };
    let mut files = vec![("by hand", hair(&wavy_cap(2000, 20.0)))];
    if let Some(data) = data_dir() {
        for name in ["yuksel/straight.hair", "tressfx/sintel_16pt.tfx"] {
            files.push((name, load_hair(&data.join("hair").join(name)).expect(name)));
        }
    }
    for (name, file) in files {
        let (scalp, settings) = (PlainHead.scalp(24), ImportSettings::default());
        let groom = place(&file, &settings, &scalp, None).expect("a place on the head");
        let (style, order, _) = hairstyle_of(&file, &settings, &scalp, &groom);
        let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        for i in 0..frame.guides.x.len() {
            let p = breeze(Vec3::new(frame.guides.x[i], frame.guides.y[i], frame.guides.z[i]));
            (frame.guides.x[i], frame.guides.y[i], frame.guides.z[i]) = (p.x, p.y, p.z);
        }
        let mut strands = Strands::default();
        interpolate(&style, &frame, &mut strands);
        let (mut error, mut way, mut stretched) = (0.0, 0.0, 0);
        for (strand, &source) in order.iter().enumerate() {
            let first = style.strands.first_point[strand] as usize;
            let rest = groom.strand(source as usize);
            let moved: Vec<Vec3> = (0..rest.len()).map(|k| strands.point(first + k)).collect();
            for (point, rest) in moved.iter().zip(rest) {
                error += point.distance(breeze(*rest));
                way += breeze(*rest).distance(*rest);
            }
            let wanted: Vec<Vec3> = rest.iter().map(|&p| breeze(p)).collect();
            stretched += u32::from((length(&moved) / length(&wanted) - 1.0).abs() > 0.1);
        }
        let (error, stretched) = (error / way, stretched as f32 / order.len() as f32);
        println!("{name}: {error:.3} of the way off, {stretched:.4} of the strands stretched");
        // Offsets turn with the wisp instead of shearing with the space, and a few wide wisps spread slightly.
        assert!(error < 0.12 && stretched < 0.02, "{name}: {error} {stretched}");
    }
}
