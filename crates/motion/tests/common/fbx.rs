//! A small FBX figure, written as text and as binary from the same tree.

/// A property of a node.
pub enum Value {
    Integer(i64),
    Number(f64),
    Text(&'static str, &'static str),
    Integers(Vec<i64>),
    Longs(Vec<i64>),
    Numbers(Vec<f64>),
    Floats(Vec<f32>),
    /// Bytes, which only the binary form has; as text they are an empty string.
    Bytes(Vec<u8>),
}

use Value::{Bytes, Floats, Integer, Integers, Longs, Number, Numbers, Text};

pub struct Node {
    pub name: &'static str,
    pub values: Vec<Value>,
    pub children: Vec<Node>,
}

pub fn node(name: &'static str, values: Vec<Value>, children: Vec<Node>) -> Node {
    Node { name, values, children }
}

pub fn word(text: &'static str) -> Value {
    Text(text, "")
}

pub fn p(name: &'static str, kind: &'static str, values: Vec<Value>) -> Node {
    let mut all = vec![word(name), word(kind), word(""), word("A")];
    all.extend(values);
    node("P", all, vec![])
}

pub fn properties(children: Vec<Node>) -> Node {
    node("Properties70", vec![], children)
}

/// The axes and the unit of a file.
#[derive(Clone, Copy)]
pub struct Space {
    pub z_up: bool,
    /// Centimetres per unit.
    pub unit: f64,
}

const SECOND: i64 = 46_186_158_000;

/// A figure of two joints and a triangle: `hips` at 1 m, `head` 0.5 m above it with a pre-rotation of a quarter turn about X. The
/// triangle is 0.1 m to the left, in front and above of the head; its first corner follows the hips, the others the head. In one
/// second the hips turn by a quarter to the left about the vertical, and the shape `open` goes from 0 to 100 %, which moves the third
/// corner up by 0.1 m.
pub fn figure(space: Space) -> Vec<Node> {
    // From metres with Y up to the file.
    let size = 100.0 / space.unit;
    let at = |x: f64, y: f64, z: f64| {
        if space.z_up { [x * size, -z * size, y * size] } else { [x * size, y * size, z * size] }
    };
    let matrix = |columns: [[f64; 3]; 3], t: [f64; 3]| {
        let [a, b, c] = columns;
        Numbers(vec![
            a[0], a[1], a[2], 0.0, b[0], b[1], b[2], 0.0, c[0], c[1], c[2], 0.0, t[0], t[1], t[2], 1.0,
        ])
    };
    let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // A quarter turn about X: Y to Z, Z to -Y; and its inverse.
    let (turned, back) = (
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
    );
    let (hips, head) = (at(0.0, 1.0, 0.0), at(0.0, 1.5, 0.0));
    let up = at(0.0, 0.5, 0.0);
    let local = |v: [f64; 3]| p("Lcl Translation", "Lcl Translation", v.into_iter().map(Number).collect());
    let corners = [at(0.1, 1.5, 0.0), at(0.0, 1.5, 0.1), at(0.0, 1.6, 0.0)];
    let joint = |id: i64, name: &'static str, properties_of: Vec<Node>| {
        node(
            "Model",
            vec![Integer(id), Text(name, "Model"), word("LimbNode")],
            vec![node("Version", vec![Integer(232)], vec![]), properties(properties_of)],
        )
    };
    let attribute = |id: i64| {
        node("NodeAttribute", vec![Integer(id), Text("", "NodeAttribute"), word("LimbNode")], vec![])
    };
    let cluster =
        |id: i64, corners: Vec<i64>, columns: [[f64; 3]; 3], inverse: [[f64; 3]; 3], link: [f64; 3]| {
            let gone: [f64; 3] =
                std::array::from_fn(|k| -(0..3).map(|j| inverse[j][k] * link[j]).sum::<f64>());
            node(
                "Deformer",
                vec![Integer(id), Text("", "SubDeformer"), word("Cluster")],
                vec![
                    node("Weights", vec![Numbers(vec![1.0; corners.len()])], vec![]),
                    node("Indexes", vec![Integers(corners)], vec![]),
                    node("Transform", vec![matrix(inverse, gone)], vec![]),
                    node("TransformLink", vec![matrix(columns, link)], vec![]),
                ],
            )
        };
    let curve = |id: i64, to: f32| {
        node(
            "AnimationCurve",
            vec![Integer(id), Text("", "AnimCurve"), word("")],
            vec![
                node("Default", vec![Number(0.0)], vec![]),
                node("KeyVer", vec![Integer(4008)], vec![]),
                node("KeyTime", vec![Longs(vec![0, SECOND])], vec![]),
                node("KeyValueFloat", vec![Floats(vec![0.0, to])], vec![]),
                node("KeyAttrFlags", vec![Integers(vec![4])], vec![]),
                node("KeyAttrDataFloat", vec![Floats(vec![0.0; 4])], vec![]),
                node("KeyAttrRefCount", vec![Integers(vec![2])], vec![]),
            ],
        )
    };
    let axes = if space.z_up { [2, 1, 1, -1, 0, 1] } else { [1, 1, 2, 1, 0, 1] };
    let names = ["UpAxis", "UpAxisSign", "FrontAxis", "FrontAxisSign", "CoordAxis", "CoordAxisSign"];
    let mut settings: Vec<Node> =
        names.into_iter().zip(axes).map(|(name, value)| p(name, "int", vec![Integer(value)])).collect();
    settings.push(p("UnitScaleFactor", "double", vec![Number(space.unit)]));
    let (numbers, integers) = (|v: &[[f64; 3]]| Numbers(v.concat()), |v: &[i64]| Integers(v.to_vec()));
    let rise = at(0.0, 0.1, 0.0);
    let objects = vec![
        node(
            "Geometry",
            vec![Integer(10), Text("body", "Geometry"), word("Mesh")],
            vec![
                node("Vertices", vec![numbers(&corners)], vec![]),
                node("PolygonVertexIndex", vec![integers(&[0, 1, -3])], vec![]),
            ],
        ),
        node(
            "Geometry",
            vec![Integer(11), Text("open", "Geometry"), word("Shape")],
            vec![
                node("Indexes", vec![integers(&[2])], vec![]),
                node("Vertices", vec![numbers(&[rise])], vec![]),
            ],
        ),
        node("Model", vec![Integer(20), Text("body", "Model"), word("Mesh")], vec![]),
        attribute(31),
        attribute(32),
        joint(21, "hips", vec![local(hips)]),
        joint(
            22,
            "head",
            vec![
                p("RotationActive", "bool", vec![Integer(1)]),
                p("PreRotation", "Vector3D", vec![Number(90.0), Number(0.0), Number(0.0)]),
                local(up),
            ],
        ),
        node("Deformer", vec![Integer(40), Text("", "Deformer"), word("Skin")], vec![]),
        cluster(41, vec![0], straight, straight, hips),
        cluster(42, vec![1, 2], turned, back, head),
        node("Deformer", vec![Integer(50), Text("", "Deformer"), word("BlendShape")], vec![]),
        node(
            "Deformer",
            vec![Integer(51), Text("open", "SubDeformer"), word("BlendShapeChannel")],
            vec![
                node("DeformPercent", vec![Number(0.0)], vec![]),
                node("FullWeights", vec![Numbers(vec![100.0])], vec![]),
            ],
        ),
        node(
            "AnimationStack",
            vec![Integer(60), Text("dance", "AnimStack"), word("")],
            vec![properties(vec![p("LocalStop", "KTime", vec![Integer(SECOND)])])],
        ),
        node("AnimationLayer", vec![Integer(61), Text("base", "AnimLayer"), word("")], vec![]),
        node("AnimationCurveNode", vec![Integer(62), Text("R", "AnimCurveNode"), word("")], vec![]),
        curve(63, 90.0),
        node(
            "AnimationCurveNode",
            vec![Integer(64), Text("DeformPercent", "AnimCurveNode"), word("")],
            vec![],
        ),
        curve(65, 100.0),
    ];
    let link = |child: i64, parent: i64| node("C", vec![word("OO"), Integer(child), Integer(parent)], vec![]);
    let drive = |child: i64, parent: i64, of: &'static str| {
        node("C", vec![word("OP"), Integer(child), Integer(parent), word(of)], vec![])
    };
    let connections = vec![
        link(20, 0),
        link(21, 0),
        link(22, 21),
        link(31, 21),
        link(32, 22),
        link(10, 20),
        link(40, 10),
        link(41, 40),
        link(42, 40),
        link(21, 41),
        link(22, 42),
        link(50, 10),
        link(51, 50),
        link(11, 51),
        link(61, 60),
        link(62, 61),
        drive(62, 21, "Lcl Rotation"),
        drive(63, 62, if space.z_up { "d|Z" } else { "d|Y" }),
        link(64, 61),
        drive(64, 51, "DeformPercent"),
        drive(65, 64, "d|DeformPercent"),
    ];
    vec![
        node(
            "FBXHeaderExtension",
            vec![],
            vec![
                node("FBXHeaderVersion", vec![Integer(1003)], vec![]),
                node("FBXVersion", vec![Integer(7400)], vec![]),
                node("EncryptionType", vec![Integer(0)], vec![]),
            ],
        ),
        node("GlobalSettings", vec![], vec![properties(settings)]),
        node("Objects", vec![], objects),
        node("Connections", vec![], connections),
    ]
}

/// The text form.
pub fn text(nodes: &[Node]) -> String {
    let mut out = String::from("; FBX 7.4.0 project file\n");
    for node in nodes {
        write_text(node, &mut out);
    }
    out
}

fn write_text(node: &Node, out: &mut String) {
    let list = |numbers: Vec<String>| format!("*{} {{\na: {}\n}}", numbers.len(), numbers.join(","));
    let values: Vec<String> = node
        .values
        .iter()
        .map(|value| match value {
            Integer(n) => n.to_string(),
            Number(n) => format!("{n:?}"),
            Text(name, "") => format!("\"{name}\""),
            Text(name, class) => format!("\"{class}::{name}\""),
            Integers(v) | Longs(v) => list(v.iter().map(ToString::to_string).collect()),
            Numbers(v) => list(v.iter().map(|n| format!("{n:?}")).collect()),
            Floats(v) => list(v.iter().map(|n| format!("{n:?}")).collect()),
            Bytes(_) => "\"\"".to_owned(),
        })
        .collect();
    *out += node.name;
    *out += ": ";
    *out += &values.join(", ");
    if !node.children.is_empty() {
        *out += " {\n";
        for child in &node.children {
            write_text(child, out);
        }
        *out += "}";
    }
    *out += "\n";
}

/// The binary form of version 7.4.
pub fn binary(nodes: &[Node]) -> Vec<u8> {
    let mut out = b"Kaydara FBX Binary  \0\x1a\0".to_vec();
    out.extend(7400_u32.to_le_bytes());
    for node in nodes {
        write_binary(node, &mut out);
    }
    out.extend([0; 13]);
    out
}

fn write_binary(node: &Node, out: &mut Vec<u8>) {
    let start = out.len();
    out.extend([0; 12]);
    out.push(node.name.len() as u8);
    out.extend(node.name.as_bytes());
    let of_values = out.len();
    for value in &node.values {
        let array = |out: &mut Vec<u8>, kind: u8, count: usize, bytes: Vec<u8>| {
            out.push(kind);
            for number in [count, 0, bytes.len()] {
                out.extend((number as u32).to_le_bytes());
            }
            out.extend(bytes);
        };
        match value {
            Integer(n) => {
                out.push(b'L');
                out.extend(n.to_le_bytes());
            }
            Number(n) => {
                out.push(b'D');
                out.extend(n.to_le_bytes());
            }
            Text(name, class) => {
                let whole =
                    if class.is_empty() { (*name).to_owned() } else { format!("{name}\0\x01{class}") };
                out.push(b'S');
                out.extend((whole.len() as u32).to_le_bytes());
                out.extend(whole.as_bytes());
            }
            Integers(v) => {
                array(out, b'i', v.len(), v.iter().flat_map(|n| (*n as i32).to_le_bytes()).collect());
            }
            Longs(v) => array(out, b'l', v.len(), v.iter().flat_map(|n| n.to_le_bytes()).collect()),
            Numbers(v) => array(out, b'd', v.len(), v.iter().flat_map(|n| n.to_le_bytes()).collect()),
            Floats(v) => array(out, b'f', v.len(), v.iter().flat_map(|n| n.to_le_bytes()).collect()),
            Bytes(v) => {
                out.push(b'R');
                out.extend((v.len() as u32).to_le_bytes());
                out.extend(v);
            }
        }
    }
    let value_bytes = out.len() - of_values;
    if !node.children.is_empty() {
        for child in &node.children {
            write_binary(child, out);
        }
        out.extend([0; 13]);
    }
    let end = out.len();
    for (k, number) in [end, node.values.len(), value_bytes].into_iter().enumerate() {
        out[start + 4 * k..start + 4 * k + 4].copy_from_slice(&(number as u32).to_le_bytes());
    }
}

/// A second mesh of a triangle, `cap`, under a node `group`, and what hides them.
#[derive(Default)]
pub struct Cap {
    /// Properties of the cap and of the group: name, kind and value.
    pub own: Vec<(&'static str, &'static str, i64)>,
    pub group: Vec<(&'static str, &'static str, i64)>,
    /// Whether the display layer of the cap is shown, if it is in one.
    pub layer: Option<i64>,
    /// `Visibility` of the cap at 0 and 1 s, if it is animated.
    pub animated: Option<[f32; 2]>,
    /// Whether the group holds levels of detail, of which the cap is the second.
    pub is_level: bool,
}

/// Adds a cap to a figure.
pub fn with_cap(mut nodes: Vec<Node>, cap: &Cap) -> Vec<Node> {
    let of = |list: &[(&'static str, &'static str, i64)]| {
        properties(list.iter().map(|&(name, kind, value)| p(name, kind, vec![Integer(value)])).collect())
    };
    let kind = if cap.is_level { "LodGroup" } else { "Null" };
    let mut objects = vec![
        node(
            "Geometry",
            vec![Integer(12), Text("cap", "Geometry"), word("Mesh")],
            vec![
                node("Vertices", vec![Numbers(vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0])], vec![]),
                node("PolygonVertexIndex", vec![Integers(vec![0, 1, -3])], vec![]),
            ],
        ),
        node("Model", vec![Integer(25), Text("finest", "Model"), word("Null")], vec![]),
        node("Model", vec![Integer(24), Text("group", "Model"), word(kind)], vec![of(&cap.group)]),
        node("Model", vec![Integer(23), Text("cap", "Model"), word("Mesh")], vec![of(&cap.own)]),
    ];
    let link = |child: i64, parent: i64| node("C", vec![word("OO"), Integer(child), Integer(parent)], vec![]);
    let mut connections = vec![link(24, 0), link(25, 24), link(23, 24), link(12, 23)];
    if cap.is_level {
        objects.push(node(
            "NodeAttribute",
            vec![Integer(33), Text("", "NodeAttribute"), word("LodGroup")],
            vec![],
        ));
        connections.push(link(33, 24));
    }
    if let Some(shown) = cap.layer {
        objects.push(node(
            "CollectionExclusive",
            vec![Integer(70), Text("layer", "DisplayLayer"), word("DisplayLayer")],
            vec![properties(vec![p("Show", "bool", vec![Integer(shown)])])],
        ));
        connections.push(link(23, 70));
    }
    if let Some(values) = cap.animated {
        objects.push(node(
            "AnimationCurveNode",
            vec![Integer(66), Text("Visibility", "AnimCurveNode"), word("")],
            vec![],
        ));
        objects.push(node(
            "AnimationCurve",
            vec![Integer(67), Text("", "AnimCurve"), word("")],
            vec![
                node("KeyTime", vec![Longs(vec![0, SECOND])], vec![]),
                node("KeyValueFloat", vec![Floats(values.to_vec())], vec![]),
                node("KeyAttrFlags", vec![Integers(vec![4])], vec![]),
                node("KeyAttrDataFloat", vec![Floats(vec![0.0; 4])], vec![]),
                node("KeyAttrRefCount", vec![Integers(vec![2])], vec![]),
            ],
        ));
        let drive = |child: i64, parent: i64, of: &'static str| {
            node("C", vec![word("OP"), Integer(child), Integer(parent), word(of)], vec![])
        };
        connections.extend([link(66, 61), drive(66, 23, "Visibility"), drive(67, 66, "d|Visibility")]);
    }
    for node in &mut nodes {
        match node.name {
            "Objects" => node.children.append(&mut objects),
            "Connections" => node.children.append(&mut connections),
            _ => {}
        }
    }
    nodes
}

/// Gives the body of a figure a material named `Face` with a texture of its colour, whose image is in the file if there is one. On another
/// computer it was `C:\work\maps\skin.png`. The corners have the texture coordinates (0.25, 0.75), (0.5, 0) and (1, 1) from below.
pub fn with_texture(mut nodes: Vec<Node>, image: Option<&[u8]>) -> Vec<Node> {
    const FILE: &str = "C:\\work\\maps\\skin.png";
    let leaf = |name: &'static str, values: Vec<Value>| node(name, values, vec![]);
    let layer = |name: &'static str, mapping: &'static str, lists: Vec<Node>| {
        let mut children = vec![
            leaf("Version", vec![Integer(101)]),
            leaf("Name", vec![word("map")]),
            leaf("MappingInformationType", vec![word(mapping)]),
            leaf("ReferenceInformationType", vec![word("IndexToDirect")]),
        ];
        children.extend(lists);
        node(name, vec![Integer(0)], children)
    };
    let element = |kind: &'static str| {
        node(
            "LayerElement",
            vec![],
            vec![leaf("Type", vec![word(kind)]), leaf("TypedIndex", vec![Integer(0)])],
        )
    };
    let files =
        || vec![leaf("FileName", vec![word(FILE)]), leaf("RelativeFilename", vec![word("maps\\skin.png")])];
    let mut content = files();
    content.extend(image.map(|image| leaf("Content", vec![Bytes(image.to_vec())])));
    let wrap = |name: &'static str| p(name, "enum", vec![Integer(1)]);
    let mut texture = files();
    texture.push(properties(vec![wrap("WrapModeU")]));
    let color = p("DiffuseColor", "Color", vec![Number(0.1), Number(0.2), Number(0.3)]);
    let mut objects = vec![
        node(
            "Material",
            vec![Integer(80), Text("Face", "Material"), word("")],
            vec![leaf("ShadingModel", vec![word("phong")]), properties(vec![color])],
        ),
        node("Texture", vec![Integer(81), Text("skin", "Texture"), word("")], texture),
        node("Video", vec![Integer(82), Text("skin", "Video"), word("Clip")], content),
    ];
    let link = |child: i64, parent: i64| leaf("C", vec![word("OO"), Integer(child), Integer(parent)]);
    let of_color = || leaf("C", vec![word("OP"), Integer(81), Integer(80), word("DiffuseColor")]);
    for node in &mut nodes {
        match node.name {
            "Objects" => {
                let body = node.children.iter_mut().find(|node| node.name == "Geometry").expect("the body");
                body.children.push(layer(
                    "LayerElementUV",
                    "ByPolygonVertex",
                    vec![
                        leaf("UV", vec![Numbers(vec![0.25, 0.75, 0.5, 0.0, 1.0, 1.0])]),
                        leaf("UVIndex", vec![Integers(vec![0, 1, 2])]),
                    ],
                ));
                let materials = vec![leaf("Materials", vec![Integers(vec![0])])];
                body.children.push(layer("LayerElementMaterial", "AllSame", materials));
                let elements = vec![element("LayerElementUV"), element("LayerElementMaterial")];
                body.children.push(self::node("Layer", vec![Integer(0)], elements));
                node.children.append(&mut objects);
            }
            "Connections" => node.children.extend([link(80, 20), link(82, 81), of_color()]),
            _ => {}
        }
    }
    nodes
}
