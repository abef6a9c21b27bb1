//! Clusters of hair drawn through a semantics-aware texture function (Xu et al., "SATF").
//!
//! Instead of strands, a wisp is drawn as a few layers of a generalised cylinder. What a block of such a layer looks like
//! from each side and in each light stands in a [`Database`], which is made once.
//!
//! - Off-line: [`sector`], [`trace`] and [`database`] make the records; [`file`](mod@file) and [`cache`] keep them.
//! - Once per hairstyle: [`cluster`] sorts the strands of each wisp into the sectors of its layers.
//! - Once per frame: [`disk`] follows the guides.
//! - Per pixel: [`boundary`] reads records, [`lighting`] and [`shadow`] shade them, [`composite`] blends them.
//!
//! This crate draws nothing: it is the definition by which drawing is tested.

/// The azimuth of a direction in the plane of a sector.
pub mod azimuth;
pub mod boundary;
pub mod cache;
mod cells;
pub mod cluster;
pub mod composite;
pub mod database;
pub mod disk;
pub mod ellipse;
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
pub use cluster::Clusters;
pub use database::Database;
pub use disk::{DiskFrames, DiskPlan};
pub use features::{Curl, Features, SectorRef};
pub use hair::ClusterHair;
pub use ribs::RibGrid;
pub use settings::{ClusterSettings, ClusterShading, ClusterView, RecordLookup};
pub use shadow::LocalShadow;
