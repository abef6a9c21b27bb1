//! `cargo xtask pictures`: renders the images of the documents again.
//!
//! Left out are `reference`, which needs the path tracer of `cargo xtask reference`, the three of `satf.md`, whose commands are there
//! and need other files, and `locks`, half of which an earlier version of the solver has drawn.

mod images;
mod recipes;
mod render;
mod window;

use anyhow::{Context as _, ensure};
use image::RgbImage;
use lovelock_xtask::{system, tool};
use recipes::{PORTRAIT, RECIPES, Recipe, Source};
use std::fs;
use std::path::Path;

/// Renders the images whose names start with one of `names`, or all if there are none, and replaces their files in `docs/pictures`.
pub(crate) fn run(names: &[String]) -> anyhow::Result<()> {
    let recipes = chosen(names)?;
    system::prepare()?;
    for recipe in &recipes {
        match recipe.source {
            Source::Window(_) => system::prepare_screen()?,
            Source::Page(_) => system::prepare_browser()?,
            Source::Film { .. } => system::prepare_film()?,
            _ => {}
        }
    }
    for recipe in recipes {
        let folder = tool::target().join("pictures").join(recipe.name);
        if folder.exists() {
            fs::remove_dir_all(&folder).with_context(|| format!("could not empty {}", folder.display()))?;
        }
        fs::create_dir_all(&folder).with_context(|| format!("could not create {}", folder.display()))?;
        let image = make(recipe, &folder).with_context(|| recipe.name.to_owned())?;
        let file = format!("docs/pictures/{}", file_name(recipe));
        let bytes = images::save(&image, &tool::root().join(&file))?;
        println!("{file}: {} x {} pixels, {} KiB", image.width(), image.height(), bytes.div_ceil(1024));
    }
    Ok(())
}

/// The recipes of the images whose names start with one of `names`; all if there are none.
fn chosen(names: &[String]) -> anyhow::Result<Vec<&'static Recipe>> {
    let has = |recipe: &Recipe, name: &String| recipe.name.starts_with(name.as_str());
    for name in names {
        ensure!(
            RECIPES.iter().any(|recipe| has(recipe, name)),
            "NAME: found {name}; must be the start of one of {}",
            RECIPES.iter().map(|recipe| recipe.name).collect::<Vec<_>>().join(", ")
        );
    }
    let is_chosen = |recipe: &Recipe| names.is_empty() || names.iter().any(|name| has(recipe, name));
    Ok(RECIPES.iter().filter(|recipe| is_chosen(recipe)).collect())
}

/// The sides of a portrait, radians from the front: front, half, profile, back, and the other half.
const SIDES: [f32; 5] = [0.0, 0.75, std::f32::consts::FRAC_PI_2, std::f32::consts::PI, -0.75];

/// The name of an image's file.
fn file_name(recipe: &Recipe) -> String {
    let extension = if matches!(recipe.source, Source::Plate) { "png" } else { "jpg" };
    format!("{}.{extension}", recipe.name)
}

/// Makes one image, with other files in `folder`.
fn make(recipe: &Recipe, folder: &Path) -> anyhow::Result<RgbImage> {
    let mut tiles: Vec<(&str, RgbImage)> = Vec::new();
    match recipe.source {
        Source::Window(options) => return window::screenshot(folder, options),
        Source::Page(options) => return render::page(folder, options),
        Source::Frame(options) => return render::frame(folder, None, &[options]),
        Source::Sheet(options) => return render::sheet(folder, options),
        Source::Plate => return render::plate(folder, recipe.name),
        Source::Steps { view, steps } => {
            for step in steps {
                let off: Vec<String> =
                    step.off.iter().map(|layer| format!("--set hair.stack.{layer}.on=false")).collect();
                let mut options = vec![view];
                options.extend(step.options);
                options.extend(off.iter().map(String::as_str));
                tiles.push(("", render::rest(folder, None, &options)?));
            }
        }
        Source::Layers { example, view, labels } => {
            let preset = format!("--preset docs/examples/{example}.lovelockstyle --size 200x240");
            for (&label, layer) in labels.iter().zip(101..) {
                let on = format!("--set hair.stack.{layer}.on=true");
                tiles.push((label, render::rest(folder, None, &[&preset, &on, view])?));
            }
        }
        Source::Rows { view, columns, options } => {
            for (label, options) in options {
                tiles.push((label, render::rest(folder, None, &[view, options])?));
            }
            return images::join_in(columns, &tiles);
        }
        Source::Portraits { figure } => {
            for rig in ["soft-beauty", "three-point", "rim-at-night"] {
                let light = format!("--lights {rig}");
                for azimuth in SIDES {
                    let side = format!("--set camera.azimuth={azimuth}");
                    let options = [figure, PORTRAIT, "--size 180x225", &light, &side];
                    tiles.push(("", render::rest(folder, None, &options)?));
                }
            }
            return images::join_in(SIDES.len(), &tiles);
        }
        Source::Instants { view, columns, secs } => {
            for secs in secs {
                let frame = (secs * 30.0).round() as u32;
                let at = format!("--fps 30 --frames {frame}..{}", frame + 1);
                tiles.push(("", render::frame(folder, None, &[view, PORTRAIT, &at])?));
            }
            return images::join_in(columns, &tiles);
        }
        Source::Strokes { view, counts } => {
            for &count in counts {
                let image = if count == 0 {
                    render::rest(folder, None, &["--preset long", view])?
                } else {
                    let brushed = render::brushed(folder, Some(count))?;
                    render::rest(folder, Some(&brushed), &[view])?
                };
                tiles.push(("", image));
            }
        }
        Source::Dance { view, frames } => {
            let brushed = render::brushed(folder, None)?;
            let dance = "--set motion.source=Clip --set timeline.preroll_secs=2 --fps 2";
            for &frame in frames {
                let at = format!("--frames {frame}..{}", frame + 1);
                tiles.push(("", render::frame(folder, Some(&brushed), &[dance, view, &at])?));
            }
        }
        Source::Film { view, secs } => {
            tiles.extend(render::film(folder, view, secs)?.into_iter().map(|frame| ("", frame)));
        }
    }
    images::join(&tiles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Images that this chore does not make.
    const OTHERS: [&str; 5] =
        ["locks.jpg", "reference.jpg", "satf.jpg", "satf_curls.jpg", "satf_figures.jpg"];

    #[test]
    fn every_image_of_the_documents_has_a_recipe() {
        let folder = tool::root().join("docs/pictures");
        let entries = fs::read_dir(folder).expect("the folder of the images");
        let files: BTreeSet<String> =
            entries.map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned()).collect();
        let mut made: BTreeSet<String> = RECIPES.iter().map(file_name).collect();
        assert_eq!(made.len(), RECIPES.len(), "names differ");
        made.extend(OTHERS.map(str::to_owned));
        assert_eq!(files, made);
    }

    #[test]
    fn a_row_has_one_hairstyle_and_one_size() {
        for recipe in RECIPES {
            let Source::Rows { view, options, .. } = recipe.source else { continue };
            for (label, options) in options {
                let words = || [view, *options].into_iter().flat_map(str::split_whitespace);
                for name in ["--preset", "--size"] {
                    let count = words().filter(|word| *word == name).count();
                    assert_eq!(count, 1, "{}, {label}: {name}", recipe.name);
                }
            }
        }
    }

    #[test]
    fn names_choose_by_their_start() {
        let names = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            chosen(&names).map(|recipes| recipes.iter().map(|recipe| recipe.name).collect::<Vec<_>>())
        };
        assert_eq!(names(&[]).expect("all").len(), RECIPES.len());
        let some = names(&["frame", "compare"]).expect("three");
        assert_eq!(some, ["frame", "compare", "compare_window"]);
        let error = names(&["frame", "sky"]).expect_err("no such image").to_string();
        assert!(error.contains("found sky") && error.contains("styling_bob"), "{error}");
    }
}
