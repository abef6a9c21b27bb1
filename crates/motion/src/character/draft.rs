//! The last steps of every reader: rest surface, unit, direction of the face, winding, head, loops.

use std::{collections::BTreeMap, path::Path, sync::Arc};

use glam::Vec3;

use super::Character;
use super::axes::turn_to_face;
use super::headed::{add_head, add_head_of_all, is_mere_surface};
use crate::look::{Look, Looks};
use crate::{
    Body, BodySettings, Clip, Expression, LengthUnit, Mesh, MotionError, Skeleton, SkinData, guess_head,
    head::find_head, skinning::update_rest_surface,
};

/// A file whose largest extent exceeds this many metres by its own unit is in another unit.
const GIANT: f32 = 10.0;

/// A character as its reader leaves it: in the unit and axes of its format.
#[derive(Default)]
pub(crate) struct Draft<'a> {
    /// The file as the user named it.
    pub(crate) file: &'a str,
    /// The joints; `world_at_rest` is filled.
    pub(crate) skeleton: Skeleton,
    /// The surface.
    pub(crate) mesh: Mesh,
    /// The surface in bind space.
    pub(crate) skin: SkinData,
    /// How the surface looks.
    pub(crate) look: Look,
    /// Its expressions.
    pub(crate) expressions: Vec<Expression>,
    /// The clips.
    pub(crate) clips: Vec<Clip>,
    /// Joints used by skins; nodes with meshes if there is no skin.
    pub(crate) joints: usize,
    /// Number of skins.
    pub(crate) skins: usize,
    /// Counts of what was left out.
    pub(crate) dropped: BTreeMap<String, u64>,
    /// Remarks.
    pub(crate) notes: Vec<String>,
}

/// What decides the unit and the axes of a character.
#[derive(Clone, Copy)]
pub(crate) struct Axes {
    /// What the user chose.
    pub(crate) settings: BodySettings,
    /// Metres per unit of the file as its format or the file itself states it. The draft is in metres by this unit.
    pub(crate) usual_unit_metres: f32,
}

impl<'a> Draft<'a> {
    /// A character with a surface and its materials, and nothing else yet. `notes` are the remarks so far.
    pub(crate) fn with_surface(
        file: &'a str,
        (mut mesh, skin): (Mesh, SkinData),
        looks: Looks,
        mut notes: Vec<String>,
    ) -> Self {
        let look = looks.finish(&mut mesh, &mut notes);
        Self { file, mesh, skin, look, notes, ..Self::default() }
    }

    /// Brings a character to metres with its face toward +Z, and chooses its head.
    pub(crate) fn finish(self, axes: Axes) -> Result<Character, MotionError> {
        let (file, mut clips, mut notes) = (self.file, self.clips, self.notes);
        let stem =
            Path::new(file).file_stem().map_or_else(|| file.to_owned(), |s| s.to_string_lossy().into_owned());
        let (skeleton, mesh, skin) = (self.skeleton, self.mesh, self.skin);
        let Look { materials, images } = self.look;
        let expressions = self.expressions;
        let mut body =
            Body { name: stem, skeleton, mesh, skin, materials, images, expressions, ..Body::default() };
        update_rest_surface(&mut body);
        if !body.mesh.positions.iter().all(|p| p.is_finite() && p.abs().max_element() < 1e12) {
            return Err(MotionError::malformed(
                file,
                "the scene",
                "its transforms move vertices to infinity",
            ));
        }
        let scale = choose_scale(&body, axes, &mut notes);
        if scale != 1.0 {
            rescale(&mut body, &mut clips, scale);
        }
        let head = if is_mere_surface(&body, self.skins) {
            let found = find_head(&body.mesh.positions, &body.mesh.triangles);
            body.is_without_head = found.is_none();
            found
        } else {
            None
        };
        turn_to_face(&mut body, &mut clips, (axes.settings, head), &mut notes);
        fix_winding(&mut body);
        body.head_joint = guess_head(&body.skeleton, &body.mesh);
        if head.is_some() && add_head(&mut body) {
            notes.push("the figure has no joints; its head was found by its shape".to_owned());
        }
        if body.is_without_head {
            add_head_of_all(&mut body);
        }
        for clip in &mut clips {
            clip.detect_loop(&body);
        }
        Ok(Character {
            body: Arc::new(body),
            clips: clips.into_iter().map(Arc::new).collect(),
            dropped: self.dropped,
            notes,
            format: String::new(),
            joints: self.joints,
            skins: self.skins,
            unit_metres: scale * axes.usual_unit_metres,
        })
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

/// The factor to metres. A figure of more than ten metres was exported in another unit than its file says.
fn choose_scale(body: &Body, axes: Axes, notes: &mut Vec<String>) -> f32 {
    if let Some(metres) = axes.settings.unit.metres() {
        return metres / axes.usual_unit_metres;
    }
    let size = extent(&body.mesh.positions).max_element();
    let guess = if size > 100.0 * GIANT {
        LengthUnit::Millimetres
    } else if size > GIANT {
        LengthUnit::Centimetres
    } else {
        return 1.0;
    };
    let scale = guess.metres().unwrap_or(1.0);
    if axes.usual_unit_metres == 1.0 {
        notes.push(format!(
            "the figure is {size:.0} units long; interpreted as {}: {:.2} m",
            guess.label(),
            size * scale
        ));
    } else {
        notes.push(format!(
            "the figure is {size:.0} m long by the unit of the file; made {:.2} m",
            size * scale
        ));
    }
    scale
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
