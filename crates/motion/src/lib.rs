//! Bodies and motion: glTF, VRM, FBX, USD, BVH, VMD, retargeting, poses and colliders.
//!
//! A [`Body`] is immutable and shared by `Arc`. Everything is in metres, right-handed, Y up, with the face of
//! the rest pose toward +Z; loaders convert.

mod backflip;
mod body;
mod bvh;
mod character;
mod clip;
mod collide;
mod collider;
mod content;
mod distance;
mod error;
mod expression;
mod face;
mod fbx;
mod field;
mod gltf;
mod head;
mod humanoid;
mod info;
mod load;
mod look;
mod material;
mod pose;
mod recorded;
mod retarget;
mod sample;
mod scalp;
mod seam;
mod settings;
mod skinning;
mod surface;
mod surface_info;
mod usd;
mod vmd;
mod words;

pub use backflip::backflip;
pub use body::{Bind, Body, Joint, Mesh, MorphTarget, Skeleton, SkinData};
pub use bvh::{MotionFile, MotionJoint, write_bvh};
pub use character::Character;
pub use clip::{Clip, ExpressionTrack, Interpolation, JointTracks, Keys, MorphTrack, Track};
pub use collide::{
    ColliderEdit, ColliderEdits, FieldEdit, collider_lines, fit_colliders, place_colliders, signed_distance,
};
pub use collider::{Collider, ColliderShape, PlacedCollider};
pub use content::FigureContent;
pub use distance::{RestDistance, SurfaceDistance};
pub use error::MotionError;
pub use expression::{Expression, FaceTrack};
pub use face::{Face, FaceWeight, FaceWeights, face_names, unknown_faces, unplaced_faces};
pub use fbx::is_fbx;
pub use field::{BodyField, FIELD_JOINTS, FieldLattice, FieldPose, FieldWeights};
pub use head::{HeadMesh, guess_head, head_mesh, joint_paths};
pub use info::{CharacterInfo, ClipInfo, MotionInfo};
pub use load::{
    figure_content, load_character, load_character_bytes, load_character_bytes_with, load_character_watched,
    load_character_with, load_motion, load_motion_bytes, load_motion_watched, load_motion_with,
};
pub use lovelock_gltf::{GltfError, gltf_reference};
pub use material::{Alpha, Image, Material, Region, Shading, TextureUse, Toon, ToonRim, Wrap};
pub use pose::Pose;
pub use retarget::retarget;
pub use sample::pose_at;
pub use scalp::{
    FittedScalp, Raise, ScalpArea, ScalpFit, Skull, fitted_scalp, hairline_place, raise_hairline,
};
pub use seam::Seam;
pub use settings::{
    BodySettings, Facing, LengthUnit, LoopBlend, MotionSettings, OwnHair, RootPosition, UpAxis,
};
pub use skinning::{Skin, skin};
pub use surface_info::{ExpressionInfo, ImageInfo, MaterialInfo, TextureUseInfo};
