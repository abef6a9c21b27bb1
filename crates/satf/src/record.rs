//! Records of a sector for one azimuth of view: smoothed, as bytes, with their levels of detail.

use crate::layout::{ANGLES, MIP_START, MIPS, RECORD, TEXELS, texels_of};
use crate::sector::WIDTH;
use crate::trace::{AMBIENT, Rays};

/// Width of the smoothing in standard deviations of a strand's gaussian.
const SMOOTHING: f32 = 1.5;

/// Writes the finest level of the records of `rays`: `opacity` has [`TEXELS`] bytes or more, and `reflectances` as many
/// records of [`RECORD`] bytes as there are azimuths of light.
///
/// Both are smoothed along the arc by a gaussian of 1.5 `sigma`, which is in units of length, before the opacity is divided
/// out of the reflectance. The paper keeps the product, and multiplies by the opacity once more when it blends the layers.
pub(crate) fn write(rays: &Rays, sigma: f32, opacity: &mut [u8], reflectances: &mut [u8]) {
    let kernel = kernel(SMOOTHING * sigma / WIDTH * TEXELS as f32);
    let opaque = smoothed(&rays.opacity, &kernel);
    for (byte, value) in opacity.iter_mut().zip(opaque) {
        *byte = byte_of(value);
    }
    for (light, record) in reflectances.chunks_exact_mut(RECORD).enumerate().take(ANGLES) {
        let reflected = smoothed(&rays.reflected[light], &kernel);
        for ((byte, value), opaque) in record.iter_mut().zip(reflected).zip(opaque) {
            *byte = byte_of(if opaque > 1e-6 { value / opaque } else { AMBIENT });
        }
    }
}

/// Fills the coarser levels of `opacity`, a record whose finest level is set, with means.
pub(crate) fn opacity_mips(opacity: &mut [u8]) {
    for mip in 1..MIPS {
        for texel in 0..texels_of(mip) {
            let sum: u32 = opacity[texel << mip..(texel + 1) << mip].iter().map(|&o| u32::from(o)).sum();
            opacity[MIP_START[mip] + texel] = ((sum + (1 << mip) / 2) >> mip) as u8;
        }
    }
}

/// Fills the coarser levels of `reflectance` with means that are weighted by `opacity`, of the same sector and view.
pub(crate) fn reflectance_mips(opacity: &[u8], reflectance: &mut [u8]) {
    for mip in 1..MIPS {
        for texel in 0..texels_of(mip) {
            let (mut sum, mut weights) = (0, 0);
            for i in texel << mip..(texel + 1) << mip {
                // Never 0: the mean of transparent texels is defined too.
                let weight = 1 + 256 * u32::from(opacity[i]);
                sum += weight * u32::from(reflectance[i]);
                weights += weight;
            }
            reflectance[MIP_START[mip] + texel] = ((sum + weights / 2) / weights) as u8;
        }
    }
}

fn byte_of(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// A gaussian over the texels of one period, with `sigma` in texels and the sum 1.
fn kernel(sigma: f32) -> [f32; TEXELS] {
    let mut kernel = std::array::from_fn(|i| {
        let apart = i.min(TEXELS - i) as f32;
        (-0.5 * (apart / sigma) * (apart / sigma)).exp()
    });
    let sum: f32 = kernel.iter().sum();
    for weight in &mut kernel {
        *weight /= sum;
    }
    kernel
}

/// The periodic convolution of `values` with `kernel`.
fn smoothed(values: &[f32; TEXELS], kernel: &[f32; TEXELS]) -> [f32; TEXELS] {
    let mut twice = [0.0; 2 * TEXELS];
    twice[..TEXELS].copy_from_slice(values);
    twice[TEXELS..].copy_from_slice(values);
    let mut out = [0.0; TEXELS];
    for (shift, weight) in kernel.iter().enumerate() {
        for (sum, value) in out.iter_mut().zip(&twice[shift..]) {
            *sum += weight * value;
        }
    }
    out
}
