//! Polylines of Wavefront OBJ: the records `v` and `l`. The rest of a file is ignored.
//!
//! `#` begins a comment wherever a word may begin, and a backslash at the end of a line continues it. Lines end as in Unix, Windows or old Macs.

use lovelock_base::numbers::{number, numbers_of};
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
use super::words::{begins_with_word, start_of};

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "OBJ polylines",
    extensions: &["obj"],
    signature: "a record of OBJ such as `v`",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: |start| begins_with_word(start, &RECORDS),
    by_chance: false,
    read,
    write: Some(write),
};

/// Records with which a file may begin.
const RECORDS: [&str; 12] = ["v", "vn", "vt", "vp", "o", "g", "s", "l", "f", "p", "mtllib", "usemtl"];
/// The longest line: a polyline of several thousand points.
const LONGEST_LINE: u64 = 1 << 20;
/// The most numbers of a vertex that are looked at.
const MOST_NUMBERS: usize = 7;
/// What a record of a vertex must be.
const VERTEX: &str = "a vertex: 3 numbers, 4 with a weight, or 6 or 7 with a colour";

/// What the lines of a file add up to.
#[derive(Default)]
struct Content {
    positions: Vec<Vec3>,
    /// Those of the vertices that have one; not numbers for the others. As long as the last vertex that has one.
    colours: Vec<[f32; 3]>,
    /// The record of a line with the largest index of a vertex, which may follow it.
    largest: Option<(u32, u64, String)>,
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
    let io = |source| HairFileError::Io { name: name.to_owned(), source };
    let (mut content, mut line, mut offset) = (Content::default(), Vec::new(), 0_u64);
    let mut lines = 0_u64;
    loop {
        line.clear();
        let (start, first_line) = (offset, lines + 1);
        // A backslash continues a record on the next line, but no comment: paths of Windows end in one.
        loop {
            let begin = line.len();
            let read = read_line(&mut *reader, &mut line).map_err(io)?;
            offset += read;
            lines += 1;
            if let Some(comment) = comment_in(&line[begin..]) {
                line.truncate(begin + comment);
                break;
            }
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
                first_line,
                "a line of 1048576 bytes or more".to_owned(),
                "shorter lines",
            ));
        }
        if offset == start {
            break;
        }
        if start == 0 && line.starts_with(b"\xef\xbb\xbf") {
            line.drain(..3);
        }
        content.record(name, first_line, &line)?;
    }
    content.finish(name)
}

/// Appends a line without its end, and returns the bytes that were read. It stops where the line becomes too long.
fn read_line(reader: &mut dyn BufRead, line: &mut Vec<u8>) -> std::io::Result<u64> {
    let mut read = 0;
    while (line.len() as u64) < LONGEST_LINE {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            break;
        }
        let room = buffer.len().min(LONGEST_LINE as usize - line.len());
        let end = buffer[..room].iter().position(|&byte| byte == b'\n' || byte == b'\r');
        let taken = end.unwrap_or(room);
        line.extend_from_slice(&buffer[..taken]);
        let is_return = end.is_some_and(|end| buffer[end] == b'\r');
        let consumed = taken + usize::from(end.is_some());
        reader.consume(consumed);
        read += consumed as u64;
        if is_return && reader.fill_buf()?.first() == Some(&b'\n') {
            reader.consume(1);
            read += 1;
        }
        if end.is_some() {
            break;
        }
    }
    Ok(read)
}

/// Where a comment begins in a line. What Microsoft's library writes for no number, `-1.#IND`, is none.
fn comment_in(line: &[u8]) -> Option<usize> {
    (0..line.len()).find(|&at| line[at] == b'#' && (at == 0 || line[at - 1] != b'.'))
}

fn malformed(name: &str, line: u64, found: String, wanted: &str) -> HairFileError {
    HairFileError::MalformedLine { name: name.to_owned(), line, found, wanted: wanted.to_owned() }
}

/// The numbers of a vertex and how many there are; `None` if a word is none, or a vertex has another number of them.
fn vertex<'a>(words: impl Iterator<Item = &'a [u8]>) -> Option<([f32; MOST_NUMBERS], usize)> {
    let (mut numbers, mut count) = ([0.0; MOST_NUMBERS], 0);
    for word in words {
        for part in numbers_of(std::str::from_utf8(word).ok()?) {
            if let Some(place) = numbers.get_mut(count) {
                *place = number(part)? as f32;
                count += 1;
            }
        }
    }
    (count >= 3 && count != 5).then_some((numbers, count))
}

impl Content {
    fn record(&mut self, name: &str, at: u64, line: &[u8]) -> Result<(), HairFileError> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let (numbers, count) = vertex(words)
                    .ok_or_else(|| malformed(name, at, format!("`{}`", start_of(line)), VERTEX))?;
                // Red, green and blue may follow, as in MeshLab and Blender; a single fourth number is a weight.
                if count >= 6 {
                    self.colours.resize(self.positions.len(), [f32::NAN; 3]);
                    self.colours.push([numbers[3], numbers[4], numbers[5]]);
                }
                self.positions.push(Vec3::new(numbers[0], numbers[1], numbers[2]));
            }
            Some(b"l") => {
                let begin = self.long.len();
                for word in words {
                    let vertex = self.vertex(name, at, line, word)?;
                    self.long.push(vertex);
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
    fn vertex(&mut self, name: &str, at: u64, line: &[u8], word: &[u8]) -> Result<u32, HairFileError> {
        let index = word.split(|&byte| byte == b'/').next().unwrap_or_default();
        let index = std::str::from_utf8(index).ok().and_then(|index| index.parse::<i64>().ok());
        let known = self.positions.len() as i64;
        let place = match index {
            Some(index) if index > 0 => u32::try_from(index - 1).ok().filter(|place| *place < u32::MAX),
            Some(index) if index < 0 => index.checked_add(known).and_then(|place| u32::try_from(place).ok()),
            _ => None,
        };
        let place = place.ok_or_else(|| self.no_vertex(name, at, &start_of(line)))?;
        // Some programs write the lines before their vertices.
        if i64::from(place) >= known && self.largest.as_ref().is_none_or(|(largest, ..)| place > *largest) {
            self.largest = Some((place, at, start_of(line)));
        }
        Ok(place)
    }

    fn no_vertex(&self, name: &str, at: u64, line: &str) -> HairFileError {
        let wanted = format!("vertices from 1 to {}, of the records `v`", self.positions.len());
        malformed(name, at, format!("`{line}`"), &wanted)
    }

    fn finish(self, name: &str) -> Result<RawHair, HairFileError> {
        if self.long_counts.is_empty() && self.pairs.is_empty() {
            let vertices = counted(self.positions.len(), "vertex", "vertices");
            let found = format!("{vertices}, {} and no line", counted(self.faces, "face", "faces"));
            let (name, wanted) = (name.to_owned(), "records `l` of two vertices or more".to_owned());
            return Err(HairFileError::Malformed { name, offset: 0, found, wanted });
        }
        if let Some((largest, at, line)) = &self.largest
            && *largest as usize >= self.positions.len()
        {
            return Err(self.no_vertex(name, *at, line));
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
        let colours = self.colours_of(&vertices, &mut notes);
        let points = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        Ok(RawHair { colours, notes, ..RawHair::new(counts, points) })
    }

    /// The colours of the vertices of strands. Those without one get the mean of the others. Vertices of other objects, such as a head, do not
    /// count.
    fn colours_of(&self, vertices: &[u32], notes: &mut Vec<String>) -> Option<Vec<[f32; 3]>> {
        let colour = |v: u32| {
            self.colours.get(v as usize).copied().filter(|colour| colour.iter().all(|v| !v.is_nan()))
        };
        let (mut sum, mut known, mut largest) = ([0.0_f64; 3], 0_usize, 0.0_f32);
        for colour in vertices.iter().filter_map(|&v| colour(v)) {
            sum.iter_mut().zip(colour).for_each(|(sum, value)| *sum += f64::from(value));
            largest = colour.into_iter().fold(largest, f32::max);
            known += 1;
        }
        if known == 0 {
            return None;
        }
        if known < vertices.len() {
            let others = counted(vertices.len() - known, "vertex has", "vertices have");
            notes.push(format!("{others} no colour and got the mean of the others."));
        }
        // Some programs write bytes.
        let full = if largest > 1.0 && largest <= 255.0 { 255.0 } else { 1.0 };
        if full > 1.0 {
            notes.push("The colours are from 0 to 255.".to_owned());
        }
        let mean = sum.map(|sum| (sum / known as f64) as f32);
        Some(vertices.iter().map(|&v| colour(v).unwrap_or(mean).map(|value| value / full)).collect())
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
    fn comments_continuations_and_line_ends_of_every_program() {
        let lines = [
            "\u{feff}v 0 0 0# the first",
            "v\t0 1  0 1\t# with a weight",
            "# C:\\models\\",
            "v 0 \\",
            "  2 0 \\  ",
            "1",
            "l 1//1 2/5 \\",
            "  3/1/1 # three points",
            "l 4 5 -3 # forward",
            "v 1 0 0 #",
            "v 1 1.5e0 +0",
            "vn 1.#IND 0 0",
            "#",
            "",
        ];
        let of = |end: &str| load_hair_bytes("a.obj", lines.join(end).as_bytes()).expect("hair");
        let file = of("\n");
        assert_eq!(file.first_point, [0, 3, 6]);
        assert_eq!(file.strand(0), [Vec3::ZERO, Vec3::Y, 2.0 * Vec3::Y]);
        assert_eq!(file.strand(1), [Vec3::X, Vec3::new(1.0, 1.5, 0.0), Vec3::ZERO]);
        assert_eq!((of("\r\n").points, of("\r").points), (file.points.clone(), file.points.clone()));
        // Negative control: without the backslash the second record of three numbers is not one.
        assert!(load_hair_bytes("a.obj", b"v 0 \n 2 0\nl 1 1\n").is_err());
        // A vertex that is no number takes its strand with it.
        for word in ["-1.#IND", "-nan(ind)"] {
            let text = format!("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 {word} 0\nl 1 2\nl 3 4\n");
            let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
            assert_eq!((file.strands(), file.dropped["non_finite_strands"]), (1, 1));
        }
    }

    #[test]
    fn rows_of_vertices_are_divided_or_refused_by_line() {
        let head = "v 0 0 0\n# a comment\n";
        let read =
            |row: &str| load_hair_bytes("a.obj", format!("{head}{row}\nv 1 1 1\nl 1 2 3\n").as_bytes());
        for row in ["v 0.5-0.25 -1", "v 0.5-0.25-1", "v 5e-1 -.25-1.0"] {
            let file = read(row).expect(row);
            assert_eq!(file.points[1], Vec3::new(0.5, -0.25, -1.0), "{row}");
            assert_eq!(file.points[2], Vec3::ONE, "the row after {row}");
        }
        for row in ["v 0.50.25 1", "v 0.5 0.25", "v 0.5 0.25 1 0.1 0.2", "v 0,5 0,25 1,0", "v 0.5 0.25-"] {
            let error = read(row).expect_err(row).to_string();
            assert!(error.starts_with(&format!("a.obj: line 3: found `{row}`")), "{error}");
        }
        // Negative control: the same rows with blanks.
        assert_eq!(read("v 0.5 0.25 1").expect("hair").points[1], Vec3::new(0.5, 0.25, 1.0));
    }

    #[test]
    fn one_vertex_without_colour_does_not_drop_those_of_the_others() {
        let head = "v 9 9 9\nv 9 8 9\nv 8 8 9\nf 1 2 3\n";
        let hair = "v 0 0 0 0.4 0.2 0.1\nv 0 1 0 0.4 0.2 0.1\nv 0 2 0 0.4 0.2 0.1\n";
        for text in [format!("{head}{hair}l 4 5 6\n"), format!("{hair}{head}l 1 2 3\n")] {
            let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
            assert_eq!(file.colours.as_deref(), Some(&[[0.4, 0.2, 0.1]; 3][..]), "{text}");
        }
        let text = format!("{head}{hair}v 0 3 0\nl 4 5 6 7\n");
        let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
        assert_eq!(file.colours.expect("colours")[3].map(|v| (v * 1000.0).round()), [400.0, 200.0, 100.0]);
        assert!(file.notes.iter().any(|note| note.contains("1 vertex has no colour")), "{:?}", file.notes);
        // Bytes, with an alpha.
        let text = "v 0 0 0 255 0 51 255\nv 0 1 0 255 0 51 255\nl 1 2\n";
        let file = load_hair_bytes("a.obj", text.as_bytes()).expect("hair");
        assert_eq!(file.colours.as_deref(), Some(&[[1.0, 0.0, 0.2]; 2][..]));
        // Negative control: colours of the head only are none of the hair.
        let text = "v 0 0 0\nv 0 1 0\nv 9 9 9 1 0 0\nl 1 2\n";
        assert!(load_hair_bytes("a.obj", text.as_bytes()).expect("hair").colours.is_none());
    }

    #[test]
    fn spellings_of_other_programs_mean_the_same() {
        let Some(data) = lovelock_testkit::data_dir() else { return };
        let read = |name: &str| crate::load_hair(&data.join("reports").join(name)).expect(name);
        let (spelled, plain) = (read("spellings.obj"), read("spellings_reference.obj"));
        assert_eq!((spelled.strands(), &spelled.first_point), (60, &plain.first_point));
        let off = spelled.points.iter().zip(&plain.points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off < 1e-6, "{off}");
        let coloured = read("two_point_lines_with_head.obj");
        assert_eq!(coloured.strands(), 60);
        let colours = coloured.colours.expect("colours");
        assert!(colours.iter().all(|colour| *colour == [0.4, 0.2, 0.1]), "{:?}", colours[0]);
    }

    #[test]
    fn what_is_no_hair_is_refused() {
        for (text, found) in [
            ("v 0 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n", "3 vertices, 1 face and no line"),
            ("v 0 0 0\nl 1 2\n", "line 2: found `l 1 2`; must be vertices from 1 to 1"),
            ("v 0 0 0\nl 1 0\n", "`l 1 0`"),
            ("v 0 0 0\nl 1 -2\n", "`l 1 -2`"),
            ("v 0 zero 0\n", "line 1: found `v 0 zero 0`"),
            ("v 0 0\n", "line 1: found `v 0 0`; must be a vertex: 3 numbers"),
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
