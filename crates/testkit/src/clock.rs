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

/// CPU time of `work` in milliseconds. It runs on one thread of its own, also what it hands to rayon, so that other tests do not count.
///
/// # Panics
/// If the thread cannot be started.
pub fn alone_ms(work: impl FnOnce() + Send) -> f64 {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let spent = one.install(|| {
        let start = thread_time();
        work();
        thread_time().saturating_sub(start)
    });
    1e3 * spent.as_secs_f64()
}

#[cfg(unix)]
fn of(clock: rustix::time::ClockId) -> Duration {
    let time = rustix::time::clock_gettime(clock);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

#[cfg(not(unix))]
fn wall() -> Duration {
    use lovelock_base::clock::Stopwatch;
    static START: std::sync::LazyLock<Stopwatch> = std::sync::LazyLock::new(Stopwatch::start);
    START.elapsed()
}
