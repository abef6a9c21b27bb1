//! The project: everything that is saved and undone.
//!
//! - [`project`]: [`Project`] and its sections, reading and writing project files, ranges of values.
//! - [`styles`]: hairstyles as documents of their own, those that are shipped, and applying one to a project.
//! - [`files`]: the files that a project names, and which of them it may read.
//! - [`grants`]: files outside the folder of a project that the user picked for it once.
//! - [`unfinished`]: recordings that were interrupted.
//! - [`tracks`]: keys over time for a number of the project.
//! - [`animation`]: the project at a time of its timeline, and controls that write keys while time passes.
//! - [`variants`]: a hairstyle changed by chance, and two of them mixed.
//! - [`history`]: undo and redo.
//! - [`date`]: the date and time, for people.
//! - [`journal`]: unsaved changes on disk, within a second of each edit, and their recovery.
//! - [`state_folder`]: where the program keeps what no user chose a place for.
//! - [`error`]: the error of all crates above, and the problems that do not stop a load.
//!
//! Nothing here runs: scenes, simulations and threads are in `lovelock-session`.

pub mod animation;
pub mod date;
pub mod document;
pub mod error;
pub mod files;
pub mod grants;
pub mod history;
pub mod journal;
pub mod project;
pub mod state_folder;
pub mod styles;
pub mod tracks;
pub mod unfinished;
pub mod variants;

pub use project::Project;
