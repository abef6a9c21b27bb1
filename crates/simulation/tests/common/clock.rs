//! CPU time, which does not include other work on the machine.

use std::time::Duration;

/// CPU time of all threads of this process; wall time where the system does not report it.
pub fn process_time() -> Duration {
    #[cfg(unix)]
    {
        of(rustix::time::ClockId::ProcessCPUTime)
    }
    #[cfg(not(unix))]
    {
        wall()
    }
}

/// CPU time of this thread alone.
pub fn thread_time() -> Duration {
    #[cfg(unix)]
    {
        of(rustix::time::ClockId::ThreadCPUTime)
    }
    #[cfg(not(unix))]
    {
        wall()
    }
}

#[cfg(unix)]
fn of(clock: rustix::time::ClockId) -> Duration {
    let time = rustix::time::clock_gettime(clock);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

#[cfg(not(unix))]
fn wall() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}
