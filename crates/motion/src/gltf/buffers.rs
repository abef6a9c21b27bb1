//! The bytes of a glTF file: the binary container, data URIs, and separate files.

use std::{
    io::Read as _,
    path::{Component, Path, PathBuf},
};

use percent_encoding::percent_decode_str;

use super::document::{Buffer, Document};
use crate::MotionError;

/// The chunks of a `.glb` file, or the text of a `.gltf` file.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) bin: Option<&'a [u8]>,
    /// The name of the format.
    pub(super) format: &'static str,
}

/// Splits a binary file into its chunks (glTF 2.0, section 4.4); anything else is treated as text.
pub(super) fn open<'a>(file: &str, bytes: &'a [u8]) -> Result<Container<'a>, MotionError> {
    let Some(rest) = bytes.strip_prefix(b"glTF") else {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return Ok(Container { json, bin: None, format: "glTF 2.0 (text)" });
    };
    let word = |at: usize| {
        let bytes = rest.get(at..at + 4).and_then(|b| <[u8; 4]>::try_from(b).ok());
        bytes.map(u32::from_le_bytes).ok_or_else(|| {
            MotionError::malformed(
                file,
                format!("byte {}", at + 4),
                "the file ends inside the header of a chunk",
            )
        })
    };
    let version = word(0)?;
    if version != 2 {
        return Err(MotionError::malformed(
            file,
            "byte 4",
            format!("glTF version {version}; must be version 2"),
        ));
    }
    let (mut json, mut bin, mut at) = (None, None, 8_usize);
    while at < rest.len() && (json.is_none() || bin.is_none()) {
        // Some writers leave a few bytes of padding at the end.
        if json.is_some() && rest.len() - at < 8 {
            break;
        }
        let (length, kind) = (word(at)? as usize, word(at + 4)?);
        let data = rest.get(at + 8..).and_then(|tail| tail.get(..length)).ok_or_else(|| {
            let left = rest.len() - at - 8;
            MotionError::malformed(
                file,
                format!("byte {}", at + 4),
                format!(
                    "a chunk of {length} bytes, of which the file contains {left}; the file is truncated"
                ),
            )
        })?;
        match kind {
            0x4E4F_534A if json.is_none() => json = Some(data),
            0x004E_4942 if bin.is_none() => bin = Some(data),
            _ => {}
        }
        at += 8 + length;
    }
    let json = json.ok_or_else(|| {
        MotionError::malformed(file, "byte 12", "no JSON chunk; the first chunk must be JSON")
    })?;
    Ok(Container { json, bin, format: "glTF 2.0 (binary)" })
}

/// Fetches every buffer. `bin` is the binary chunk, which is the first buffer if that has no URI.
pub(super) fn load(
    file: &str,
    document: &Document,
    bin: Option<&[u8]>,
    folder: Option<&Path>,
) -> Result<Vec<Vec<u8>>, MotionError> {
    let mut total = 0_u64;
    let mut buffers = Vec::new();
    for (i, buffer) in document.buffers.iter().enumerate() {
        let place = format!("buffer {i}");
        let bytes = fetch(file, &place, buffer, (i == 0).then_some(bin).flatten(), folder)?;
        if (bytes.len() as u64) < buffer.byte_length {
            let problem = format!("{} bytes; must have {} (byteLength)", bytes.len(), buffer.byte_length);
            return Err(MotionError::malformed(file, place, problem));
        }
        total += bytes.len() as u64;
        if total > super::BUFFER_LIMIT {
            return Err(MotionError::malformed(
                file,
                place,
                format!("all buffers together exceed {} bytes", super::BUFFER_LIMIT),
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn fetch(
    file: &str,
    place: &str,
    buffer: &Buffer,
    bin: Option<&[u8]>,
    folder: Option<&Path>,
) -> Result<Vec<u8>, MotionError> {
    let Some(uri) = &buffer.uri else {
        return match bin {
            Some(bin) => Ok(bin.to_vec()),
            // A meshopt fallback buffer has no bytes; reading from it reports an error.
            None if buffer.byte_length == 0 => Ok(Vec::new()),
            None => Err(MotionError::malformed(file, place, "has neither a URI nor a binary chunk")),
        };
    };
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, text)) = data.split_once(";base64,") else {
            return Err(MotionError::malformed(file, place, "its data URI is not base64"));
        };
        return base64(text.as_bytes())
            .ok_or_else(|| MotionError::malformed(file, place, "invalid base64 in its data URI"));
    }
    let path = resolve(file, uri, folder)?;
    let read = |source| MotionError::Read { file: format!("{file}: {place}: {}", path.display()), source };
    let mut bytes = Vec::new();
    let limit = buffer.byte_length.min(super::BUFFER_LIMIT);
    std::fs::File::open(&path).map_err(read)?.take(limit).read_to_end(&mut bytes).map_err(read)?;
    Ok(bytes)
}

/// Resolves a reference to a path, which must stay in the file's folder even through links.
fn resolve(file: &str, uri: &str, folder: Option<&Path>) -> Result<PathBuf, MotionError> {
    let outside = || MotionError::Outside { file: file.to_owned(), uri: uri.chars().take(200).collect() };
    let relative = gltf_reference(uri).ok_or_else(outside)?;
    let folder = folder.ok_or_else(outside)?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let path = folder.join(relative);
    if let (Ok(folder), Ok(real)) = (folder.canonicalize(), path.canonicalize())
        && !real.starts_with(&folder)
    {
        return Err(outside());
    }
    Ok(path)
}

/// The file that a URI in a glTF refers to, as a path relative to the glTF's folder. The URI is
/// percent-encoded as in RFC 3986, or plain, as many programs write it (glTF 2.0, section 2.8). `None` for
/// data URIs, for URIs with a scheme, and for those that lead out of the folder.
pub fn gltf_reference(uri: &str) -> Option<PathBuf> {
    let name = percent_decode_str(uri).decode_utf8().ok()?;
    // A scheme or drive letter, a path of another system, or a path upward.
    if name.contains([':', '\\', '\0']) {
        return None;
    }
    let mut relative = PathBuf::new();
    for part in Path::new(&*name).components() {
        match part {
            Component::Normal(part) => relative.push(part),
            Component::CurDir => {}
            _ => return None,
        }
    }
    Some(relative)
}

/// Decodes base64 (RFC 4648, both alphabets); padding is optional.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut word, mut bits) = (0_u32, 0_u32);
    for &c in text {
        let digit = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            b'\r' | b'\n' | b' ' | b'\t' => continue,
            _ => return None,
        };
        word = word << 6 | u32::from(digit);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((word >> bits) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_rfc_4648() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYmE", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text.as_bytes()).unwrap(), bytes.as_bytes());
        }
        assert!(base64(b"Zm9*").is_none());
    }

    #[test]
    fn references_stay_in_the_folder() {
        let folder = Some(Path::new("models"));
        for (uri, path) in [
            ("a%20b/c.bin", "models/a b/c.bin"),
            ("./a b/%e9%A6%99.bin", "models/a b/香.bin"),
            ("a%23b%3Fc%25d+e.bin", "models/a#b?c%d+e.bin"),
            // Not a code: a name that was not encoded.
            ("100%.bin", "models/100%.bin"),
            ("50%zz", "models/50%zz"),
        ] {
            assert_eq!(resolve("f", uri, folder).unwrap(), Path::new(path), "{uri}");
        }
        for uri in [
            "../x.bin",
            "a/../../x",
            "/etc/passwd",
            "%2e%2e/x",
            "http://a/b",
            "C:\\x",
            "file:///x",
            "a%00",
            "%2Fetc/passwd",
            "a/..%2f..%2fx",
            "c%3A\\x",
            "%ff.bin",
            "data:,x",
        ] {
            assert!(matches!(resolve("f", uri, folder), Err(MotionError::Outside { .. })), "{uri}");
        }
        assert!(matches!(resolve("f", "x.bin", None), Err(MotionError::Outside { .. })));
    }

    #[test]
    fn a_truncated_container_is_refused() {
        let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x04\0\0\0JSON{}  ".to_vec();
        assert_eq!(open("f", &glb).unwrap().json, b"{}  ");
        glb.truncate(22);
        assert!(open("f", &glb).is_err());
        assert!(open("f", b"glTF\x01\0\0\0").is_err());
    }
}
