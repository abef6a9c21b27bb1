//! Constants of the file format that reading and writing share.

/// The first bytes of an archive.
pub(crate) const MAGIC: &[u8] = b"Ogawa";
/// The position of the byte that says whether writing was finished, and its value then.
pub(crate) const FROZEN_AT: u64 = 5;
pub(crate) const FROZEN: u8 = 0xff;
/// The position of the address of the root group.
pub(crate) const ROOT_AT: u64 = 8;
/// Length of the header.
pub(crate) const HEADER: u64 = 16;

/// The bit of an address that says data; without it the address is that of a group.
pub(crate) const DATA: u64 = 1 << 63;

/// Bytes of the digest before each sample.
pub(crate) const DIGEST: u64 = 16;
/// Bytes of the digests after the headers of an object's children.
pub(crate) const OBJECT_DIGESTS: usize = 32;

/// An index of metadata that means that the metadata follows.
pub(crate) const METADATA_FOLLOWS: u8 = 0xff;

/// Bits of a property's header.
pub(crate) mod info {
    /// 0 compound, 1 scalar, 2 array, 3 array of one element.
    pub(crate) const KIND: u32 = 0x3;
    /// log2 of the bytes of each number in the header.
    pub(crate) const SIZE_SHIFT: u32 = 2;
    pub(crate) const POD_SHIFT: u32 = 4;
    /// The index of the times follows; otherwise it is 0.
    pub(crate) const HAS_TIMES: u32 = 0x100;
    /// The first and the last index at which the value changed follow.
    pub(crate) const HAS_CHANGES: u32 = 0x200;
    /// All samples have equally many elements.
    pub(crate) const HOMOGENEOUS: u32 = 0x400;
    /// All samples are equal.
    pub(crate) const CONSTANT: u32 = 0x800;
    pub(crate) const EXTENT_SHIFT: u32 = 12;
    pub(crate) const METADATA_SHIFT: u32 = 20;
}

/// The value of a key in metadata, which is text of the form `key=value;key=value`.
pub fn metadata_value<'a>(metadata: &'a str, key: &str) -> Option<&'a str> {
    let mut pairs = metadata.split(';').filter_map(|pair| pair.split_once('='));
    pairs.find(|(name, _)| *name == key).map(|(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::metadata_value;

    #[test]
    fn metadata_is_found_by_its_whole_key() {
        let text = "geoScope=vtx;isGeomParam=true;a=b=c";
        assert_eq!(metadata_value(text, "geoScope"), Some("vtx"));
        assert_eq!(metadata_value(text, "a"), Some("b=c"));
        assert_eq!(metadata_value(text, "Scope"), None);
        assert_eq!(metadata_value("", "geoScope"), None);
    }
}
