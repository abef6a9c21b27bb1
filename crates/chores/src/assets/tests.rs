//! Tests of the shipped file, read back by the `gltf` crate, and of the code that generates it.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use super::rig::rest;
use super::score::Score;
use super::{animal, dance, glb, head, ik, lawn, mesh, path, remesh, rig, score};

/// The contents of the file.
struct File {
    document: gltf::Document,
    binary: Vec<u8>,
    length: usize,
}

/// Vertices of the only primitive.
struct Vertices {
    positions: Vec<Vec3>,
    scalp: Vec<f32>,
    joints: Vec<[u8; 4]>,
    weights: Vec<[u16; 4]>,
    triangles: Vec<[u32; 3]>,
}

fn file() -> File {
    read("dancer")
}

fn read(name: &str) -> File {
    let bytes = std::fs::read(path(name)).expect("a file of assets is missing: cargo xtask assets makes it");
    // `from_slice` validates the document.
    let gltf = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    File { document: gltf.document, binary: gltf.blob.expect("a binary chunk"), length: bytes.len() }
}

impl File {
    fn vertices(&self) -> Vertices {
        let primitive = self.document.meshes().next().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(self.binary.as_slice()));
        let scalp = primitive.get(&gltf::Semantic::Extras("SCALP".into())).expect("the attribute _SCALP");
        let scalp =
            gltf::accessor::Iter::<f32>::new(scalp, |_| Some(self.binary.as_slice())).unwrap().collect();
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        let gltf::mesh::util::ReadJoints::U8(joints) = reader.read_joints(0).unwrap() else {
            panic!("u8 joints")
        };
        let gltf::mesh::util::ReadWeights::U16(weights) = reader.read_weights(0).unwrap() else {
            panic!("u16 weights")
        };
        Vertices {
            positions: reader.read_positions().unwrap().map(Vec3::from).collect(),
            scalp,
            joints: joints.collect(),
            weights: weights.collect(),
            triangles: indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        }
    }
}

/// Extent along one axis of the points that pass a test.
fn extent(points: &[Vec3], axis: Vec3, keep: impl Fn(&Vec3) -> bool) -> (f32, f32) {
    points
        .iter()
        .filter(|p| keep(p))
        .map(|p| p.dot(axis))
        .fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(x), high.max(x)))
}

/// Directed edges without an opposite edge, or that occur twice. A closed, consistently wound surface has none.
fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let mut count: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for t in triangles {
        for i in 0..3 {
            *count.entry((t[i], t[(i + 1) % 3])).or_default() += 1;
        }
    }
    count.iter().filter(|((a, b), n)| **n != 1 || count.get(&(*b, *a)) != Some(&1)).count()
}

#[test]
fn file_is_small_and_complete() {
    let file = file();
    assert!(file.length < 2 << 20, "{} bytes", file.length);
    let skin = file.document.skins().next().expect("a skin");
    let names: Vec<&str> = skin.joints().filter_map(|joint| joint.name()).collect();
    assert!(names.len() >= 22, "{} joints", names.len());
    for name in ["hips", "spine", "chest", "neck", "head", "upper_arm_l", "hand_r", "shin_l", "toe_r"] {
        assert!(names.contains(&name), "no joint {name}");
    }
    let clips: Vec<&str> = file.document.animations().filter_map(|clip| clip.name()).collect();
    assert_eq!(clips, ["dance", "idle"]);
    assert!(file.vertices().positions.len() <= 28_000);
}

#[test]
fn surface_is_closed() {
    let vertices = file().vertices();
    assert_eq!(open_edges(&vertices.triangles), 0);
    // A single body: the Euler characteristic of a sphere. A tunnel, such as between nose and face, would lower it.
    let (v, t) = (vertices.positions.len() as i64, vertices.triangles.len() as i64);
    assert_eq!(v - t * 3 / 2 + t, 2);
    // Negative control: without one triangle there are three open edges.
    assert_eq!(open_edges(&vertices.triangles[1..]), 3);
}

#[test]
fn the_other_bodies_are_closed_and_hair_grows_on_most_of_their_skin() {
    for (model, most) in [(animal::make(), 700 << 10), (lawn::make(), 400 << 10)] {
        let name = model.name;
        let bytes = glb::write(&model).expect("a file");
        assert_eq!(
            std::fs::read(path(name)).expect(name),
            bytes,
            "{name}: cargo xtask assets makes it again"
        );
        assert!(bytes.len() < most, "{name}: {} bytes", bytes.len());
        let vertices = read(name).vertices();
        assert_eq!(open_edges(&vertices.triangles), 0, "{name}");
        let (v, t) = (vertices.positions.len() as i64, vertices.triangles.len() as i64);
        assert_eq!(v - t * 3 / 2 + t, 2, "{name}: one body without tunnels");
        let area = |hairy: bool| -> f32 {
            let at = |v: u32| vertices.positions[v as usize];
            let chosen = vertices
                .triangles
                .iter()
                .filter(|t| !hairy || t.iter().all(|v| vertices.scalp[*v as usize] > 0.5));
            chosen.map(|t| 0.5 * (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length()).sum()
        };
        let share = area(true) / area(false);
        // Grass grows on the upper side alone.
        let wanted = if name == "lawn" { 0.35..0.55 } else { 0.9..0.99 };
        assert!(wanted.contains(&share), "{name}: hair grows on {share} of {} m²", area(false));
        let (low, _) = extent(&vertices.positions, Vec3::Y, |_| true);
        assert!(low.abs() < 0.003, "{name} stands at {low} m");
    }
}

#[test]
fn figure_has_the_proportions_of_a_head_and_a_body() {
    let vertices = file().vertices();
    let p = &vertices.positions;
    let within = |what: &str, measured: f32, wanted: f32, part: f32| {
        assert!((measured / wanted - 1.0).abs() < part, "{what}: {measured} m, wanted {wanted} m");
    };
    let (low, high) = extent(p, Vec3::Y, |_| true);
    within("height", high - low, 1.70, 0.01);
    assert!(low.abs() < 0.002, "the soles are at {low} m");
    let (chin, _) = extent(p, Vec3::Y, |p| p.z > 0.065 && p.y > 1.42);
    within("chin to crown", high - chin, 0.23, 0.05);
    let (left, right) = extent(p, Vec3::X, |p| p.y > 1.61);
    within("width of the skull", right - left, 0.155, 0.05);
    let (back, front) = extent(p, Vec3::Z, |p| p.y > 1.595);
    within("depth of the skull", front - back, 0.195, 0.05);
    within("heads in the body", (high - low) / (high - chin), 7.4, 0.05);
    within("eyes at half of the head", head::EYE.y - chin, 0.5 * (high - chin), 0.05);
}

#[test]
fn weights_sum_to_one_and_the_scalp_is_rigid() {
    let vertices = file().vertices();
    for (weights, joints) in vertices.weights.iter().zip(&vertices.joints) {
        assert_eq!(weights.iter().map(|w| u32::from(*w)).sum::<u32>(), 65535);
        assert!(joints.iter().all(|j| usize::from(*j) < rig::joints().len()));
    }
    for i in 0..vertices.scalp.len() {
        if vertices.scalp[i] > 0.0 {
            assert_eq!(
                (vertices.joints[i][0], vertices.weights[i][0]),
                (rig::HEAD as u8, 65535),
                "vertex {i}"
            );
        }
    }
}

#[test]
fn scalp_is_as_large_as_a_head_of_hair_wants() {
    let vertices = file().vertices();
    let area: f32 = vertices
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| vertices.positions[i as usize]);
            let mask = t.iter().map(|i| vertices.scalp[*i as usize]).sum::<f32>() / 3.0;
            0.5 * (b - a).cross(c - a).length() * mask
        })
        .sum();
    // 600 to 700 cm² on an adult.
    assert!((0.055..0.072).contains(&area), "{} cm²", area * 1e4);
    let hairline =
        extent(&vertices.positions, Vec3::Y, |p| p.z > 0.05 && p.x.abs() < 0.01 && super::scalp(*p) > 0.5);
    assert!((hairline.0 - head::BROW_Y - 0.065).abs() < 0.006, "hairline at {} m", hairline.0);
    let at_face = vertices.positions.iter().zip(&vertices.scalp).filter(|(p, _)| p.z > 0.06 && p.y < 1.64);
    assert!(at_face.clone().count() > 1000 && at_face.clone().all(|(_, s)| *s == 0.0));
}

/// World transforms of all joints at every key of a clip.
fn worlds(score: &Score) -> Vec<Vec<(Quat, Vec3)>> {
    let joints = rig::joints();
    let clip = score.sample(&joints);
    (0..clip.times.len())
        .map(|key| {
            let rotations = clip.rotations.iter().map(|r| r[key]).collect();
            dance::world_of(&joints, &dance::LocalPose { rotations, hips: clip.hips[key] })
        })
        .collect()
}

/// Angular speed between the rotations of two neighbouring keys, in radians per second.
fn angular_speed(a: Quat, b: Quat) -> f32 {
    let turn = a.inverse() * b;
    2.0 * turn.xyz().length().atan2(turn.w.abs()) * dance::RATE
}

#[test]
fn clips_close_in_place_and_speed() {
    for score in [score::dance(), score::idle()] {
        let worlds = worlds(&score);
        let last = worlds.len() - 1;
        assert!(score.name != "dance" || last as f32 / dance::RATE >= 8.0);
        for (joint, _) in rig::joints().iter().enumerate() {
            let at = |key: usize| worlds[key][joint];
            assert!(at(0).1.distance(at(last).1) < 1e-5, "{}: joint {joint}", score.name);
            assert!(
                angular_speed(at(0).0, at(last).0) < 1e-3,
                "{}: joint {joint} {:?} {:?}",
                score.name,
                at(0),
                at(last)
            );
            // The change of speed across the loop's seam is no larger than between neighbouring keys elsewhere.
            let jump = |a: usize, b: usize, c: usize| ((at(c).1 - at(b).1) - (at(b).1 - at(a).1)).length();
            let worst = (1..last).map(|k| jump(k - 1, k, k + 1)).fold(0.0_f32, f32::max);
            let seam = ((at(1).1 - at(0).1) - (at(last).1 - at(last - 1).1)).length();
            assert!(seam <= worst + 1e-5, "{}: joint {joint} jerks at the seam: {seam} m", score.name);
            let spin = |a: usize, b: usize| (at(b).0 * at(a).0.inverse()).to_scaled_axis();
            let change = |a: usize, b: usize, c: usize, d: usize| (spin(c, d) - spin(a, b)).length();
            let worst = (1..last).map(|k| change(k - 1, k, k, k + 1)).fold(0.0_f32, f32::max);
            assert!(change(last - 1, last, 0, 1) <= worst + 1e-4, "{}: joint {joint}", score.name);
        }
    }
}

#[test]
fn nothing_pops_and_the_head_turns_at_a_human_speed() {
    for score in [score::dance(), score::idle()] {
        let worlds = worlds(&score);
        for (joint, rig_joint) in rig::joints().iter().enumerate() {
            let (mut fastest, mut frame) = (0.0_f32, 0);
            for (k, pair) in worlds.windows(2).enumerate() {
                let speed = angular_speed(pair[0][joint].0, pair[1][joint].0);
                if speed > fastest {
                    (fastest, frame) = (speed, k);
                }
            }
            // The pirouette and head toss of a trained dancer reach about 12 rad/s; limbs swing faster.
            let limit = if joint == rig::HEAD { 12.0 } else { 22.0 };
            let name = &rig_joint.name;
            assert!(fastest < limit, "{}: {name} at key {frame}: {fastest} rad/s", score.name);
        }
    }
}

#[test]
fn planted_feet_stay_and_soles_stay_above_the_ground() {
    let vertices = file().vertices();
    let joints = rig::joints();
    let score = score::dance();
    let worlds = worlds(&score);
    for side in 0..2 {
        let toe = rig::THIGH + side * rig::LEG_JOINTS + rig::TOES;
        let planted = |key: usize| {
            let beat = key as f32 / dance::RATE / score.beat_secs;
            !score.steps[side].iter().any(|step| beat > step.lift && beat < step.land)
        };
        let mut since: Option<Vec3> = None;
        let mut kept = 0;
        for (key, world) in worlds.iter().enumerate() {
            let at = world[toe].1;
            if planted(key) {
                let start = *since.get_or_insert(at);
                assert!(
                    start.distance(at) < 0.005,
                    "foot {side} slides {} m at key {key}",
                    start.distance(at)
                );
                kept += 1;
            } else {
                since = None;
            }
        }
        assert!(kept > 100 && kept < worlds.len());
    }
    for (key, world) in worlds.iter().enumerate().step_by(2) {
        for (i, p) in vertices.positions.iter().enumerate().filter(|(_, p)| p.y < 0.15) {
            let mut height = 0.0;
            for c in 0..4 {
                let joint = usize::from(vertices.joints[i][c]);
                let (rotation, place) = world[joint];
                height += f32::from(vertices.weights[i][c]) / 65535.0
                    * (rotation * (*p - joints[joint].rest) + place).y;
            }
            assert!(height > -0.005, "a sole is {height} m below the ground at key {key}");
        }
    }
}

#[test]
fn the_dance_turns_folds_and_stays_in_place() {
    let worlds = worlds(&score::dance());
    let (mut turned, mut most) = (0.0_f32, 0.0_f32);
    for pair in worlds.windows(2) {
        let heading = |q: Quat| (q * Vec3::Z).x.atan2((q * Vec3::Z).z);
        let step = heading(pair[1][rig::HIPS].0) - heading(pair[0][rig::HIPS].0);
        turned += step - (step / std::f32::consts::TAU).round() * std::f32::consts::TAU;
        most = most.max(turned.abs());
    }
    assert!(most > 5.8, "the hips turn by {most} rad at most");
    let heads: Vec<Vec3> = worlds.iter().map(|w| w[rig::HEAD].1).collect();
    let (low, high) = extent(&heads, Vec3::Y, |_| true);
    assert!(high - low > 0.45, "the head's height changes by {} m", high - low);
    for axis in [Vec3::X, Vec3::Z] {
        let hips: Vec<Vec3> = worlds.iter().map(|w| w[rig::HIPS].1).collect();
        let (low, high) = extent(&hips, axis, |_| true);
        assert!(high - low < 0.6);
    }
}

#[test]
fn a_limb_reaches_where_it_is_told() {
    let lengths = [0.41, 0.40];
    for target in [Vec3::new(0.1, -0.7, 0.2), Vec3::new(-0.2, -0.3, 0.3), Vec3::new(0.0, 0.5, 0.1)] {
        let bent = ik::reach(target, lengths, Vec3::Z);
        let end = bent.first * lengths[0] + bent.second * lengths[1];
        assert!(end.distance(target) < 1e-5);
        assert!(
            bent.first.cross(bent.second).dot(bent.hinge) > 0.0,
            "the hinge turns the first bone to the second"
        );
        let turn = ik::align((Vec3::X, Vec3::Z), (bent.first, bent.hinge));
        assert!((turn * Vec3::X).distance(bent.first) < 1e-4 && (turn * Vec3::Z).distance(bent.hinge) < 1e-4);
    }
    // Out of reach: the limb is stretched toward the target.
    let far = ik::reach(Vec3::new(0.0, -2.0, 0.0), lengths, Vec3::Z);
    assert!((far.first * lengths[0] + far.second * lengths[1]).distance(Vec3::new(0.0, -0.81, 0.0)) < 0.002);
    let axis = Vec3::new(0.6, 0.8, 0.0);
    assert!((ik::twist_about(Quat::from_axis_angle(axis, 0.7), axis) - 0.7).abs() < 1e-5);
    assert!((ik::angle_about(Vec3::Y, Vec3::Z, Vec3::X) - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
}

#[test]
fn a_ball_is_meshed_closed_even_and_the_same_twice() {
    let centre = Vec3::new(0.0, 1.0, 0.02);
    let distance = |p: Vec3| p.distance(centre) - 0.08;
    let make = || {
        let mut ball = mesh::surface_nets(&mesh::Grid::dancer(), &distance);
        remesh::remesh(&mut ball, &distance, &|_| 0.012, 4);
        ball
    };
    let ball = make();
    assert_eq!(open_edges(&ball.triangles), 0);
    assert!(ball.positions.iter().all(|p| distance(*p).abs() < 1e-5));
    for t in &ball.triangles {
        let [a, b, c] = t.map(|i| ball.positions[i as usize]);
        assert!((b - a).cross(c - a).dot(a - centre) > 0.0, "a triangle faces inward");
        // Splitting above 4/3 and collapsing below 4/5 leaves edges between these, before the last relaxation.
        assert!((0.45..1.7).contains(&(a.distance(b) / 0.012)));
    }
    let again = make();
    assert!(ball.positions == again.positions && ball.triangles == again.triangles);
}

#[test]
fn rest_pose_is_an_a_pose_on_the_ground() {
    let arm = rest::upper_arm_direction();
    let below = (-arm.y).atan2(arm.x).to_degrees();
    assert!((35.0..=45.0).contains(&below), "the arms hang {below} degrees below the horizontal");
    for joint in rig::joints() {
        if let Some(parent) = joint.parent {
            assert!(rig::joints().iter().position(|j| j.name == joint.name).unwrap() > parent);
        }
    }
}
