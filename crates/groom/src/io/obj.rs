//! Polylines of Wavefront OBJ: the records `v` and `l`. The rest of a file is ignored.

use lovelock_base::words::counted;
use std::fmt::Write as _;
use std::io::BufRead;

use glam::Vec3;

use super::HairFileError;
use super::chain::chain;
use super::file::{HairFile, RawHair};
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;
use super::words::begins_with_word;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "OBJ polylines",
    extensions: &["obj"],
    signature: "a record of OBJ such as `v`",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: |start| begins_with_word(start, &RECORDS),
    read,
    write: Some(write),
};

/// Records with which a file may begin.
const RECORDS: [&str; 12] = ["v", "vn", "vt", "vp", "o", "g", "s", "l", "f", "p", "mtllib", "usemtl"];
/// The longest line: a polyline of several thousand points.
const LONGEST_LINE: u64 = 1 << 20;

/// What the lines of a file add up to.
#[derive(Default)]
struct Content {
    positions: Vec<Vec3>,
    /// One per vertex, as long as every vertex has one.
    colours: Vec<[f32; 3]>,
    /// Vertices of the polylines of three points or more, and how many each has.
    long: Vec<u32>,
    long_counts: Vec<u32>,
    /// Number of records of two points before each longer one.
    pairs_before: Vec<u32>,
    /// Records of two points, which are joined.
    pairs: Vec<[u32; 2]>,
    faces: u64,
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let mut reader = source.into_reader();
    let (mut content, mut line, mut offset) = (Content::default(), Vec::new(), 0_u64);
    loop {
        line.clear();
        let start = offset;
        // A backslash continues a record on the next line.
        loop {
            let room = LONGEST_LINE.saturating_sub(line.len() as u64);
            let read = std::io::Read::take(&mut reader, room).read_until(b'\n', &mut line);
            let read = read.map_err(|source| HairFileError::Io { name: name.to_owned(), source })?;
            offset += read as u64;
            let trimmed = line.trim_ascii_end();
            if read > 0 && trimmed.ends_with(b"\\") {
                line.truncate(trimmed.len() - 1);
                line.push(b' ');
            } else {
                break;
            }
        }
        if line.len() as u64 >= LONGEST_LINE {
            return Err(malformed(
                name,
                start,
                "a line of 1048576 bytes or more".to_owned(),
                "shorter lines",
            ));
        }
        if line.is_empty() && offset == start {
            break;
        }
        content.record(name, start, &line)?;
    }
    content.finish(name)
}

fn malformed(name: &str, offset: u64, found: String, wanted: &str) -> HairFileError {
    HairFileError::Malformed { name: name.to_owned(), offset, found, wanted: wanted.to_owned() }
}

impl Content {
    fn record(&mut self, name: &str, offset: u64, line: &[u8]) -> Result<(), HairFileError> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let mut numbers = [0.0_f32; 7];
                let mut count = 0;
                for (number, word) in numbers.iter_mut().zip(&mut words) {
                    let parsed = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
                    *number = parsed.ok_or_else(|| {
                        malformed(name, offset, format!("`{}`", start_of(line)), "the numbers of a vertex")
                    })?;
                    count += 1;
                }
                if count < 3 {
                    return Err(malformed(
                        name,
                        offset,
                        format!("`{}`", start_of(line)),
                        "three numbers of a vertex",
                    ));
                }
                // Red, green and blue may follow, as in MeshLab and Blender; a single fourth number is a weight.
                if count >= 6 && self.colours.len() == self.positions.len() {
                    self.colours.push([numbers[3], numbers[4], numbers[5]]);
                }
                self.positions.push(Vec3::new(numbers[0], numbers[1], numbers[2]));
            }
            Some(b"l") => {
                let begin = self.long.len();
                for word in words {
                    self.long.push(self.vertex(name, offset, line, word)?);
                }
                match self.long[begin..] {
                    [a, b] => {
                        self.pairs.push([a, b]);
                        self.long.truncate(begin);
                    }
                    [] => {}
                    _ => {
                        self.long_counts.push((self.long.len() - begin) as u32);
                        self.pairs_before.push(self.pairs.len() as u32);
                    }
                }
            }
            Some(b"f") => self.faces += 1,
            _ => {}
        }
        Ok(())
    }

    /// The vertex of `3`, `3/7` or `-1`, the last one so far.
    fn vertex(&self, name: &str, offset: u64, line: &[u8], word: &[u8]) -> Result<u32, HairFileError> {
        let index = word.split(|&byte| byte == b'/').next().unwrap_or_default();
        let index = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i64>().ok());
        let known = self.positions.len() as i64;
        let place = match index {
            Some(index) if index > 0 => Some(index - 1),
            Some(index) if index < 0 => index.checked_add(known),
            _ => None,
        };
        place.filter(|place| (0..known).contains(place)).map(|place| place as u32).ok_or_else(|| {
            let wanted = format!("vertices from 1 to {known}, of the records `v` before it");
            malformed(name, offset, format!("`{}`", start_of(line)), &wanted)
        })
    }

    fn finish(self, name: &str) -> Result<RawHair, HairFileError> {
        if self.long_counts.is_empty() && self.pairs.is_empty() {
            let found = format!("{} vertices, {} faces and no line", self.positions.len(), self.faces);
            return Err(malformed(name, 0, found, "records `l` of two vertices or more"));
        }
        let mut notes = Vec::new();
        if self.faces > 0 {
            let faces = counted(self.faces, "face was", "faces were");
            notes.push(format!("{faces} left out: only lines are hair."));
        }
        let chains = chain(&self.pairs, self.positions.len());
        let (mut counts, mut vertices) = (Vec::new(), Vec::new());
        let mut joined = Strands { counts: &chains.counts, vertices: &chains.vertices };
        let mut long = Strands { counts: &self.long_counts, vertices: &self.long };
        // In the order of the file: a strand of several records where its first one is.
        let mut first_listed = chains.first_listed.iter().copied().peekable();
        for &before in &self.pairs_before {
            while first_listed.next_if(|&first| first < before).is_some() {
                joined.take(&mut counts, &mut vertices);
            }
            long.take(&mut counts, &mut vertices);
        }
        first_listed.for_each(|_| joined.take(&mut counts, &mut vertices));
        let coloured = self.colours.len() == self.positions.len();
        let colours = coloured.then(|| vertices.iter().map(|&v: &u32| self.colours[v as usize]).collect());
        let points = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        Ok(RawHair { colours, notes, ..RawHair::new(counts, points) })
    }
}

/// Strands that are taken one after the other.
struct Strands<'a> {
    counts: &'a [u32],
    vertices: &'a [u32],
}

impl Strands<'_> {
    fn take(&mut self, counts: &mut Vec<u32>, vertices: &mut Vec<u32>) {
        let Some((&count, rest)) = self.counts.split_first() else { return };
        let (own, after) = self.vertices.split_at(count as usize);
        counts.push(count);
        vertices.extend(own);
        (self.counts, self.vertices) = (rest, after);
    }
}

/// The first characters of a line, for messages.
fn start_of(line: &[u8]) -> String {
    String::from_utf8_lossy(line).trim().chars().take(40).collect::<String>().escape_debug().to_string()
}

/// Writes metres, Y up; colours follow the positions. The numbers are the shortest that give the same single-precision
/// value when read.
fn write(hair: &HairFile) -> Result<Vec<u8>, String> {
    let mut out = "# Hair as polylines, in metres with Y up\no hair\n".to_owned();
    let formatted = |_| "a number cannot be written".to_owned();
    for (i, p) in hair.points.iter().enumerate() {
        write!(out, "v {} {} {}", p.x, p.y, p.z).map_err(formatted)?;
        if let Some([r, g, b]) = hair.colours.as_ref().map(|colours| colours[i]) {
            write!(out, " {r} {g} {b}").map_err(formatted)?;
        }
        out.push('\n');
    }
    for [start, end] in hair.first_point.array_windows() {
        out.push('l');
        for vertex in *start..*end {
            write!(out, " {}", vertex + 1).map_err(formatted)?;
        }
        out.push('\n');
    }
    Ok(out.into_bytes())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::load_hair_bytes;

    #[test]
    fn polylines_of_every_spelling() {
        let text = "# by hand\r\nmtllib a.mtl\r\no hair\r\nv 0 0 0\r\nv 0 1 0 1.0\r\nv 0 2 0\r\nvt 0 0\r\n\
            l 1/1 2/1 \\\r\n 3/1\r\nv 1 0 0\r\nv 1 1e0 0\r\nv 1 2 0\r\nv 1 3 0\r\nl -4 -3\r\nl 6 7\r\nl 5 6\r\nf 1 2 3\r\n";
        let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
        assert_eq!(file.first_point, [0, 3, 7]);
        assert_eq!(file.strand(0), [Vec3::ZERO, Vec3::Y, 2.0 * Vec3::Y]);
        assert_eq!(file.strand(1)[3], Vec3::new(1.0, 3.0, 0.0));
        assert!(file.notes.iter().any(|note| note.contains("1 face")) && file.colours.is_none());
    }

    #[test]
    fn two_point_records_are_joined_and_colours_follow() {
        let vertices =
            (0..50).map(|at| format!("v {} {} 0 0.5 0.25 {}\n", at / 5, at % 5, (at % 5) as f32 * 0.125));
        let lines = (1..50).filter(|at| at % 5 != 0).map(|at| format!("l {at} {}\n", at + 1));
        let text: String = vertices.chain(lines).collect();
        let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
        assert_eq!((file.strands(), file.points.len()), (10, 50));
        assert_eq!(file.colours.expect("colours")[4], [0.5, 0.25, 0.5]);
    }

    #[test]
    fn what_is_no_hair_is_refused() {
        for (text, found) in [
            ("v 0 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n", "3 vertices, 1 faces and no line"),
            ("v 0 0 0\nl 1 2\n", "byte 8: found `l 1 2`; must be vertices from 1 to 1"),
            ("v 0 0 0\nl 1 0\n", "`l 1 0`"),
            ("v 0 0 0\nl 1 -2\n", "`l 1 -2`"),
            ("v 0 zero 0\n", "byte 0: found `v 0 zero 0`"),
            ("v 0 0\n", "three numbers"),
            ("# nothing\n", "0 vertices"),
        ] {
            let error = load_hair_bytes("a.obj", text.as_bytes()).expect_err(text).to_string();
            assert!(error.contains(found), "{error}");
        }
        let long = [b"v 0 0 0\nl".to_vec(), b" 1".repeat(1 << 20)].concat();
        assert!(
            load_hair_bytes("a.obj", &long).is_err_and(|error| error.to_string().contains("shorter lines"))
        );
    }
}
