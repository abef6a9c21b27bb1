//! What the methods share that follow the rays of a light through the world themselves: their rays are not made parallel as in
//! [`perspective`](crate::perspective).

mod columns;
mod light;
mod to_light;

pub(crate) use columns::{COLUMNS, ColumnViews, column_map};
pub(crate) use light::WorldLight;
pub(crate) use to_light::ToLight;
