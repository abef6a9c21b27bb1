//! The step of a block, compiled for the processor that runs it.
//!
//! The loops over lanes become wider instructions where the processor has them, and all versions give the same bits.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use lovelock_groom::simd::Width;
use lovelock_groom::simd_versions;

use crate::block::Block;
use crate::solver::{Plan, advance};

/// Takes `block` through the step of `plan`.
pub(crate) fn step_block(block: &mut Block, plan: &Plan) {
    step(if plan.wide { Width::widest() } else { Width::Baseline }, block, plan);
}

simd_versions! {
    /// [`advance`].
    fn step(block: &mut Block, plan: &Plan) -> () {
        advance(block, plan)
    }
}
