//! Steps a block with code compiled for the vector width of the CPU.
//!
//! The loops over lanes use wider instructions where the CPU has them. All versions give the same bits.
// `unsafe` is used by the macro, which calls functions that require CPU features after checking for them.
#![allow(unsafe_code)]

use std::cell::RefCell;

use lovelock_base::simd::Width;
use lovelock_base::simd_versions;

use crate::block::{Block, Work};
use crate::solver::{Plan, advance};

thread_local! {
    /// Working memory that this thread lends to the block it is stepping.
    static WORK: RefCell<Work> = RefCell::default();
}

/// Advances `block` by the step of `plan`.
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
