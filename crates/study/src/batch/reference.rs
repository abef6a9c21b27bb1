//! The reference images.

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{
    Backend, FrameInput, HairDrawing, KnownTransmittance, Picture, RenderError, Renderer, ShadowMethod,
    Transparency, ValueRenderer,
};

use super::hair::{Hair, LitHair};
use super::maps;
use super::maps::at_pixels;
use super::pictures::ReferencePictures;
use super::truth::{Truth, converge};
use super::work::Work;
use crate::report::{CompareReport, NamedTruth, ReferencePicture};

impl Work<'_> {
    /// Renders the reference images: strands with exact transparency, shaded with converged transmittance, which is known for the first
    /// light. Empty if the ground truth does not fit in memory; the report says so.
    ///
    /// # Errors
    /// If the size is out of range, a device is lost, or a file cannot be written.
    pub(super) fn reference(
        &self,
        hair: &Hair,
        of_first_light: &Truth,
        renderers: &mut [Renderer],
        report: &mut CompareReport,
    ) -> Result<ReferencePictures, ProjectError> {
        let mut project = self.project.clone();
        project.shadow.method = ShadowMethod::Exact;
        project.picture.draw = HairDrawing::Strands;
        project.picture.transparency = Transparency::Exact;
        let mut pictures = ReferencePictures::default();
        let Some(at_points) = self.light_at_points(hair, of_first_light, &project, report) else {
            return Ok(pictures);
        };
        let known = KnownTransmittance { at_points: &at_points, at_vertices: &[] };
        let mut input = hair.frame_input(&project);
        input.known = Some(known);
        for renderer in renderers {
            let Some(picture) = self.draw_reference(renderer, &input, report)? else { continue };
            let backend = renderer.backend();
            let is_first = report.reference.picture.is_none();
            let name = if is_first { "reference".to_owned() } else { format!("reference-{backend}") };
            let file = self.folder.picture(&name, (picture.width, picture.height, &picture.rgba))?;
            report.reference.picture.get_or_insert_with(|| file.clone());
            report.reference.pictures.push(ReferencePicture { backend: backend.to_string(), file });
            pictures.add(backend, picture);
        }
        if pictures.of(Backend::Cpu).is_none()
            && let Some(picture) = self.draw_reference(&mut Renderer::open(Backend::Cpu)?, &input, report)?
        {
            pictures.add(Backend::Cpu, picture);
        }
        let mut values = ValueRenderer::default();
        let pixels = at_pixels(&mut values, &input, &at_points[0], self.size)?;
        report.reference.transmittance = self.pixel_map("reference", maps::TRANSMITTANCE, &pixels)?;
        Ok(pictures)
    }

    /// Converged transmittance at every strand point for every light; `None` if it does not fit in memory.
    fn light_at_points(
        &self,
        hair: &Hair,
        of_first_light: &Truth,
        project: &Project,
        report: &mut CompareReport,
    ) -> Option<Vec<Vec<f32>>> {
        let mut at_points = Vec::new();
        for (i, light) in self.lights.iter().enumerate() {
            let found = if i == 0 {
                of_first_light.transmittance.clone()
            } else {
                let (found, facts) = converge(LitHair { hair, project, light }, &project.shadow);
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
                    return None;
                }
            }
        }
        Some(at_points)
    }

    /// The reference image of one renderer; `None` if its maps do not fit in memory.
    fn draw_reference(
        &self,
        renderer: &mut Renderer,
        input: &FrameInput,
        report: &mut CompareReport,
    ) -> Result<Option<Picture>, ProjectError> {
        let mut picture = Picture::default();
        let [width, height] = self.size;
        match renderer.picture(input, width, height, &mut picture) {
            Ok(_) => Ok(Some(picture)),
            Err(error @ RenderError::Shadow(_)) => {
                let backend = renderer.backend();
                report.reference.refused.push(format!("the reference picture ({backend}): {error}"));
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }
}
