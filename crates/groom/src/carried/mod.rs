//! Hair that the skin carries: brows and lashes. It is not simulated, but follows each triangle on which it grows.
//!
//! A [`SkinGroom`] says where strands grow, by a mask on the vertices of a surface, and what they are like. [`SkinHair`] is what grows on
//! one body: every strand is stored in the frame of its triangle at rest, and [`SkinHair::place`] puts it on the surface of an instant. So
//! strands follow all that moves the skin: joints and morph targets.
//!
//! Further hair of this kind is one more entry of a list of grooms.

mod bound;
mod brows;
mod grow;
mod roots;
#[cfg(test)]
mod tests;

pub use bound::{SkinHair, is_mask_of_hair};
pub use brows::{BROWS, LOWER_LASHES, UPPER_LASHES};

use glam::Vec3;

use crate::StrandColour;

/// Hair on a part of the skin. Lengths are those on a head of the shipped dancer's size, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinGroom {
    /// What it is.
    pub name: &'static str,
    /// The mask on the vertices of the surface: the name of a vertex attribute of a file.
    pub mask: &'static str,
    /// Where in the mask its roots are.
    pub roots: RootPlace,
    /// Number of strands on all of the mask.
    pub strands: f32,
    /// Lengths of the shortest and of the longest strands.
    pub length: [f32; 2],
    /// Width of a strand at its root.
    pub width: f32,
    /// Width of the tip as a fraction of that at the root.
    pub tip: f32,
    /// How its strands lie.
    pub course: Course,
    /// Its colour over that of the look with which it is drawn.
    pub colour: StrandColour,
}

/// Where the roots of hair are in its mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RootPlace {
    /// On the triangles of the mask, by its value.
    Triangles,
    /// Along the line in each half of the mask that is farthest in a direction, as along the rim of a lid. The mask may be a row of
    /// vertices or a band around the rim.
    Rim(Vec3),
}

/// How strands lie on the body at rest, which faces +Z. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// Along the mask of each half of the face toward the temple, close to the skin; the innermost ones stand up.
    Temple {
        /// The angle at which strands leave the skin.
        lift: f32,
    },
    /// Away from the face, spread to both sides.
    Forward {
        /// Elevation at the root and at the tip.
        elevation: [f32; 2],
        /// Sideways slope of the strands at the ends of the mask of each half of the face.
        spread: f32,
    },
}

/// A surface at rest on which hair grows, world space.
#[derive(Clone, Copy, Debug)]
pub struct SkinSurface<'a> {
    /// Positions of its vertices, metres.
    pub positions: &'a [Vec3],
    /// Unit normals of its vertices.
    pub normals: &'a [Vec3],
    /// Counter-clockwise triangles.
    pub triangles: &'a [[u32; 3]],
}

impl SkinSurface<'_> {
    /// The corners of a triangle; `None` if the surface does not have them.
    fn corners(&self, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
        let [a, b, c] = triangle.map(|i| self.positions.get(i as usize).copied());
        Some([a?, b?, c?])
    }
}
