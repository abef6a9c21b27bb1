//! Films of the compared frames: panes with the errors of every frame below, and the error maps of every frame.

use std::sync::Arc;

use lovelock_project::error::ProjectError;
use lovelock_project::project::{CompareSection, Contender};
use lovelock_record::{PictureSink, SinkSettings};
use lovelock_render::{Picture, Renderer, ValueRenderer};

use super::entrants::file_name;
use super::hair::Hair;
use super::maps::{self, at_pixels};
use super::sheet::{Pane, Sheet};
use super::stability::Film;
use super::work::{CheckCancel, Work};
use crate::report::{CompareReport, FilmFile};

/// An entrant with errors of every frame.
pub(super) struct Played {
    /// Its place among the methods of the report.
    pub at: usize,
    pub contender: Contender,
    /// The number of its ground truth.
    pub truth: usize,
}

/// The two films of up to nine panes: images, and errors of transmittance.
struct Films<'a> {
    played: &'a [Played],
    sheet: Sheet,
    sinks: [PictureSink; 2],
}

/// What the films show, in the report and in the names of their files.
const SHOWS: [(&str, &str); 2] = [("picture", "pictures"), (maps::TRANSMITTANCE_ERROR.id, "errors")];

impl Work<'_> {
    /// Draws every frame by every entrant and writes the films and the error maps. `check_cancel` is called before each image.
    ///
    /// # Errors
    /// As drawing, if a file cannot be written, or the error of `check_cancel`.
    pub(super) fn films(
        &self,
        film: &Film,
        played: &[Played],
        renderers: &mut [Renderer],
        report: &mut CompareReport,
        check_cancel: &mut CheckCancel,
    ) -> Result<(), ProjectError> {
        let mut values = ValueRenderer::default();
        for (number, panes) in played.chunks(CompareSection::MAX_PANES).enumerate() {
            let names = SHOWS.map(|(_, name)| match number {
                0 => format!("{name}.mp4"),
                more => format!("{name}-{}.mp4", more + 1),
            });
            let mut films = self.begin_films(panes, report, &names)?;
            for (frame, snapshot) in film.snapshots().iter().enumerate() {
                let hair = Hair::new(Arc::clone(snapshot), self.project);
                let mut drawn = [Vec::new(), Vec::new()];
                for pane in panes {
                    check_cancel()?;
                    let truth = film.truth(pane.truth, frame);
                    let found = self.pane(
                        pane,
                        (&hair, frame, truth),
                        &films.sheet,
                        renderers,
                        (&mut values, &mut *report),
                    )?;
                    for (to, picture) in drawn.iter_mut().zip(found) {
                        to.push(picture);
                    }
                }
                films
                    .push(frame, &drawn)
                    .map_err(|error| ProjectError::output(&self.folder.path_of(&names[0]), error))?;
            }
            films.finish().map_err(|error| ProjectError::output(&self.folder.path_of(&names[0]), error))?;
            let methods: Vec<String> =
                panes.iter().map(|pane| report.methods[pane.at].name.clone()).collect();
            report.films.extend(SHOWS.into_iter().zip(names).map(|((shows, _), file)| FilmFile {
                file,
                shows: shows.to_owned(),
                methods: methods.clone(),
            }));
            self.folder.report(report)?;
        }
        Ok(())
    }

    fn begin_films<'a>(
        &self,
        played: &'a [Played],
        report: &CompareReport,
        names: &[String; 2],
    ) -> Result<Films<'a>, ProjectError> {
        let of = |pane: &Played| {
            let method = &report.methods[pane.at];
            Pane {
                name: method.name.clone(),
                errors: method.frame_errors.iter().map(|error| error.rmse).collect(),
            }
        };
        let sheet = Sheet::new(played.iter().map(of).collect(), self.size, report.frames[0]);
        let [width, height] = sheet.size();
        let [first, end] = report.frames;
        let settings = SinkSettings {
            first_frame: first,
            frames: end - first,
            ..SinkSettings::new(width, height, report.scene.fps)
        };
        let [pictures, errors] = names;
        let sinks = [self.folder.film(pictures, settings.clone())?, self.folder.film(errors, settings)?];
        Ok(Films { played, sheet, sinks })
    }

    /// The image and the error map of one entrant in one frame, of the size of a pane. The whole error map is written.
    fn pane(
        &self,
        pane: &Played,
        (hair, frame, truth): (&Hair, usize, Option<&[f32]>),
        sheet: &Sheet,
        renderers: &mut [Renderer],
        (values, report): (&mut ValueRenderer, &mut CompareReport),
    ) -> Result<[Picture; 2], ProjectError> {
        let project = pane.contender.applied_to(self.project);
        let input = hair.frame_input(&project);
        let [width, height] = sheet.pane();
        let mut picture = Picture::default();
        let renderer = renderers.iter_mut().find(|open| open.backend() == pane.contender.backend);
        let Some(renderer) = renderer else { return Ok([picture.clone(), picture]) };
        renderer.picture(&input, width, height, &mut picture)?;
        let found = renderer.transmittance(0)?;
        let Some(truth) = truth else { return Ok([picture, Picture::default()]) };
        let error: Vec<f32> = found.iter().zip(truth).map(|(test, truth)| test - truth).collect();
        let kind = maps::TRANSMITTANCE_ERROR;
        let whole = at_pixels(values, &input, &error, self.size)?;
        let method = &mut report.methods[pane.at];
        let place = (file_name(&method.name), report.frames[0] + frame as u64);
        if let Some((width, height, rgba)) = kind.painted(self.size[0], self.size[1], &whole) {
            let folder = self.folder.frame((&place.0, place.1), (width, height, &rgba))?;
            method.files.error_frames = Some(folder);
        }
        let small = at_pixels(values, &input, &error, [width, height])?;
        Ok([picture, Picture { width, height, rgba: kind.colours(&small) }])
    }
}

impl Films<'_> {
    /// Adds a frame with the panes of each film.
    fn push(&mut self, frame: usize, drawn: &[Vec<Picture>; 2]) -> Result<(), lovelock_record::RecordError> {
        for (at, (sink, drawn)) in self.sinks.iter_mut().zip(drawn).enumerate() {
            let scale = (at == 1).then(|| maps::TRANSMITTANCE_ERROR.scale());
            sink.push(self.sheet.compose(frame, drawn, scale.as_ref()).rgba())?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), lovelock_record::RecordError> {
        debug_assert!(!self.played.is_empty());
        self.sinks.into_iter().try_for_each(|sink| sink.finish().map(|_| ()))
    }
}
