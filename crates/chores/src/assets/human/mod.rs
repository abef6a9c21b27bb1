//! Figures from `MakeHuman`'s base mesh: a recipe ([`recipe`]) mixes targets of shape, and everything else follows from the mesh and
//! the masks that come with it.
//!
//! 1. [`shape`]: the base mesh with its targets; the skeleton from its joint cubes.
//! 2. [`refine`]: one step of subdivision where the mesh is coarse and seen close up.
//! 3. [`marks`]: where hair, brows and lashes grow; [`face`]: morph targets; [`weights`].
//! 4. [`garment`]: top and leggings; the skin below them is removed. [`eyes`].
//! 5. [`occlusion`] and [`texture`].

mod eyes;
mod face;
mod garment;
mod marks;
mod noise;
mod occlusion;
mod recipe;
mod refine;
mod shape;
mod source;
mod surface;
mod texture;
mod weights;

use std::path::Path;

use anyhow::ensure;
use glam::{Vec2, Vec3};

use super::glb::{Image, Material, Model, Part};
use super::score;
use garment::Cut;
use marks::Marks;
use recipe::{FIGURES, Recipe};
use source::{Base, Face, Source};
use surface::{MORPHS, Surface, Vertex};

/// Width and height of the textures of the skin, of its roughness and of the eyes, pixels.
const SKIN_SIZE: u32 = 2048;
const ROUGHNESS_SIZE: u32 = 512;
const EYE_SIZE: u32 = 512;
/// Thickness of the leggings and of the top, metres; the top's lower edge lies over the leggings.
const THICKNESS: [f32; 2] = [0.0038, 0.0022];
/// Skin that is covered by at least this much cloth is removed, metres.
const COVERED: f32 = 0.012;
/// Distance from the edges of garments within which weights are softened, metres.
const HEM_REACH: f32 = 0.05;
/// Faces with longer edges than this are subdivided: where brows grow, on the head, and on the trunk and the arms, metres.
const BROW_EDGE: f32 = 0.0022;
const HEAD_EDGE: f32 = 0.0042;
const TRUNK_EDGE: f32 = 0.0130;

/// Makes all figures from the unpacked package in `folder`, and hands each over as soon as it is made.
pub(super) fn make(folder: &Path, mut done: impl FnMut(&Model) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let source = Source::open(folder)?;
    let base = source.base()?;
    let masks = texture::Masks::read(&source)?;
    for recipe in &FIGURES {
        done(&figure(recipe, &source, &base, &masks)?)?;
    }
    Ok(())
}

fn figure(recipe: &Recipe, source: &Source, base: &Base, masks: &texture::Masks) -> anyhow::Result<Model> {
    let shape = recipe.shape(source, base)?;
    let rig = shape.rig(source, base)?;
    ensure!(rig.joints.len() == surface::JOINTS, "{} joints", rig.joints.len());
    let places = &shape.positions;

    let faces = &base.groups["body"];
    let uv: Vec<Vec2> = base.uv.iter().map(|t| Vec2::new(t.x, 1.0 - t.y)).collect();
    let chosen = coarse(faces, places, base.middle("helper-l-eye", places)?, recipe.height);
    let refined = refine::refine(faces, &chosen, places, &uv);
    let rows = weights::rows(source, &rig, places)?;
    let mut skin = Surface {
        vertices: refined
            .values(|v| places[v as usize])
            .into_iter()
            .map(|p| Vertex::at(p, Vec3::Y))
            .collect(),
        triangles: refined.triangles.iter().map(|t| t.map(|c| c.0)).collect(),
        uv: refined.triangles.iter().map(|t| t.map(|c| c.1)).collect(),
    };
    for (vertex, stencil) in skin.vertices.iter_mut().zip(&refined.stencils) {
        for (v, w) in stencil {
            for (sum, weight) in vertex.weights.iter_mut().zip(rows[*v as usize]) {
                *sum += weight * w;
            }
        }
    }
    skin.update_normals();

    // The eyeball is the ball that the eye's mesh is made around.
    let of_eye: Vec<Vec3> = base.vertices("helper-l-eye")?.iter().map(|v| places[*v as usize]).collect();
    let low = of_eye.iter().fold(Vec3::INFINITY, |a, b| a.min(*b));
    let high = of_eye.iter().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b));
    let radius = 0.25 * (high.x - low.x + high.y - low.y);
    let eye = (0.5 * (low + high)).with_z(low.z + radius);

    let mut ears = vec![false; skin.vertices.len()];
    for (t, uv) in skin.triangles.iter().zip(&skin.uv) {
        for i in 0..3 {
            ears[t[i] as usize] |= masks.is_ear(uv[i]);
        }
    }
    let marks = Marks::measure(&skin, &ears, &rig, (eye, radius));
    let lashes = lash_roots(base, places, &skin)?;
    let scalp = marks.scalp(&skin, &ears);
    let is_lid = |v: &Vertex| v.place.distance(eye.with_x(eye.x.copysign(v.place.x))) < 2.0 * radius;
    for (vertex, scalp) in skin.vertices.iter_mut().zip(scalp) {
        let lash = |roots: &[Vec3]| {
            let near = is_lid(vertex) && roots.iter().any(|r| r.distance(vertex.place) < 0.0009);
            f32::from(u8::from(near))
        };
        vertex.grows = [scalp, marks.brow(vertex.place), lash(&lashes[0]), lash(&lashes[1])];
        let rigid = marks.moves_with_head(vertex.place).max(scalp);
        let mut total = 0.0;
        for (joint, weight) in vertex.weights.iter_mut().enumerate() {
            let of_head = f32::from(u8::from(joint == super::rig::HEAD));
            *weight += (of_head - *weight) * if vertex.place.x.abs() < 0.13 { rigid } else { 0.0 };
            total += *weight;
        }
        vertex.weights.iter_mut().for_each(|w| *w /= total.max(1e-9));
    }
    let is_hem = |v: &Vertex| {
        let to_edge = [marks.inside_top(v.place), marks.inside_leggings(v.place)];
        // Hair moves with the head alone.
        v.grows[0] == 0.0 && to_edge.iter().any(|d| d.abs() < HEM_REACH)
    };
    weights::soften(&mut skin, is_hem);
    face::add(&mut skin, &refined, source, shape.scale, (eye, radius))?;

    let paint = texture::Paint {
        look: &recipe.look,
        marks: &marks,
        masks,
        lashes: [&lashes[0], &lashes[1]],
        old: recipe.old,
    };
    let skin_image = texture::jpeg(&paint.draw(&skin, SKIN_SIZE))?;
    let rough_image = texture::jpeg(&paint.draw_roughness(&skin, ROUGHNESS_SIZE))?;
    let eye_image = texture::jpeg(&eyes::texture(&recipe.look, EYE_SIZE))?;

    let cuts: [Cut; 2] = [&|p| marks.inside_top(p), &|p| marks.inside_leggings(p)];
    let garments: Vec<Surface> =
        cuts.iter().zip(THICKNESS).map(|(cut, thickness)| garment::make(&skin, *cut, thickness)).collect();
    let covered: Vec<bool> =
        skin.vertices.iter().map(|v| cuts.iter().any(|cut| cut(v.place) > COVERED)).collect();
    let seen = skin.part(|t| !t.iter().all(|v| covered[*v as usize]));
    let mut surfaces = vec![seen, eyes::surface(eye, radius)];
    surfaces.extend(garments);
    occlude(&mut surfaces, &skin);

    let material = |name: &str, region: &str, colour: Vec3, roughness: f32, image: Option<usize>| Material {
        name: name.to_owned(),
        colour,
        roughness,
        image,
        rough_image: None,
        region: Some(region.to_owned()),
    };
    let rough = |material: Material| Material { rough_image: Some(2), ..material };
    let [top, leggings] = recipe.look.cloth;
    let scores = [score::dance(), score::idle()];
    let clips = scores.iter().map(|score| {
        let mut clip = score.sample(&rig);
        clip.weights = face::weights(score).into_iter().map(|row| row.to_vec()).collect();
        clip
    });
    Ok(Model {
        name: recipe.name,
        clips: clips.collect(),
        parts: surfaces.iter().enumerate().map(|(i, surface)| part(surface, i)).collect(),
        materials: vec![
            rough(material("skin", "skin", paint.factor(), 1.0, Some(0))),
            material("eyes", "eye", Vec3::ONE, 0.08, Some(1)),
            material("top", "cloth", top, 0.80, None),
            material("leggings", "cloth", leggings, 0.75, None),
        ],
        images: vec![
            Image { name: "skin", bytes: skin_image },
            Image { name: "eye", bytes: eye_image },
            Image { name: "skin roughness", bytes: rough_image },
        ],
        morphs: MORPHS.to_vec(),
        joints: rig.joints,
    })
}

/// Which faces of the body are too coarse for what is seen close up: those of the head, and of the trunk and the arms.
fn coarse(faces: &[Face], places: &[Vec3], eye: Vec3, height: f32) -> Vec<bool> {
    faces
        .iter()
        .map(|face| {
            let [a, b, c, d] = face.corners.map(|v| places[v as usize]);
            let edge = 0.25 * (a.distance(b) + b.distance(c) + c.distance(d) + d.distance(a));
            let middle = 0.25 * (a + b + c + d);
            let from_eye = middle - eye.with_x(eye.x.copysign(middle.x));
            let is_brow =
                (0.010..0.036).contains(&from_eye.y) && from_eye.x.abs() < 0.034 && from_eye.z > -0.02;
            let y = middle.y * (1.70 / height);
            let longest = match y {
                _ if is_brow => BROW_EDGE,
                y if y > 1.45 && middle.x.abs() < 0.12 => HEAD_EDGE,
                y if y > 0.90 => TRUNK_EDGE,
                _ => f32::MAX,
            };
            edge > longest
        })
        .collect()
}

/// Places on the skin from which the upper and the lower lashes hang: the edges of their strips that lie on it.
/// Each row is in order from the wearer's right to the left.
fn lash_roots(base: &Base, places: &[Vec3], skin: &Surface) -> anyhow::Result<[Vec<Vec3>; 2]> {
    let mut roots = [Vec::new(), Vec::new()];
    for side in ["l", "r"] {
        for (row, number) in [(0, 2), (1, 1)] {
            for v in base.vertices(&format!("helper-{side}-eyelashes-{number}"))? {
                let at = places[v as usize];
                let near = skin
                    .vertices
                    .iter()
                    .map(|s| s.place)
                    .min_by(|a, b| a.distance_squared(at).total_cmp(&b.distance_squared(at)));
                roots[row].extend(near.filter(|p| p.distance(at) < 0.0016));
            }
        }
    }
    for row in &mut roots {
        row.sort_by(|a, b| a.x.total_cmp(&b.x));
        row.dedup();
    }
    Ok(roots)
}

/// Bakes the light that gets to each vertex. Nothing is in its way but the whole skin, the eyes and the surface itself: an edge of cloth
/// would darken the skin below it in jags.
fn occlude(surfaces: &mut [Surface], skin: &Surface) {
    let triangles = |s: &Surface| -> Vec<[Vec3; 3]> {
        s.triangles.iter().map(|t| t.map(|v| s.vertices[v as usize].place)).collect()
    };
    let around = [triangles(skin), triangles(&surfaces[1])].concat();
    for (i, surface) in surfaces.iter_mut().enumerate() {
        let own = if i < 2 { Vec::new() } else { triangles(surface) };
        let points: Vec<(Vec3, Vec3)> = surface.vertices.iter().map(|v| (v.place, v.normal)).collect();
        let open = occlusion::bake(&points, [around.clone(), own].concat());
        for (vertex, open) in surface.vertices.iter_mut().zip(open) {
            vertex.open = open;
        }
    }
}

/// A surface as a part of the file.
fn part(surface: &Surface, material: usize) -> Part {
    let (vertices, triangles) = surface.split();
    let mut masks = vec![("_OCCLUSION", vertices.iter().map(|v| v.open).collect())];
    if material == 0 {
        for (i, name) in ["_SCALP", "_BROW", "_LASH_UPPER", "_LASH_LOWER"].into_iter().enumerate() {
            masks.push((name, vertices.iter().map(|v| v.grows[i]).collect()));
        }
    }
    let moves = (0..MORPHS.len()).map(|m| {
        let moved = vertices.iter().enumerate().map(|(v, vertex)| (v as u32, vertex.moves[m]));
        moved.filter(|(_, by)| *by != Vec3::ZERO).collect()
    });
    Part {
        material,
        positions: vertices.iter().map(|v| v.place).collect(),
        normals: vertices.iter().map(|v| v.normal).collect(),
        colours: Vec::new(),
        uv: vertices.iter().map(|v| v.uv).collect(),
        masks,
        influences: vertices.iter().map(|v| weights::strongest(&v.weights)).collect(),
        triangles,
        moves: moves.collect(),
    }
}
