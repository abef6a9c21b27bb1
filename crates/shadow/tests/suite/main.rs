//! Tests of shadow methods through the public interface, in one program: each further one would link everything again.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/gpu.rs"]
mod gpu;
#[path = "../common/grooms.rs"]
mod grooms;

mod docs;
mod gpu_agreement;
mod gpu_edges;
mod gpu_shaders;
mod gpu_slices;
mod gpu_stage;
mod gpu_standing;
mod methods_converge;
mod methods_edges;
mod methods_memory;
mod published;
mod ray;
mod ray_traced_truth;
mod soft;
mod standing;
mod steadiness;
mod texel_methods_truth;
mod user_methods;
mod voxel_map_adaptive;
mod voxel_map_agreement;
mod voxel_map_edges;
mod voxel_map_truth;
mod voxel_march_truth;
