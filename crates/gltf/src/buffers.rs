//! The bytes of buffers: the binary chunk, data URIs, and separate files.

use std::borrow::Cow;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::{STANDARD, URL_SAFE};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use crate::GltfError;
use crate::document::{Buffer, Document};

/// Largest total size of buffers that is read, bytes.
const MAX_BYTES: u64 = 1 << 33;

/// The bytes of all buffers of a file.
#[derive(Debug)]
pub struct Buffers<'a> {
    pub(crate) bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Fetches every buffer. `bin` is the binary chunk, which is the first buffer if that has no URI.
    ///
    /// # Errors
    /// If a buffer is missing, too short or outside the folder.
    pub fn load(
        file: &str,
        document: &Document,
        bin: Option<&'a [u8]>,
        folder: Option<&Path>,
    ) -> Result<Self, GltfError> {
        let mut total = 0_u64;
        let mut buffers = Vec::new();
        for (i, buffer) in document.buffers.iter().enumerate() {
            let place = format!("buffer {i}");
            let bytes = fetch(file, &place, buffer, bin.filter(|_| i == 0), folder)?;
            if (bytes.len() as u64) < buffer.byte_length {
                let (found, wanted) =
                    (format!("{} bytes", bytes.len()), format!("{} (byteLength)", buffer.byte_length));
                return Err(GltfError::malformed(file, place, found, wanted));
            }
            total += bytes.len() as u64;
            if total > MAX_BYTES {
                let found = format!("{total} bytes of buffers");
                return Err(GltfError::malformed(file, place, found, format!("{MAX_BYTES} at most")));
            }
            buffers.push(bytes);
        }
        Ok(Self { bytes: buffers })
    }

    /// Length of all buffers together, bytes.
    pub(crate) fn total(&self) -> u64 {
        self.bytes.iter().map(|bytes| bytes.len() as u64).sum()
    }
}

fn fetch<'a>(
    file: &str,
    place: &str,
    buffer: &Buffer,
    bin: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<Cow<'a, [u8]>, GltfError> {
    let malformed = |found: String, wanted: &str| GltfError::malformed(file, place, found, wanted);
    let Some(uri) = &buffer.uri else {
        return match bin {
            Some(bin) => Ok(Cow::Borrowed(bin)),
            // A meshopt fallback buffer has no bytes; reading from it reports an error.
            None if buffer.byte_length == 0 => Ok(Cow::Borrowed(&[])),
            None => Err(malformed("neither a URI nor a binary chunk".to_owned(), "one of them")),
        };
    };
    if let Some(bytes) = data_uri(file, place, uri)? {
        return Ok(Cow::Owned(bytes));
    }
    let path = resolve(file, uri, folder)?;
    read_start(file, place, &path, buffer.byte_length.min(MAX_BYTES)).map(Cow::Owned)
}

/// The bytes of a data URI; `None` if a URI is of another kind.
pub(crate) fn data_uri(file: &str, place: &str, uri: &str) -> Result<Option<Vec<u8>>, GltfError> {
    let Some(data) = uri.strip_prefix("data:") else { return Ok(None) };
    let malformed = |found: String| GltfError::malformed(file, place, found, "base64");
    let Some((_, text)) = data.split_once(";base64,") else {
        return Err(malformed("a data URI that is not base64".to_owned()));
    };
    decoded(text).map(Some).map_err(|error| malformed(format!("invalid base64 ({error})")))
}

/// The bytes of a file in the folder that a URI refers to, which has at most `limit` of them.
pub(crate) fn file_bytes(
    file: &str,
    place: &str,
    uri: &str,
    folder: Option<&Path>,
    limit: u64,
) -> Result<Vec<u8>, GltfError> {
    let path = resolve(file, uri, folder)?;
    let bytes = read_start(file, place, &path, limit.saturating_add(1))?;
    if bytes.len() as u64 > limit {
        let found = format!("more than {limit} bytes in {}", path.display());
        return Err(GltfError::malformed(file, place, found, format!("{limit} at most")));
    }
    Ok(bytes)
}

/// The first `limit` bytes of a file.
fn read_start(file: &str, place: &str, path: &Path, limit: u64) -> Result<Vec<u8>, GltfError> {
    let read = |source| GltfError::Read { file: format!("{file}: {place}: {}", path.display()), source };
    let opened = std::fs::File::open(path).map_err(read)?;
    // A device or a pipe might never end.
    if !opened.metadata().map_err(read)?.is_file() {
        return Err(GltfError::malformed(
            file,
            place,
            format!("{}, which is no file", path.display()),
            "a file",
        ));
    }
    let mut bytes = Vec::new();
    opened.take(limit).read_to_end(&mut bytes).map_err(read)?;
    Ok(bytes)
}

/// Decodes base64 (RFC 4648, both alphabets); padding is optional, and white space is ignored.
fn decoded(text: &str) -> Result<Vec<u8>, base64::DecodeError> {
    let text: Cow<'_, str> = if text.contains(|c: char| c.is_ascii_whitespace()) {
        Cow::Owned(text.chars().filter(|c| !c.is_ascii_whitespace()).collect())
    } else {
        Cow::Borrowed(text)
    };
    let lenient = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let decode = |alphabet| GeneralPurpose::new(alphabet, lenient).decode(&*text);
    decode(&STANDARD).or_else(|error| decode(&URL_SAFE).map_err(|_| error))
}

/// Resolves a reference to a path, which must stay in the file's folder even through links.
fn resolve(file: &str, uri: &str, folder: Option<&Path>) -> Result<PathBuf, GltfError> {
    let outside = || GltfError::Outside { file: file.to_owned(), uri: uri.chars().take(200).collect() };
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
            ("Zm9v\r\n YmFy", "foobar"),
            // Both alphabets.
            ("Pz8/Pj4+", "???>>>"),
            ("Pz8_Pj4-", "???>>>"),
        ] {
            assert_eq!(decoded(text).unwrap(), bytes.as_bytes());
        }
        assert!(decoded("Zm9*").is_err());
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
            assert!(matches!(resolve("f", uri, folder), Err(GltfError::Outside { .. })), "{uri}");
        }
        assert!(matches!(resolve("f", "x.bin", None), Err(GltfError::Outside { .. })));
    }
}
