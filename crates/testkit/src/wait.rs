//! Waiting for other threads and programs. How long it takes never decides a test: only a hang ends a wait.

use std::time::Duration;

use lovelock_base::clock::Stopwatch;

/// The time after which a wait is taken for a hang. No test comes near it, however busy the machine is.
pub const HANG: Duration = Duration::from_mins(15);

/// The least and the longest pause between two looks. A look may be a pass of the window, which would take the processor from what is waited
/// for; so the pauses grow to [`PART`] of the wait.
const PAUSES: [Duration; 2] = [Duration::from_millis(2), Duration::from_millis(60)];
/// The pauses as a part of the wait: one of so many.
const PART: u32 = 12;

/// Calls `ready` until it returns something, and returns that.
///
/// # Panics
/// If it returns nothing for [`HANG`]; the message names `what`.
#[track_caller]
pub fn wait_for<T>(what: &str, mut ready: impl FnMut() -> Option<T>) -> T {
    let watch = Stopwatch::start();
    loop {
        if let Some(value) = ready() {
            return value;
        }
        assert!(watch.elapsed() < HANG, "hangs while waiting for {what}");
        std::thread::sleep((watch.elapsed() / PART).clamp(PAUSES[0], PAUSES[1]));
    }
}

/// Calls `is_so` until it is true.
///
/// # Panics
/// As [`wait_for`].
#[track_caller]
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    wait_for(what, || is_so().then_some(()));
}

#[cfg(test)]
mod tests {
    use super::wait_for;

    #[test]
    fn a_wait_ends_with_the_first_value() {
        let mut looks = 0;
        let found = wait_for("the third look", || {
            looks += 1;
            (looks == 3).then_some(looks)
        });
        assert_eq!(found, 3);
    }
}
