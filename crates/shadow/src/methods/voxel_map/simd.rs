//! The two inner loops, compiled once for every processor and once more for those with wide vectors.
//!
//! The source is the same safe code; only the instruction set differs. Nothing in it is reordered or fused by
//! the compiler, so that all versions give the same bits, which a test checks.
#![allow(unsafe_code)] // Calling a function compiled for features that were just found to be there.

use lovelock_groom::Strands;

use super::deposit::Deposit;
use super::grid::Grid;
use super::lookup::Lookup;

/// Which version runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Width {
    /// What every processor of this architecture has.
    Baseline,
    /// 256-bit vectors.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512-bit registers and masks.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Width {
    /// Every version, narrow to wide.
    pub(super) const ALL: &'static [Self] = &[
        Self::Baseline,
        #[cfg(target_arch = "x86_64")]
        Self::Avx2,
        #[cfg(target_arch = "x86_64")]
        Self::Avx512,
    ];

    /// Whether this processor has it.
    pub(super) fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        }
    }

    /// The widest that this processor has.
    pub(super) fn widest() -> Self {
        Self::ALL
            .iter()
            .rev()
            .copied()
            .find(|width| width.is_available())
            .unwrap_or(Self::Baseline)
    }
}

/// [`Deposit::run`] in the version `width`, which must be available.
pub(super) fn deposit(
    width: Width,
    deposit: &Deposit,
    strands: &Strands,
    first: usize,
    last: usize,
    grid: &mut Grid,
) -> u64 {
    assert!(width.is_available());
    match width {
        Width::Baseline => deposit.run(strands, first, last, grid),
        // SAFETY: the processor has the features.
        #[cfg(target_arch = "x86_64")]
        Width::Avx2 => unsafe { deposit_avx2(deposit, strands, first, last, grid) },
        // SAFETY: the processor has the features.
        #[cfg(target_arch = "x86_64")]
        Width::Avx512 => unsafe { deposit_avx512(deposit, strands, first, last, grid) },
    }
}

/// [`Lookup::run`] in the version `width`, which must be available.
pub(super) fn lookup(width: Width, lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
    assert!(width.is_available());
    match width {
        Width::Baseline => lookup.run(x, y, z, out),
        // SAFETY: the processor has the features.
        #[cfg(target_arch = "x86_64")]
        Width::Avx2 => unsafe { lookup_avx2(lookup, x, y, z, out) },
        // SAFETY: the processor has the features.
        #[cfg(target_arch = "x86_64")]
        Width::Avx512 => unsafe { lookup_avx512(lookup, x, y, z, out) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn deposit_avx2(deposit: &Deposit, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
    deposit.run(strands, first, last, grid)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
fn deposit_avx512(deposit: &Deposit, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
    deposit.run(strands, first, last, grid)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn lookup_avx2(lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
    lookup.run(x, y, z, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
fn lookup_avx512(lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
    lookup.run(x, y, z, out);
}
