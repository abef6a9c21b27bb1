//! Assembles a body and its clips: nodes, surface, rest pose, unit, head.

use std::{
    collections::{BTreeMap, HashMap},
    path::Path,
    sync::Arc,
};

use glam::{Affine3A, Vec3};

use super::{
    Character,
    accessor::Accessors,
    axes::turn_to_face,
    clip::{Targets, read_clip},
    document::{Document, Mesh as MeshEntry},
    mesh::{Binding, Surface},
    nodes::Tree,
    skin::{Palette, read_skin},
};
use crate::{Body, BodySettings, Clip, LengthUnit, MotionError, guess_head, skinning::update_rest_surface};

/// A file whose largest extent exceeds this many units is not in metres.
const GIANT: f32 = 10.0;

pub(super) fn assemble(accessors: &Accessors, settings: BodySettings) -> Result<Character, MotionError> {
    let (file, document) = (accessors.file, accessors.document);
    let mut dropped = BTreeMap::new();
    let mut notes = Vec::new();
    let tree = Tree::new(file, document, &mut dropped, &mut notes)?;

    let mut wanted = vec![false; document.nodes.len()];
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
    let mesh_nodes = wanted.iter().filter(|w| **w).count();
    let joints = match is_joint.iter().filter(|j| **j).count() {
        0 => mesh_nodes,
        some => some,
    };
    let (skeleton, joint_of_node) = tree.skeleton(file, document, wanted, &mut dropped)?;

    let worn = worn_hair(document, &tree.order);
    if !worn.is_empty() {
        let names: Vec<String> = worn.iter().map(|&n| format!("`{}`", name_of(document, n))).collect();
        notes.push(format!("left out, because it is hair: {}", names.join(", ")));
    }
    let mut palette = Palette::default();
    let mut skins: BTreeMap<usize, Vec<u16>> = BTreeMap::new();
    let mut surface = Surface::default();
    let mut morphs_of_node = BTreeMap::new();
    for &n in &tree.order {
        let node = &document.nodes[n];
        let Some(mesh) = node.mesh.map(|m| &document.meshes[m]) else { continue };
        if worn.contains(&n) {
            continue;
        }
        let count = mesh.primitives.iter().map(|p| p.targets.len()).max().unwrap_or(0);
        let weights = node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default();
        let first_morph = surface.add_morphs(&morph_names(mesh), weights, count);
        if count > 0 {
            morphs_of_node.insert(n, (first_morph, count));
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
        for primitive in &mesh.primitives {
            surface.add(accessors, primitive, &binding, first_morph, &mut dropped)?;
        }
    }
    surface.skin.palette = palette.binds;
    let (mesh, skin_data) = surface.finish();
    if mesh.triangles.is_empty() {
        let found = describe_contents(document, &dropped);
        return Err(MotionError::Empty { file: file.to_owned(), found, wanted: "a mesh of triangles" });
    }
    let stem =
        Path::new(file).file_stem().map_or_else(|| file.to_owned(), |s| s.to_string_lossy().into_owned());
    let mut body = Body { name: stem, skeleton, mesh, skin: skin_data, head_joint: 0 };
    update_rest_surface(&mut body);
    if !body.mesh.positions.iter().all(|p| p.is_finite() && p.max_element() < 1e12) {
        return Err(MotionError::malformed(file, "the scene", "its transforms move vertices to infinity"));
    }

    let targets = Targets { joint_of_node: &joint_of_node, morphs_of_node: &morphs_of_node };
    let mut times = HashMap::new();
    let mut clips = Vec::new();
    for (i, animation) in document.animations.iter().enumerate() {
        let clip = read_clip(accessors, i, animation, &targets, &mut times, &mut dropped)?;
        if clip.joints.is_empty() && clip.morphs.is_empty() {
            *dropped.entry("empty_clips".into()).or_default() += 1;
        } else {
            clips.push(clip);
        }
    }

    let unit_metres = choose_unit(&body, settings.unit, &mut notes);
    if unit_metres != 1.0 {
        rescale(&mut body, &mut clips, unit_metres);
    }
    turn_to_face(&mut body, &mut clips, settings, &mut notes);
    fix_winding(&mut body);
    body.head_joint = guess_head(&body.skeleton, &body.mesh);
    for clip in &mut clips {
        clip.detect_loop(&body);
    }
    note_textures(document, &mut notes);
    Ok(Character {
        body: Arc::new(body),
        clips: clips.into_iter().map(Arc::new).collect(),
        dropped,
        notes,
        format: String::new(),
        joints,
        skins: document.skins.len(),
        unit_metres,
    })
}

/// The name of a node with a mesh: its own, or that of the mesh.
fn name_of(document: &Document, node: usize) -> &str {
    let node = &document.nodes[node];
    let of_mesh = node.mesh.and_then(|m| document.meshes[m].name.as_deref());
    node.name.as_deref().or(of_mesh).unwrap_or_default()
}

/// The nodes whose mesh is the hair that a character was made with, by the names of node and mesh: other hair grows in its place. None
/// if that would leave nothing.
fn worn_hair(document: &Document, order: &[usize]) -> Vec<usize> {
    let with_mesh: Vec<usize> = order.iter().copied().filter(|&n| document.nodes[n].mesh.is_some()).collect();
    let hair = |n: &usize| {
        let node = &document.nodes[*n];
        let of_mesh = node.mesh.and_then(|m| document.meshes[m].name.as_deref());
        node.name.as_deref().is_some_and(names_hair) || of_mesh.is_some_and(names_hair)
    };
    let worn: Vec<usize> = with_mesh.iter().copied().filter(hair).collect();
    if worn.len() == with_mesh.len() { Vec::new() } else { worn }
}

/// Whether one of the words of a name says hair. Words end at signs, digits and before capitals.
fn names_hair(name: &str) -> bool {
    const HAIR: [&str; 7] = ["hair", "hairs", "wig", "ponytail", "hairstyle", "haircut", "bangs"];
    let mut words = vec![String::new()];
    let mut was_small = false;
    for c in name.chars() {
        if !c.is_alphabetic() || (c.is_uppercase() && was_small) {
            words.push(String::new());
        }
        if let (true, Some(word)) = (c.is_alphabetic(), words.last_mut()) {
            word.extend(c.to_lowercase());
        }
        was_small = c.is_lowercase();
    }
    words.iter().any(|word| HAIR.contains(&word.as_str()))
}

fn describe_contents(document: &Document, dropped: &BTreeMap<String, u64>) -> String {
    let dropped_parts = ["triangles", "primitives_without_triangles", "node_links"];
    let dropped_parts: Vec<String> = dropped_parts
        .iter()
        .filter_map(|&what| dropped.get(what).map(|n| format!("{n} {} dropped", what.replace('_', " "))))
        .collect();
    let found = format!(
        "{} nodes and {} meshes without a usable triangle",
        document.nodes.len(),
        document.meshes.len()
    );
    if dropped_parts.is_empty() { found } else { format!("{found} ({})", dropped_parts.join(", ")) }
}

fn morph_names(mesh: &MeshEntry) -> Vec<String> {
    let names = mesh.extras.as_ref().and_then(|e| e.get("targetNames")).and_then(|n| n.as_array());
    names.map_or_else(Vec::new, |names| {
        names.iter().map(|n| n.as_str().unwrap_or_default().to_owned()).collect()
    })
}

fn note_textures(document: &Document, notes: &mut Vec<String>) {
    let textured =
        document.materials.iter().filter(|m| m.pbr_metallic_roughness.base_color_texture.is_some()).count();
    if textured > 0 && !document.textures.is_empty() {
        notes.push(format!(
            "{textured} materials have textures, which are ignored; only their base colour is used"
        ));
    }
}

/// Flips the triangles that the rest pose mirrors, so that all are counter-clockwise from outside.
fn fix_winding(body: &mut Body) {
    let mirrors: Vec<bool> = body
        .skin
        .palette
        .iter()
        .map(|bind| {
            let world = body.skeleton.world_at_rest[usize::from(bind.joint)];
            (world.matrix3 * bind.joint_from_bind.matrix3).determinant() < 0.0
        })
        .collect();
    if mirrors.contains(&true) {
        for triangle in &mut body.mesh.triangles {
            if mirrors[usize::from(body.skin.binds[triangle[0] as usize][0])] {
                triangle.swap(1, 2);
            }
        }
    }
}

/// Metres per unit. glTF specifies metres, but a figure of more than ten of them was exported in centimetres
/// or millimetres.
fn choose_unit(body: &Body, unit: LengthUnit, notes: &mut Vec<String>) -> f32 {
    let size = extent(&body.mesh.positions).max_element();
    if let Some(metres) = unit.metres() {
        return metres;
    }
    let guess = if size > 100.0 * GIANT {
        LengthUnit::Millimetres
    } else if size > GIANT {
        LengthUnit::Centimetres
    } else {
        return 1.0;
    };
    let metres = guess.metres().unwrap_or(1.0);
    notes.push(format!(
        "the figure is {size:.0} units long; interpreted as {}: {:.2} m",
        guess.label(),
        size * metres
    ));
    metres
}

fn extent(positions: &[Vec3]) -> Vec3 {
    let low = positions.iter().fold(Vec3::INFINITY, |a, &b| a.min(b));
    let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
    (high - low).max(Vec3::ZERO)
}

/// Multiplies every length by `scale`. Scales and rotations stay: the transform `W` of a joint becomes
/// `S W S^-1`.
fn rescale(body: &mut Body, clips: &mut [Clip], scale: f32) {
    for joint in &mut body.skeleton.joints {
        joint.translation *= scale;
    }
    body.skeleton.update_rest();
    for bind in &mut body.skin.palette {
        bind.joint_from_bind.translation *= scale;
    }
    let morphs = body.skin.morphs.iter_mut().flat_map(|m| &mut m.positions);
    body.skin.positions.iter_mut().chain(morphs).for_each(|p| *p *= scale);
    update_rest_surface(body);
    for track in clips.iter_mut().flat_map(|c| &mut c.joints).filter_map(|j| j.translation.as_mut()) {
        track.values.iter_mut().for_each(|v| *v *= scale);
    }
}

#[cfg(test)]
mod tests {
    use super::names_hair;

    #[test]
    fn hair_is_known_by_its_name() {
        for name in ["Hair", "hair_01", "Mesh.Hair", "LongHair", "FemaleWig2", "head-hair"] {
            assert!(names_hair(name), "{name}");
        }
        for name in ["Chair", "Body", "Hairy", "wiggle", ""] {
            assert!(!names_hair(name), "{name}");
        }
    }
}
