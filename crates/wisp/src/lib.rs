//! The wisp simulator: rigid links, shape memory, collisions, density-grid repulsion and wind.

mod block;
mod colliders;
mod dispatch;
mod grid;
mod hash;
mod input;
mod lanes;
mod motion;
mod report;
mod rest;
mod settings;
mod simulation;
mod solver;
mod wind;

pub use input::StepInput;
pub use report::StepReport;
pub use settings::{MAX_SUBSTEPS, Repulsion, RepulsionMode, SimulationSettings, Wind};
pub use simulation::Simulation;
