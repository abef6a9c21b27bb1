//! A contact sheet: a picture of each hairstyle, or a row of pictures, with its name.

use std::ops::ControlFlow;

use lovelock_metrics::{Canvas, Image};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_render::{Backend, Picture};
use lovelock_session::progress::{Progress, report_progress};

use super::Listed;
use super::portrait::{Portraits, Shot};

/// What stands beside each name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetRows {
    /// One picture at rest.
    Rest,
    /// A row of so many pictures at rest, from sides around the head.
    Sides(u32),
    /// A row of so many instants of the dance.
    Dance(u32),
}

/// How a contact sheet is drawn.
pub struct SheetRequest<'a> {
    /// Width and height of a picture, pixels.
    pub size: [u32; 2],
    /// Pictures side by side where each style has one; chosen if none is given.
    pub columns: Option<u32>,
    /// What is shown of each style.
    pub rows: SheetRows,
    /// Backend.
    pub backend: Backend,
    /// Changes the project of each style, for example its light.
    pub change: &'a dyn Fn(&mut Project) -> Result<(), ProjectError>,
}

/// Height of a line with a name, pixels.
const NAME: u32 = 24;
/// Pixels between pictures.
const GAP: u32 = 6;
/// The most pixels along a side of the sheet.
const MAX_SIDE: u32 = 32_768;
/// The most pixels of the sheet.
const MAX_PIXELS: u64 = 200_000_000;
const PAGE: [u8; 3] = [19, 20, 23];
const INK: [u8; 3] = [236, 238, 242];
const QUIET: [u8; 3] = [168, 172, 180];

/// Draws the styles.
///
/// # Errors
/// A sheet that is too large, a style that grows no hair, or [`ProjectError::Cancelled`].
pub fn sheet(
    styles: &[Listed],
    request: &SheetRequest<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Picture, ProjectError> {
    let [width, height] = request.size;
    let shots: Vec<Shot> = match request.rows {
        SheetRows::Rest => vec![Shot::Rest(0.0)],
        SheetRows::Sides(count) => {
            (0..count).map(|i| Shot::Rest(std::f32::consts::TAU * i as f32 / count as f32)).collect()
        }
        SheetRows::Dance(count) => {
            (0..count).map(|i| Shot::Dance((f64::from(i) + 0.5) / f64::from(count))).collect()
        }
    };
    let wide = shots.len() as u32;
    let places = Places::of(styles.len() as u32, wide, request);
    let [whole_width, whole_height] = places.whole()?;
    let mut portraits = Portraits::open(request.backend, request.size)?;
    let mut canvas = Canvas::new(whole_width as usize, whole_height as usize, PAGE);
    for (i, listed) in styles.iter().enumerate() {
        let what = listed.style.name.clone();
        let (done, total) = (i as u64, styles.len() as u64);
        report_progress(progress, Progress::Comparing { what, done, total, left_secs: None })?;
        let mut project = Portraits::project_of(&listed.style);
        (request.change)(&mut project)?;
        let mut access = Access::new();
        if let Some(file) = &project.hair.file {
            access.pick(&file.path);
        }
        portraits = portraits.with_access(access);
        // The steps inside a style are not worth a line each; cancelling is.
        let pictures = portraits.draw(&project, &shots, &mut |step| match step {
            Progress::Loaded { .. } => progress(step),
            _ => progress(Progress::Comparing {
                what: listed.style.name.clone(),
                done,
                total,
                left_secs: None,
            }),
        })?;
        let [x, y] = places.of_style(i as u32);
        for (column, picture) in (0_u32..).zip(&pictures) {
            if let Ok(image) = Image::new(picture.width, picture.height, &picture.rgba) {
                canvas.put((x + column * (width + GAP)) as i32, y as i32, &image);
            }
        }
        let below = (y + height + 4) as i32;
        let room = (wide * (width + GAP)) as usize;
        let name = fitted(&listed.style.name, room);
        canvas.text(x as i32 + 2, below, name, INK);
        let after = Canvas::text_width(name) + 12;
        canvas.text(
            x as i32 + 2 + after as i32,
            below,
            fitted(&listed.id, room.saturating_sub(after)),
            QUIET,
        );
    }
    let (width, height) = (canvas.width() as u32, canvas.height() as u32);
    Ok(Picture { width, height, rgba: canvas.into_rgba() })
}

/// Where the pictures of each style are.
struct Places {
    styles: u32,
    /// Styles side by side.
    columns: u32,
    /// Width and height of a style with its name and the gaps, pixels.
    each: [u32; 2],
}

impl Places {
    fn of(styles: u32, wide: u32, request: &SheetRequest<'_>) -> Self {
        let chosen = if wide > 1 { 1 } else { (f64::from(styles) * 1.6).sqrt().ceil() as u32 };
        let columns = request.columns.unwrap_or(chosen).clamp(1, styles.max(1));
        let [width, height] = request.size;
        let each =
            [width.saturating_add(GAP).saturating_mul(wide), height.saturating_add(NAME).saturating_add(GAP)];
        Self { styles, columns, each }
    }

    fn whole(&self) -> Result<[u32; 2], ProjectError> {
        let rows = self.styles.div_ceil(self.columns).max(1);
        let [width, height] = [self.each[0].saturating_mul(self.columns), self.each[1].saturating_mul(rows)]
            .map(|side| side.saturating_add(GAP));
        if width.max(height) > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(ProjectError::option(format!(
                "--sheet: would have {width}x{height} pixels; must be at most {MAX_SIDE} a side and {} million in all: \
                 take a smaller --size or fewer styles",
                MAX_PIXELS / 1_000_000
            )));
        }
        Ok([width, height])
    }

    fn of_style(&self, i: u32) -> [u32; 2] {
        [GAP + i % self.columns * self.each[0], GAP + i / self.columns * self.each[1]]
    }
}

/// The start of a text that fits into `room` pixels.
fn fitted(text: &str, room: usize) -> &str {
    let letter = Canvas::text_width("0").max(1);
    text.char_indices().nth(room / letter).map_or(text, |(end, _)| &text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(styles: u32, wide: u32, size: [u32; 2], columns: Option<u32>) -> Places {
        let request =
            SheetRequest { size, columns, rows: SheetRows::Rest, backend: Backend::Cpu, change: &|_| Ok(()) };
        Places::of(styles, wide, &request)
    }

    #[test]
    fn styles_do_not_overlap_and_fit_into_the_sheet() {
        for (styles, wide, columns) in [(1, 1, None), (7, 1, None), (22, 1, Some(4)), (3, 6, None)] {
            let places = places(styles, wide, [100, 50], columns);
            let whole = places.whole().expect("a size");
            let mut seen = std::collections::BTreeSet::new();
            for at in (0..styles).map(|i| places.of_style(i)) {
                assert!(seen.insert(at), "{at:?} twice");
                assert!(at[0] + wide * (100 + GAP) <= whole[0] && at[1] + 50 + NAME <= whole[1], "{at:?}");
            }
        }
        assert!(places(9, 1, [u32::MAX, 9], None).whole().is_err());
        assert!(places(4000, 1, [320, 400], None).whole().is_err(), "too many pixels");
    }
}
