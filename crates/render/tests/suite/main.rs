//! Tests of pictures through the public interface, in one program: each further one would link everything again.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod backdrop;
mod carried;
mod cluster_agreement;
mod cluster_lights;
mod clusters;
mod colours;
mod drafts;
mod false_colors;
mod fibre;
mod fine;
mod inspect;
mod kajiya_kay;
mod layers;
mod lens;
mod map_view;
mod picture_cpu;
mod picture_gpu;
mod receding;
mod shaders;
mod surfaces;
mod values;
mod visible;
mod window;
