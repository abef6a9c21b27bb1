//! The wisp simulator: rigid links, shape memory, collisions, density-grid repulsion and wind.

mod input;
mod report;
mod settings;
mod simulation;

pub use input::StepInput;
pub use report::StepReport;
pub use settings::{MAX_SUBSTEPS, Repulsion, RepulsionMode, SimulationSettings, Wind};
pub use simulation::Simulation;
