//! Descriptions as text for people.

use std::fmt;

use lovelock_motion::MotionInfo;

use super::character_text;
use super::lines::{line, remarks};
use super::{Content, Info};
use crate::satf::DatabaseInfo;

/// Number of changes of a take's guides that are listed individually.
const MAX_REGROWN: usize = 8;

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.file)?;
        match &self.content {
            Content::Hair(hair) => {
                line(f, "kind", format_args!("hair, {}", hair.format))?;
                line(f, "strands", hair.strands)?;
                line(f, "points", hair.points)?;
                line(f, "segments", hair.segments)?;
                let size = hair.bounds_m.size();
                line(f, "size", format_args!("{:.3} x {:.3} x {:.3} m", size.x, size.y, size.z))?;
                let guessed = if hair.unit_guessed { " (guessed)" } else { "" };
                line(f, "unit", format_args!("{}{guessed}, {} m", hair.unit, hair.metres_per_unit))?;
                let sure = |confidence: f32| match confidence {
                    1.0.. => String::new(),
                    _ => format!(" (guessed, {:.0} %)", 100.0 * confidence.min(0.99)),
                };
                let (up, facing) = (sure(hair.up_confidence), sure(hair.facing_confidence));
                line(f, "up, face", format_args!("{}{up}, {}{facing}", hair.up, hair.facing))?;
                remarks(f, &hair.dropped, &hair.notes)
            }
            Content::Character(character) => character_text::write(f, character),
            Content::Motion(motion) => {
                line(f, "kind", format_args!("motion, {}", motion.format))?;
                line(f, "joints", motion.joints)?;
                line(f, "keys", keys_of(motion))?;
                let (start, end) = (motion.start_secs, motion.end_secs);
                line(f, "time", format_args!("{:.2} s, from {start:.2} s to {end:.2} s", end - start))?;
                if motion.frames > 1 {
                    let ends = if motion.loops {
                        "repeats without a jump"
                    } else {
                        "the last pose is not the first; the end is blended into the first pose while it loops"
                    };
                    line(f, "loop", ends)?;
                }
                line(f, "unit", format_args!("{} m", motion.unit_metres))?;
                line(f, "height", format_args!("{:.2} m", motion.height_m))?;
                remarks(f, &motion.dropped, &motion.notes)
            }
            Content::Project(project) => {
                line(f, "kind", &project.format)?;
                line(f, "body", &project.body)?;
                line(f, "motion", &project.motion)?;
                line(f, "hair", &project.hair)?;
                line(f, "shadow", &project.shadow)?;
                line(f, "lights", project.lights)?;
                if let Some(surroundings) = &project.surroundings {
                    line(f, "surround", surroundings)?;
                }
                if let Some(sound) = &project.sound {
                    line(f, "sound", sound)?;
                }
                line(
                    f,
                    "film",
                    format_args!("{}x{} at {} per second", project.width, project.height, project.fps),
                )?;
                remarks(f, &project.dropped, &project.notes)
            }
            Content::Style(style) => {
                line(f, "kind", &style.format)?;
                line(f, "name", &style.name)?;
                if !style.text.is_empty() {
                    line(f, "about", &style.text)?;
                }
                if !style.tags.is_empty() {
                    line(f, "tags", style.tags.join(", "))?;
                }
                match style.strands {
                    Some(strands) => line(f, "strands", strands)?,
                    None => line(f, "strands", "those of a hair file")?,
                }
                line(f, "layers", style.layers.join(", "))?;
                remarks(f, &style.dropped, &style.notes)
            }
            Content::Strokes(strokes) => {
                line(f, "kind", &strokes.format)?;
                line(f, "strokes", format_args!("{}, {} samples", strokes.strokes, strokes.samples))?;
                if !strokes.tools.is_empty() {
                    line(f, "tools", strokes.tools.join(", "))?;
                }
                if let (Some(start), Some(end)) = (strokes.start_secs, strokes.end_secs) {
                    line(f, "time", format_args!("{start:.2} s to {end:.2} s of the dance"))?;
                }
                remarks(f, &strokes.dropped, &strokes.notes)
            }
            Content::Surroundings(picture) => {
                line(f, "kind", format_args!("surroundings, {}", picture.format))?;
                line(f, "size", format_args!("{} x {} pixels", picture.width, picture.height))?;
                let [r, g, b] = picture.mean;
                line(f, "mean", format_args!("{r:.3}, {g:.3}, {b:.3}"))?;
                match &picture.strongest {
                    Some(light) => {
                        let [x, y, z] = light.direction;
                        line(f, "strongest", format_args!("from {x:.2}, {y:.2}, {z:.2}"))?;
                    }
                    None => line(f, "strongest", "no direction stands out")?,
                }
                remarks(f, &picture.dropped, &picture.notes)
            }
            Content::Sound(sound) => {
                line(f, "kind", format_args!("sound, {}", sound.format))?;
                line(f, "duration", format_args!("{:.2} s", sound.duration_secs))?;
                line(f, "samples", format_args!("{} per second, {} channels", sound.rate, sound.channels))?;
                let tempo = sound.tempo.map_or_else(
                    || "no regular beat".to_owned(),
                    |tempo| format!("{tempo:.1} beats per minute, {} beats", sound.beats),
                );
                line(f, "tempo", tempo)?;
                remarks(f, &sound.dropped, &sound.notes)
            }
            Content::HairClusters(database) => {
                line(f, "kind", format_args!("database of hair clusters, {}", database.format))?;
                let DatabaseInfo { sectors, azimuths, texels, .. } = database;
                line(f, "records", format_args!("{sectors} sectors, {azimuths} azimuths, {texels} texels"))?;
                line(f, "size", format_args!("{} bytes, checksum {}", database.bytes, database.checksum))?;
                remarks(f, &database.dropped, &database.notes)
            }
            Content::Take(take) => {
                line(f, "kind", &take.format)?;
                line(
                    f,
                    "frames",
                    format_args!("{} at {} per second, {:.2} s", take.frames, take.fps, take.duration_secs),
                )?;
                line(f, "guides", format_args!("{} of {} points", take.guides, take.points_per_guide))?;
                for regrown in take.regrown.iter().take(MAX_REGROWN) {
                    let (guides, points) = (regrown.guides, regrown.points_per_guide);
                    line(f, "", format_args!("{guides} of {points} points from frame {}", regrown.frame))?;
                }
                if let Some(more @ 1..) = take.regrown.len().checked_sub(MAX_REGROWN) {
                    line(f, "", format_args!("and {more} times more; --json has them all"))?;
                }
                line(f, "strands", take.strands)?;
                if !take.clip.is_empty() {
                    line(f, "clip", &take.clip)?;
                }
                line(f, "program", &take.program)?;
                let rate = take.bytes as f64 / 1e6 / take.duration_secs.max(1e-9);
                line(f, "size", format_args!("{} bytes, {rate:.2} MB per second", take.bytes))?;
                line(f, "condition", &take.condition)?;
                remarks(f, &take.dropped, &[])
            }
        }
    }
}

/// The keys of a motion file and their distance.
fn keys_of(motion: &MotionInfo) -> String {
    let keys = motion.keys;
    let lasts = motion.end_secs - motion.start_secs;
    match motion.key_secs {
        _ if keys < 2 => keys.to_string(),
        Some(secs) if (lasts / secs).round() as usize + 1 == keys => format!("{keys}, one every {secs:.5} s"),
        Some(secs) => format!("{keys}, at multiples of {secs:.5} s"),
        None => format!("{keys}, at uneven times"),
    }
}
