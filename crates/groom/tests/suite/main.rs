//! Tests of hairstyles through the public interface, in one program: each further one would link everything again.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/motion.rs"]
mod motion;

mod damaged_hair;
mod growing;
mod hair_files;
mod hair_round_trips;
mod interpolation;
mod orientation;
mod strand_bounds;
