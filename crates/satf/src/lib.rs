//! Clusters of hair drawn through a semantics-aware texture function (Xu et al., "SATF").
//!
//! Instead of strands, a wisp is drawn as a few layers of a generalised cylinder. What a block of such a layer looks like
//! from each side and in each light stands in a [`Database`], which is made once.
//!
//! - Off-line: [`sector`], [`trace`] and [`database`] make the records; [`file`](mod@file) and [`cache`] keep them.
//! - Once per hairstyle: [`ClusterHair`] fits a generalised disk to the strands of each wisp, sorts them into the sectors of its
//!   layers, and makes the ribs on which the layers are drawn.
//! - Per frame the ribs follow the guides as strands do, and the `render` crate draws the layers between them: it reads records
//!   ([`boundary`], [`Database::sample_stored`]), and [`lighting`] and [`shadow`] shade them. [`composite`] says how layers are blended.
//!
//! This crate draws nothing and needs no graphics device.

pub mod boundary;
pub mod cache;
mod cells;
pub mod composite;
pub mod database;
mod ellipse;
pub mod features;
pub mod file;
mod generate;
mod hair;
pub mod layout;
pub mod lighting;
mod lookup;
mod record;
mod ribs;
mod section;
pub mod sector;
mod settings;
pub mod shadow;
pub mod trace;

pub use cells::{Cell, strand_width};
pub use database::Database;
pub use features::{Curl, Features, SectorRef};
pub use hair::{ClusterHair, nominal_width};
pub use ribs::RibGrid;
pub use settings::{ClusterSettings, ClusterShading, ClusterView, RecordLookup};
pub use shadow::LocalShadow;
