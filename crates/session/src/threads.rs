//! Names and priorities of threads.

use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Lowers the priority of the calling thread, so that other threads run first. Does nothing if the system refuses.
pub fn lower_priority() {
    // A quarter of the scale from its low end: niceness 9 on Unix.
    if let Ok(low) = ThreadPriorityValue::try_from(25_u8)
        && let Err(error) = set_current_thread_priority(ThreadPriority::Crossplatform(low))
    {
        tracing::debug!(?error, "no lower priority");
    }
}

/// Workers of low priority for a page of the window, named by their `work`; `None` if the system has no threads for them, and the global
/// workers must do.
pub fn background_workers(work: &'static str) -> Option<rayon::ThreadPool> {
    let workers = rayon::ThreadPoolBuilder::new()
        .thread_name(move |i| format!("{work} worker {i}"))
        .start_handler(|_| lower_priority())
        .build();
    workers.inspect_err(|error| tracing::warn!(%error, work, "the global workers are shared")).ok()
}

/// Names the threads of the global rayon pool, which would otherwise inherit the name of the thread that uses the pool first.
///
/// There is one thread per hardware thread, or as many as `RAYON_NUM_THREADS` says.
pub fn name_workers() {
    // Fails if the pool exists already; then only the names differ.
    let _ = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("worker {i}")).build_global();
}
