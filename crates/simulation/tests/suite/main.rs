//! Tests of the simulator through the public interface, in one program: each further one would link everything again.

#[path = "../../examples/brush/hair.rs"]
mod brush;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/drive.rs"]
mod drive;

mod body;
mod chains;
mod crowded;
mod dance;
mod drives;
mod factors;
mod imported;
mod integrators;
mod kinks;
mod locks;
mod long_dances;
mod moved;
mod physics;
mod snapshots;
mod still;
mod style;
mod survival;
mod tension;
mod world;
