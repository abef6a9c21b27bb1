//! A hair file: a shipped hairstyle as polylines.

use std::fmt::Write as _;

use glam::Affine3A;
use lovelock_groom::{GuideFrame, Strands, interpolate};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_session::scene::SceneLoader;

use super::style;

/// Strands of the file.
const STRANDS: usize = 6000;

/// The hairstyle as text of an OBJ file, in centimetres with Y up.
pub(super) fn strands() -> Result<String, ProjectError> {
    let mut project = Project::default();
    style(&mut project, "long-waves");
    let (scene, _) = SceneLoader::new().load_now(&project, &Access::new())?;
    let guides = GuideFrame::at_rest(&scene.style.guides, Affine3A::IDENTITY, 0.0);
    let mut strands = Strands::default();
    interpolate(&scene.style, &guides, &mut strands);
    let step = strands.count().div_ceil(STRANDS).max(1);
    let mut text = "# Long waves, written by Lovelock. Centimetres, Y up.\n".to_owned();
    let mut first = 1;
    for strand in strands.first_point.windows(2).step_by(step) {
        let points = strand[0] as usize..strand[1] as usize;
        for at in points.clone() {
            let point = strands.point(at) * 100.0;
            let _ = writeln!(text, "v {:.3} {:.3} {:.3}", point.x, point.y, point.z);
        }
        text.push('l');
        for at in first..first + points.len() {
            let _ = write!(text, " {at}");
        }
        text.push('\n');
        first += points.len();
    }
    Ok(text)
}
