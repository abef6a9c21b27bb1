//! The header of a PLY file: what its rows contain.

use crate::io::HairFileError;

/// The longest header, bytes.
const LONGEST: usize = 1 << 16;

/// How the rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn of(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Its size in a binary file, bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value that stands for full brightness in a colour.
    pub(super) fn full(self) -> f32 {
        match self {
            Self::I8 | Self::U8 => 255.0,
            Self::I16 | Self::U16 => 65_535.0,
            _ => 1.0,
        }
    }
}

/// A column of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) ty: Number,
    /// The type of the length of a list.
    pub(super) length: Option<Number>,
}

/// A table of the file.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The first column with one of these names, in lower case; one number per row.
    pub(super) fn number(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| {
            self.properties.iter().position(|property| property.length.is_none() && property.name == *name)
        })
    }

    /// The first column of lists with one of these names.
    pub(super) fn list(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| {
            self.properties.iter().position(|property| property.length.is_some() && property.name == *name)
        })
    }

    /// The fewest bytes that a row takes.
    pub(super) fn least_bytes(&self, form: Form) -> u64 {
        let of = |property: &Property| match form {
            Form::Ascii => 2,
            _ => property.length.unwrap_or(property.ty).size() as u64,
        };
        self.properties.iter().map(of).sum()
    }
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) form: Form,
    pub(super) elements: Vec<Element>,
    /// Where the rows begin, bytes.
    pub(super) end: usize,
    /// Texts of the comments.
    pub(super) comments: Vec<String>,
}

/// Reads the header.
pub(super) fn header(name: &str, data: &[u8]) -> Result<Header, HairFileError> {
    let malformed = |offset: usize, found: String, wanted: &str| HairFileError::Malformed {
        name: name.to_owned(),
        offset: offset as u64,
        found,
        wanted: wanted.to_owned(),
    };
    let (mut form, mut elements, mut comments, mut at) = (None, Vec::<Element>::new(), Vec::new(), 0);
    loop {
        let rest = &data[at..data.len().min(at + LONGEST)];
        let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
        let Some(end) = end.filter(|_| at < LONGEST) else {
            return Err(malformed(
                at,
                "a header without `end_header`".to_owned(),
                "a header of 65536 bytes at most",
            ));
        };
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        let start = at;
        // Windows ends lines with two characters.
        at += end + if rest[end] == b'\r' && rest.get(end + 1) == Some(&b'\n') { 2 } else { 1 };
        let mut words = line.split_ascii_whitespace();
        let wrong = |wanted: &str| malformed(start, format!("`{}`", line.trim()), wanted);
        match words.next() {
            Some("format") => {
                form = Some(match words.next() {
                    Some("ascii") => Form::Ascii,
                    Some("binary_little_endian") => Form::LittleEndian,
                    Some("binary_big_endian") => Form::BigEndian,
                    _ => return Err(wrong("format ascii, binary_little_endian or binary_big_endian")),
                });
            }
            Some("comment" | "obj_info") => comments.push(words.collect::<Vec<_>>().join(" ")),
            Some("element") => {
                let (name, rows) = (words.next(), words.next().and_then(|rows| rows.parse().ok()));
                let (Some(name), Some(rows)) = (name, rows) else {
                    return Err(wrong("the name and the number of rows of an element"));
                };
                elements.push(Element { name: name.to_ascii_lowercase(), rows, properties: Vec::new() });
            }
            Some("property") => {
                let words: Vec<&str> = words.collect();
                let property = match words[..] {
                    ["list", length, ty, name] => {
                        Number::of(length).zip(Number::of(ty)).map(|(length, ty)| Property {
                            name: name.to_ascii_lowercase(),
                            ty,
                            length: Some(length),
                        })
                    }
                    [ty, name] => Number::of(ty).map(|ty| Property {
                        name: name.to_ascii_lowercase(),
                        ty,
                        length: None,
                    }),
                    _ => None,
                };
                let (Some(property), Some(element)) = (property, elements.last_mut()) else {
                    return Err(wrong("a type of PLY and a name, after an element"));
                };
                element.properties.push(property);
            }
            Some("end_header") => break,
            Some("ply") if start == 0 => {}
            None => {}
            Some(_) => return Err(wrong("a line of a PLY header")),
        }
    }
    let Some(form) = form else {
        return Err(malformed(
            0,
            "a header without a format".to_owned(),
            "a line such as `format ascii 1.0`",
        ));
    };
    for element in &elements {
        let least = element.least_bytes(form);
        // The last number of a text needs no blank after it.
        let room = (data.len() - at) as u64 + 1;
        if least > 0 && element.rows > room / least {
            let found = format!("{} rows of `{}` in {} bytes", element.rows, element.name, room - 1);
            return Err(malformed(at, found, "as many rows as the file has room for"));
        }
    }
    Ok(Header { form, elements, end: at, comments })
}
