//! The date and time, for what people read and for telling files apart. No result of the program depends on it.

use std::time::{Duration, SystemTime};

/// The date and time.
#[expect(clippy::disallowed_methods, reason = "a date for people, on which no result depends")]
pub fn now() -> SystemTime {
    SystemTime::now()
}

/// Milliseconds from 1970 to `time`; 0 before.
pub fn unix_ms(time: SystemTime) -> u64 {
    time.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_millis() as u64)
}

/// The time that many milliseconds after 1970, at most some million years.
pub fn of_unix_ms(ms: u64) -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_millis(ms.min(u64::MAX >> 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_in_milliseconds_is_that_time() {
        assert_eq!(unix_ms(of_unix_ms(1_234_567_890_123)), 1_234_567_890_123);
        assert!(unix_ms(now()) > 1_600_000_000_000 && of_unix_ms(u64::MAX) > now());
    }
}
