//! Tests of the shipped files, read back by the `gltf` crate, and of the code that generates them.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use super::score::Score;
use super::{animal, dance, glb, ik, lawn, mesh, path, remesh, rig, score};

/// The figures.
const FIGURES: [&str; 4] = ["dancer", "man", "woman", "elder"];

/// The contents of a file.
struct File {
    document: gltf::Document,
    binary: Vec<u8>,
    length: usize,
}

/// Vertices of one primitive, or of all.
#[derive(Default)]
struct Vertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    masks: BTreeMap<&'static str, Vec<f32>>,
    joints: Vec<[u8; 4]>,
    weights: Vec<[u16; 4]>,
    triangles: Vec<[u32; 3]>,
}

fn read(name: &str) -> File {
    let bytes = std::fs::read(path(name)).expect("a file of assets is missing: cargo xtask assets makes it");
    // `from_slice` validates the document.
    let gltf = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    File { document: gltf.document, binary: gltf.blob.expect("a binary chunk"), length: bytes.len() }
}

impl File {
    /// The primitive with a material.
    fn part(&self, material: &str) -> Vertices {
        let mesh = self.document.meshes().next().expect("a mesh");
        let mut out = Vertices::default();
        for primitive in mesh.primitives().filter(|p| p.material().name() == Some(material)) {
            let reader = primitive.reader(|_| Some(self.binary.as_slice()));
            let first = out.positions.len() as u32;
            out.positions.extend(reader.read_positions().expect("positions").map(Vec3::from));
            out.normals.extend(reader.read_normals().expect("normals").map(Vec3::from));
            for name in ["SCALP", "BROW", "LASH_UPPER", "LASH_LOWER", "OCCLUSION"] {
                if let Some(mask) = primitive.get(&gltf::Semantic::Extras(name.into())) {
                    let values = gltf::accessor::Iter::<f32>::new(mask, |_| Some(self.binary.as_slice()));
                    out.masks.entry(name).or_default().extend(values.expect("numbers"));
                }
            }
            let indices: Vec<u32> = reader.read_indices().expect("indices").into_u32().collect();
            out.triangles.extend(indices.chunks_exact(3).map(|t| [t[0] + first, t[1] + first, t[2] + first]));
            let gltf::mesh::util::ReadJoints::U8(joints) = reader.read_joints(0).expect("joints") else {
                panic!("u8 joints")
            };
            let gltf::mesh::util::ReadWeights::U16(weights) = reader.read_weights(0).expect("weights") else {
                panic!("u16 weights")
            };
            out.joints.extend(joints);
            out.weights.extend(weights);
        }
        assert!(!out.positions.is_empty(), "no part {material}");
        out
    }

    /// The skeleton, with the palm's direction only guessed from the arm.
    fn rig(&self) -> rig::Rig {
        let skin = self.document.skins().next().expect("a skin");
        let nodes: Vec<gltf::Node> = skin.joints().collect();
        let parent = |index: usize| {
            nodes.iter().position(|n| n.children().any(|child| child.index() == nodes[index].index()))
        };
        let mut joints: Vec<rig::RigJoint> = Vec::new();
        for (index, node) in nodes.iter().enumerate() {
            let from = parent(index).map_or(Vec3::ZERO, |p| joints[p].rest);
            let rest = from + Vec3::from(node.transform().decomposed().0);
            joints.push(rig::RigJoint {
                name: node.name().expect("a name").into(),
                parent: parent(index),
                rest,
            });
        }
        let fore = joints[rig::CLAVICLE + rig::HAND].rest - joints[rig::CLAVICLE + rig::FOREARM].rest;
        rig::Rig { joints, palm: Vec3::new(fore.y, -fore.x, 0.0).normalize_or(Vec3::NEG_Y) }
    }

    /// World transforms of all joints at every key of a clip of the file.
    fn worlds(&self, clip: &str) -> Vec<Vec<(Quat, Vec3)>> {
        let rig = self.rig();
        let animation = self.document.animations().find(|a| a.name() == Some(clip)).expect("a clip");
        let names: Vec<&str> = rig.joints.iter().map(|j| j.name.as_str()).collect();
        let mut rotations: Vec<Vec<Quat>> = vec![Vec::new(); names.len()];
        let mut hips: Vec<Vec3> = Vec::new();
        for channel in animation.channels() {
            let reader = channel.reader(|_| Some(self.binary.as_slice()));
            match reader.read_outputs().expect("values") {
                gltf::animation::util::ReadOutputs::Translations(places) => {
                    hips = places.map(Vec3::from).collect();
                }
                gltf::animation::util::ReadOutputs::Rotations(turns) => {
                    let name = channel.target().node().name().expect("a name").to_owned();
                    let joint = names.iter().position(|n| *n == name).expect("a joint");
                    rotations[joint] = turns.into_f32().map(Quat::from_array).collect();
                }
                _ => {}
            }
        }
        let pose = |key: usize| dance::LocalPose {
            rotations: rotations.iter().map(|r| r[key]).collect(),
            hips: hips[key],
        };
        (0..hips.len()).map(|key| dance::world_of(&rig.joints, &pose(key))).collect()
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
fn files_are_small_and_complete() {
    for name in FIGURES {
        let file = read(name);
        assert!(file.length < 6 << 20, "{name}: {} bytes", file.length);
        let skin = file.document.skins().next().expect("a skin");
        let joints: Vec<&str> = skin.joints().filter_map(|joint| joint.name()).collect();
        for joint in ["hips", "spine", "chest", "neck", "head", "upper_arm_l", "hand_r", "shin_l", "toe_r"] {
            assert!(joints.contains(&joint), "{name}: no joint {joint}");
        }
        let clips: Vec<&str> = file.document.animations().filter_map(|clip| clip.name()).collect();
        assert_eq!(clips, ["dance", "idle"]);
        let vertices: usize =
            ["skin", "eyes", "top", "leggings"].map(|m| file.part(m).positions.len()).iter().sum();
        assert!(vertices <= 40_000, "{name}: {vertices} vertices");
        assert_eq!(file.document.images().count(), 3);
        for image in file.document.images() {
            let gltf::image::Source::View { view, .. } = image.source() else {
                panic!("an image in the file")
            };
            let bytes = &file.binary[view.offset()..view.offset() + view.length()];
            let image = image::load_from_memory(bytes).expect("an image");
            assert!(image.width() == image.height() && image.width() >= 512);
        }
    }
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
        let vertices = read(name).part("matt");
        let scalp = &vertices.masks["SCALP"];
        assert_eq!(open_edges(&vertices.triangles), 0, "{name}");
        // Negative control: without one triangle there are three open edges.
        assert_eq!(open_edges(&vertices.triangles[1..]), 3);
        let (v, t) = (vertices.positions.len() as i64, vertices.triangles.len() as i64);
        assert_eq!(v - t * 3 / 2 + t, 2, "{name}: one body without tunnels");
        let area = |hairy: bool| -> f32 {
            let at = |v: u32| vertices.positions[v as usize];
            let chosen =
                vertices.triangles.iter().filter(|t| !hairy || t.iter().all(|v| scalp[*v as usize] > 0.5));
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
fn figures_have_the_proportions_of_a_head_and_a_body() {
    for (name, height) in FIGURES.into_iter().zip([1.70, 1.80, 1.72, 1.66]) {
        let file = read(name);
        let p = &file.part("skin").positions;
        let within = |what: &str, measured: f32, wanted: f32, part: f32| {
            assert!(
                (measured / wanted - 1.0).abs() < part,
                "{name}: {what}: {measured} m, wanted {wanted} m"
            );
        };
        let (low, high) = extent(p, Vec3::Y, |_| true);
        within("height", high - low, height, 0.01);
        assert!(low.abs() < 0.002, "the soles are at {low} m");
        let (left, right) = extent(p, Vec3::X, |p| p.y > high - 0.085);
        within("width of the skull", right - left, 0.155, 0.08);
        let (back, front) = extent(p, Vec3::Z, |p| p.y > high - 0.095);
        within("depth of the skull", front - back, 0.195, 0.10);
        let eyes = file.part("eyes").positions;
        let (below, above) = extent(&eyes, Vec3::Y, |_| true);
        within("from the eyes to the crown", high - 0.5 * (below + above), 0.115, 0.10);
    }
}

#[test]
fn weights_sum_to_one_and_the_scalp_is_rigid() {
    for name in FIGURES {
        let file = read(name);
        let count = file.rig().joints.len();
        for part in ["skin", "eyes", "top", "leggings"] {
            let vertices = file.part(part);
            for (weights, joints) in vertices.weights.iter().zip(&vertices.joints) {
                assert_eq!(weights.iter().map(|w| u32::from(*w)).sum::<u32>(), 65535);
                assert!(joints.iter().all(|j| usize::from(*j) < count));
            }
            assert!(vertices.masks["OCCLUSION"].iter().all(|open| (0.0..=1.0).contains(open)));
            assert!(part == "skin" || !vertices.masks.contains_key("SCALP"));
        }
        let skin = file.part("skin");
        for (i, scalp) in skin.masks["SCALP"].iter().enumerate() {
            if *scalp >= 0.999 {
                assert_eq!((skin.joints[i][0], skin.weights[i][0]), (rig::HEAD as u8, 65535), "vertex {i}");
            }
        }
    }
}

#[test]
fn the_scalp_is_as_large_as_a_head_of_hair_wants_and_outside_of_the_head() {
    for name in FIGURES {
        let file = read(name);
        let skin = file.part("skin");
        let scalp = &skin.masks["SCALP"];
        let area: f32 = skin
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| skin.positions[i as usize]);
                let mask = t.iter().map(|i| scalp[*i as usize]).sum::<f32>() / 3.0;
                0.5 * (b - a).cross(c - a).length() * mask
            })
            .sum();
        // 600 to 700 cm² on an adult.
        assert!((0.055..0.076).contains(&area), "{name}: {} cm²", area * 1e4);
        let (_, crown) = extent(&skin.positions, Vec3::Y, |_| true);
        // The back of the throat is 40 mm from the middle of the skull.
        let middle = Vec3::new(0.0, crown - 0.09, file.rig().joints[rig::HEAD].rest.z + 0.012);
        let hairy: Vec<Vec3> =
            skin.positions.iter().zip(scalp).filter(|(_, s)| **s > 0.0).map(|(p, _)| *p).collect();
        assert!(hairy.iter().all(|p| p.distance(middle) > 0.060), "{name}: hair grows inside of the head");
        for mask in ["BROW", "LASH_UPPER", "LASH_LOWER"] {
            let on: Vec<Vec3> = skin
                .positions
                .iter()
                .zip(&skin.masks[mask])
                .filter(|(_, m)| **m > 0.5)
                .map(|(p, _)| *p)
                .collect();
            let left = on.iter().filter(|p| p.x > 0.0).count();
            assert!(left >= 12 && on.len() - left >= 12, "{name}: {mask} has {} vertices", on.len());
            assert!(on.iter().all(|p| p.x.abs() < 0.07 && p.z > middle.z + 0.03), "{name}: {mask}");
        }
    }
}

#[test]
fn nothing_shows_through_the_cloth_in_the_dance() {
    let file = read("dancer");
    let worlds = file.worlds("dance");
    let joints = file.rig().joints;
    let skin = file.part("skin");
    // Skin vertices that have cloth over them at rest, with the vertex of the cloth.
    let pairs: Vec<(Vertices, Vec<(usize, usize)>)> = ["top", "leggings"]
        .map(|name| {
            let cloth = file.part(name);
            let mut pairs = Vec::new();
            for (s, p) in skin.positions.iter().enumerate() {
                for (c, q) in cloth.positions.iter().enumerate() {
                    if p.distance_squared(*q) < 0.0045 * 0.0045 {
                        pairs.push((s, c));
                        break;
                    }
                }
            }
            (cloth, pairs)
        })
        .into();
    // A vertex and its normal in a pose.
    let posed = |v: &Vertices, i: usize, world: &[(Quat, Vec3)]| -> (Vec3, Vec3) {
        let (mut at, mut normal) = (Vec3::ZERO, Vec3::ZERO);
        for c in 0..4 {
            let joint = usize::from(v.joints[i][c]);
            let (rotation, place) = world[joint];
            let weight = f32::from(v.weights[i][c]) / 65535.0;
            at += (rotation * (v.positions[i] - joints[joint].rest) + place) * weight;
            normal += rotation * v.normals[i] * weight;
        }
        (at, normal.normalize_or(Vec3::Y))
    };
    for (cloth, pairs) in &pairs {
        let above = |(s, c): &&(usize, usize)| {
            (cloth.positions[*c] - skin.positions[*s]).dot(skin.normals[*s]) > 0.0012
        };
        let covered: Vec<&(usize, usize)> = pairs.iter().filter(above).collect();
        assert!(covered.len() > 20, "{} vertices under an edge of cloth", covered.len());
        for world in worlds.iter().step_by(24) {
            for (s, c) in &covered {
                let (skin_at, normal) = posed(&skin, *s, world);
                let height = (posed(cloth, *c, world).0 - skin_at).dot(normal);
                // The two are beside each other, so that they shear in an armpit; cloth with weights of its own sinks by a centimetre.
                assert!(height > -0.0025, "cloth is {height} m above the skin at {}", skin.positions[*s]);
            }
        }
    }
}

/// Angular speed between the rotations of two neighbouring keys, in radians per second.
fn angular_speed(a: Quat, b: Quat) -> f32 {
    let turn = a.inverse() * b;
    2.0 * turn.xyz().length().atan2(turn.w.abs()) * dance::RATE
}

/// The transforms of all joints at each key of a clip.
type Worlds = Vec<Vec<(Quat, Vec3)>>;

/// The clips of the dancer with their scores.
fn clips() -> Vec<(Score, Worlds)> {
    let file = read("dancer");
    [score::dance(), score::idle()].map(|score| (score.clone(), file.worlds(score.name))).into()
}

#[test]
fn clips_close_in_place_and_speed() {
    for (score, worlds) in clips() {
        let last = worlds.len() - 1;
        assert!(score.name != "dance" || last as f32 / dance::RATE >= 8.0);
        assert!((last as f32 / dance::RATE - score.beats * score.beat_secs).abs() < 1e-3);
        for (joint, _) in worlds[0].iter().enumerate() {
            let at = |key: usize| worlds[key][joint];
            assert!(at(0).1.distance(at(last).1) < 1e-5, "{}: joint {joint}", score.name);
            assert!(angular_speed(at(0).0, at(last).0) < 1e-3, "{}: joint {joint}", score.name);
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
    let joints = read("dancer").rig().joints;
    for (score, worlds) in clips() {
        for (joint, rig_joint) in joints.iter().enumerate() {
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
    let file = read("dancer");
    let vertices = file.part("skin");
    let joints = file.rig().joints;
    let score = score::dance();
    let worlds = file.worlds("dance");
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
            assert!(height > -0.008, "a sole is {height} m below the ground at key {key}");
        }
    }
}

#[test]
fn the_dance_turns_folds_and_stays_in_place() {
    let worlds = read("dancer").worlds("dance");
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
fn eyes_blink_and_stay_between_their_limits() {
    let file = read("dancer");
    let mesh = file.document.meshes().next().expect("a mesh");
    let morphs = mesh.primitives().next().expect("a primitive").morph_targets().count();
    let animation = file.document.animations().next().expect("a clip");
    let weights: Vec<f32> = animation
        .channels()
        .find_map(|channel| match channel.reader(|_| Some(file.binary.as_slice())).read_outputs()? {
            gltf::animation::util::ReadOutputs::MorphTargetWeights(weights) => {
                Some(weights.into_f32().collect())
            }
            _ => None,
        })
        .expect("a track of weights");
    assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
    let rows: Vec<&[f32]> = weights.chunks_exact(morphs).collect();
    let blinks = rows.windows(2).filter(|pair| pair[0][0] < 0.9 && pair[1][0] >= 0.9).count();
    assert_eq!(blinks, score::dance().blinks.len());
    assert_eq!(rows.first(), rows.last());
    let most = rows.iter().flat_map(|row| &row[1..5]).copied().fold(0.0, f32::max);
    assert!((0.1..0.5).contains(&most), "eyes turn by {most} at most");
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
        let grid = mesh::Grid::even(centre - Vec3::splat(0.1), centre + Vec3::splat(0.1), 0.0095);
        let mut ball = mesh::surface_nets(&grid, &distance);
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
    for name in FIGURES {
        let joints = read(name).rig().joints;
        let at = |offset: usize| joints[rig::CLAVICLE + offset].rest;
        let arm = at(rig::FOREARM) - at(rig::UPPER_ARM);
        let below = (-arm.y).atan2(arm.x).to_degrees();
        assert!((35.0..=55.0).contains(&below), "{name}: the arms hang {below} degrees below the horizontal");
        for (index, joint) in joints.iter().enumerate() {
            assert!(joint.parent.is_none_or(|parent| parent < index));
        }
    }
}
