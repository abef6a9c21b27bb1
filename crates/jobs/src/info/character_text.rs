//! The description of a character as text for people.

use std::fmt;

use lovelock_base::words::counted;
use lovelock_motion::{CharacterInfo, ClipInfo, MaterialInfo};

use super::lines::{line, remarks};

/// Materials, textures, morph targets and expressions that are listed individually.
const MAX_LISTED: usize = 16;

pub(super) fn write(f: &mut fmt::Formatter<'_>, character: &CharacterInfo) -> fmt::Result {
    line(f, "kind", format_args!("character, {}", character.format))?;
    line(f, "height", format_args!("{:.2} m", character.height_m))?;
    let skins = counted(character.skins, "skin", "skins");
    line(f, "joints", format_args!("{}, {skins}", character.joints))?;
    line(f, "head", &character.head)?;
    let vertices = counted(character.vertices, "vertex", "vertices");
    let triangles = counted(character.triangles, "triangle", "triangles");
    line(f, "surface", format_args!("{vertices}, {triangles}"))?;
    if character.morph_targets > 0 {
        let names = listed(character.morph_target_names.iter().map(|name| named(name).to_owned()));
        line(f, "morphs", format_args!("{}: {names}", character.morph_targets))?;
    }
    if !character.expressions.is_empty() {
        let names = listed(character.expressions.iter().map(|expression| match &expression.preset {
            Some(preset) if *preset != expression.name => format!("{} ({preset})", named(&expression.name)),
            _ => named(&expression.name).to_owned(),
        }));
        line(
            f,
            "face",
            format_args!("{}: {names}", counted(character.expressions.len(), "expression", "expressions")),
        )?;
    }
    for material in character.materials.iter().take(MAX_LISTED) {
        line(f, "material", material_text(character, material))?;
    }
    more(f, character.materials.len())?;
    for texture in character.textures.iter().take(MAX_LISTED) {
        let (width, height) = (texture.width, texture.height);
        line(f, "texture", format_args!("{}, {width} x {height} pixels", named(&texture.name)))?;
    }
    more(f, character.textures.len())?;
    for clip in &character.clips {
        line(f, "clip", clip_text(clip))?;
    }
    remarks(f, &character.dropped, &character.notes)
}

fn material_text(character: &CharacterInfo, material: &MaterialInfo) -> String {
    let mut words = vec![material.region.clone()];
    if material.shading != "lit" {
        words.push(material.shading.clone());
    }
    match (material.alpha.as_str(), material.alpha_cutoff) {
        ("mask", Some(cutoff)) => words.push(format!("mask from {cutoff}")),
        ("blend", _) => words.push("blended".to_owned()),
        _ => {}
    }
    if material.double_sided {
        words.push("double-sided".to_owned());
    }
    words.push(counted(material.triangles, "triangle", "triangles"));
    for of in &material.textures {
        let name = character.textures.get(of.texture).map_or("", |texture| texture.name.as_str());
        words.push(format!("{} of {}", of.gives, named(name)));
    }
    format!("{}: {}", named(&material.name), words.join(", "))
}

fn clip_text(clip: &ClipInfo) -> String {
    let loops = if clip.loops { ", loops" } else { ", its end is blended while it loops" };
    let (name, secs, start, end) = (named(&clip.name), clip.duration_secs, clip.start_secs, clip.end_secs);
    format!("{name}, {secs:.2} s from {start:.2} s to {end:.2} s{loops}")
}

/// A name, or words in its place.
fn named(name: &str) -> &str {
    if name.is_empty() { "(no name)" } else { name }
}

/// The first names, and the number of the others.
fn listed(names: impl ExactSizeIterator<Item = String>) -> String {
    let others = names.len().saturating_sub(MAX_LISTED);
    let mut names: Vec<String> = names.take(MAX_LISTED).collect();
    if others > 0 {
        names.push(format!("and {others} more"));
    }
    names.join(", ")
}

fn more(f: &mut fmt::Formatter<'_>, all: usize) -> fmt::Result {
    match all.saturating_sub(MAX_LISTED) {
        0 => Ok(()),
        others => line(f, "", format_args!("and {others} more; --json has them all")),
    }
}
