//! Saving the panes as an image file on a background thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use lovelock_panes::request::LivePane;
use lovelock_panes::sheet::Sheet;
use lovelock_record as recording;

use super::costs::Way;
use super::{Compare, grid};
use crate::window::Window;

/// An image that is being written.
pub(super) struct Saving {
    path: PathBuf,
    done: Receiver<Result<(), String>>,
}

impl Compare {
    /// The path of an image that was saved, or the error, once per image.
    pub(crate) fn saved(&mut self) -> Option<Result<PathBuf, String>> {
        let finished = self.saving.iter().enumerate().find_map(|(at, saving)| match saving.done.try_recv() {
            Ok(done) => Some((at, done)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some((at, Err("The image was not saved.".to_owned()))),
        });
        let (at, done) = finished?;
        let path = self.saving.remove(at).path;
        Some(done.map(|()| path))
    }

    /// Starts to write the panes that are on the screen, with their labels.
    fn save(&mut self, sheet: Sheet, panes: &[usize], path: &Path, ctx: &egui::Context) {
        let shown: Vec<(usize, Arc<LivePane>, f64)> = panes
            .iter()
            .filter_map(|&index| {
                let pane = self.panes.get(index)?.clone()?;
                let known = self.costs.of(&pane.contender);
                let ms = known.map_or(pane.times.whole, Way::whole);
                Some((index, pane, ms))
            })
            .collect();
        let whole = sheet.size_of(shown.len(), self.wanted);
        let (sender, done) = sync_channel(1);
        let (to, wake) = (path.to_owned(), ctx.clone());
        let write = move || {
            let panes: Vec<_> = shown.iter().map(|(index, pane, ms)| (*index, &**pane, *ms)).collect();
            let lost = panes.iter().find_map(|(_, pane, _)| pane.image.picture().err());
            let written = if let Some(error) = lost {
                Err(error.to_string())
            } else {
                let picture = sheet.compose(&panes, whole);
                recording::write_png(&to, picture.width, picture.height, &picture.rgba)
                    .map_err(|error| error.to_string())
            };
            let _ = sender.send(written);
            wake.request_repaint();
        };
        let spawned = std::thread::Builder::new().name("save picture".to_owned()).spawn(write);
        // If no thread can be started the channel is closed, which reports the failure.
        drop(spawned);
        self.saving.push(Saving { path: path.to_owned(), done });
    }
}

impl Window {
    /// Starts to write the panes that are on the screen, with their labels.
    pub(in crate::window) fn save_panes(&mut self, path: &Path, ctx: &egui::Context) {
        let layout = &self.layout.compare;
        let panes = layout.visible(self.document.project().compare.panes.len());
        let columns = Some(grid::columns(panes.len(), self.pages.compare.page));
        let sheet = Sheet { columns, ..layout.sheet() };
        self.pages.compare.save(sheet, &panes, path, ctx);
    }

    /// Shows a message that the image of the panes was saved, or why not.
    pub(in crate::window) fn report_saved(&mut self) {
        while let Some(saved) = self.pages.compare.saved() {
            match saved {
                Ok(path) => self.notices.push_written(format!("Saved {}", path.display()), path),
                Err(why) => self.fail(why),
            }
        }
    }
}
