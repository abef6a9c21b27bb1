//! What VRM files say beyond glTF: which joints are the bones of a person, and which chains of joints swing.
//!
//! VRM 0.x is the extension `VRM`, VRM 1.0 are `VRMC_vrm` and `VRMC_springBone`, and a motion is `VRMC_vrm_animation`. What is wrong
//! in them is left out, because the file is a valid glTF without it.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use lovelock_gltf::document::Document;

use crate::character::names_hair;

/// The VRM part of a document.
pub(super) struct Vrm {
    /// The format, such as `VRM 1.0`.
    pub(super) format: &'static str,
    /// Names of bones by node, such as `leftUpperArm`.
    pub(super) bones: BTreeMap<usize, String>,
    springs: Vec<Spring>,
}

/// Joints that swing together.
struct Spring {
    name: String,
    nodes: Vec<usize>,
}

impl Vrm {
    /// The VRM part of a document, if it has one.
    pub(super) fn of(document: &Document) -> Option<Self> {
        let extension = |name: &str| document.extensions.get(name);
        let mut vrm = if let Some(of) = extension("VRMC_vrm") {
            let springs = extension("VRMC_springBone").map_or_else(Vec::new, springs_of_1);
            Self { format: "VRM 1.0", bones: bones_of_1(of), springs }
        } else if let Some(of) = extension("VRM") {
            Self { format: "VRM 0.x", bones: bones_of_0(of), springs: springs_of_0(of) }
        } else if let Some(of) = extension("VRMC_vrm_animation") {
            Self { format: "VRM animation 1.0", bones: bones_of_1(of), springs: Vec::new() }
        } else {
            return None;
        };
        let count = document.nodes.len();
        vrm.bones.retain(|&node, _| node < count);
        for spring in &mut vrm.springs {
            spring.nodes.retain(|&node| node < count);
        }
        Some(vrm)
    }

    /// The nodes that move hair: springs whose name or joints say hair, or all that hang on the head if none does; with the nodes below.
    pub(super) fn hair_nodes(&self, document: &Document) -> BTreeSet<usize> {
        let below = |roots: Vec<usize>| {
            let mut found = BTreeSet::new();
            let mut stack = roots;
            while let Some(node) = stack.pop() {
                if found.insert(node) {
                    stack.extend(document.nodes[node].children.iter().filter(|&&c| c < document.nodes.len()));
                }
            }
            found
        };
        let says_hair = |node: &usize| document.nodes[*node].name.as_deref().is_some_and(names_hair);
        let named: Vec<usize> = self
            .springs
            .iter()
            .filter(|spring| names_hair(&spring.name) || spring.nodes.iter().any(says_hair))
            .flat_map(|spring| spring.nodes.iter().copied())
            .collect();
        if !named.is_empty() {
            return below(named);
        }
        let head: Vec<usize> =
            self.bones.iter().filter(|(_, bone)| *bone == "head").map(|(&n, _)| n).collect();
        let on_head = below(head);
        let springs = self.springs.iter().flat_map(|spring| spring.nodes.iter().copied());
        below(springs.filter(|node| on_head.contains(node)).collect())
    }
}

fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|n| usize::try_from(n).ok())
}

/// `humanoid.humanBones` of VRM 1.0: an object by the names of bones.
fn bones_of_1(extension: &Value) -> BTreeMap<usize, String> {
    let bones = extension.pointer("/humanoid/humanBones").and_then(Value::as_object);
    bones.into_iter().flatten().filter_map(|(bone, of)| Some((index(&of["node"])?, bone.clone()))).collect()
}

/// `humanoid.humanBones` of VRM 0.x: a list.
fn bones_of_0(extension: &Value) -> BTreeMap<usize, String> {
    let bones = extension.pointer("/humanoid/humanBones").and_then(Value::as_array);
    let bones = bones.into_iter().flatten();
    bones.filter_map(|of| Some((index(&of["node"])?, of["bone"].as_str()?.to_owned()))).collect()
}

fn springs_of_1(extension: &Value) -> Vec<Spring> {
    let springs = extension["springs"].as_array();
    springs
        .into_iter()
        .flatten()
        .map(|spring| Spring {
            name: spring["name"].as_str().unwrap_or_default().to_owned(),
            nodes: spring["joints"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(|j| index(&j["node"]))
                .collect(),
        })
        .collect()
}

fn springs_of_0(extension: &Value) -> Vec<Spring> {
    let groups = extension.pointer("/secondaryAnimation/boneGroups").and_then(Value::as_array);
    groups
        .into_iter()
        .flatten()
        .map(|group| Spring {
            name: group["comment"].as_str().unwrap_or_default().to_owned(),
            nodes: group["bones"].as_array().into_iter().flatten().filter_map(index).collect(),
        })
        .collect()
}
