//! Expressions of VRM: `blendShapeMaster` of VRM 0.x, `expressions` of VRM 1.0, and the nodes whose way is the weight of an expression
//! in a VRM animation.

use std::collections::BTreeMap;

use lovelock_gltf::document::Document;
use serde_json::Value;

use super::textures::number;
use crate::Expression;
use crate::face::preset_of;

/// Most morph targets that all expressions of a file move together.
const MOST_MOVED: usize = 1 << 20;

/// The first morph target and the number of morph targets of each node that has some.
pub(super) type MorphsOfNodes = BTreeMap<usize, (usize, usize)>;

/// The expressions of a document. What refers to morph targets that do not exist is left out and counted.
pub(super) fn read(
    document: &Document,
    morphs: &MorphsOfNodes,
    dropped: &mut BTreeMap<String, u64>,
) -> Vec<Expression> {
    let mut reader = Reader { document, morphs, left: MOST_MOVED, lost: 0, of_materials: 0 };
    let expressions = match (document.extensions.get("VRMC_vrm"), document.extensions.get("VRM")) {
        (Some(of), _) => reader.of_1(&of["expressions"]),
        (None, Some(of)) => reader.of_0(&of["blendShapeMaster"]["blendShapeGroups"]),
        (None, None) => return Vec::new(),
    };
    if reader.lost > 0 {
        *dropped.entry("parts_of_expressions".into()).or_default() += reader.lost;
    }
    if reader.of_materials > 0 {
        *dropped.entry("changes_of_materials_by_expressions".into()).or_default() += reader.of_materials;
    }
    expressions
}

struct Reader<'a> {
    document: &'a Document,
    morphs: &'a MorphsOfNodes,
    /// How many more morph targets may be moved.
    left: usize,
    lost: u64,
    /// Changes of colours and of places of textures, which are not read.
    of_materials: u64,
}

impl Reader<'_> {
    /// Objects by name: `preset` and `custom`.
    fn of_1(&mut self, expressions: &Value) -> Vec<Expression> {
        let mut found = Vec::new();
        for (group, is_preset) in [("preset", true), ("custom", false)] {
            for (name, of) in expressions[group].as_object().into_iter().flatten() {
                let mut morphs = Vec::new();
                for bind in of["morphTargetBinds"].as_array().into_iter().flatten() {
                    let nodes: Vec<usize> = index(&bind["node"]).into_iter().collect();
                    self.bind(&nodes, bind, 1.0, &mut morphs);
                }
                for binds in ["materialColorBinds", "textureTransformBinds"] {
                    self.of_materials += of[binds].as_array().map_or(0, |binds| binds.len() as u64);
                }
                found.push(Expression {
                    name: short(name),
                    preset: preset_of(name).filter(|_| is_preset),
                    is_binary: of["isBinary"].as_bool().unwrap_or(false),
                    morphs,
                });
            }
        }
        found
    }

    /// A list of groups, whose weights are percentages.
    fn of_0(&mut self, groups: &Value) -> Vec<Expression> {
        let mut nodes_of_mesh: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (n, node) in self.document.nodes.iter().enumerate() {
            if let Some(mesh) = node.mesh {
                nodes_of_mesh.entry(mesh).or_default().push(n);
            }
        }
        let mut found = Vec::new();
        for group in groups.as_array().into_iter().flatten() {
            let mut morphs = Vec::new();
            for bind in group["binds"].as_array().into_iter().flatten() {
                let nodes = index(&bind["mesh"]).and_then(|mesh| nodes_of_mesh.get(&mesh));
                self.bind(nodes.map_or(&[], Vec::as_slice), bind, 0.01, &mut morphs);
            }
            self.of_materials += group["materialValues"].as_array().map_or(0, |values| values.len() as u64);
            let preset = preset_of(group["presetName"].as_str().unwrap_or_default());
            let name =
                group["name"].as_str().filter(|name| !name.is_empty()).or(preset).unwrap_or("expression");
            found.push(Expression {
                name: short(name),
                preset,
                is_binary: group["isBinary"].as_bool().unwrap_or(false),
                morphs,
            });
        }
        found
    }

    /// Adds what one bind moves: a morph target of each node.
    fn bind(&mut self, nodes: &[usize], bind: &Value, unit: f32, morphs: &mut Vec<(usize, f32)>) {
        let (target, weight) = (index(&bind["index"]), number(&bind["weight"]).unwrap_or(0.0) * unit);
        let mut placed = false;
        for node in nodes {
            let morph = self.morphs.get(node).and_then(|&(first, count)| {
                target.filter(|target| *target < count).map(|target| first + target)
            });
            if let Some(morph) = morph.filter(|_| self.left > 0) {
                morphs.push((morph, weight.clamp(-1.0, 1.0)));
                self.left -= 1;
                placed = true;
            }
        }
        self.lost += u64::from(!placed);
    }
}

/// Names of expressions by the node of a VRM animation whose way along x is their weight (`VRMC_vrm_animation` 1.0).
pub(super) fn nodes_of_animation(document: &Document) -> BTreeMap<usize, String> {
    let Some(of) = document.extensions.get("VRMC_vrm_animation") else { return BTreeMap::new() };
    let mut nodes = BTreeMap::new();
    for group in ["preset", "custom"] {
        for (name, of) in of["expressions"][group].as_object().into_iter().flatten() {
            if let Some(node) = index(&of["node"]).filter(|node| *node < document.nodes.len()) {
                nodes.insert(node, short(name));
            }
        }
    }
    nodes
}

fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|n| usize::try_from(n).ok())
}

/// A name of at most 80 characters.
fn short(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_materials_are_counted() {
        for (extensions, count) in [
            (
                r#"{"VRMC_vrm":{"expressions":{"preset":{"happy":{"materialColorBinds":[{},{}],"textureTransformBinds":[{}]}}}}}"#,
                3,
            ),
            (r#"{"VRM":{"blendShapeMaster":{"blendShapeGroups":[{"materialValues":[{},{}]}]}}}"#, 2),
            (r#"{"VRMC_vrm":{"expressions":{"preset":{"happy":{}}}}}"#, 0),
        ] {
            let text = format!(r#"{{"asset":{{"version":"2.0"}},"extensions":{extensions}}}"#);
            let document: Document = serde_json::from_str(&text).unwrap();
            let mut dropped = BTreeMap::new();
            assert_eq!(read(&document, &MorphsOfNodes::new(), &mut dropped).len(), 1);
            let found = dropped.get("changes_of_materials_by_expressions").copied().unwrap_or(0);
            assert_eq!(found, count, "{dropped:?}");
        }
    }
}
