//! What the chores share: running other programs, and installing what the system lacks.

pub mod system;
pub mod tool;
