//! `lovelock presets`.

use std::ops::ControlFlow;
use std::path::Path;

use lovelock_jobs::presets::{
    Listed, Portraits, PresetRow, PresetsReport, SheetRequest, SheetRows, every_style, sheet, style_named,
    thumbnail,
};
use lovelock_project::error::ProjectError;
use lovelock_render::Backend;
use lovelock_session::progress::Progress;

use super::args::Presets;
use super::bar::Bar;
use super::output::Output;
use super::replace::{self, Holds};

/// Size of a picture of the sheet if none is given, pixels.
const SIZE: (u32, u32) = (320, 400);

/// Lists hairstyles, and draws a contact sheet or thumbnails of them.
pub(crate) fn run(task: &Presets, output: Output) -> Result<(), ProjectError> {
    let (styles, notes) = if task.preset.is_empty() {
        every_style()
    } else {
        (task.preset.iter().map(|name| style_named(name)).collect::<Result<_, _>>()?, Vec::new())
    };
    if let Some(path) = &task.sheet {
        let replaced = replace::check(path, Holds::IMAGE, task.force)?;
        draw_sheet(task, &styles, path)?;
        replaced.tell();
    }
    if let Some(folder) = &task.thumbnails {
        let names = styles.iter().map(thumbnail_name);
        let replaced = replace::check_in(folder, names, Holds::IMAGE, task.force)?;
        draw_thumbnails(&styles, folder)?;
        replaced.tell();
    }
    let rows = styles.iter().map(|listed| {
        let drawn = task.thumbnails.as_ref().map(|folder| folder.join(thumbnail_name(listed)));
        let kept = || {
            let path = thumbnail::path_in(&thumbnail::cache_folder()?, &listed.style);
            path.is_file().then_some(path)
        };
        PresetRow::new(listed, drawn.or_else(kept).as_deref())
    });
    let report = PresetsReport {
        presets: rows.collect(),
        sheet: task.sheet.as_ref().map(|path| path.display().to_string()),
        notes,
    };
    output.result(&report, || report.to_text())
}

fn draw_sheet(task: &Presets, styles: &[Listed], path: &Path) -> Result<(), ProjectError> {
    let (width, height) = task.size.unwrap_or(SIZE);
    let request = SheetRequest {
        size: [width, height],
        columns: task.columns,
        rows: match (task.dance, task.sides) {
            (Some(count), _) => SheetRows::Dance(count),
            (None, Some(count)) => SheetRows::Sides(count),
            (None, None) => SheetRows::Rest,
        },
        backend: task.backend.unwrap_or_default(),
        change: &|project| project.assign(&task.set),
    };
    let picture = watched(|progress| sheet(styles, &request, progress))?;
    lovelock_record::write_png(path, picture.width, picture.height, &picture.rgba)
        .map_err(|error| ProjectError::output(path, error))
}

fn draw_thumbnails(styles: &[Listed], folder: &Path) -> Result<(), ProjectError> {
    let mut portraits = Portraits::open(Backend::Cpu, thumbnail::SIZE)?;
    let total = styles.len() as u64;
    watched(|progress| {
        for (done, listed) in (0_u64..).zip(styles) {
            let what =
                || Progress::Comparing { what: listed.style.name.clone(), done, total, left_secs: None };
            let file = thumbnail::draw(&mut portraits, &listed.style, &mut |_| progress(what()))?;
            thumbnail::keep(&folder.join(thumbnail_name(listed)), &file)?;
        }
        Ok(())
    })
}

/// The file of a style's thumbnail: its id, without the folder of one's own.
fn thumbnail_name(listed: &Listed) -> String {
    format!("{}.jpg", listed.id.replace('/', "-"))
}

/// Runs work and shows its progress.
fn watched<T>(
    work: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<T, ProjectError>,
) -> Result<T, ProjectError> {
    let mut bar = Bar::new();
    let result = work(&mut |progress| {
        bar.show(&progress);
        ControlFlow::Continue(())
    });
    bar.done();
    result
}
