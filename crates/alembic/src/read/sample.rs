//! Samples of properties.

use super::archive::Archive;
use super::headers::{Property, PropertyKind};
use crate::error::AlembicError;
use crate::{Pod, layout};

/// Bytes that are read and converted at a time.
const BLOCK: usize = 1 << 18;

impl Archive<'_> {
    /// Position and length of the numbers of a sample.
    fn place(&mut self, property: &Property, sample: u64) -> Result<(u64, u64), AlembicError> {
        if property.kind == PropertyKind::Compound || sample >= property.samples {
            let found = format!("{} samples of {}", property.samples, property.name);
            return Err(AlembicError::malformed(property.group, found, "one sample more"));
        }
        let stored = property.stored(sample);
        // An array has the number of its elements beside each sample.
        let index = if property.kind == PropertyKind::Array { 2 * stored } else { stored };
        let address = self.source.child(property.group, index)?;
        let (at, size) = self.source.data(address)?;
        if size == 0 {
            return Ok((at, 0));
        }
        let element = property.ty.pod.bytes() * usize::from(property.ty.extent);
        let Some(size) = size.checked_sub(layout::DIGEST) else {
            return Err(AlembicError::malformed(at, format!("a sample of {size} bytes"), "16 bytes or more"));
        };
        if element > 0 && size % element as u64 != 0 {
            let found = format!("{size} bytes of {} in elements of {element}", property.name);
            return Err(AlembicError::malformed(at, found, "whole elements"));
        }
        Ok((at + layout::DIGEST, size))
    }

    /// Number of elements of a sample; for text the number of bytes.
    ///
    /// # Errors
    /// For a sample that does not exist or contradicts the file.
    pub fn elements(&mut self, property: &Property, sample: u64) -> Result<u64, AlembicError> {
        let (_, size) = self.place(property, sample)?;
        let element = property.ty.pod.bytes().max(1) * usize::from(property.ty.extent);
        Ok(size / element as u64)
    }

    /// A number that differs between samples with different places in the file: equal samples often have the same.
    ///
    /// # Errors
    /// As [`Self::elements`].
    pub fn place_of(&mut self, property: &Property, sample: u64) -> Result<u64, AlembicError> {
        Ok(self.place(property, sample)?.0)
    }

    /// Gives the numbers of a sample to `take`, block after block, converted from any type. Blocks hold whole elements.
    ///
    /// # Errors
    /// As [`Self::elements`], and for text.
    pub fn numbers(
        &mut self,
        property: &Property,
        sample: u64,
        take: &mut dyn FnMut(&[f64]),
    ) -> Result<(), AlembicError> {
        let (mut at, mut left) = self.place(property, sample)?;
        let (pod, bytes) = (property.ty.pod, property.ty.pod.bytes());
        if bytes == 0 {
            return Err(AlembicError::malformed(at, format!("text in {}", property.name), "numbers"));
        }
        let element = bytes * usize::from(property.ty.extent);
        let whole = BLOCK / element * element;
        let mut block = vec![0; whole.min(left as usize)];
        let mut numbers = Vec::with_capacity(block.len() / bytes);
        while left > 0 {
            let count = whole.min(left as usize);
            self.source.read(at, &mut block[..count])?;
            numbers.clear();
            numbers.extend(block[..count].chunks_exact(bytes).map(|chunk| pod.number(chunk).unwrap_or(0.0)));
            take(&numbers);
            at += count as u64;
            left -= count as u64;
        }
        Ok(())
    }

    /// The elements of a sample as arrays of `N` single-precision numbers. Elements of more numbers are cut.
    ///
    /// # Errors
    /// As [`Self::numbers`], and for elements of fewer numbers.
    pub fn vectors<const N: usize>(
        &mut self,
        property: &Property,
        sample: u64,
        take: &mut dyn FnMut([f32; N]),
    ) -> Result<(), AlembicError> {
        let extent = usize::from(property.ty.extent);
        if extent < N {
            let found = format!("elements of {extent} numbers in {}", property.name);
            return Err(AlembicError::malformed(property.group, found, "vectors"));
        }
        self.numbers(property, sample, &mut |numbers| {
            for element in numbers.chunks_exact(extent) {
                take(std::array::from_fn(|i| element[i] as f32));
            }
        })
    }

    /// The texts of a sample of at most `most` bytes.
    ///
    /// # Errors
    /// As [`Self::elements`], and for numbers or more bytes.
    pub fn texts(
        &mut self,
        property: &Property,
        sample: u64,
        most: u64,
    ) -> Result<Vec<String>, AlembicError> {
        let (at, size) = self.place(property, sample)?;
        if property.ty.pod != Pod::String || size > most {
            let found = format!("{size} bytes of {}", property.name);
            return Err(AlembicError::malformed(property.group, found, "a few texts"));
        }
        let mut bytes = vec![0; size as usize];
        self.source.read(at, &mut bytes)?;
        // Each text ends with a zero.
        let whole = bytes.strip_suffix(&[0]).unwrap_or(&bytes);
        Ok(whole.split(|&byte| byte == 0).map(|text| String::from_utf8_lossy(text).into_owned()).collect())
    }

    /// All numbers of a sample that has at most `most`.
    ///
    /// # Errors
    /// As [`Self::numbers`], and for more numbers.
    pub fn few(&mut self, property: &Property, sample: u64, most: u64) -> Result<Vec<f64>, AlembicError> {
        let count = self.elements(property, sample)? * u64::from(property.ty.extent);
        if count > most {
            let found = format!("{count} numbers of {}", property.name);
            return Err(AlembicError::malformed(property.group, found, "fewer"));
        }
        let mut all = Vec::with_capacity(count as usize);
        self.numbers(property, sample, &mut |numbers| all.extend_from_slice(numbers))?;
        Ok(all)
    }
}
