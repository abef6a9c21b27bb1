use std::fs;
use std::path::Path;

use glam::{Affine3A, Mat4, Quat, Vec3};
use lovelock_alembic::{Archive, Compound, Object, Source};
use lovelock_groom::{HairFile, load_hair, load_hair_bytes};
use lovelock_testkit::suite;

use super::*;
use crate::partial::failing::small_disk;

/// The largest accepted error of a point, in metres.
const LIMIT_M: f32 = 1e-4;

struct Dance {
    scene: CurveScene,
    frames: Vec<Vec<Vec3>>,
    joints: Vec<Vec<Affine3A>>,
}

/// Swinging curves and a body of one triangle on two joints.
fn dance(frames: u64, curves: u32) -> Dance {
    let counts = (0..curves).map(|curve| 2 + curve % 4);
    let mut first_point = vec![0];
    first_point.extend(counts.scan(0, |end, count| {
        *end += count;
        Some(*end)
    }));
    let points = first_point[curves as usize];
    let at = |frame: u64, i: u32| {
        let turn = Quat::from_rotation_y(0.1 * frame as f32) * Quat::from_rotation_z(0.02 * i as f32);
        turn * Vec3::new(0.1, 1.7 - 0.003 * i as f32, 0.07)
    };
    let corner = |x: f32| Vec3::new(x, 1.0, 0.2);
    let still = MorphTarget { name: "still".into(), ..MorphTarget::default() };
    let blink = MorphTarget {
        name: "blink".into(),
        vertices: vec![2, 1],
        positions: vec![Vec3::X, Vec3::new(0.0, 0.5, -0.25)],
        normals: vec![Vec3::ZERO; 2],
        rest_weight: 0.0,
    };
    let body = CurveBody {
        triangles: vec![[0, 1, 2]],
        colors: vec![Vec3::new(0.8, 0.5, 0.4); 3],
        bind_positions: vec![corner(0.0), corner(0.5), corner(1.0)],
        bind_normals: vec![Vec3::Z; 3],
        joints: vec![[0, 1, 0, 0, 0, 0, 0, 0]; 3],
        weights: [0.0, 0.3, 1.0].map(|w| [1.0 - w, w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).to_vec(),
        joint_from_bind: vec![Affine3A::IDENTITY, Affine3A::from_translation(Vec3::new(-0.5, -1.0, 0.0))],
        morphs: vec![still, blink],
        ..CurveBody::default()
    };
    let joints = |frame: u64| {
        let turn =
            |angle: f32, at: Vec3| Affine3A::from_rotation_translation(Quat::from_rotation_x(angle), at);
        vec![turn(0.05 * frame as f32, Vec3::ZERO), turn(2.0 * frame as f32, Vec3::new(0.5, 1.0, 0.0))]
    };
    Dance {
        scene: CurveScene {
            rate: FrameRate { num: 30, den: 1 },
            first_frame: 12,
            frames,
            first_point,
            widths: (0..points).map(|i| 1e-4 + 1e-6 * i as f32).collect(),
            colors: (0..points).map(|i| Vec3::new(0.2, 0.01 * (i % 50) as f32, 0.05)).collect(),
            are_guides: false,
            marks: lovelock_groom::StrandMarks::default(),
            body: Some(body),
        },
        frames: (0..frames).map(|frame| (0..points).map(|i| at(frame, i)).collect()).collect(),
        joints: (0..frames).map(joints).collect(),
    }
}

/// Weights of the morph targets in a frame.
fn weights_of(frame: usize) -> [f32; 2] {
    [0.5, 0.1 + 0.2 * frame as f32]
}

impl Dance {
    /// The body in a frame, by linear blend skinning.
    fn skinned(&self, frame: usize) -> Vec<Vec3> {
        let body = self.scene.body.as_ref().expect("a body");
        let map = |joint: usize| self.joints[frame][joint] * body.joint_from_bind[joint];
        let mut bound = body.bind_positions.clone();
        for (morph, weight) in body.morphs.iter().zip(weights_of(frame)) {
            for (&vertex, &by) in morph.vertices.iter().zip(&morph.positions) {
                bound[vertex as usize] += weight * by;
            }
        }
        let vertices = bound.into_iter().zip(&body.weights);
        vertices.map(|(p, w)| w[0] * map(0).transform_point3(p) + w[1] * map(1).transform_point3(p)).collect()
    }

    fn write(&self, path: &Path) -> Result<CurveReport, RecordError> {
        self.write_with(path, &open_file)
    }

    fn write_with(&self, path: &Path, opener: &Opener) -> Result<CurveReport, RecordError> {
        let mut writer = CurveWriter::create_with(path, self.scene.clone(), opener)?;
        for (frame, points) in self.frames.iter().enumerate() {
            let axis = |k: usize| points.iter().map(|p| p[k]).collect::<Vec<_>>();
            let [x, y, z] = [0, 1, 2].map(axis);
            let positions = self.skinned(frame);
            let body = BodyFrame {
                positions: &positions,
                normals: &[Vec3::Z; 3],
                joints: &self.joints[frame],
                morph_weights: &weights_of(frame),
            };
            let body = self.scene.body.is_some().then_some(body);
            writer.push(&CurveFrame { points: [&x, &y, &z], body })?;
        }
        writer.finish()
    }
}

/// The largest error of a point in the first frame.
fn farthest(file: &HairFile, points: &[Vec3]) -> f32 {
    assert_eq!(file.points.len(), points.len());
    file.points.iter().zip(points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn usd_and_alembic_come_back_through_our_own_importer() {
    let folder = tempfile::tempdir().expect("a folder");
    let dance = dance(5, 40);
    for name in ["a.usda", "b.usdc", "ü c.USD", "d.abc"] {
        let path = folder.path().join("new").join(name);
        let report = dance.write(&path).expect(name);
        assert_eq!((report.frames, report.bytes), (5, fs::metadata(&path).expect("a file").len()), "{name}");
        let file = load_hair(&path).expect(name);
        assert_eq!(file.first_point, dance.scene.first_point, "{name}");
        let off = farthest(&file, &dance.frames[0]);
        assert!(off <= LIMIT_M, "{name}: {off} m");
        // Negative control: the next frame is farther away.
        assert!(farthest(&file, &dance.frames[1]) > 10.0 * LIMIT_M, "{name}");
        let widths = file.thickness.expect("widths");
        assert!(widths.iter().zip(&dance.scene.widths).all(|(a, b)| (a - b).abs() < 1e-9), "{name}");
        let colours = file.colours.expect("colours");
        assert!((colours[0][0] - 0.484_53).abs() < 1e-3, "{name}: {:?} is sRGB of 0.2", colours[0]);
    }
    let left = fs::read_dir(folder.path().join("new")).expect("a folder").count();
    assert_eq!(left, 4, "only the files");
}

#[test]
fn a_crate_has_a_version_that_older_programs_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.usdc");
    dance(2, 3).write(&path).expect("a file");
    let bytes = fs::read(&path).expect("a file");
    assert_eq!((&bytes[..8], &bytes[8..11]), (&b"PXR-USDC"[..], &[0, 8, 0][..]));
}

#[test]
fn broken_files_are_refused_or_read_without_a_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.usda", "b.usdc", "c.abc"] {
        let path = folder.path().join(name);
        dance(2, 6).write(&path).expect(name);
        let whole = fs::read(&path).expect("a file");
        let strands = load_hair_bytes(name, &whole).expect(name).strands();
        for length in (0..whole.len() - 8).step_by(whole.len().div_ceil(400)) {
            assert!(load_hair_bytes(name, &whole[..length]).is_err(), "{name}: {length} bytes of it");
        }
        // Sets every byte in turn to values that make counts and offsets large, small and negative; in the short suite every third byte to
        // one of them.
        let mut broken = whole.clone();
        let (mut refused, mut tried) = (0, 0);
        for at in suite::sample(0..whole.len(), 3) {
            let first = if suite::is_long() { 0 } else { at / 3 % 4 };
            for value in suite::sample([0, 0x7f, 0xff, whole[at] ^ 1].into_iter().skip(first), 4) {
                broken[at] = value;
                tried += 1;
                match load_hair_bytes(name, &broken) {
                    Ok(file) => assert!(file.strands() <= strands + 1, "{name}: byte {at}"),
                    Err(error) => {
                        refused += 1;
                        assert!(error.to_string().lines().count() == 1, "{name}: {error}");
                    }
                }
            }
            broken[at] = whole[at];
        }
        assert!(40 * refused > tried, "{name}: {refused} of {tried} changes are refused");
    }
}

/// The child of an object in an archive.
fn child(archive: &mut Archive<'_>, of: &Object, name: &str) -> Object {
    let children = archive.children(of).expect("children");
    children.into_iter().find(|child| child.name == name).expect(name)
}

/// The properties of a schema, and its parameters.
fn schema(archive: &mut Archive<'_>, object: &Object, name: &str) -> [Compound; 2] {
    let properties = archive.properties(object).expect("properties");
    let schema = archive.compound(properties.get(name).expect(name)).expect("a compound");
    let parameters = archive.compound(schema.get(".arbGeomParams").expect("parameters")).expect("a compound");
    [schema, parameters]
}

fn sample(archive: &mut Archive<'_>, of: &Compound, name: &str, sample: u64) -> Vec<f64> {
    archive.few(of.get(name).expect(name), sample, 1 << 16).expect(name)
}

#[test]
fn alembic_holds_every_frame_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.abc");
    let mut dance = dance(4, 9);
    dance.scene.are_guides = true;
    dance.write(&path).expect("a file");
    let bytes = fs::read(&path).expect("a file");
    let mut archive = Archive::open(Source::Memory(&bytes)).expect("an archive");
    assert!(archive.metadata().contains("FramesPerTimeUnit=30.000000;"), "{}", archive.metadata());
    let top = archive.top();
    let root = child(&mut archive, &top, "Lovelock");
    let [_, about] = schema(&mut archive, &root, ".xform");
    assert_eq!(sample(&mut archive, &about, "groom_version_major", 0), [1.0]);
    assert_eq!(sample(&mut archive, &about, "groom_version_minor", 0), [5.0]);
    let hair = child(&mut archive, &root, "Hair");
    let strands = child(&mut archive, &hair, "Strands_0");
    let [curves, parameters] = schema(&mut archive, &strands, ".geom");
    let points = curves.get("P").expect("points").clone();
    assert_eq!((points.samples, archive.times(&points).secs(3)), (4, 15.0 / 30.0));
    let wide = |values: &[Vec3]| values.iter().flat_map(|p| p.to_array().map(f64::from)).collect::<Vec<_>>();
    for (frame, wanted) in dance.frames.iter().enumerate() {
        let read = sample(&mut archive, &curves, "P", frame as u64);
        assert_eq!(read, wide(wanted), "frame {frame}");
        assert_ne!(read, wide(&dance.frames[(frame + 1) % 4]), "negative control");
    }
    let counts: Vec<f64> = dance.scene.counts().map(f64::from).collect();
    assert_eq!(sample(&mut archive, &curves, "nVertices", 3), counts);
    // Written once for all frames.
    let counts = curves.get("nVertices").expect("counts");
    assert!(counts.is_constant() && counts.samples == 4);
    assert_eq!(sample(&mut archive, &curves, "curveBasisAndType", 0), [1.0, 0.0, 0.0, 0.0]);
    let widths: Vec<f64> = dance.scene.widths.iter().copied().map(f64::from).collect();
    assert_eq!(sample(&mut archive, &curves, "width", 3), widths);
    assert_eq!(sample(&mut archive, &parameters, "groom_width", 0), widths);
    assert_eq!(sample(&mut archive, &parameters, "groom_color", 0), wide(&dance.scene.colors));
    assert_eq!(sample(&mut archive, &parameters, "groom_guide", 0), [1.0; 9]);
    assert_eq!(sample(&mut archive, &parameters, "groom_id", 0)[8], 8.0);
    assert_eq!(sample(&mut archive, &parameters, "groom_group_id", 0), [0.0]);
    let uv = sample(&mut archive, &parameters, "groom_root_uv", 0);
    assert!(uv.len() == 18 && uv.iter().all(|v| (0.0..=1.0).contains(v)), "{uv:?}");
    let low = sample(&mut archive, &curves, ".selfBnds", 2)[1];
    let lowest = dance.frames[2].iter().fold(f32::INFINITY, |low, p| low.min(p.y));
    assert!(low < f64::from(lowest) && low > f64::from(lowest) - 1e-3, "{low} for {lowest}");

    let body = child(&mut archive, &root, "Body");
    let [mesh, colours] = schema(&mut archive, &body, ".geom");
    assert_eq!(sample(&mut archive, &mesh, ".faceIndices", 0), [2.0, 1.0, 0.0], "clockwise");
    assert_eq!(sample(&mut archive, &mesh, ".faceCounts", 0), [3.0]);
    assert_eq!(sample(&mut archive, &mesh, "N", 3)[..3], [0.0, 0.0, 1.0]);
    assert_eq!(sample(&mut archive, &colours, "Cd", 0).len(), 9);
    for frame in 0..4 {
        assert_eq!(sample(&mut archive, &mesh, "P", frame as u64), wide(&dance.skinned(frame)));
    }
}

#[test]
fn gltf_is_valid_and_comes_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.glb");
    let dance = dance(4, 9);
    let report = dance.write(&path).expect("a file");
    let bytes = fs::read(&path).expect("a file");
    assert_eq!(report, CurveReport { frames: 4, bytes: bytes.len() as u64 });
    // The library validates indices, required fields and the sizes of the parts.
    let glb = gltf::Gltf::from_slice(&bytes).expect("valid");
    let blob = glb.blob.as_deref().expect("a binary part");
    let clip = glb.animations().next().expect("an animation");
    for frame in 0..4_usize {
        let secs = frame as f32 / 30.0;
        let shown: Vec<_> = glb.nodes().filter(|n| n.mesh().is_some() && n.skin().is_none()).collect();
        let visible: Vec<_> =
            shown.iter().filter(|node| scale_at(&clip, blob, node, secs) == [1.0; 3]).collect();
        assert_eq!(visible.len(), 1, "one mesh of hair at {secs} s");
        assert!(shown.iter().all(|node| [[0.0; 3], [1.0; 3]].contains(&scale_at(&clip, blob, node, secs))));
        let primitive = visible[0].mesh().expect("a mesh").primitives().next().expect("lines");
        assert_eq!(primitive.mode(), gltf::mesh::Mode::Lines);
        let reader = primitive.reader(|_| Some(blob));
        let points: Vec<Vec3> = reader.read_positions().expect("positions").map(Vec3::from).collect();
        let off = points.iter().zip(&dance.frames[frame]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off <= LIMIT_M && points.len() == dance.frames[frame].len(), "frame {frame}: {off} m");
        let lines = reader.read_indices().expect("indices").into_u32().count();
        assert_eq!(lines, 2 * (dance.scene.points() - dance.scene.curves()));

        let body = skin_of(&glb, blob, &clip, secs);
        let off = body.iter().zip(dance.skinned(frame)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        assert!(off <= LIMIT_M, "frame {frame}: the body is {off} m off");
        let next = dance.skinned((frame + 1) % 4);
        let off = body.iter().zip(next).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        assert!(off > 10.0 * LIMIT_M, "negative control: another frame differs by {off} m");
    }
}

/// Scale of a node at a time: the value of the last key before it.
fn scale_at(clip: &gltf::Animation<'_>, blob: &[u8], node: &gltf::Node<'_>, secs: f32) -> [f32; 3] {
    for channel in clip.channels().filter(|channel| channel.target().node().index() == node.index()) {
        assert_eq!(channel.sampler().interpolation(), gltf::animation::Interpolation::Step);
        let reader = channel.reader(|_| Some(blob));
        let key = reader.read_inputs().expect("times").filter(|&time| time <= secs + 1e-5).count() - 1;
        if let Some(gltf::animation::util::ReadOutputs::Scales(mut scales)) = reader.read_outputs() {
            return scales.nth(key).expect("a key");
        }
    }
    panic!("a node of hair without its animation");
}

/// The skinned mesh at the time of a key, as a viewer computes it.
fn skin_of(glb: &gltf::Gltf, blob: &[u8], clip: &gltf::Animation<'_>, secs: f32) -> Vec<Vec3> {
    use gltf::animation::util::ReadOutputs;
    let skin = glb.skins().next().expect("a skin");
    let node = glb.nodes().find(|node| node.skin().is_some()).expect("a skinned node");
    let inverse = skin.reader(|_| Some(blob)).read_inverse_bind_matrices().expect("matrices");
    let joints = skin.joints().zip(inverse).map(|(joint, inverse)| {
        let (mut translation, mut rotation, scale) = joint.transform().decomposed();
        for channel in clip.channels().filter(|channel| channel.target().node().index() == joint.index()) {
            let reader = channel.reader(|_| Some(blob));
            let times: Vec<f32> = reader.read_inputs().expect("times").collect();
            let key = times.iter().position(|time| (time - secs).abs() < 1e-5).expect("a key at each frame");
            match reader.read_outputs().expect("values") {
                ReadOutputs::Translations(mut values) => translation = values.nth(key).expect("a value"),
                ReadOutputs::Rotations(values) => rotation = values.into_f32().nth(key).expect("a value"),
                ReadOutputs::Scales(_) | ReadOutputs::MorphTargetWeights(_) => panic!("not animated here"),
            }
        }
        let world = Mat4::from_scale_rotation_translation(
            scale.into(),
            Quat::from_array(rotation),
            translation.into(),
        );
        world * Mat4::from_cols_array_2d(&inverse)
    });
    let joints: Vec<Mat4> = joints.collect();
    let primitive = node.mesh().expect("a mesh").primitives().next().expect("triangles");
    let reader = primitive.reader(|_| Some(blob));
    let bound = reader.read_joints(0).expect("joints").into_u16();
    let weights = reader.read_weights(0).expect("weights").into_f32();
    let mut points: Vec<Vec3> = reader.read_positions().expect("positions").map(Vec3::from).collect();
    let moves =
        clip.channels().find(|channel| channel.target().node().index() == node.index()).expect("weights");
    let moves = moves.reader(|_| Some(blob));
    let key = moves.read_inputs().expect("times").position(|time| (time - secs).abs() < 1e-5).expect("a key");
    let Some(ReadOutputs::MorphTargetWeights(of_morphs)) = moves.read_outputs() else {
        panic!("not weights")
    };
    let of_morphs: Vec<f32> = of_morphs.into_f32().skip(2 * key).take(2).collect();
    for ((by, _, _), weight) in reader.read_morph_targets().zip(of_morphs) {
        for (point, by) in points.iter_mut().zip(by.expect("displacements")) {
            *point += weight * Vec3::from(by);
        }
    }
    let points = points.into_iter().zip(bound).zip(weights);
    points
        .map(|((p, joint), weight)| {
            (0..4).map(|k| weight[k] * joints[usize::from(joint[k])].transform_point3(p)).sum()
        })
        .collect()
}

#[test]
fn a_full_disk_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.usda", "a.usdc", "a.glb", "a.abc"] {
        let path = folder.path().join(name);
        fs::write(&path, b"old").expect("a file");
        let error = dance(3, 9).write_with(&path, &small_disk(1000)).expect_err(name);
        assert!(!error.is_request() && error.to_string().contains("write the file"), "{name}: {error}");
        assert_eq!(fs::read(&path).expect("a file"), b"old", "{name}");
        fs::remove_file(&path).expect("a file");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn invalid_requests_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let refused = |dance: &Dance, name: &str, wanted: &str| {
        let error = dance.write(&at(name)).expect_err(wanted);
        assert!(error.is_request() && error.to_string().contains(wanted), "{error}");
    };
    let good = || dance(3, 4);
    refused(&good(), "a.obj", "the name must end in .usda");
    let change = |change: &dyn Fn(&mut Dance)| {
        let mut dance = good();
        change(&mut dance);
        dance
    };
    refused(&change(&|dance| dance.scene.frames = 0), "a.usdc", "no frame");
    refused(&change(&|dance| dance.scene.first_point = vec![0]), "a.usdc", "no curves");
    refused(&change(&|dance| dance.scene.widths.truncate(3)), "a.glb", "differ in length");
    refused(&change(&|dance| dance.scene.frames = 4), "a.usdc", "3 frames; must be the 4 of its settings");
    refused(&change(&|dance| dance.scene.frames = 2), "a.usda", "more frames than the 2");
    for name in ["a.glb", "a.abc"] {
        refused(&change(&|dance| dance.frames[1].truncate(13)), name, "a frame of 13 points; must have 14");
    }
    refused(&change(&|dance| dance.scene.frames = 4), "a.abc", "3 frames; must be the 4 of its settings");
    for name in ["a.usda", "a.usdc", "a.glb", "a.abc"] {
        refused(&change(&|dance| dance.scene.frames = 1 << 30), name, "--frames");
    }
    // So many curves that a few frames are too large.
    let large = |frames: u64| {
        let mut dance = good();
        let (points, curves) = (1 << 20, 1 << 19);
        dance.scene.first_point = (0..=curves).map(|curve| 2 * curve).collect();
        (dance.scene.widths, dance.scene.colors) = (vec![1e-4; points], vec![Vec3::ONE; points]);
        dance.scene.frames = frames;
        dance
    };
    for (name, frames) in [("a.usda", 200), ("a.glb", 400)] {
        refused(&large(frames), name, "--curves guides");
    }
    let mut body = good();
    body.scene.frames = 1 << 20;
    if let Some(body) = &mut body.scene.body {
        let vertices = 200;
        (body.colors, body.bind_positions) = (vec![Vec3::ONE; vertices], vec![Vec3::ZERO; vertices]);
        (body.bind_normals, body.weights) = (vec![Vec3::Z; vertices], vec![[0.125; 8]; vertices]);
        body.joints = vec![[0; 8]; vertices];
    }
    refused(&body, "a.usdc", "--no-body");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0, "nothing was written");
}

/// The dance with a body of two triangles, of which the first has a texture.
fn textured() -> Dance {
    use glam::{Affine2, Vec2};
    use lovelock_motion::{Alpha, Image, Material, Region, Shading, TextureUse, Wrap};
    let mut dance = dance(2, 3);
    let body = dance.scene.body.as_mut().expect("a body");
    body.triangles = vec![[0, 1, 2], [2, 1, 0]];
    body.of_triangles = vec![1, 0];
    body.coordinates[0] = [[0.0, 0.25], [1.0, 0.0], [0.5, 1.0]].map(Vec2::from).to_vec();
    body.opacity = vec![0.5, 1.0, 1.0];
    let pixels: Vec<u8> = (0..2 * 3 * 4).map(|k| 10 * k as u8).collect();
    body.images = vec![Image { name: "checks".into(), size: [2, 3], pixels: pixels.into() }].into();
    let base = TextureUse {
        image: 0,
        set: 0,
        transform: Affine2::from_scale_angle_translation(Vec2::new(2.0, 0.5), 0.3, Vec2::new(0.1, 0.2)),
        wrap: [Wrap::Mirror, Wrap::Clamp],
        is_nearest: true,
    };
    let plain = Material {
        name: "plain".into(),
        region: Region::Cloth,
        shading: Shading::Unlit,
        ..Material::default()
    };
    let painted = Material {
        name: "painted".into(),
        region: Region::Eye,
        base: Some(base),
        normal: Some((base, 0.5)),
        emissive: Vec3::new(3.0, 0.0, 0.0),
        alpha: Alpha::Mask(0.25),
        is_double_sided: true,
        roughness: 0.75,
        roughness_texture: Some(base),
        ..Material::default()
    };
    body.materials = vec![plain, painted];
    dance
}

#[test]
fn materials_and_images_of_gltf_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.glb");
    let dance = textured();
    dance.write(&path).expect("a file");
    let character = lovelock_motion::load_character(&path).expect("a character");
    let (body, wanted) = (&character.body, dance.scene.body.as_ref().expect("a body"));
    // Each material has triangles of its own, in the order of materials.
    let [plain, painted] = &body.materials[..] else { panic!("{:?}", body.materials) };
    assert_eq!(plain, &wanted.materials[0]);
    let (found, base) = (painted.base.expect("a texture"), wanted.materials[1].base.expect("a texture"));
    assert!(found.transform.abs_diff_eq(base.transform, 1e-5), "{found:?}");
    assert_eq!((found.wrap, found.is_nearest, painted.normal.map(|of| of.1)), (base.wrap, true, Some(0.5)));
    assert_eq!((painted.roughness, painted.roughness_texture.map(|of| of.image)), (0.75, Some(0)));
    assert_eq!(
        (painted.region, painted.alpha, painted.emissive),
        (wanted.materials[1].region, wanted.materials[1].alpha, Vec3::new(3.0, 0.0, 0.0))
    );
    assert_eq!((body.images.len(), &body.images[0].pixels), (1, &wanted.images[0].pixels));
    assert_eq!(body.mesh.materials, [0, 1]);
    // Both materials have the same vertices, which are read once.
    assert_eq!(body.mesh.triangles, [wanted.triangles[1], wanted.triangles[0]]);
    assert_eq!(body.mesh.coordinates[0], wanted.coordinates[0]);
    assert!(body.mesh.opacity.iter().any(|opacity| (opacity - 0.5).abs() < 1e-4));
    let [still, blink] = &body.skin.morphs[..] else { panic!("{:?}", body.skin.morphs) };
    assert_eq!((still.name.as_str(), still.vertices.len(), still.rest_weight), ("still", 0, 0.5));
    assert_eq!((blink.name.as_str(), &blink.vertices[..]), ("blink", &[1, 2][..]));
    assert_eq!(blink.positions, [Vec3::new(0.0, 0.5, -0.25), Vec3::X]);
}

#[test]
fn materials_of_usd_are_beside_the_file_and_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.usda", "b.usdc"] {
        let path = folder.path().join(name);
        textured().write(&path).expect(name);
        let image = folder.path().join(format!("{}_textures/image_0.png", &name[..1]));
        assert_eq!(&fs::read(image).expect("an image")[1..4], b"PNG", "{name}");
        assert!(load_hair(&path).is_ok(), "{name}");
        // Our own reader of characters takes up the same look.
        let character = lovelock_motion::load_character(&path).expect(name);
        let (body, wanted) = (&character.body, textured().scene.body.expect("a body"));
        let painted = body.materials.iter().find(|material| material.base.is_some()).expect(name);
        let (found, base) = (painted.base.expect("a texture"), wanted.materials[1].base.expect("a texture"));
        assert!(found.transform.abs_diff_eq(base.transform, 1e-5), "{name}: {found:?}");
        assert_eq!(
            (found.wrap, painted.alpha, painted.roughness),
            (base.wrap, wanted.materials[1].alpha, 0.75),
            "{name}"
        );
        let rough = painted.roughness_texture.expect("the skin's roughness");
        assert!(rough.transform.abs_diff_eq(base.transform, 1e-5), "{name}: {rough:?}");
        assert_eq!(body.images[0].pixels, wanted.images[0].pixels, "{name}");
        let mut coordinates: Vec<_> = body.mesh.coordinates[0].iter().map(glam::Vec2::to_array).collect();
        coordinates.dedup();
        assert!(coordinates.contains(&[0.0, 0.25]), "{name}: {coordinates:?}");
    }
    let text = fs::read_to_string(folder.path().join("a.usda")).expect("text");
    for words in [
        "rel material:binding = </Lovelock/Materials/Material_1>",
        "inputs:diffuseColor.connect = </Lovelock/Materials/Material_1/Base.outputs:rgb>",
        "asset inputs:file = @./a_textures/image_0.png@",
        "inputs:roughness.connect = </Lovelock/Materials/Material_1/Roughness.outputs:g>",
        "float inputs:opacityThreshold = 0.25",
        "texCoord2f[] primvars:st = [(0.0, 0.75), (1.0, 1.0), (0.5, 0.0)]",
        "MaterialBindingAPI",
        "token inputs:wrapS = \"mirror\"",
    ] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}
