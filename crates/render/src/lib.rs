//! One picture: strands, shading, transparency, body, ground and tone mapping.
//!
//! A [`FrameInput`] is everything that a picture shows at one instant; a [`Renderer`] makes a [`Picture`] of it.
//! Shadow methods run here, between the strands and their shading.

mod ambient;
mod backdrop;
mod camera;
mod closed;
mod clusters;
mod color_scale;
mod cpu;
mod error;
mod fibre;
mod frame;
mod gpu;
mod image;
mod known;
mod layers;
mod light_view;
mod map_view;
mod picture;
mod renderer;
mod resident;
mod scene_light;
mod shadow_look;
mod skin;
mod standing;
mod strand_details;
mod strand_portion;
mod strand_values;
mod surface_material;
mod textures;
mod uniform;

pub use backdrop::LaidBackdrop;
pub use camera::Camera;
pub use color_scale::ColorScale;
pub use cpu::{CpuRenderer, DrawnHair, HairHit, Interrupt, ValuePicture, ValueRenderer};
pub use error::RenderError;
pub use frame::{CarriedHair, ClusterStats, FrameInput, FrameStats, HairPose};
pub use gpu::{Finished, GpuRenderer, MAX_IN_FLIGHT, PendingPicture, Shrinker, all_shaders};
pub use image::{DeviceImage, DeviceImages, Image};
pub use known::KnownTransmittance;
pub use layers::Layers;
pub use lovelock_gpu::{Gpu, GpuError, PassTime, PooledBuffer, Traffic, check_shader, wgpu};
pub use lovelock_picture::{
    Backend, BackgroundForm, BodyLook, HairDrawing, Light, LightKind, LightRig, MAX_LIGHTS, MAX_PIXELS,
    MAX_SIDE, MapForm, MapValue, MapView, PictureFit, PictureSettings, SizeError, StrandCount, Transparency,
    UnknownBackend, check_size,
};
pub use lovelock_satf::{ClusterSettings, ClusterShading, ClusterView, LocalShadow, RecordLookup};
pub use lovelock_shadow::voxel_map::{MapExtent, VoxelDeposit, VoxelFilter, VoxelMapSettings, VoxelSlices};
pub use lovelock_shadow::{
    AdaptiveSettings, ApproximateDeepSettings, ClusterDeviation, ClusterSeeds, DeepOpacityMapsSettings,
    DeepShadowMapsSettings, DensityClusteringSettings, DepthRange, ExactSettings, FourierSettings,
    LayerGrowth, MomentsSettings, OccupancyMapsSettings, OpacityMapsSettings, RayMark, RayMarkKind,
    RayStructure, RayTracedSettings, ShadowError, ShadowMethod, ShadowSettings, TEXEL_RESOLUTIONS,
    TexelFilter, UserMethod, VoxelMarchSettings, fallbacks_sentence, new_method,
};
pub use picture::Picture;
pub use renderer::Renderer;
pub use resident::ResidentGuides;
pub use standing::light_frame;
