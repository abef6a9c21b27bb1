//! Onset strength: how much louder each band of frequency becomes from one frame to the next (section 3.1).

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use crate::sound::{RATE, Sound};

/// Samples of a spectrum: 21 ms.
const WINDOW: usize = 1024;
/// Samples from one frame to the next: 5.3 ms.
const HOP: usize = 256;
/// Frames per second.
pub(super) const FRAME_RATE: f64 = RATE as f64 / HOP as f64;
/// Bands of frequency, spaced by the mel scale.
const BANDS: usize = 40;
/// Amplitudes well below this one do not count: 80 dB below a full sine.
const FLOOR: f32 = 1e-4;
/// A sound is strongest in the flux when it has entered the window by about a third: the centre of the window is then this much before
/// its onset, seconds. Measured with clicks.
const LEAD_SECS: f64 = 0.0053;

/// The time of a frame, seconds: that of the onset which it shows.
pub(super) fn secs_of(frame: usize) -> f64 {
    (frame as f64 / FRAME_RATE + LEAD_SECS).max(0.0)
}

/// The onset strength of each frame, with the mean removed and a deviation of 1; all 0 where nothing ever changes.
pub(super) fn strength(sound: &Sound) -> Vec<f32> {
    let fft = RealFftPlanner::<f32>::new().plan_fft_forward(WINDOW);
    let (mut input, mut spectrum) = (fft.make_input_vec(), fft.make_output_vec());
    let mut scratch = fft.make_scratch_vec();
    let phase = |i: usize| std::f32::consts::TAU * i as f32 / WINDOW as f32;
    let hann: Vec<f32> = (0..WINDOW).map(|i| 0.5 - 0.5 * phase(i).cos()).collect();
    let edges = band_edges();
    let frames = sound.frames() / HOP + 1;
    let mut flux = Vec::with_capacity(frames);
    let (mut before, mut now) = ([0.0_f32; BANDS], [0.0_f32; BANDS]);
    for frame in 0..frames {
        let start = (frame * HOP) as i64 - WINDOW as i64 / 2;
        sound.mono(start..start + WINDOW as i64, &mut input);
        input.iter_mut().zip(&hann).for_each(|(sample, weight)| *sample *= weight);
        // Sizes are those of the plan, so it cannot refuse them.
        if fft.process_with_scratch(&mut input, &mut spectrum, &mut scratch).is_err() {
            return vec![0.0; frames];
        }
        for (band, level) in now.iter_mut().enumerate() {
            let bins = &spectrum[edges[band]..edges[band + 1]];
            let power: f32 = bins.iter().map(Complex::norm_sqr).sum();
            // A full sine has the amplitude WINDOW / 4 in its bin.
            let amplitude = power.sqrt() / (WINDOW as f32 / 4.0);
            *level = (1.0 + amplitude / FLOOR).ln();
        }
        let rise: f32 = now.iter().zip(&before).map(|(now, before)| (now - before).max(0.0)).sum();
        flux.push(if frame == 0 { 0.0 } else { rise });
        before = now;
    }
    normalised(smooth(&high_pass(&flux)))
}

/// The first bins of the bands, and one past the last bin of the last one. Each band has at least one bin.
fn band_edges() -> [usize; BANDS + 1] {
    let mel = |hertz: f32| 2595.0 * (1.0 + hertz / 700.0).log10();
    let hertz = |mel: f32| 700.0 * (10.0_f32.powf(mel / 2595.0) - 1.0);
    let [low, high] = [30.0, 16_000.0].map(mel);
    let bin_hertz = RATE as f32 / WINDOW as f32;
    let mut edges = [0; BANDS + 1];
    for i in 0..=BANDS {
        let at = hertz(low + (high - low) * i as f32 / BANDS as f32) / bin_hertz;
        let least = if i == 0 { 1 } else { edges[i - 1] + 1 };
        edges[i] = (at.round() as usize).max(least);
    }
    edges
}

/// Removes slow changes of loudness: the mean over about 0.8 s (the paper filters at 0.4 Hz).
fn high_pass(flux: &[f32]) -> Vec<f32> {
    let reach = (0.4 * FRAME_RATE) as usize;
    let mut sums = Vec::with_capacity(flux.len() + 1);
    sums.push(0.0_f64);
    for &value in flux {
        sums.push(sums[sums.len() - 1] + f64::from(value));
    }
    let mean = |i: usize| {
        let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(flux.len()));
        ((sums[to] - sums[from]) / (to - from) as f64) as f32
    };
    flux.iter().enumerate().map(|(i, &value)| (value - mean(i)).max(0.0)).collect()
}

/// Smoothed by a Gaussian with a deviation of about 10 ms (the paper: 20 ms wide).
fn smooth(flux: &[f32]) -> Vec<f32> {
    const REACH: i64 = 5;
    let weight = |i: i64| (-0.5 * (i as f32 / 1.9).powi(2)).exp();
    let total: f32 = (-REACH..=REACH).map(weight).sum();
    let at = |i: i64| usize::try_from(i).ok().and_then(|i| flux.get(i)).copied().unwrap_or(0.0);
    (0..flux.len() as i64)
        .map(|i| (-REACH..=REACH).map(|k| weight(k) * at(i + k)).sum::<f32>() / total)
        .collect()
}

fn normalised(mut values: Vec<f32>) -> Vec<f32> {
    let count = values.len().max(1) as f64;
    let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / count;
    let variance = values.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / count;
    let scale = if variance > 1e-6 { 1.0 / variance.sqrt() } else { 0.0 };
    for value in &mut values {
        *value = ((f64::from(*value) - mean) * scale) as f32;
    }
    values
}
