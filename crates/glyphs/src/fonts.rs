//! The fonts of the system, and which of them has a character.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fontdb::{Database, FaceInfo, ID, Source, Style};
use skrifa::{FontRef, GlyphId, MetadataProvider as _};

use crate::script::Script;

/// The largest font file that is read, bytes. The largest known ones have about 120 MiB.
const MAX_BYTES: u64 = 512 << 20;

/// A face of a font file.
pub struct Face {
    /// The family and the name of the face, unique among the faces of [`Fonts`].
    pub name: String,
    /// The whole file.
    pub data: Arc<Vec<u8>>,
    /// The number of the face in the file.
    pub index: u32,
    /// Whether its glyphs are outlines. Those of most colour fonts for emoji are pictures.
    pub has_outlines: bool,
}

impl Face {
    /// The parsed face; `None` if the file is damaged.
    pub(crate) fn font(&self) -> Option<FontRef<'_>> {
        FontRef::from_index(&self.data, self.index).ok()
    }
}

/// Fonts, searched by character.
pub struct Fonts {
    database: Database,
    language: String,
    found: Mutex<Found>,
}

/// What was looked up before.
#[derive(Default)]
struct Found {
    chars: HashMap<char, Option<Arc<Face>>>,
    faces: HashMap<ID, Option<Arc<Face>>>,
    files: HashMap<std::path::PathBuf, Arc<Vec<u8>>>,
    /// Scripts of which a font was found.
    present: BTreeSet<Script>,
    /// Scripts with a character that no font has, and those of them that were not taken yet.
    missing: BTreeSet<Script>,
    untold: BTreeSet<Script>,
}

static SYSTEM: OnceLock<Fonts> = OnceLock::new();

impl Fonts {
    /// The fonts of the system. The first call lists them, which takes up to some tenths of a second.
    pub fn of_system() -> &'static Self {
        SYSTEM.get_or_init(|| {
            let mut database = Database::new();
            database.load_system_fonts();
            Self::new(database)
        })
    }

    /// The fonts of the system if they have been listed.
    pub fn listed() -> Option<&'static Self> {
        SYSTEM.get()
    }

    /// Fonts from a list.
    pub(crate) fn new(database: Database) -> Self {
        let language = ["LC_ALL", "LC_CTYPE", "LANG"]
            .iter()
            .find_map(|name| std::env::var(name).ok().filter(|value| !value.is_empty()));
        Self { database, language: language.unwrap_or_default(), found: Mutex::default() }
    }

    /// The best face that has a character; `None` if no font has it.
    pub fn face_for(&self, c: char) -> Option<Arc<Face>> {
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = found.chars.get(&c) {
            return known.clone();
        }
        let script = Script::of(c);
        // Without a font for one letter of an alphabet there is none for the next: looking through all fonts takes time.
        let is_known_missing =
            script != Script::Other && found.missing.contains(&script) && !found.present.contains(&script);
        let face = if is_known_missing { None } else { self.search(c) };
        let face = face.and_then(|id| self.read(id, &mut found));
        if face.is_some() {
            found.present.insert(script);
        }
        // Control characters and spaces have no glyph in many fonts and need none.
        if face.is_none() && !c.is_control() && !c.is_whitespace() && found.missing.insert(script) {
            found.untold.insert(script);
        }
        found.chars.insert(c, face.clone());
        face
    }

    /// Scripts without a font that were needed since the last call. Each is returned once.
    pub fn take_missing(&self) -> Vec<Script> {
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut found.untold).into_iter().collect()
    }

    /// The best face with a glyph for `c`: by preferred family, then sans serif, upright, and closest to the regular weight.
    fn search(&self, c: char) -> Option<ID> {
        let families = Script::of(c).families(&self.language);
        let rank = |face: &FaceInfo| {
            let family = face.families.first().map_or("", |(name, _)| name.as_str());
            let preferred = families.iter().position(|wanted| family == *wanted).unwrap_or(families.len());
            (
                preferred,
                u8::from(face.style != Style::Normal),
                face.weight.0.abs_diff(400),
                u8::from(!family.contains("Sans")),
                family.to_owned(),
                face.index,
            )
        };
        let mut faces: Vec<_> = self.database.faces().map(|face| (rank(face), face.id)).collect();
        faces.sort();
        faces.into_iter().map(|(_, id)| id).find(|id| {
            let has = |bytes: &[u8], index: u32| {
                let font = FontRef::from_index(bytes, index).ok()?;
                font.charmap().map(c).filter(|glyph| *glyph != GlyphId::NOTDEF)
            };
            self.database.with_face_data(*id, has).flatten().is_some()
        })
    }

    /// Reads the file of a face, once.
    fn read(&self, id: ID, found: &mut Found) -> Option<Arc<Face>> {
        if let Some(face) = found.faces.get(&id) {
            return face.clone();
        }
        let face = self.read_anew(id, found).map(Arc::new);
        found.faces.insert(id, face.clone());
        face
    }

    fn read_anew(&self, id: ID, found: &mut Found) -> Option<Face> {
        let info = self.database.face(id)?;
        let data = match &info.source {
            Source::File(path) | Source::SharedFile(path, _) => {
                if let Some(data) = found.files.get(path) {
                    Arc::clone(data)
                } else {
                    let is_small = std::fs::metadata(path).is_ok_and(|about| about.len() <= MAX_BYTES);
                    let data = Arc::new(is_small.then(|| std::fs::read(path).ok()).flatten()?);
                    found.files.insert(path.clone(), Arc::clone(&data));
                    data
                }
            }
            Source::Binary(data) => Arc::new((**data).as_ref().to_vec()),
        };
        let name = format!("{} {}", info.post_script_name, info.index);
        let mut face = Face { name, data, index: info.index, has_outlines: false };
        let font = face.font()?;
        face.has_outlines = font.outline_glyphs().format().is_some();
        Some(face)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_without_a_font_is_told_once() {
        let fonts = Fonts::new(Database::new());
        assert!(fonts.face_for('あ').is_none() && fonts.face_for('い').is_none());
        assert!(fonts.face_for(' ').is_none() && fonts.face_for('\n').is_none());
        assert_eq!(fonts.take_missing(), [Script::Japanese]);
        assert!(fonts.face_for('う').is_none());
        assert_eq!(fonts.take_missing(), []);
    }

    #[test]
    fn a_damaged_font_has_no_characters() {
        let mut database = Database::new();
        database.load_font_data(vec![7; 300]);
        assert!(Fonts::new(database).face_for('a').is_none());
    }
}
