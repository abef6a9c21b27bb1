//! Comparison without a window: a folder with images, error maps, tables and a page.

mod banding;
mod csv;
mod draw;
mod entrants;
mod folder;
mod hair;
mod light_sweep;
mod maps;
mod measure;
mod pictures;
mod probe;
mod reference;
mod request;
mod run;
mod sequence;
mod sheet;
mod stability;
mod steps;
mod stray;
mod sweep;
mod swim;
mod truth;
mod work;

pub use hair::{Hair, lights};
pub use request::CompareRequest;
pub use run::compare;
pub use sweep::Sweep;

#[cfg(test)]
mod tests;
