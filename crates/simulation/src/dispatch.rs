//! Steps a block with code compiled for the vector width of the CPU.
//!
//! The loops over lanes use wider instructions where the CPU has them. All versions give the same bits.
// `unsafe` is used by the macro, which calls functions that require CPU features after checking for them.
#![allow(unsafe_code)]

use std::cell::RefCell;

use lovelock_base::simd::Width;
use lovelock_base::simd_versions;

use crate::block::{Block, Work};
use crate::lanes::Lane;
use crate::solver::{Ending, Plan, advance, measure};

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

/// Lets `read` write the state that another device computed into `block`, then measures it as after a step.
pub(crate) fn accept_block(block: &mut Block, ending: &Ending, read: impl FnOnce(&mut Block)) {
    WORK.with_borrow_mut(|work| {
        std::mem::swap(work, &mut block.work);
        block.work.fit(block.position.len());
        let Block { position, work: own, .. } = &mut *block;
        for (start, row) in own.start_pose.iter_mut().zip(position.iter()) {
            for (axis, (to, from)) in start.iter_mut().zip(row).enumerate() {
                *to = from.plus(Lane::splat(ending.rebase[axis]));
            }
        }
        read(block);
        measure(block, ending);
        std::mem::swap(work, &mut block.work);
    });
}

simd_versions! {
    /// [`advance`].
    fn step(block: &mut Block, plan: &Plan) -> () {
        advance(block, plan)
    }
}
