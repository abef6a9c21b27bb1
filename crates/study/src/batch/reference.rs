//! The reference image.

use lovelock_project::error::ProjectError;
use lovelock_render::{
    Backend, HairDrawing, KnownTransmittance, Picture, RenderError, Renderer, ShadowMethod, Transparency,
    ValueRenderer,
};

use super::hair::Hair;
use super::maps;
use super::maps::at_pixels;
use super::truth::{Truth, converge};
use super::work::Work;
use crate::report::{CompareReport, NamedTruth};

impl Work<'_> {
    /// Renders the reference image: strands with exact transparency, shaded with converged transmittance, which is known for the first light.
    /// `None` if the ground truth does not fit in memory; the report says so.
    ///
    /// # Errors
    /// If the size is out of range, or a file cannot be written.
    pub(super) fn reference(
        &self,
        hair: &Hair,
        of_first_light: &Truth,
        report: &mut CompareReport,
    ) -> Result<Option<Picture>, ProjectError> {
        let mut project = self.project.clone();
        project.shadow.method = ShadowMethod::Exact;
        project.picture.draw = HairDrawing::Strands;
        project.picture.transparency = Transparency::Exact;
        let mut at_points = Vec::new();
        for (i, light) in self.lights.iter().enumerate() {
            let found = if i == 0 {
                of_first_light.transmittance.clone()
            } else {
                let (found, facts) = converge((hair, &project, light), &project.shadow);
                if found.is_ok() {
                    let name = format!("reference picture, light {}", i + 1);
                    report.reference.others.push(NamedTruth::new(name, &facts));
                }
                found
            };
            match found {
                Ok(found) => at_points.push(found),
                Err(error) => {
                    report.reference.refused.push(format!("the reference picture: {error}"));
                    return Ok(None);
                }
            }
        }
        let known = KnownTransmittance { at_points: &at_points, at_vertices: &[] };
        let mut input = hair.frame_input(&project);
        input.known = Some(known);
        let mut renderer = Renderer::open(Backend::Cpu)?;
        let mut picture = Picture::default();
        let [width, height] = self.size;
        match renderer.picture(&input, width, height, &mut picture) {
            Ok(_) => {}
            Err(error @ RenderError::Shadow(_)) => {
                report.reference.refused.push(format!("the reference picture: {error}"));
                return Ok(None);
            }
            Err(error) => return Err(error.into()),
        }
        let file = self.folder.picture("reference", (width, height, &picture.rgba))?;
        report.reference.picture = Some(file);
        let mut values = ValueRenderer::default();
        let pixels = at_pixels(&mut values, &input, &at_points[0], self.size)?;
        report.reference.transmittance = self.pixel_map("reference", maps::TRANSMITTANCE, &pixels)?;
        Ok(Some(picture))
    }
}
