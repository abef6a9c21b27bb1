//! What runs: the scene, the simulation and the threads that they live on.

mod camera;
mod combing;
mod dancer;
mod dress;
mod engine;
mod head_path;
mod inside;
mod load_thread;
mod loader;
mod mailbox;
mod parts;
mod preroll;
mod scene;
mod snapshot;
mod totals;
mod worker;

pub use camera::{camera_at, frame_points};
pub use dancer::dancer;
pub use engine::Engine;
pub(crate) use engine::LastSteps;
pub use head_path::HeadPath;
pub use load_thread::LoadProgress;
pub use loader::{LoadControl, SceneLoader};
pub use preroll::{Preroll, PrerollProgress};
pub use scene::{BodyObstacle, Scene};
pub use snapshot::FrameSnapshot;
pub(crate) use snapshot::SnapshotPool;
pub use totals::{Found, Totals};
pub use worker::{Event, Wake, Worker};

#[cfg(test)]
mod collider_tests;
#[cfg(test)]
mod preroll_tests;
#[cfg(test)]
pub(crate) mod tests;
#[cfg(test)]
mod worker_tests;
