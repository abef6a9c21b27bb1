//! Pictures of tiny scenes by the CPU backend; no adapter is needed.

mod cases;
mod common;

use lovelock_render::Backend;

const BACKEND: Backend = Backend::Cpu;
