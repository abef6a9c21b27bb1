//! The table of hair formats, and reading a file in any of them.

use std::path::Path;

use lovelock_base::watch::Watch;

use super::clean::clean;
use super::file::HairFile;
use super::format::HairFormat;
use super::source::Source;
use super::{HairFileError, alembic, gltf, headless, numpy, obj, pbrt, ply, tressfx, usc, usd, yuksel};

/// Every hair format that can be read. A new format is a file or folder beside this one, and an entry here.
pub static HAIR_FORMATS: [&HairFormat; 14] = [
    &yuksel::FORMAT,
    &tressfx::FORMAT,
    &usd::FORMAT,
    &alembic::FORMAT,
    &gltf::BINARY,
    &gltf::TEXT,
    &obj::FORMAT,
    &pbrt::FORMAT,
    &ply::FORMAT,
    &numpy::ARRAY,
    &numpy::ARCHIVE,
    &headless::FORMAT,
    &usc::FORMAT,
    &usc::BIN,
];

impl HairFormat {
    /// The format whose files have the extension of `path`, in any case. Of several, it is the most common one.
    pub fn of_path(path: &Path) -> Option<&'static Self> {
        Self::named(path).next()
    }

    /// The formats whose files have the extension of `path`.
    fn named(path: &Path) -> impl Iterator<Item = &'static Self> + use<> {
        let extension =
            path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        HAIR_FORMATS.into_iter().filter(move |format| {
            extension.as_ref().is_some_and(|extension| format.extensions.contains(&extension.as_str()))
        })
    }

    /// The format of a file that begins with `start`, if these bytes are unambiguous. TressFX files have no magic number.
    pub fn of_magic(start: &[u8]) -> Option<&'static Self> {
        HAIR_FORMATS.into_iter().find(|format| format.magics.iter().any(|magic| start.starts_with(magic)))
    }

    /// The format of a hair file of this name that begins with `start`. Where the start fits several formats, the name
    /// decides. A format that the start fits by chance comes last.
    fn of_start(name: &str, start: &[u8]) -> Option<&'static Self> {
        let fits = |format: &&'static Self| (format.may_begin)(start);
        let is_sure = |format: &&'static Self| fits(format) && !format.by_chance;
        let by_name = || Self::named(Path::new(name));
        Self::of_magic(start)
            .or_else(|| by_name().find(is_sure))
            .or_else(|| HAIR_FORMATS.into_iter().find(is_sure))
            .or_else(|| by_name().find(fits))
            .or_else(|| HAIR_FORMATS.into_iter().find(fits))
    }

    /// The extensions of all formats, without the dot.
    pub fn all_extensions() -> Vec<&'static str> {
        let mut all: Vec<&str> = Vec::new();
        for &extension in HAIR_FORMATS.into_iter().flat_map(|format| format.extensions) {
            if !all.contains(&extension) {
                all.push(extension);
            }
        }
        all
    }
}

/// The first bytes of a file compressed by gzip.
const GZIP: &[u8] = b"\x1f\x8b";

/// Reads a hair file. The format is recognised by the content, not by the name.
///
/// # Errors
/// The file cannot be read, has no known format, contradicts itself, ends early, or holds no strand that can be
/// drawn. Memory is allocated only after the counts in the file have been compared with its size.
pub fn load_hair(path: &Path) -> Result<HairFile, HairFileError> {
    load_hair_watched(path, false, &Watch::default())
}

/// As [`load_hair`]; with `include_hidden` strands that the file hides are read, too. Reports to `watch`, and stops when it says so.
///
/// # Errors
/// As [`load_hair`], and if the load is cancelled.
pub fn load_hair_watched(
    path: &Path,
    include_hidden: bool,
    watch: &Watch,
) -> Result<HairFile, HairFileError> {
    let name = path.display().to_string();
    // The start is checked before the rest is read, so that a film dropped by mistake is refused at once.
    let source = Source::open_watched(&name, path, watch)?;
    load(&name, source, include_hidden)
}

/// Reads a hair file that is in memory; `name` is for messages.
///
/// # Errors
/// As [`load_hair`], except for reading.
pub fn load_hair_bytes(name: &str, data: &[u8]) -> Result<HairFile, HairFileError> {
    load(name, Source::Memory(data), false)
}

fn load(name: &str, source: Source<'_>, include_hidden: bool) -> Result<HairFile, HairFileError> {
    let start = source.start();
    if start.starts_with(GZIP)
        && let Some(extension) = packed_extension(name)
    {
        return Err(HairFileError::Malformed {
            name: name.to_owned(),
            offset: 0,
            found: "a file compressed by gzip".to_owned(),
            wanted: format!("unpacked to a .{extension} file; only .pbrt files are read compressed"),
        });
    }
    let Some(format) = HairFormat::of_start(name, start) else {
        return Err(unknown(name, start));
    };
    let mut named = HairFormat::named(Path::new(name)).peekable();
    if format.by_chance && named.peek().is_some() && named.all(|named| named != format) {
        let start = start[..start.len().min(4)].to_vec();
        let data = source.into_bytes(name)?;
        return match (format.read)(name, Source::Memory(&data)) {
            Ok(raw) => clean(name, format, raw.settled(name, include_hidden)?),
            // What is said of another format than that of the name would mislead.
            Err(_) => Err(unknown(name, &start)),
        };
    }
    clean(name, format, (format.read)(name, source)?.settled(name, include_hidden)?)
}

/// The extension of a hair format other than pbrt, before that of a compression, such as in `a.obj.gz`.
fn packed_extension(name: &str) -> Option<String> {
    let path = Path::new(name);
    let is_packed = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let inner = if is_packed { Path::new(path.file_stem()?) } else { path };
    HairFormat::of_path(inner).filter(|format| **format != pbrt::FORMAT)?;
    inner.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase())
}

/// The error for a file whose start fits no format, or not one of its name.
fn unknown(name: &str, start: &[u8]) -> HairFileError {
    let found = match start.first_chunk::<4>() {
        Some(start) => format!("`{}`", start.escape_ascii()),
        None => format!("a file of {} bytes", start.len()),
    };
    let mut said: Vec<&str> = HairFormat::named(Path::new(name)).map(|format| format.signature).collect();
    if said.is_empty() {
        said = HAIR_FORMATS.map(|format| format.signature).to_vec();
    }
    let wanted = match &said[..] {
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{}, or {last}", first.join(", ")),
        [] => String::new(),
    };
    HairFileError::Malformed { name: name.to_owned(), offset: 0, found, wanted }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{HAIR_FORMATS, HairFormat};
    use crate::{Facing, HairFile, ImportSettings, Unit, UpAxis, load_hair_bytes};

    /// Two strands of three points, metres, Y up.
    fn hair() -> HairFile {
        let text = "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{\n\
            uniform token type = \"linear\"\nint[] curveVertexCounts = [3, 3]\n\
            point3f[] points = [(0, 0.1, 0.01), (0, 0.2, 0), (0, 0.3, 0), (0.1, 0, 0), (0.2, 0, 0.05), (0.3, 0, 0)]\n\
            float[] widths = [1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4]\n}\n";
        load_hair_bytes("a.usda", text.as_bytes()).expect("hair")
    }

    fn write(extension: &str, hair: &HairFile) -> Result<Vec<u8>, String> {
        let format = HairFormat::of_path(Path::new("a").with_extension(extension).as_path());
        let write = format.and_then(|format| format.write).expect("a format that is written");
        write(hair)
    }

    #[test]
    fn written_files_come_back() {
        let settings = |unit, up, facing| ImportSettings { unit, up, facing, ..ImportSettings::default() };
        let usual = settings(Unit::Auto, UpAxis::Y, Facing::PlusZ);
        let hair = hair().in_metres(&usual);
        for (name, bytes, settings) in [
            ("a.hair", write("hair", &hair), settings(Unit::Metre, UpAxis::Z, Facing::PlusY)),
            ("a.tfx", write("tfx", &hair), settings(Unit::Centimetre, UpAxis::Y, Facing::PlusZ)),
            ("a.npy", write("npy", &hair), settings(Unit::Metre, UpAxis::Y, Facing::PlusZ)),
            ("a.npz", write("npz", &hair), settings(Unit::Metre, UpAxis::Y, Facing::PlusZ)),
        ] {
            let back = load_hair_bytes(name, &bytes.expect(name)).expect(name).in_metres(&settings);
            assert_eq!(back.first_point, hair.first_point, "{name}");
            let off = back.points.iter().zip(&hair.points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!(off < 1e-6, "{name}: {off} m");
            if name == "a.hair" {
                assert_eq!(back.thickness, hair.thickness, "{name}");
            }
            // The control: read in another unit or without its axes it is not the same.
            assert!(back.in_metres(&usual).points[0].distance(hair.points[1]) > 1e-2, "{name}");
        }
    }

    #[test]
    fn tressfx_refuses_strands_of_different_lengths() {
        let mut hair = hair();
        hair.points.pop();
        hair.first_point[2] = 5;
        assert!(write("tfx", &hair).is_err_and(|why| why.contains("2 to 3 points")));
    }

    #[test]
    fn only_hair_is_the_extension_of_two_formats() {
        let all = HairFormat::all_extensions();
        let listed: usize = HAIR_FORMATS.iter().map(|format| format.extensions.len()).sum();
        assert_eq!(all.len(), listed - 1);
        for extension in all {
            let name = format!("a.{}", extension.to_ascii_uppercase());
            let formats = HAIR_FORMATS.into_iter().filter(|format| format.extensions.contains(&extension));
            assert_eq!(formats.count(), 1 + usize::from(extension == "hair"), "{extension}");
            let format = HairFormat::of_path(Path::new(&name)).expect("a format");
            assert!(format.extensions.contains(&extension), "{name}");
        }
        assert_eq!(HairFormat::of_path(Path::new("a.hair")).map(|format| format.label), Some("Yuksel .hair"));
        assert_eq!(HairFormat::of_path(Path::new("a.stl")), None);
    }

    #[test]
    fn a_compressed_file_is_refused_in_words_about_its_compression() {
        use std::io::Write;
        let pack = |text: &str| {
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            encoder.write_all(text.as_bytes()).expect("memory");
            encoder.finish().expect("memory")
        };
        for (name, extension) in [
            ("a.obj.gz", "obj"),
            ("a.OBJ.GZ", "obj"),
            ("a.obj", "obj"),
            ("b/a.ply.gz", "ply"),
            ("a.usd.gz", "usd"),
        ] {
            let error =
                load_hair_bytes(name, &pack("v 0 0 0\nv 0 1 0\nl 1 2\n")).expect_err(name).to_string();
            let words = format!("found a file compressed by gzip; must be unpacked to a .{extension} file");
            assert!(error.contains(&words) && !error.contains("Shape"), "{error}");
        }
        // Negative control: scenes of pbrt are read compressed.
        let curve = "WorldBegin Shape \"curve\" \"point3 P\" [ 0 0 0 0 1 0 0 2 0 0 3 0 ]\n";
        for name in ["a.pbrt.gz", "a.gz", "a.pbrt"] {
            assert_eq!(load_hair_bytes(name, &pack(curve)).expect(name).strands(), 1, "{name}");
        }
    }

    #[test]
    fn a_refusal_speaks_of_the_formats_of_the_name() {
        for (name, word, other) in [
            ("a.hair", "`HAIR` (Yuksel), or the numbers of strands", "glTF"),
            ("a.data", "USC-HairSalon", "HAIR"),
            ("a.bin", "CT2Hair", "USC"),
            ("a.ply", "`ply` (PLY)", "USC"),
            ("a.npz", "ZIP", "HAIR"),
            ("a.unknown", "(TressFX)", "nothing"),
            ("unnamed", "USC-HairSalon", "nothing"),
        ] {
            // The second could be the start of strands of USC-HairSalon, but they do not end with the file.
            for bytes in [&b"GIF89a.."[..], &[2, 0, 0, 0, 3, 0, 0, 0, 1, 2, 3]] {
                let error = load_hair_bytes(name, bytes).expect_err(name).to_string();
                let is_of_name = bytes[0] == 2
                    && [".data", ".bin", ".unknown", "unnamed"].iter().any(|end| name.ends_with(end));
                assert!(is_of_name || (error.contains(word) && !error.contains(other)), "{name}: {error}");
            }
        }
        // Strands of USC-HairSalon are read under any name.
        let strand = [1_i32.to_le_bytes(), 2_i32.to_le_bytes()].concat();
        let points: Vec<u8> =
            [0.0_f32, 1.0, 0.0, 0.0, 2.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        let hair = load_hair_bytes("a.obj", &[strand, points].concat()).expect("hair");
        assert_eq!((hair.strands(), hair.format.as_str()), (1, "USC-HairSalon .data"));
    }
}
