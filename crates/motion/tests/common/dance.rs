//! One dance of a figure of 21 joints, written in several formats, with the names of any family of rigs and from any time on.

use std::fmt::Write;

use glam::{EulerRot, Quat, Vec3};

use super::fbx::{Node, Value, node, p, properties, word};

/// Parent, and offset in a T-pose that faces +Z, metres: hips, spine, chest, neck, head, then for each side clavicle, upper arm,
/// forearm and hand, then for each side thigh, shin, foot and toes.
pub const JOINTS: [(usize, [f32; 3]); 21] = [
    (0, [0.0, 0.95, 0.0]),
    (0, [0.0, 0.12, 0.0]),
    (1, [0.0, 0.15, 0.0]),
    (2, [0.0, 0.24, 0.0]),
    (3, [0.0, 0.1, 0.02]),
    (2, [0.03, 0.2, 0.0]),
    (5, [0.14, 0.0, 0.0]),
    (6, [0.28, 0.0, 0.0]),
    (7, [0.25, 0.0, 0.0]),
    (2, [-0.03, 0.2, 0.0]),
    (9, [-0.14, 0.0, 0.0]),
    (10, [-0.28, 0.0, 0.0]),
    (11, [-0.25, 0.0, 0.0]),
    (0, [0.09, -0.05, 0.0]),
    (13, [0.0, -0.42, 0.0]),
    (14, [0.0, -0.4, 0.0]),
    (15, [0.0, -0.06, 0.13]),
    (0, [-0.09, -0.05, 0.0]),
    (17, [0.0, -0.42, 0.0]),
    (18, [0.0, -0.4, 0.0]),
    (19, [0.0, -0.06, 0.13]),
];

/// Names of the joints, in the order of [`JOINTS`].
pub type Names = [&'static str; 21];

pub const MIXAMO: Names = [
    "Hips",
    "Spine",
    "Spine1",
    "Neck",
    "Head",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightShoulder",
    "RightArm",
    "RightForeArm",
    "RightHand",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
];

/// A dance from one time to another.
#[derive(Clone, Copy)]
pub struct Dance {
    pub names: Names,
    pub frames: usize,
    /// Number of the first frame; 30 frames are a second.
    pub first: i64,
    /// Whether joints of an FBX file have axes of their own, so that their zero rotations are no pose of a figure.
    pub own_axes: bool,
    /// Number of frames after which it repeats; otherwise it goes on.
    pub cycle: Option<usize>,
}

impl Dance {
    pub fn new(names: &Names) -> Self {
        Self { names: *names, frames: 20, first: 0, own_axes: false, cycle: None }
    }

    fn offset(joint: usize) -> Vec3 {
        Vec3::from(JOINTS[joint].1)
    }

    /// The frame of the dance that is played in a frame: a cycle goes there and back.
    fn phase(&self, frame: usize) -> f32 {
        let turn = |frames: usize| std::f32::consts::TAU * frame as f32 / frames as f32;
        self.cycle.map_or(frame as f32, |frames| 10.0 * turn(frames).sin())
    }

    fn hips(&self, frame: usize) -> Vec3 {
        let frame = self.phase(frame);
        Self::offset(0) + Vec3::new(0.02 * frame, 0.0, 0.01 * frame)
    }

    /// Rotation of a joint relative to its parent: the arms come down, the knees bend, the trunk turns. The last pose is not the first.
    fn turn(&self, joint: usize, frame: usize) -> Quat {
        let t = self.phase(frame) * 0.1;
        match joint {
            1 => Quat::from_rotation_y(0.2 * t),
            4 => Quat::from_rotation_x(0.15 * t),
            5 => Quat::from_rotation_z(0.05 * t),
            6 => Quat::from_rotation_z(-0.5 * t) * Quat::from_rotation_x(0.2 * t),
            7 => Quat::from_rotation_y(-0.4 * t),
            8 => Quat::from_rotation_z(0.2 * t),
            10 => Quat::from_rotation_z(0.3 * t),
            11 => Quat::from_rotation_y(0.3 * t),
            13 => Quat::from_rotation_x(-0.3 * t),
            14 => Quat::from_rotation_x(0.4 * t),
            15 => Quat::from_rotation_x(-0.1 * t),
            16 | 20 => Quat::from_rotation_x(-0.05 * t),
            _ => Quat::IDENTITY,
        }
    }

    fn children(joint: usize) -> impl Iterator<Item = usize> {
        (1..JOINTS.len()).filter(move |&child| JOINTS[child].0 == joint)
    }

    /// As BVH, in centimetres.
    pub fn bvh(&self) -> String {
        let mut text = "HIERARCHY\n".to_owned();
        let mut order = Vec::new();
        self.bvh_joint(0, &mut order, &mut text);
        write!(text, "MOTION\nFrames: {}\nFrame Time: 0.033333\n", self.frames).expect("memory");
        for frame in 0..self.frames {
            let hips = self.hips(frame) * 100.0;
            write!(text, "{:.5} {:.5} {:.5}", hips.x, hips.y, hips.z).expect("memory");
            for &joint in &order {
                let (z, x, y) = self.turn(joint, frame).to_euler(EulerRot::ZXY);
                let [z, x, y] = [z, x, y].map(f32::to_degrees);
                write!(text, " {z:.5} {x:.5} {y:.5}").expect("memory");
            }
            text.push('\n');
        }
        text.replace("-0.00000", "0.00000")
    }

    fn bvh_joint(&self, joint: usize, order: &mut Vec<usize>, text: &mut String) {
        order.push(joint);
        let kind = if joint == 0 { "ROOT" } else { "JOINT" };
        let at = if joint == 0 { Vec3::ZERO } else { Self::offset(joint) * 100.0 };
        let positions = if joint == 0 { "6 Xposition Yposition Zposition" } else { "3" };
        let name = self.names[joint];
        write!(
            text,
            "{kind} {name}\n{{\nOFFSET {} {} {}\nCHANNELS {positions} Zrotation Xrotation Yrotation\n",
            at.x, at.y, at.z
        )
        .expect("memory");
        for child in Self::children(joint) {
            self.bvh_joint(child, order, text);
        }
        *text += "}\n";
    }

    fn secs(&self, frame: usize) -> f64 {
        (self.first + frame as i64) as f64 / 30.0
    }

    /// As glTF.
    pub fn glb(&self) -> Vec<u8> {
        self.glb_with("{}")
    }

    /// As a VRM animation, which names bones by itself.
    pub fn vrma(&self) -> Vec<u8> {
        const BONES: Names = [
            "hips",
            "spine",
            "chest",
            "neck",
            "head",
            "leftShoulder",
            "leftUpperArm",
            "leftLowerArm",
            "leftHand",
            "rightShoulder",
            "rightUpperArm",
            "rightLowerArm",
            "rightHand",
            "leftUpperLeg",
            "leftLowerLeg",
            "leftFoot",
            "leftToes",
            "rightUpperLeg",
            "rightLowerLeg",
            "rightFoot",
            "rightToes",
        ];
        let bones: Vec<String> =
            BONES.iter().enumerate().map(|(k, bone)| format!(r#""{bone}":{{"node":{k}}}"#)).collect();
        let bones = bones.join(",");
        self.glb_with(&format!(r#"{{"VRMC_vrm_animation":{{"humanoid":{{"humanBones":{{{bones}}}}}}}}}"#))
    }

    fn glb_with(&self, extensions: &str) -> Vec<u8> {
        let mut bin: Vec<u8> = Vec::new();
        let mut accessors = Vec::new();
        let mut put = |kind: &str, values: &[f32], lanes: usize| {
            let (offset, count) = (bin.len(), values.len() / lanes);
            bin.extend(values.iter().flat_map(|v| v.to_le_bytes()));
            accessors.push(format!(
                r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"{kind}"}}"#
            ));
            accessors.len() - 1
        };
        let frames = || 0..self.frames;
        let times: Vec<f32> = frames().map(|frame| self.secs(frame) as f32).collect();
        let input = put("SCALAR", &times, 1);
        let mut outputs = vec![(0, "translation", {
            let values: Vec<f32> = frames().flat_map(|frame| self.hips(frame).to_array()).collect();
            put("VEC3", &values, 3)
        })];
        for joint in 0..JOINTS.len() {
            let values: Vec<f32> = frames().flat_map(|frame| self.turn(joint, frame).to_array()).collect();
            outputs.push((joint, "rotation", put("VEC4", &values, 4)));
        }
        let samplers: Vec<String> =
            outputs.iter().map(|(.., output)| format!(r#"{{"input":{input},"output":{output}}}"#)).collect();
        let channels: Vec<String> = outputs
            .iter()
            .enumerate()
            .map(|(k, (joint, path, _))| {
                format!(r#"{{"sampler":{k},"target":{{"node":{joint},"path":"{path}"}}}}"#)
            })
            .collect();
        let nodes: Vec<String> = (0..JOINTS.len())
            .map(|joint| {
                let [x, y, z] = JOINTS[joint].1;
                let children: Vec<String> = Self::children(joint).map(|child| child.to_string()).collect();
                let children = if children.is_empty() {
                    String::new()
                } else {
                    format!(r#","children":[{}]"#, children.join(","))
                };
                format!(r#"{{"name":"{}","translation":[{x},{y},{z}]{children}}}"#, self.names[joint])
            })
            .collect();
        let length = bin.len();
        super::glb(
            format!(
                r#"{{"asset":{{"version":"2.0"}},"extensions":{extensions},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}],
                "animations":[{{"name":"dance","samplers":[{}],"channels":[{}]}}],"accessors":[{}],
                "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length}}}]}}"#,
                nodes.join(","),
                samplers.join(","),
                channels.join(","),
                accessors.join(",")
            ),
            bin,
        )
    }

    /// As USD text, at 30 time codes per second.
    pub fn usda(&self) -> String {
        let paths: Vec<String> = (0..JOINTS.len())
            .map(|joint| {
                let mut path = self.names[joint].to_owned();
                let mut at = joint;
                while at != 0 {
                    at = JOINTS[at].0;
                    path = format!("{}/{path}", self.names[at]);
                }
                format!("\"{path}\"")
            })
            .collect();
        let paths = paths.join(", ");
        let mut places = [Vec3::ZERO; 21];
        for joint in 0..JOINTS.len() {
            let from = if joint == 0 { Vec3::ZERO } else { places[JOINTS[joint].0] };
            places[joint] = from + Self::offset(joint);
        }
        let matrices = places
            .map(|p| format!("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({}, {}, {}, 1))", p.x, p.y, p.z));
        let samples = |text: &dyn Fn(usize, usize) -> String| {
            let all: Vec<String> = (0..self.frames)
                .map(|frame| {
                    let values: Vec<String> = (0..JOINTS.len()).map(|joint| text(joint, frame)).collect();
                    format!("{}: [{}]", self.first + frame as i64, values.join(", "))
                })
                .collect();
            all.join(",\n")
        };
        let translations = samples(&|joint, frame| {
            let p = if joint == 0 { self.hips(frame) } else { Self::offset(joint) };
            format!("({}, {}, {})", p.x, p.y, p.z)
        });
        let rotations = samples(&|joint, frame| {
            let q = self.turn(joint, frame);
            format!("({}, {}, {}, {})", q.w, q.x, q.y, q.z)
        });
        format!(
            "#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = \"Y\"\ntimeCodesPerSecond = 30\nstartTimeCode = 0\n)\n\
             def SkelRoot \"figure\"\n{{\ndef Skeleton \"rig\" (prepend apiSchemas = [\"SkelBindingAPI\"])\n{{\n\
             uniform token[] joints = [{paths}]\nuniform matrix4d[] bindTransforms = [{}]\n\
             rel skel:animationSource = </figure/rig/dance>\ndef SkelAnimation \"dance\"\n{{\n\
             uniform token[] joints = [{paths}]\nfloat3[] translations.timeSamples = {{\n{translations}\n}}\n\
             quatf[] rotations.timeSamples = {{\n{rotations}\n}}\nhalf3[] scales = [{}]\n}}\n}}\n}}\n",
            matrices.join(", "),
            vec!["(1, 1, 1)"; JOINTS.len()].join(", ")
        )
    }

    /// As FBX without a mesh, in centimetres. The transforms of its nodes are those in the middle of the dance.
    pub fn fbx(&self) -> Vec<Node> {
        const SECOND: i64 = 46_186_158_000;
        let axes = |joint: usize| {
            let k = if self.own_axes { joint as f32 } else { 0.0 };
            Quat::from_rotation_z(0.7 * k) * Quat::from_rotation_x(0.4 * k)
        };
        let above = |joint: usize| axes(JOINTS[joint].0).inverse();
        let degrees = |joint: usize, frame: usize| {
            let local = above(joint) * self.turn(joint, frame) * axes(joint);
            let (z, y, x) = local.to_euler(EulerRot::ZYX);
            [x, y, z].map(|angle| f64::from(angle.to_degrees()))
        };
        let place = |joint: usize, frame: usize| {
            let p = if joint == 0 { self.hips(frame) } else { above(joint) * Self::offset(joint) };
            p.to_array().map(|v| f64::from(v) * 100.0)
        };
        let lcl = |name: &'static str, values: [f64; 3]| p(name, name, values.map(Value::Number).into());
        let middle = self.frames / 2;
        let times: Vec<i64> = (0..self.frames).map(|f| (self.first + f as i64) * SECOND / 30).collect();
        let (mut objects, mut links) = (Vec::new(), Vec::new());
        let connect = |child: i64, parent: i64, of: Option<&'static str>| {
            let kind = if of.is_some() { "OP" } else { "OO" };
            let mut values = vec![word(kind), Value::Integer(child), Value::Integer(parent)];
            values.extend(of.map(word));
            node("C", values, vec![])
        };
        for (joint, name) in self.names.into_iter().enumerate() {
            let id = 100 * (joint as i64 + 1);
            let model = vec![Value::Integer(id), Value::Text(name, "Model"), word("LimbNode")];
            let transforms = vec![
                lcl("Lcl Translation", place(joint, middle)),
                lcl("Lcl Rotation", degrees(joint, middle)),
            ];
            objects.push(node("Model", model, vec![properties(transforms)]));
            let attribute = vec![Value::Integer(id + 1), Value::Text("", "NodeAttribute"), word("LimbNode")];
            objects.push(node("NodeAttribute", attribute, vec![]));
            links.push(connect(id + 1, id, None));
            links.push(connect(id, if joint == 0 { 0 } else { 100 * (JOINTS[joint].0 as i64 + 1) }, None));
            for (k, (of, short)) in [("Lcl Rotation", "R"), ("Lcl Translation", "T")].into_iter().enumerate()
            {
                if k == 1 && joint != 0 {
                    continue;
                }
                let of_node = id + 10 + 10 * k as i64;
                let values = vec![Value::Integer(of_node), Value::Text(short, "AnimCurveNode"), word("")];
                objects.push(node("AnimationCurveNode", values, vec![]));
                links.push(connect(of_node, 61, None));
                links.push(connect(of_node, id, Some(of)));
                for (axis, channel) in ["d|X", "d|Y", "d|Z"].into_iter().enumerate() {
                    let value = |frame: usize| {
                        let all = if k == 0 { degrees(joint, frame) } else { place(joint, frame) };
                        all[axis] as f32
                    };
                    let curve = of_node + 1 + axis as i64;
                    objects.push(node(
                        "AnimationCurve",
                        vec![Value::Integer(curve), Value::Text("", "AnimCurve"), word("")],
                        vec![
                            node("KeyTime", vec![Value::Longs(times.clone())], vec![]),
                            node(
                                "KeyValueFloat",
                                vec![Value::Floats((0..self.frames).map(value).collect())],
                                vec![],
                            ),
                            node("KeyAttrFlags", vec![Value::Integers(vec![4])], vec![]),
                            node("KeyAttrDataFloat", vec![Value::Floats(vec![0.0; 4])], vec![]),
                            node("KeyAttrRefCount", vec![Value::Integers(vec![self.frames as i64])], vec![]),
                        ],
                    ));
                    links.push(connect(curve, of_node, Some(channel)));
                }
            }
        }
        let stack = vec![Value::Integer(60), Value::Text("dance", "AnimStack"), word("")];
        let stop = p("LocalStop", "KTime", vec![Value::Integer(SECOND)]);
        objects.push(node("AnimationStack", stack, vec![properties(vec![stop])]));
        let axes = [
            ("UpAxis", 1),
            ("UpAxisSign", 1),
            ("FrontAxis", 2),
            ("FrontAxisSign", 1),
            ("CoordAxis", 0),
            ("CoordAxisSign", 1),
        ];
        let mut settings: Vec<Node> =
            axes.into_iter().map(|(name, value)| p(name, "int", vec![Value::Integer(value)])).collect();
        settings.push(p("UnitScaleFactor", "double", vec![Value::Number(1.0)]));
        let layer = vec![Value::Integer(61), Value::Text("base", "AnimLayer"), word("")];
        objects.push(node("AnimationLayer", layer, vec![]));
        links.push(connect(61, 60, None));
        vec![
            node("FBXHeaderExtension", vec![], vec![node("FBXVersion", vec![Value::Integer(7400)], vec![])]),
            node("GlobalSettings", vec![], vec![properties(settings)]),
            node("Objects", vec![], objects),
            node("Connections", vec![], links),
        ]
    }
}
