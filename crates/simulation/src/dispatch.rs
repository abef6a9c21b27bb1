//! The step of a block, compiled for the processor that runs it.
//!
//! The loops over lanes become wider instructions where the processor has them, and all versions give the same bits.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use std::cell::RefCell;

use lovelock_groom::simd::Width;
use lovelock_groom::simd_versions;

use crate::block::{Block, Work};
use crate::solver::{Plan, advance};

thread_local! {
    /// What this thread lends to the block that it works on.
    static WORK: RefCell<Work> = RefCell::default();
}

/// Takes `block` through the step of `plan`.
pub(crate) fn step_block(block: &mut Block, plan: &Plan) {
    WORK.with_borrow_mut(|work| {
        std::mem::swap(work, &mut block.work);
        step(if plan.wide { Width::widest() } else { Width::Baseline }, block, plan);
        std::mem::swap(work, &mut block.work);
    });
}

simd_versions! {
    /// [`advance`].
    fn step(block: &mut Block, plan: &Plan) -> () {
        advance(block, plan)
    }
}
