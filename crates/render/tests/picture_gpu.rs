//! Pictures of tiny scenes by the GPU backend.

mod cases;
mod common;

use lovelock_render::Backend;

const BACKEND: Backend = Backend::Gpu;
