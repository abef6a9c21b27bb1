//! Tests of stages through the interface of the crate.

mod many_prims;
