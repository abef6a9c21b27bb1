//! Why a shadow could not be built.

use std::fmt;

use crate::{ShadowMethod, UserMethod};

/// Why a shadow could not be built. The previous map is freed: everything is lit until the next build.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShadowError {
    /// The map of this hair would exceed the memory limit of the method.
    #[error(
        "{method} needs {} for this hair, more than its limit of {}{}: {}",
        Bytes(*.needed_bytes), Bytes(*.limit_bytes), Share(*.maps), .method.advice()
    )]
    TooLarge {
        /// The method.
        method: ShadowMethod,
        /// What it would need.
        needed_bytes: u64,
        /// What one map may use: its share of the limit of all maps.
        limit_bytes: u64,
        /// The number of maps that share that limit, 1 or more.
        maps: u32,
    },
    /// The graphics device cannot create a buffer of that size.
    #[error(
        "{method} needs a buffer of {} for this hair, and this graphics device allows at most {}: {}, or render on \
         the CPU",
        Bytes(*.needed_bytes), Bytes(*.limit_bytes), .method.advice()
    )]
    Device {
        /// The method.
        method: ShadowMethod,
        /// What it would need.
        needed_bytes: u64,
        /// The device's limit.
        limit_bytes: u64,
    },
    /// A method of the user's own cannot be used.
    #[error("{problem}")]
    User {
        /// The method.
        method: UserMethod,
        /// What is wrong, with file and line where it has one.
        problem: String,
    },
}

/// The number of maps that share a limit, as text; empty for one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Share(u32);

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 > 1 { write!(f, " as one of {} lights", self.0) } else { Ok(()) }
    }
}

/// A number of bytes in a readable unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Bytes(u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"];
        if self.0 < 1024 {
            return write!(f, "{} bytes", self.0);
        }
        let at = (self.0.ilog2() / 10).min(units.len() as u32);
        let value = self.0 as f64 / (1_u64 << (10 * at)) as f64;
        write!(f, "{value:.1} {}", units[at as usize - 1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_readable() {
        let cases = [
            (0, "0 bytes"),
            (1023, "1023 bytes"),
            (1024, "1.0 KiB"),
            (10 << 20, "10.0 MiB"),
            (3 << 29, "1.5 GiB"),
            (u64::MAX, "16.0 EiB"),
        ];
        for (bytes, text) in cases {
            assert_eq!(Bytes(bytes).to_string(), text);
        }
    }

    #[test]
    fn the_message_has_both_numbers_and_a_way_out() {
        let error = |limit_bytes, maps| {
            let (method, needed_bytes) = (ShadowMethod::Exact, 12 << 30);
            ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps }.to_string()
        };
        assert_eq!(
            error(2 << 30, 4),
            "exact needs 12.0 GiB for this hair, more than its limit of 2.0 GiB as one of 4 lights: lower the map's \
             resolution or the number of strands, or raise the limit"
        );
        assert_eq!(
            error(8 << 30, 1),
            "exact needs 12.0 GiB for this hair, more than its limit of 8.0 GiB: lower the map's resolution or the \
             number of strands, or raise the limit"
        );
    }
}
