//! Methods beside each other on the same hair at the same instant, live or in a film.
//!
//! - [`live`]: renders panes, on a thread of its own or frame by frame for a film.
//! - [`request`] and [`view`]: what is asked for and what comes back.
//! - [`probe`]: the light along a ray through a chosen hair.
//! - [`sheet`] and [`label`]: panes in one picture, with their labels.

mod heat;
pub mod label;
pub mod live;
pub mod probe;
pub mod request;
pub mod sheet;
pub mod view;
