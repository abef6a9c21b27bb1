//! The window on its display: opening it, its graphics device, and opening it again with another device after a loss.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_project::error::ProjectError;
use lovelock_project::project::{PROJECT_EXTENSION, save_project};
use lovelock_session::window_device::WindowDevice;

use super::dock::SecondWindow;
use super::images::{self, Textures};
use super::screenshot::Screenshot;
use super::{LAYOUT_KEY, Window, notices, theme};

/// Environment variable with a number of seconds after which the window's graphics device is destroyed, once, as if it had failed.
const LOSE_DEVICE: &str = "LOVELOCK_LOSE_DEVICE";

/// What the window knows of its display.
pub(super) struct Display {
    /// The graphics device of the window, and its images there.
    device: WindowDevice,
    pub(super) textures: Textures,
    /// The screenshot to take.
    pub(super) screenshot: Option<Screenshot>,
    /// The title that was set last.
    pub(super) title: String,
    /// The second window.
    pub(super) second: SecondWindow,
    /// The context of the window, and its place on the screen, points.
    ctx: Option<egui::Context>,
    place: Option<egui::Rect>,
    /// Whether the window is closed in order to open it with another graphics device.
    pub(super) is_reopening: bool,
    /// Whether the text options, which were changed to redraw all glyphs, must be restored.
    sharpen_text: bool,
    /// For trials without hardware that fails: when the device is taken away, seconds after the window has opened.
    loses_device: Option<(Stopwatch, f64)>,
}

impl Display {
    /// A window that is not open yet.
    pub(super) fn new(device: WindowDevice, textures: Textures) -> Self {
        let secs = std::env::var(LOSE_DEVICE).ok().and_then(|secs| secs.parse().ok());
        Self {
            device,
            textures,
            screenshot: None,
            title: String::new(),
            second: SecondWindow::default(),
            ctx: None,
            place: None,
            is_reopening: false,
            sharpen_text: false,
            loses_device: secs.map(|secs| (Stopwatch::start(), secs)),
        }
    }

    /// The graphics device of the window.
    pub(super) fn device(&self) -> &WindowDevice {
        &self.device
    }
}

/// How often the window is opened again, a second apart, before the program gives up.
const MAX_TRIES: u32 = 10;

/// Opens the window that `make` makes, and again with another graphics device after the one in use was lost, with everything on it.
/// Returns when the user closes it.
///
/// # Errors
/// If the window cannot be opened. If it cannot be opened again, unsaved changes are in the file that the error names.
pub(super) fn run(
    make: impl FnOnce(&eframe::CreationContext) -> Result<Window, ProjectError>,
) -> Result<(), ProjectError> {
    let mut make = Some(make);
    let kept = Kept::default();
    let (mut ctx, mut tries) = (None, 0);
    loop {
        let (kept_here, make) = (Rc::clone(&kept), make.take());
        let place = kept.borrow().as_ref().and_then(|window| window.display.place);
        let opened = eframe::run_native_ext(
            "lovelock",
            native_options(place),
            ctx.take(),
            Box::new(move |creation| {
                let mut window = match (kept_here.take(), make) {
                    (Some(window), _) => window,
                    (None, Some(make)) => make(creation)?,
                    (None, None) => return Err("the state of the window was lost".into()),
                };
                window.attach(creation.wgpu_render_state.as_ref(), &creation.egui_ctx);
                window.tools.pen.listen(creation);
                Ok(Box::new(Opened { window: Some(window), kept: kept_here }))
            }),
        );
        match opened {
            Ok(()) if kept.borrow().is_none() => return Ok(()),
            Ok(()) => tries = 0,
            // A driver that is being replaced has no device for a moment.
            Err(error) if kept.borrow().is_some() && tries < MAX_TRIES => {
                tracing::warn!(%error, "the window could not be opened again");
                tries += 1;
                std::thread::sleep(Duration::from_secs(1));
            }
            Err(error) => {
                let rescued = kept.take().and_then(|window| window.rescue());
                let rescued = rescued.map_or_else(String::new, |path| {
                    format!("; the unsaved project is in {}", path.display())
                });
                return Err(ProjectError::work(format!(
                    "the window could not be opened: {error}{rescued}; without a display use `lovelock record`"
                )));
            }
        }
        // The context is kept too: threads ask it for repaints, and it holds what is unfolded.
        ctx = kept.borrow().as_ref().and_then(|window| window.display.ctx.clone());
    }
}

/// The options of the window, at its old place if it is opened again.
fn native_options(place: Option<egui::Rect>) -> eframe::NativeOptions {
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("Lovelock")
        .with_app_id("lovelock")
        .with_icon(icon())
        .with_inner_size([1440.0, 900.0])
        // Both panels, and the width of another one for the image.
        .with_min_inner_size([960.0, 540.0])
        .with_drag_and_drop(true);
    if let Some(place) = place {
        viewport = viewport.with_position(place.min).with_inner_size(place.size());
    }
    eframe::NativeOptions {
        viewport,
        // Images are already dithered and panels are flat. Without a graphics card every pixel of the window costs time.
        dithering: false,
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: images::device_setup(),
            ..egui_wgpu::WgpuConfiguration::default()
        },
        ..Default::default()
    }
}

/// The picture of the program in lists of windows.
fn icon() -> egui::IconData {
    eframe::icon_data::from_png_bytes(include_bytes!("../../../packaging/icons/256x256/lovelock.png"))
        .unwrap_or_default()
}

/// The window while no graphics device shows it.
type Kept = Rc<RefCell<Option<Window>>>;

/// The window on a graphics device.
struct Opened {
    window: Option<Window>,
    kept: Kept,
}

impl Drop for Opened {
    fn drop(&mut self) {
        if let Some(window) = &mut self.window {
            window.tools.pen.close();
        }
        match self.window.take() {
            Some(window) if window.display.is_reopening => drop(self.kept.replace(Some(window))),
            // After a failure the journal stays.
            Some(mut window) if !std::thread::panicking() => window.end_safety(),
            _ => {}
        }
    }
}

impl eframe::App for Opened {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let Some(window) = &mut self.window else { return };
        // Asked only occasionally: the window may be moved to another display, and some systems respond slowly.
        if ui.ctx().cumulative_frame_nr() % 128 == 1 {
            let display = frame.winit_window().and_then(|window| window.current_monitor());
            if let Some(millihertz) = display.and_then(|display| display.refresh_rate_millihertz()) {
                window.session.set_display_hz(f64::from(millihertz) * 1e-3);
            }
        }
        window.pass_safely(ui);
        window.watch_device(ui.ctx());
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        if let Some(window) = &mut self.window {
            window.tools.pen.hook(ctx, input);
        }
    }

    /// The panels' colour: cleared once instead of painted under each panel, because every pixel of the window costs time without a
    /// graphics card.
    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::panel().to_normalized_gamma_f32()
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if let Some(window) = &self.window {
            eframe::set_value(storage, LAYOUT_KEY, &window.stored_layout());
        }
    }
}

impl Window {
    /// Shows the window with a painter and its graphics device, after a loss with another one than before.
    pub(super) fn attach(&mut self, painter: Option<&egui_wgpu::RenderState>, ctx: &egui::Context) {
        let display = &mut self.display;
        let device = painter.and_then(images::device_of);
        display.textures.attach(painter.cloned().zip(device.clone()));
        display.device.set(device);
        display.ctx = Some(ctx.clone());
        if !std::mem::take(&mut display.is_reopening) {
            return;
        }
        display.title.clear();
        // The glyphs were on the lost device; with other options all are drawn anew.
        set_hinting(ctx, false);
        display.sharpen_text = true;
        self.pages.image.forget_image();
        self.pages.compare.forget_images();
        self.pages.wall.forget_images();
        self.media.thumbnails.forget();
        self.panels.hair.styles.forget_images();
        // A method of the user's own that takes too long would be lost again and again.
        for method in self.document.project().user_methods() {
            method.distrust();
        }
        self.session.draw_again();
        self.notices.push(
            notices::Kind::Warning,
            "The graphics device was lost and reopened. The project is unchanged.".to_owned(),
        );
    }

    /// Writes unsaved changes to a file beside the project, or in the folder of the program's data. Returns its path.
    fn rescue(&self) -> Option<PathBuf> {
        if !self.document.is_modified() {
            return None;
        }
        let path = match self.document.path() {
            Some(path) => path.with_extension(format!("rescued.{PROJECT_EXTENSION}")),
            None => eframe::storage_dir("lovelock")?.join("rescued").with_extension(PROJECT_EXTENSION),
        };
        save_project(&path, self.document.project()).ok().map(|()| path)
    }

    /// Closes the window in order to open it again if its graphics device was lost.
    fn watch_device(&mut self, ctx: &egui::Context) {
        let display = &mut self.display;
        if std::mem::take(&mut display.sharpen_text) {
            set_hinting(ctx, true);
            ctx.request_repaint();
        }
        if let Some(gpu) = display.device.get()
            && display.loses_device.take_if(|(since, secs)| since.secs() > *secs).is_some()
        {
            gpu.device.destroy();
        }
        let lost = display.device.get().is_some_and(|gpu| gpu.is_lost());
        if lost && !display.is_reopening {
            tracing::warn!("the window opens another graphics device");
            display.is_reopening = true;
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let viewport = ctx.input(|input| (input.viewport().outer_rect, input.viewport().inner_rect));
        if let (Some(outer), Some(inner)) = viewport {
            display.place = Some(egui::Rect::from_min_size(outer.min, inner.size()));
        }
    }
}

/// Sets whether glyphs are fitted to pixels.
fn set_hinting(ctx: &egui::Context, hinted: bool) {
    ctx.all_styles_mut(|style| style.visuals.text_options.font_hinting = hinted);
}
