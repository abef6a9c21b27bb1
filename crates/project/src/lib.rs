//! The project: everything that is saved and undone.
//!
//! - [`project`]: [`Project`] and its sections, reading and writing project files, ranges of values.
//! - [`styles`]: hairstyles as documents of their own, those that are shipped, and applying one to a project.
//! - [`files`]: the files that a project names, and which of them it may read.
//! - [`tracks`]: keys over time for a number of the project.
//! - [`animation`]: the project at a time of its timeline, and controls that write keys while time passes.
//! - [`variants`]: a hairstyle changed by chance, and two of them mixed.
//! - [`history`]: undo and redo.
//! - [`error`]: the error of all crates above, and the problems that do not stop a load.
//!
//! Nothing here runs: scenes, simulations and threads are in `lovelock-session`.

pub mod animation;
pub mod document;
pub mod error;
pub mod files;
pub mod history;
pub mod project;
pub mod styles;
pub mod tracks;
pub mod variants;

pub use project::Project;
