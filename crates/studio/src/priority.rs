//! Threads whose work has time.

use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Lets other threads go first, where the system takes such wishes: without it their work is done as well.
pub(crate) fn give_way() {
    // A quarter of the scale from its low end: a niceness of 9 where there is such a thing.
    if let Ok(low) = ThreadPriorityValue::try_from(25_u8)
        && let Err(error) = set_current_thread_priority(ThreadPriority::Crossplatform(low))
    {
        tracing::debug!(?error, "no lower priority");
    }
}
