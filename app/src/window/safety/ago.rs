//! Times in the past, in words.

use std::time::SystemTime;

use lovelock_base::words::counted;
use lovelock_project::date;

/// How long ago a time was.
pub(in crate::window) fn ago(time: SystemTime) -> String {
    let secs = date::now().duration_since(time).map_or(0, |past| past.as_secs());
    match secs {
        0..60 => "less than a minute ago".to_owned(),
        60..3600 => format!("{} ago", counted(secs / 60, "minute", "minutes")),
        3600..172_800 => format!("{} ago", counted(secs / 3600, "hour", "hours")),
        _ => format!("{} ago", counted(secs / 86_400, "day", "days")),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn times_are_said_in_the_largest_unit() {
        let said = |secs| ago(date::now() - Duration::from_secs(secs));
        assert_eq!(said(5), "less than a minute ago");
        assert_eq!(said(61), "1 minute ago");
        assert_eq!(said(7300), "2 hours ago");
        assert_eq!(said(200_000), "2 days ago");
    }
}
