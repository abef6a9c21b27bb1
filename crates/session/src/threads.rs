//! Names and priorities of threads.

use rayon::{ThreadPool, ThreadPoolBuilder};
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

/// Workers of their own for `work`, which would wait for the tiles of an image if it shared the global ones. `None` if the system has no
/// threads for them, and the global workers must do.
pub(crate) fn own_workers(work: &'static str) -> Option<ThreadPool> {
    workers(work, ThreadPoolBuilder::new())
}

/// As the workers of the simulation, but of low priority: for what the window shows beside its image.
pub fn background_workers(work: &'static str) -> Option<ThreadPool> {
    workers(work, ThreadPoolBuilder::new().start_handler(|_| lower_priority()))
}

/// As [`background_workers`], but a single one, for what nobody waits for.
pub fn background_worker(work: &'static str) -> Option<ThreadPool> {
    workers(work, ThreadPoolBuilder::new().num_threads(1).start_handler(|_| lower_priority()))
}

fn workers(work: &'static str, builder: ThreadPoolBuilder) -> Option<ThreadPool> {
    // Linux shows fifteen letters of a name.
    let workers = builder.thread_name(move |i| format!("{work} {i}")).build();
    workers.inspect_err(|error| tracing::warn!(%error, work, "the global workers are shared")).ok()
}

/// Names the threads of the global rayon pool, which would otherwise inherit the name of the thread that uses the pool first.
///
/// There is one thread per hardware thread, or as many as `RAYON_NUM_THREADS` says.
pub fn name_workers() {
    // Fails if the pool exists already; then only the names differ.
    let _ = ThreadPoolBuilder::new().thread_name(|i| format!("worker {i}")).build_global();
}
