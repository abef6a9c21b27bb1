//! Screenshots of the window, for documents.

use std::path::PathBuf;

use egui::ViewportCommand;
use lovelock_base::clock::Stopwatch;
use lovelock_record as recording;

/// Takes a screenshot some seconds after the first hair is on the screen, and closes the window.
pub(crate) struct Screenshot {
    out: Option<PathBuf>,
    after_secs: f64,
    since: Option<Stopwatch>,
}

impl Screenshot {
    /// A screenshot that is saved as `out`.
    pub(crate) fn new(out: PathBuf, after_secs: f64) -> Self {
        Self { out: Some(out), after_secs, since: None }
    }

    /// Must be called once per pass; `ready` says whether hair is on the screen.
    pub(crate) fn update(&mut self, ctx: &egui::Context, ready: bool) {
        if ready && self.since.is_none() {
            self.since = Some(Stopwatch::start());
        }
        let due = self.since.is_some_and(|since| since.secs() >= self.after_secs);
        if let Some(out) = self.out.take_if(|_| due) {
            let closing = ctx.clone();
            ctx.request_screenshot(move |image| {
                let [width, height] = image.size.map(|side| side as u32);
                let rgba: Vec<u8> = image.pixels.iter().flat_map(egui::Color32::to_array).collect();
                if let Err(error) = recording::write_png(&out, width, height, &rgba) {
                    eprintln!("lovelock: {error}");
                }
                closing.send_viewport_cmd(ViewportCommand::Close);
            });
        }
        ctx.request_repaint_after(std::time::Duration::from_millis(200));
    }
}
