//! The step of a block, compiled for the processor that runs it.
//!
//! The loops over lanes become wider instructions where the processor has them. Rust never contracts a
//! product and a sum, so both versions give the same bits.

use crate::block::Block;
use crate::solver::{Plan, advance};

/// Takes `block` through the step of `plan`.
pub(crate) fn step_block(block: &mut Block, plan: &Plan) {
    #[cfg(target_arch = "x86_64")]
    if plan.wide && std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2, which is all that the function asks for.
        #[expect(unsafe_code, reason = "a function with target features can only be called this way")]
        unsafe {
            advance_avx2(block, plan);
        }
        return;
    }
    advance_portable(block, plan);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn advance_avx2(block: &mut Block, plan: &Plan) {
    advance(block, plan);
}

/// The same with the instructions that every processor of this kind has.
pub(crate) fn advance_portable(block: &mut Block, plan: &Plan) {
    advance(block, plan);
}
