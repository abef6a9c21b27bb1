//! What runs: scenes, the simulation, takes and the threads that simulate and render.
//!
//! - [`scene`]: what is simulated and rendered, and its loader.
//! - [`engine`]: the simulation of a scene, step by step, without a clock.
//! - [`worker`]: the same on a thread of its own, in real time.
//! - [`take`]: recorded simulations, and playing them.
//! - [`dance`]: frames of a simulation or a take for work without a window; [`prepare`] and [`progress`] belong to it.
//! - [`render_thread`] and [`filmstrip`]: threads that render.
//! - [`wall`]: variants of a hairstyle, all simulated, beside each other.
//! - [`strokes`]: brushes on the hair of an engine, and recorded strokes played on a project.
//! - [`snapshot`] and [`totals`]: one instant, and what was measured up to it; [`health`] judges it.
//! - [`clock`], [`stats`], [`job`], [`latest`], [`threads`], [`memory`], [`machine`] and [`new_folders`]: parts that the others need.
//!
//! Nothing here depends on a window or a command line.

mod aside;
pub mod clock;
pub mod dance;
pub mod engine;
pub mod filmstrip;
pub mod health;
pub mod job;
pub mod latest;
pub mod machine;
pub mod memory;
pub mod new_folders;
pub mod prepare;
pub mod progress;
pub mod render_thread;
pub mod resolution;
pub mod scene;
pub mod snapshot;
pub mod stats;
pub mod strokes;
pub mod take;
// Always there: a feature for tests would build this crate, and all above it, twice.
pub mod testing;
pub mod threads;
pub mod totals;
pub mod wall;
pub mod window_device;
pub mod worker;

#[cfg(test)]
mod preroll_tests;
#[cfg(test)]
mod tests;
