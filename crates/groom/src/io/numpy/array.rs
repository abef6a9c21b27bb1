//! An array of `NumPy`: the format `.npy`, versions 1 to 3 (NEP 1).

use half::f16;

/// The longest description of an array, bytes.
const LONGEST: usize = 1 << 16;
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// What an array contains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// `f` for floats, `i` and `u` for integers, and others as in `NumPy`.
    kind: char,
    /// Bytes of a number.
    size: usize,
    big_endian: bool,
    /// Whether the first index runs fastest.
    fortran: bool,
    pub(super) shape: Vec<usize>,
    /// Where the numbers begin, bytes.
    pub(super) start: usize,
}

/// Reads the description at the start of an array; otherwise what was found.
pub(super) fn layout(start: &[u8]) -> Result<Layout, String> {
    let version = start.strip_prefix(MAGIC).and_then(|rest| rest.first());
    let (length, begin) = match (version, start.get(8..12)) {
        (Some(1), Some(&[a, b, ..])) => (usize::from(u16::from_le_bytes([a, b])), 10),
        (Some(2 | 3), Some(&[a, b, c, d])) => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
        (Some(version @ (1..=3)), None) => {
            return Err(format!("an array of version {version} without a description"));
        }
        (Some(version), _) => return Err(format!("an array of version {version}")),
        (None, _) => return Err("no array of NumPy".to_owned()),
    };
    let text = start.get(begin..begin + length.min(LONGEST)).filter(|_| length <= LONGEST);
    let text = text.ok_or_else(|| format!("a description of {length} bytes that is not there"))?;
    let text = String::from_utf8_lossy(text);
    let value = |key: &str| {
        let after =
            text.split_once(&format!("'{key}'")).or_else(|| text.split_once(&format!("\"{key}\"")))?.1;
        Some(after.trim_start().strip_prefix(':')?.trim_start())
    };
    let wrong = || format!("the description `{}`", text.trim().chars().take(80).collect::<String>());
    let quoted = value("descr").and_then(|descr| descr.strip_prefix(['\'', '"'])?.split(['\'', '"']).next());
    // Tables of named columns have a list here.
    let descr = quoted.ok_or_else(wrong)?;
    let (order, rest) = descr.split_at_checked(1).ok_or_else(wrong)?;
    let mut kind = rest.chars();
    let (kind, size) = (kind.next().ok_or_else(wrong)?, kind.as_str().parse().map_err(|_| wrong())?);
    let fortran = match value("fortran_order") {
        Some(word) if word.starts_with("True") => true,
        Some(word) if word.starts_with("False") => false,
        _ => return Err(wrong()),
    };
    let inside = value("shape").and_then(|shape| shape.strip_prefix('(')?.split_once(')'));
    let (inside, _) = inside.ok_or_else(wrong)?;
    let numbers = inside.split(',').map(str::trim).filter(|number| !number.is_empty());
    // Python 2 wrote 10L.
    let shape: Result<Vec<usize>, _> = numbers.map(|number| number.trim_end_matches('L').parse()).collect();
    let shape = shape.map_err(|_| wrong())?;
    Ok(Layout { kind, size, big_endian: order == ">", fortran, shape, start: begin + length })
}

impl Layout {
    /// The type of the numbers and the shape, for people: `f4 (100, 32, 3)`.
    pub(super) fn words(&self) -> String {
        let shape: Vec<String> = self.shape.iter().map(usize::to_string).collect();
        format!("{}{} ({})", self.kind, self.size, shape.join(", "))
    }

    /// Whether the numbers are floats that can be read.
    pub(super) fn has_floats(&self) -> bool {
        self.kind == 'f' && [2, 4, 8].contains(&self.size)
    }

    /// Whether the numbers are integers that can be read.
    pub(super) fn has_integers(&self) -> bool {
        ['i', 'u'].contains(&self.kind) && [1, 2, 4, 8].contains(&self.size)
    }

    /// How many numbers the array has; `None` beyond what a file holds.
    pub(super) fn count(&self) -> Option<usize> {
        self.shape.iter().try_fold(1_usize, |product, &side| product.checked_mul(side))
    }

    /// The numbers in the order of the last index, from the bytes of the whole file of the array; otherwise what was found.
    pub(super) fn numbers<T: Copy>(&self, data: &[u8], of: impl Fn(f64) -> T) -> Result<Vec<T>, String> {
        let bytes = self.bytes().and_then(|bytes| data.get(self.start..)?.get(..bytes));
        let bytes = bytes.ok_or_else(|| format!("{} in {} bytes", self.words(), data.len()))?;
        let stored: Vec<T> = bytes.chunks_exact(self.size).map(|number| of(self.number(number))).collect();
        if !self.fortran || self.shape.len() < 2 {
            return Ok(stored);
        }
        // How far apart neighbours along each index are stored.
        let mut stride = 1;
        let strides: Vec<usize> = self
            .shape
            .iter()
            .map(|side| {
                let own = stride;
                stride *= side;
                own
            })
            .collect();
        let mut place = vec![0; self.shape.len()];
        let mut numbers = Vec::with_capacity(stored.len());
        for _ in 0..stored.len() {
            numbers.push(stored[place.iter().zip(&strides).map(|(at, stride)| at * stride).sum::<usize>()]);
            for axis in (0..place.len()).rev() {
                place[axis] += 1;
                if place[axis] < self.shape[axis] {
                    break;
                }
                place[axis] = 0;
            }
        }
        Ok(numbers)
    }

    /// The size of the numbers, bytes; `None` beyond what a file holds.
    pub(super) fn bytes(&self) -> Option<usize> {
        self.count()?.checked_mul(self.size)
    }

    fn number(&self, bytes: &[u8]) -> f64 {
        let mut low_first = [0; 8];
        for (i, byte) in bytes.iter().take(8).enumerate() {
            low_first[if self.big_endian { bytes.len() - 1 - i } else { i }] = *byte;
        }
        let whole = u64::from_le_bytes(low_first);
        match (self.kind, self.size) {
            ('f', 2) => f16::from_bits(whole as u16).to_f64(),
            ('f', 4) => f64::from(f32::from_bits(whole as u32)),
            ('f', _) => f64::from_bits(whole),
            ('i', size) => {
                let unused = 64 - 8 * size.clamp(1, 8) as u32;
                ((whole << unused).cast_signed() >> unused) as f64
            }
            _ => whole as f64,
        }
    }
}

/// An array of single-precision numbers as a file.
pub(super) fn file(shape: &[usize], numbers: impl Iterator<Item = f32>) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}), }}", sides.join(", "));
    // The numbers begin at a multiple of 64 bytes.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
    text.push('\n');
    let mut out = [MAGIC, &[1, 0], &(length as u16).to_le_bytes(), text.as_bytes()].concat();
    out.extend(numbers.flat_map(f32::to_le_bytes));
    out
}
