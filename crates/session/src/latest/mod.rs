//! Values and requests passed between threads, where a later one replaces an earlier one.

mod job;
mod value;

pub use job::{Job, LatestJob};
pub use value::Latest;
