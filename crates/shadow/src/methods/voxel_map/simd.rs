//! The inner loops, compiled once for every processor and once more for those with wide vectors.
//!
//! The source is the same safe code; only the instruction set differs. Nothing in it is reordered or fused by
//! the compiler, so that all versions give the same bits, which a test checks.
//!
//! Unsafe since a function compiled for features of the processor may only be called where they were found.
#![allow(unsafe_code, clippy::inline_always)]

use glam::Vec3;
use lovelock_groom::Strands;

use super::deposit::Deposit;
use super::grid::Grid;
use super::layout::Layout;
use super::lookup::Lookup;
use super::sum;
use crate::LightFrame;
use crate::bounds::Bounds;

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
        Self::ALL.iter().rev().copied().find(|width| width.is_available()).unwrap_or(Self::Baseline)
    }
}

/// A function in every version: the first argument says which, and it must be available.
macro_rules! versions {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $of:ty),*) -> $result:ty { $body:expr }) => {
        $(#[$doc])*
        pub(super) fn $name(width: Width, $($argument: $of),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($argument: $of),*) -> $result {
                $body
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl")]
            fn avx512($($argument: $of),*) -> $result {
                $body
            }
            assert!(width.is_available(), "{width:?} on a processor without");
            match width {
                Width::Baseline => $body,
                // SAFETY: the processor has the features, as asserted above.
                #[cfg(target_arch = "x86_64")]
                Width::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: the processor has the features, as asserted above.
                #[cfg(target_arch = "x86_64")]
                Width::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}

versions! {
    /// [`Bounds::of_points`].
    fn bounds(x: &[f32], y: &[f32], z: &[f32], light: &LightFrame, anchor: Vec3) -> Bounds {
        Bounds::of_points(x, y, z, light, anchor)
    }
}

versions! {
    /// [`Deposit::run`].
    fn deposit(deposit: &Deposit, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
        deposit.run(strands, first, last, grid)
    }
}

versions! {
    /// [`sum::sum_tile`].
    fn sum_tile(layout: &Layout, tile: usize, used: u64, cells: &mut [u32], others: &[Grid]) -> () {
        sum::sum_tile(layout, tile, used, cells, others)
    }
}

versions! {
    /// [`Lookup::run`].
    fn lookup(lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) -> () {
        lookup.run(x, y, z, out)
    }
}
