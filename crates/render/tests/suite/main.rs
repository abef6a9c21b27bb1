//! Tests of pictures through the public interface, in one program: each further one would link everything again.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod cluster_agreement;
mod clusters;
mod colours;
mod false_colors;
mod fibre;
mod fine;
mod inspect;
mod layers;
mod picture_cpu;
mod picture_gpu;
mod receding;
mod shaders;
mod values;
mod window;
