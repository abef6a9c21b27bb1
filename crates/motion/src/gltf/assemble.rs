//! Assembles a body and its clips from the nodes, meshes and animations of a document.

use lovelock_base::words::counted;
use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::Affine3A;

use lovelock_gltf::document::{Document, Mesh as MeshEntry, Primitive};
use lovelock_gltf::{Accessors, Asset};

use super::{
    clip::{Targets, read_clip},
    expressions,
    material::Materials,
    mesh::{Binding, read_primitives, share_vertices},
    nodes::Tree,
    skin::read_skin,
    vrm::Vrm,
};
use crate::character::{Axes, Character, Draft, Hidden, HiddenMeshes, WornHair, only_motion};
use crate::surface::{Palette, Surface};
use crate::{BodySettings, Expression, MotionError};

pub(super) fn assemble(
    asset: &Asset,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    let accessors = &asset.accessors();
    let (file, document) = (accessors.file, accessors.document);
    let mut dropped = BTreeMap::new();
    let mut notes = Vec::new();
    let tree = Tree::new(file, document, &mut dropped, &mut notes)?;

    // Without a surface every node may be a joint.
    let mut wanted = vec![!needs_mesh; document.nodes.len()];
    let mut is_joint = vec![false; document.nodes.len()];
    for &n in &tree.order {
        let node = &document.nodes[n];
        let Some(mesh) = node.mesh else { continue };
        if mesh >= document.meshes.len() {
            let problem = format!("mesh {mesh} does not exist; the file has {}", document.meshes.len());
            return Err(MotionError::malformed(file, format!("node {n}"), problem));
        }
        match node.skin {
            None => wanted[n] = true,
            Some(skin) => {
                let Some(skin) = document.skins.get(skin).filter(|s| !s.joints.is_empty()) else {
                    let problem = format!("skin {skin} does not exist or has no joints");
                    return Err(MotionError::malformed(file, format!("node {n}"), problem));
                };
                for &joint in &skin.joints {
                    (wanted[joint], is_joint[joint]) = (true, true);
                }
            }
        }
    }
    let mesh_nodes = tree.order.iter().filter(|&&n| wanted[n]).count();
    let vrm = Vrm::of(document);
    for &node in vrm.iter().flat_map(|vrm| vrm.bones.keys()) {
        wanted[node] = true;
    }
    let joints = match is_joint.iter().filter(|j| **j).count() {
        0 => mesh_nodes,
        some => some,
    };
    let (mut skeleton, joint_of_node) = tree.skeleton(file, document, wanted, &mut dropped)?;

    let hair = if needs_mesh {
        hair_parts(accessors, vrm.as_ref(), &tree.order, settings, &mut notes)?
    } else {
        BTreeSet::new()
    };
    let mut palette = Palette::default();
    let mut skins: BTreeMap<usize, Vec<u16>> = BTreeMap::new();
    let mut surface = Surface::default();
    let mut materials = Materials::new(document, asset.images());
    let mut morphs_of_node = BTreeMap::new();
    let mut hidden = HiddenMeshes::new(settings);
    for &n in &tree.order {
        let node = &document.nodes[n];
        let Some(mesh) = node.mesh.map(|m| &document.meshes[m]) else { continue };
        if needs_mesh && !hidden.reads((!tree.is_visible[n]).then_some(Hidden::Invisible)) {
            continue;
        }
        let count = mesh.primitives.iter().map(|p| p.targets.len()).max().unwrap_or(0);
        let weights = node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default();
        let (first_morph, names) = (surface.morphs(), morph_names(mesh));
        for t in 0..count {
            let name = names.get(t).cloned().unwrap_or_else(|| format!("morph {t}"));
            surface.add_morph(name, weights.get(t).copied().unwrap_or(0.0));
        }
        if count > 0 {
            morphs_of_node.insert(n, (first_morph, count));
        }
        // A motion needs only the names of what moves a face.
        if !needs_mesh {
            continue;
        }
        if let Some(skin) = node.skin
            && !skins.contains_key(&skin)
        {
            skins.insert(skin, read_skin(accessors, skin, &joint_of_node, &mut palette, &mut dropped)?);
        }
        let rigid = if node.skin.is_none() {
            let joint = joint_of_node[n].unwrap_or(0);
            palette.add(joint, Affine3A::IDENTITY).ok_or_else(|| {
                MotionError::malformed(file, format!("node {n}"), "too many nodes with meshes")
            })?
        } else {
            0
        };
        let binding = node.skin.map_or(Binding::Rigid(rigid), |s| Binding::Skin(&skins[&s]));
        let mut parts = Vec::new();
        for (_, primitive) in mesh.primitives.iter().enumerate().filter(|(p, _)| !hair.contains(&(n, *p))) {
            let names: Vec<&str> =
                [mesh.name.as_deref(), node.name.as_deref()].into_iter().flatten().collect();
            let has_colors = primitive.attributes.contains_key("COLOR_0");
            parts.push((primitive, materials.coat(primitive.material, &names, has_colors)));
        }
        for parts in parts.chunk_by(share_vertices) {
            if let Some(piece) = read_primitives(accessors, parts, &binding, first_morph, &mut dropped)? {
                let too_many = |problem| MotionError::malformed(file, "the meshes", problem);
                surface.add(piece, &mut dropped).map_err(too_many)?;
            }
        }
    }
    hidden.note(&mut notes);
    if needs_mesh {
        let of_node = |&n: &usize| document.nodes[n].mesh.map(|mesh| &document.meshes[mesh]);
        let primitives = tree.order.iter().filter_map(of_node).flat_map(|mesh| &mesh.primitives);
        let lines = primitives.filter(|primitive| matches!(primitive.mode, Some(1..=3))).count();
        if lines > 0 {
            let what = counted(lines, "primitive of lines", "primitives of lines");
            notes.push(format!("left out {what}, no part of a body"));
        }
    }
    let (mut mesh, skin_data) = surface.finish(palette);
    if needs_mesh && mesh.triangles.is_empty() {
        let found = describe_contents(document, &dropped)
            + &hidden.in_error()
            + only_motion(document.animations.len());
        return Err(MotionError::Empty { file: file.to_owned(), found, wanted: "a mesh of triangles" });
    }
    let mut named = expressions::read(document, &morphs_of_node, &mut dropped);
    let mut expression_of_node = BTreeMap::new();
    for (node, name) in expressions::nodes_of_animation(document) {
        expression_of_node.insert(node, named.len());
        named.push(Expression { name, ..Expression::default() });
    }
    let targets = Targets {
        joint_of_node: &joint_of_node,
        morphs_of_node: &morphs_of_node,
        expression_of_node: &expression_of_node,
    };
    let mut times = HashMap::new();
    let mut clips = Vec::new();
    for (i, animation) in document.animations.iter().enumerate() {
        let clip = read_clip(accessors, i, animation, &targets, &mut times, &mut dropped)?;
        if clip.joints.is_empty() && clip.morphs.is_empty() && clip.expressions.is_empty() {
            *dropped.entry("empty_clips".into()).or_default() += 1;
        } else {
            clips.push(clip);
        }
    }

    if let Some(vrm) = vrm {
        let joint = |node: usize| joint_of_node.get(node).copied().flatten();
        skeleton.named =
            vrm.bones.into_iter().filter_map(|(node, bone)| Some((joint(node)?, bone))).collect();
    }
    let look = materials.finish(&mut mesh, &mut notes);
    Draft {
        file,
        skeleton,
        mesh,
        skin: skin_data,
        look,
        expressions: named,
        clips,
        joints,
        skins: document.skins.len(),
        dropped,
        notes,
    }
    .finish(Axes { settings, usual_unit_metres: 1.0 })
}

/// The primitives, by node and number, that are the hair that the character was made with.
fn hair_parts(
    accessors: &Accessors,
    vrm: Option<&Vrm>,
    order: &[usize],
    settings: BodySettings,
    notes: &mut Vec<String>,
) -> Result<BTreeSet<(usize, usize)>, MotionError> {
    let document = accessors.document;
    let swinging = vrm.map_or_else(BTreeSet::new, |vrm| vrm.hair_nodes(document));
    let mut worn = WornHair::new(settings);
    let mut parts = Vec::new();
    for &n in order {
        let node = &document.nodes[n];
        let Some(mesh) = node.mesh.and_then(|m| document.meshes.get(m)) else { continue };
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let material = primitive.material.and_then(|m| document.materials.get(m));
            let names =
                [node.name.as_deref(), mesh.name.as_deref(), material.and_then(|m| m.name.as_deref())];
            let names: Vec<&str> = names.into_iter().flatten().collect();
            let joints = node.skin.and_then(|s| document.skins.get(s)).map_or(&[][..], |s| &s.joints);
            if joints.iter().any(|joint| swinging.contains(joint))
                && share_of(accessors, primitive, joints, &swinging)? > MOSTLY
            {
                worn.offer_hair(names.first().copied().unwrap_or("a mesh on joints of hair"));
            } else {
                worn.offer(&names);
            }
            parts.push((n, p));
        }
    }
    let hair = parts.into_iter().zip(worn.decide(notes)).filter(|(_, is_hair)| *is_hair);
    Ok(hair.map(|(part, _)| part).collect())
}

/// A mesh of which more than this share follows joints of hair is hair.
const MOSTLY: f32 = 0.5;

/// The share of the weights of a primitive that some nodes have.
fn share_of(
    accessors: &Accessors,
    primitive: &Primitive,
    joints: &[usize],
    nodes: &BTreeSet<usize>,
) -> Result<f32, MotionError> {
    let attribute = |name: &str| primitive.attributes.get(name).copied();
    let (Some(of_joints), Some(of_weights)) = (attribute("JOINTS_0"), attribute("WEIGHTS_0")) else {
        return Ok(0.0);
    };
    let (mut theirs, mut all) = (0.0, 0.0);
    let weights = accessors.read::<4>(of_weights)?;
    for (joint, weight) in accessors.read_indices::<4>(of_joints)?.iter().zip(&weights) {
        for (&joint, &weight) in joint.iter().zip(weight).filter(|(_, w)| **w > 0.0 && w.is_finite()) {
            all += weight;
            if joints.get(joint as usize).is_some_and(|node| nodes.contains(node)) {
                theirs += weight;
            }
        }
    }
    Ok(if all > 0.0 { theirs / all } else { 0.0 })
}

fn describe_contents(document: &Document, dropped: &BTreeMap<String, u64>) -> String {
    let dropped_parts = ["triangles", "primitives_without_triangles", "node_links"];
    let dropped_parts: Vec<String> = dropped_parts
        .iter()
        .filter_map(|&what| dropped.get(what).map(|n| format!("{n} {} dropped", what.replace('_', " "))))
        .collect();
    let nodes = counted(document.nodes.len(), "node", "nodes");
    let meshes = counted(document.meshes.len(), "mesh", "meshes");
    let found = format!("{nodes} and {meshes} without a usable triangle");
    if dropped_parts.is_empty() { found } else { format!("{found} ({})", dropped_parts.join(", ")) }
}

fn morph_names(mesh: &MeshEntry) -> Vec<String> {
    let names = mesh.extras.as_ref().and_then(|e| e.get("targetNames")).and_then(|n| n.as_array());
    names.map_or_else(Vec::new, |names| {
        names.iter().map(|n| n.as_str().unwrap_or_default().to_owned()).collect()
    })
}
