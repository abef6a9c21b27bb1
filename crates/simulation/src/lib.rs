//! The wisp simulator: rigid links, shape memory, collisions, density-grid repulsion and wind.
//!
//! Each guide strand is a chain of rigid links rooted in the moving scalp (Bertails, Ménier, Cani 2005). A
//! [`Simulation`] holds the guides of one hairstyle. [`Simulation::step`] advances them while the body moves
//! from its last pose to a new one, and [`Simulation::frame`] writes the guides for interpolation.

#![allow(
    clippy::inline_always,
    clippy::needless_range_loop,
    clippy::too_many_arguments,
    reason = "hot loops over lanes index several rows at once and must be inlined into the functions that are \
              compiled for wider instructions; shared values are passed as arguments to stay in registers"
)]

mod block;
mod colliders;
mod contents;
pub mod device;
mod dispatch;
mod factors;
mod grid;
mod hash;
mod input;
mod integrator;
mod lanes;
mod motion;
mod packing;
mod rates;
mod report;
mod rest;
mod rope;
mod settings;
mod simulation;
mod solver;
mod ties;
mod trilinear;
mod wake;
mod wind;

pub use input::{PlacedField, StepInput};
pub use integrator::{Integrator, MAX_SWEEPS};
pub use report::{BodyPart, InsidePoint, StepReport};
pub use settings::{Locks, MAX_SUBSTEPS, Repulsion, RepulsionMode, SimulationSettings, Wind};
pub use simulation::{BodyNow, RestoreError, Simulation};
