//! Pictures of tiny scenes by the CPU backend; no adapter is needed.

#[allow(clippy::duplicate_mod, reason = "the same cases for each backend")]
#[path = "../cases/mod.rs"]
mod cases;

use lovelock_render::Backend;

const BACKEND: Backend = Backend::Cpu;
