//! Errors of panes: their size, and their false colours.

use std::sync::Arc;

use lovelock_metrics::{ColorMap, errors};
use lovelock_project::Project;
use lovelock_render::{DeviceImages, Image, Picture, RenderError, Transparency};

use super::reference::ExactReference;
use super::round::{Rounds, input_of, take_stats};
use crate::heat;
use crate::request::{LiveError, LivePane, LiveRequest};
use crate::view::LiveShows;

impl Rounds {
    /// Renders a pane, measures its error and shows it in colour. Why there are no colours is left in the pane.
    ///
    /// Errors of transmittance are drawn where the pane is: on the device of `window` only the transmittance comes back and only the
    /// values of the points go up. Differences of images (FLIP) are computed on the CPU, from the pixels.
    ///
    /// # Errors
    /// If the pane cannot be rendered.
    pub(super) fn draw_errors(
        &mut self,
        request: &LiveRequest,
        index: usize,
        (drawn, size): (&Project, [u32; 2]),
        pane: &mut LivePane,
        window: Option<&mut DeviceImages>,
    ) -> Result<(), RenderError> {
        let shows = request.view.shows;
        let own = self.takes.instant(index).and_then(Result::ok);
        let (snapshot, strands) = own.unwrap_or((&request.snapshot, &self.strands));
        let input = input_of(snapshot, drawn, strands, &pane.camera);
        let Some(renderer) = self.renderers.last(index) else { return Err(RenderError::NoPicture) };
        let mut picture = Picture::default();
        let on_device = renderer.on_device_of(window.as_deref()).filter(|_| shows != LiveShows::PictureError);
        let (stats, is_on_device) = match on_device {
            Some(gpu) => (gpu.picture_on_device(&input, size)?, true),
            None => (renderer.picture(&input, size[0], size[1], &mut picture)?, false),
        };
        take_stats(pane, &stats);
        if !pane.contender.draws_strands() {
            let shown = match shows {
                LiveShows::PictureError => self.color_by_picture(request, index, pane, &mut picture),
                _ => Err(NO_POINTS.to_owned()),
            };
            match shown {
                Ok(()) => pane.image = Image::on(window, &mut picture),
                Err(why) => pane.colors_problem = Some(why),
            }
            return Ok(());
        }
        let found = renderer.transmittance(request.view.light).map_err(|error| error.to_string());
        let measured = found.and_then(|found| Ok((self.measure(request, index, &found, pane)?, found)));
        let colored = match (measured, shows.colors()) {
            (Ok((exact, found)), Some(colors)) if is_on_device => {
                let values = errors_of(shows, &found, &exact);
                let scale = heat::scale(colors, largest(request));
                let renderer = self.renderers.last(index);
                match (renderer.and_then(|renderer| renderer.on_device_of(window.as_deref())), window) {
                    (Some(gpu), Some(window)) => {
                        Ok(Image::Device(gpu.false_colors(&values, &scale, window)?))
                    }
                    _ => Err(RenderError::NoPicture.to_string()),
                }
            }
            (Ok((exact, found)), Some(colors)) => {
                let given = (drawn, errors_of(shows, &found, &exact), colors);
                self.color(request, index, given, pane, &mut picture)
                    .map(|()| Image::on(window, &mut picture))
            }
            (Err(why), _) => Err(why),
            (Ok(_), None) => Ok(Image::on(window, &mut picture)),
        };
        match colored {
            Ok(image) => pane.image = image,
            // The plain image beside a colour scale would be mistaken for errors.
            Err(why) => pane.colors_problem = Some(why),
        }
        Ok(())
    }

    /// Compares the transmittance of a pane with the exact one, which is returned.
    ///
    /// # Errors
    /// A sentence if there is no reference.
    pub(super) fn measure(
        &mut self,
        request: &LiveRequest,
        index: usize,
        found: &[f32],
        pane: &mut LivePane,
    ) -> Result<Arc<Vec<f32>>, String> {
        let shared = &request.project;
        let own = self.takes.instant(index).and_then(Result::ok);
        let (snapshot, strands) = own.unwrap_or((&request.snapshot, &self.strands));
        let exact = self.reference.transmittance(shared, snapshot, strands, request.view.light);
        let exact = match exact {
            Ok(exact) => exact,
            Err(why) => {
                pane.error = LiveError::Refused(why.clone());
                return Err(why);
            }
        };
        let drawn_by = (&pane.contender, pane.adapter.backend);
        pane.error = if ExactReference::is(shared, drawn_by, (found, &exact)) {
            LiveError::Reference
        } else {
            let of = errors(found, &exact);
            LiveError::Measured { rmse: of.rmse, bias: of.bias, p99: of.p99 }
        };
        Ok(exact)
    }

    /// Replaces the `picture` of a pane in memory by its errors in colour.
    ///
    /// # Errors
    /// A sentence if there is no reference, or the false-colour image cannot be rendered.
    fn color(
        &mut self,
        request: &LiveRequest,
        index: usize,
        (drawn, values, colors): (&Project, Vec<f32>, ColorMap),
        pane: &mut LivePane,
        picture: &mut Picture,
    ) -> Result<(), String> {
        if request.view.shows == LiveShows::PictureError {
            return self.color_by_picture(request, index, pane, picture);
        }
        let own = self.takes.instant(index).and_then(Result::ok);
        let (snapshot, strands) = own.unwrap_or((&request.snapshot, &self.strands));
        let largest = largest(request);
        // False colours show the front strands in every pane, whatever its transparency mode.
        let mut shown = drawn.clone();
        shown.picture.transparency = Transparency::Sorted;
        let input = input_of(snapshot, &shown, strands, &pane.camera);
        let colored = heat::on_hair(&mut self.values, &input, &values, (colors, largest), picture);
        colored.map_err(|error| error.to_string())
    }

    /// Replaces the `picture` of a pane in memory by its difference from the reference in colour.
    ///
    /// # Errors
    /// A sentence if there is no reference, or the images cannot be compared.
    fn color_by_picture(
        &mut self,
        request: &LiveRequest,
        index: usize,
        pane: &mut LivePane,
        picture: &mut Picture,
    ) -> Result<(), String> {
        let own = self.takes.instant(index).and_then(Result::ok);
        let (snapshot, strands) = own.unwrap_or((&request.snapshot, &self.strands));
        let size = [request.width, request.height];
        let gpu = self.renderers.last(index).and_then(|renderer| renderer.gpu().cloned());
        let exact = self.reference.picture(&request.project, snapshot, strands, size, gpu.as_ref())?;
        let is_itself = pane.error == LiveError::Reference
            && pane.contender.transparency == Transparency::Exact
            && *picture == *exact;
        let mean = heat::of_pictures(&exact, largest(request), picture)?;
        pane.flip = (!is_itself).then_some(mean);
        Ok(())
    }
}

/// Why a pane that draws clusters has no errors of transmittance.
const NO_POINTS: &str =
    "Errors of transmittance are measured at the points of strands, and this pane draws clusters.";

/// The value of the last colour.
fn largest(request: &LiveRequest) -> f32 {
    if request.view.largest > 0.0 { request.view.largest } else { 1.0 }
}

/// The error of each strand point, with its sign if it is shown.
fn errors_of(shows: LiveShows, found: &[f32], exact: &[f32]) -> Vec<f32> {
    let signed = shows == LiveShows::TransmittanceBias;
    let difference =
        |(&found, &exact): (&f32, &f32)| if signed { found - exact } else { (found - exact).abs() };
    found.iter().zip(exact).map(difference).collect()
}
