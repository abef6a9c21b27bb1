//! Tests of bodies and motion through the public interface, in one program: each further one would link everything again.

#[path = "../common/mod.rs"]
mod common;

mod bvh;
mod bvh_found;
mod characters;
mod clips;
mod collide;
mod face;
mod fbx;
mod fuzz;
mod materials;
mod other_files;
mod retargeting;
mod rolls;
mod rows;
mod usd;
mod vmd;
mod vrm;
