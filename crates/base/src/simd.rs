//! Compiles the same source for several vector widths and chooses one at run time.
//!
//! Inner loops are plain safe code on fixed-size arrays, which the compiler turns into vector instructions. Nothing is
//! reordered or fused, so all versions give the same bits.

pub use crate::whole_part::whole_part;

/// The version of a function that runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// The instructions that every CPU of this architecture has.
    Baseline,
    /// 256-bit vectors, and the bit instructions that came with them.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512-bit registers and masks.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Width {
    /// Every version, narrow to wide.
    pub const ALL: &'static [Self] = &[
        Self::Baseline,
        #[cfg(target_arch = "x86_64")]
        Self::Avx2,
        #[cfg(target_arch = "x86_64")]
        Self::Avx512,
    ];

    /// Whether this CPU has the instructions.
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("popcnt")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        }
    }

    /// The version for loops over eight numbers, of at most 256 bits: the compiler does not turn comparisons of eight numbers into vectors
    /// if it may use masks of 512-bit registers.
    pub fn for_eight(self) -> Self {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Self::Avx2,
            other => other,
        }
    }

    /// The widest version that this CPU can run.
    pub fn widest() -> Self {
        Self::ALL.iter().rev().copied().find(|width| width.is_available()).unwrap_or(Self::Baseline)
    }
}

/// A function in every version of [`Width`]. Its first argument selects the version, which must be available.
///
/// The body should call only functions that are always inlined; others keep the baseline's instructions. The module
/// that uses this macro must allow `unsafe_code`, because it calls functions that need CPU features.
#[macro_export]
macro_rules! simd_versions {
    (
        $(#[$doc:meta])*
        $vis:vis fn $name:ident $(<$generic:ident: $bound:path>)? ($($argument:ident: $of:ty),* $(,)?) -> $result:ty {
            $body:expr
        }
    ) => {
        $(#[$doc])*
        $vis fn $name $(<$generic: $bound>)? (width: $crate::simd::Width, $($argument: $of),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
            fn avx2 $(<$generic: $bound>)? ($($argument: $of),*) -> $result {
                $body
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,popcnt,bmi1,bmi2,avx512f,avx512bw,avx512dq,avx512vl")]
            fn avx512 $(<$generic: $bound>)? ($($argument: $of),*) -> $result {
                $body
            }
            assert!(width.is_available(), "{width:?} on a processor without");
            match width {
                $crate::simd::Width::Baseline => $body,
                // SAFETY: the CPU has the features, as asserted above.
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Width::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: the CPU has the features, as asserted above.
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Width::Avx512 => unsafe { avx512($($argument),*) },
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_is_available_and_the_baseline_always_is() {
        assert!(Width::widest().is_available());
        assert!(Width::Baseline.is_available());
        assert_eq!(Width::ALL[0], Width::Baseline);
    }

    #[test]
    fn loops_over_eight_numbers_run_wherever_the_width_does() {
        for width in Width::ALL.iter().filter(|width| width.is_available()) {
            assert!(width.for_eight().is_available(), "{width:?}");
            assert_eq!(width.for_eight().for_eight(), width.for_eight());
        }
    }
}
