//! The period of the beat, from the autocorrelation of the onset strength (section 3.2).

use super::onset::FRAME_RATE;

/// The tempo that is preferred where several fit, and how strongly: the deviation in octaves.
const USUAL_BPM: f64 = 120.0;
const SPREAD_OCTAVES: f64 = 0.9;
/// Slowest and quickest tempo, beats per minute.
const TEMPI: [f64; 2] = [40.0, 240.0];
/// The longest part that is correlated, seconds: the middle of the sound.
const LONGEST_SECS: f64 = 120.0;
/// Correlation with itself one beat later from which onsets count as regular.
const LEAST_CORRELATION: f64 = 0.1;
/// In short sounds the correlation must exceed this many deviations of that of noise.
const LEAST_DEVIATIONS: f64 = 4.5;
/// Frames that share a spectrum or are smoothed together, so that neighbours in noise are alike.
const ALIKE: f64 = 6.0;

/// The period of the beat in frames; `None` if the onsets are not regular.
pub(super) fn period(onsets: &[f32]) -> Option<f64> {
    let most = (LONGEST_SECS * FRAME_RATE) as usize;
    let skip = onsets.len().saturating_sub(most) / 2;
    let onsets = &onsets[skip..(skip + most).min(onsets.len())];
    let [shortest, longest] = [TEMPI[1], TEMPI[0]].map(|bpm| 60.0 * FRAME_RATE / bpm);
    let (shortest, longest) = (shortest.floor() as usize, longest.ceil() as usize);
    let product = |lag: usize| -> f64 {
        let Some(later) = onsets.get(lag..) else { return 0.0 };
        // Divided by the number of products, so that long periods in short sounds are not at a disadvantage.
        let sum: f64 = onsets.iter().zip(later).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum();
        sum / later.len().max(1) as f64
    };
    let power = product(0);
    if power <= 0.0 {
        return None;
    }
    // A tempo needs three beats, so longer periods of short sounds are not looked at.
    let longest = longest.min(onsets.len() / 3);
    let correlation: Vec<f64> = (0..=longest + 1).map(|lag| product(lag) / power).collect();
    let weight = |lag: usize| {
        let octaves = (60.0 * FRAME_RATE / lag as f64 / USUAL_BPM).log2();
        (-0.5 * (octaves / SPREAD_OCTAVES).powi(2)).exp()
    };
    let score = |lag: &usize| weight(*lag) * correlation[*lag];
    let best = (shortest..=longest).max_by(|a, b| score(a).total_cmp(&score(b)))?;
    let of_noise = (ALIKE / onsets.len() as f64).sqrt();
    if correlation[best] < LEAST_CORRELATION.max(LEAST_DEVIATIONS * of_noise) {
        return None;
    }
    // Between the lags, by a parabola through three of them.
    let (a, b, c) = (correlation[best - 1], correlation[best], correlation[best + 1]);
    let bend = a - 2.0 * b + c;
    let shift = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    Some(best as f64 + shift)
}

/// The quickest tempo that is reached by halving the period, beats per minute.
const QUICKEST_BPM: f64 = 195.0;
/// Onsets between the beats that are at least this strong, as a share of those at the beats, are beats as well. Measured: 1.00 for equal
/// clicks, 0.67 to 0.70 for hi-hats as loud as the clicks.
pub(super) const AS_STRONG: f64 = 0.85;
/// Frames around the middle between two beats in which an onset is looked for: 32 ms.
const AROUND: usize = 6;

/// Half of the period if the onsets in the middle between the beats are as strong as the beats: then the beats are twice as many. The
/// autocorrelation alone cannot tell, because equal clicks are equally alike one click and two clicks later.
pub(super) fn halved(onsets: &[f32], beats: &[usize], period: f64) -> Option<f64> {
    let half = period / 2.0;
    let is_slow = 60.0 * FRAME_RATE / half <= QUICKEST_BPM;
    (is_slow && between(onsets, beats) > AS_STRONG).then_some(half)
}

/// The strength of the onsets in the middle between the beats, as a share of that of the beats.
pub(super) fn between(onsets: &[f32], beats: &[usize]) -> f64 {
    let least = onsets.iter().copied().fold(f32::MAX, f32::min);
    let strongest = |frame: usize| {
        let around = frame.saturating_sub(AROUND)..(frame + AROUND + 1).min(onsets.len());
        onsets[around].iter().map(|&onset| f64::from(onset - least)).fold(0.0, f64::max)
    };
    let at_beats: f64 = beats.iter().skip(1).map(|&beat| strongest(beat)).sum();
    let between: f64 = beats.array_windows().map(|[a, b]| strongest(a.midpoint(*b))).sum();
    if at_beats > 0.0 { between / at_beats } else { 0.0 }
}
