//! Light from all directions.
