//! Tests of stages through the interface of the crate.

mod damaged;
mod many_prims;
