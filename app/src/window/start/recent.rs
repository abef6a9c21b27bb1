//! A project that was used before, with its picture and its time.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

use egui::{
    Context, Rect, RichText, Sense, TextStyle, TextWrapMode, TextureHandle, Ui, WidgetInfo, WidgetText, vec2,
};
use lovelock_project::files::write_whole;
use lovelock_project::journal::Picture;

use super::card;
use crate::window::control::HoverTooltip;
use crate::window::safety::ago::ago;
use crate::window::theme;

/// The most that are shown.
pub(super) const SHOWN: usize = 6;
/// Size of a picture, points.
const PICTURE: egui::Vec2 = vec2(64.0, 44.0);
/// The largest file of a picture, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A recent project.
pub(super) struct Recent {
    pub(super) path: PathBuf,
    name: String,
    /// When it was saved, or that it is gone.
    when: String,
    exists: bool,
    picture: Option<TextureHandle>,
}

impl Recent {
    /// That of the file at `path`.
    pub(super) fn of(path: &Path, ctx: &Context) -> Self {
        let about = std::fs::metadata(path);
        let when = match &about {
            Ok(about) => {
                about.modified().map_or_else(|_| String::new(), |time| format!("Saved {}", ago(time)))
            }
            Err(_) => "The file is no longer there".to_owned(),
        };
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let picture = picture_file(path).and_then(|file| {
            let is_small = std::fs::metadata(&file).is_ok_and(|about| about.len() <= MAX_BYTES);
            card::texture(ctx, "recent", &is_small.then(|| std::fs::read(&file).ok()).flatten()?)
        });
        Self { path: path.to_owned(), name, when, exists: about.is_ok(), picture }
    }

    /// Shows it. Returns whether it was chosen.
    pub(super) fn show(&self, ui: &mut Ui) -> bool {
        let size = vec2(ui.available_width(), PICTURE.y + 10.0);
        ui.add_enabled_ui(self.exists, |ui| {
            let (rect, response) = ui.allocate_exact_size(size, Sense::click());
            let spoken = format!("Open {}. {}", self.name, self.when);
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, self.exists, &spoken));
            card::frame(ui, rect, &response);
            let picture = Rect::from_min_size(rect.min + egui::Vec2::splat(5.0), PICTURE);
            card::fill(ui, picture, self.picture.as_ref());
            let at = picture.right_top() + vec2(8.0, 4.0);
            let wrap = rect.right() - at.x - 6.0;
            let name = lovelock_glyphs::visual_words(&self.name);
            let lines = [
                (RichText::new(name).strong(), theme::bright()),
                (RichText::new(&self.when).small(), theme::quiet()),
            ];
            for (row, (text, color)) in lines.into_iter().enumerate() {
                let galley = WidgetText::from(text.color(color)).into_galley(
                    ui,
                    Some(TextWrapMode::Truncate),
                    wrap,
                    TextStyle::Body,
                );
                ui.painter().galley(at + vec2(0.0, 18.0 * row as f32), galley, color);
            }
            response.hover_tooltip(self.path.display().to_string()).clicked()
        })
        .inner
    }
}

/// The file of the picture of a project.
fn picture_file(project: &Path) -> Option<PathBuf> {
    let mut hasher = DefaultHasher::new();
    project.hash(&mut hasher);
    Some(eframe::storage_dir("lovelock")?.join("recent").join(format!("{:016x}.png", hasher.finish())))
}

/// Keeps the picture of a project, beside the window.
pub(super) fn keep_picture(project: &Path, picture: Picture) {
    let Some(file) = picture_file(project) else { return };
    let write = move || {
        let Picture { width, height, rgba } = picture;
        let Some(image) = image::RgbaImage::from_raw(width, height, rgba) else { return };
        let mut png = std::io::Cursor::new(Vec::new());
        let made = file.parent().is_some_and(|folder| std::fs::create_dir_all(folder).is_ok());
        if made && image.write_to(&mut png, image::ImageFormat::Png).is_ok() {
            // A list without a picture is no loss.
            let _ = write_whole(&file, &png.into_inner());
        }
    };
    let _ = std::thread::Builder::new().name("recent picture".to_owned()).spawn(write);
}
