use lovelock_base::random::SplitMix64;
use lovelock_testkit::clicks as click_samples;

use super::*;
use crate::sound::RATE;

/// Decaying clicks of noise, one per beat from `first` on, in the given part of the sound.
fn clicks(bpm: f64, first: f64, part: [f64; 2], secs: f64, loudness: f32) -> (Sound, Vec<f64>) {
    let mut random = SplitMix64::new(7);
    let mut samples = vec![0.0_f32; (secs * f64::from(RATE)) as usize];
    let count = ((part[1] - first) * bpm / 60.0).ceil() as i32;
    let times: Vec<f64> =
        (0..count).map(|i| first + f64::from(i) * 60.0 / bpm).filter(|t| *t >= part[0]).collect();
    for time in &times {
        let start = (time * f64::from(RATE)).round() as usize;
        for (i, sample) in samples.iter_mut().skip(start).take(2400).enumerate() {
            let decay = (-(i as f32) / 480.0).exp();
            *sample += loudness * decay * (random.unit() * 2.0 - 1.0);
        }
    }
    (Sound::new(samples.iter().map(|&s| Sound::quantised(s)).collect(), 1), times)
}

#[test]
fn clicks_are_found_within_20_ms_at_their_tempo() {
    for (bpm, first) in [(90.0, 0.3), (120.0, 0.0), (128.0, 0.113), (77.0, 1.0), (160.0, 0.2)] {
        let secs = 20.0;
        let (sound, times) = clicks(bpm, first, [0.0, secs], secs, 0.5);
        let beats = find_beats(&sound);
        let tempo = beats.tempo.expect("a tempo");
        assert!((tempo - bpm).abs() < 0.5, "{bpm}: {tempo}");
        assert!(
            beats.secs.len() + 2 >= times.len() && beats.secs.len() <= times.len(),
            "{bpm}: {}",
            beats.secs.len()
        );
        let worst = beats
            .secs
            .iter()
            .map(|beat| times.iter().map(|time| (beat - time).abs()).fold(f64::MAX, f64::min))
            .fold(0.0, f64::max);
        println!(
            "{bpm} bpm: {tempo:.2}, {} of {} beats, off by at most {:.1} ms",
            beats.secs.len(),
            times.len(),
            worst * 1e3
        );
        assert!(worst < 0.02, "{bpm}: off by {worst} s");
    }
}

/// Adds short bursts of high noise at a rate per minute, with an amplitude of `loudness` of the full one.
fn add_hats(samples: &mut [i16], per_minute: f64, loudness: f32) {
    let mut random = SplitMix64::new(5);
    let count = (samples.len() as f64 / f64::from(RATE) * per_minute / 60.0) as usize;
    for hat in 0..count {
        let start = (hat as f64 * 60.0 / per_minute * f64::from(RATE)).round() as usize;
        let mut before = 0.0;
        for (i, sample) in samples.iter_mut().skip(start).take(1500).enumerate() {
            let noise = random.unit() * 2.0 - 1.0;
            // The difference of neighbours has little but high frequencies.
            let high = 0.5 * (noise - std::mem::replace(&mut before, noise));
            *sample = sample.saturating_add(Sound::quantised(loudness * high * (-(i as f32) / 300.0).exp()));
        }
    }
}

#[test]
fn the_tempo_is_that_of_the_clicks_and_not_half_or_twice_of_it() {
    let mut wrong = Vec::new();
    for bpm in [60.0, 70.0, 90.0, 120.0, 150.0, 174.0, 180.0, 190.0] {
        let plain = click_samples(bpm, 20.0);
        let tempo_of = |samples: Vec<i16>| find_beats(&Sound::new(samples, 1)).tempo.expect("a tempo");
        let tempo = tempo_of(plain.clone());
        // The controls: quieter onsets between the beats do not double the tempo.
        let with_hats = [0.1, 0.3].map(|loudness| {
            let mut samples = plain.clone();
            add_hats(&mut samples, 2.0 * bpm, loudness);
            tempo_of(samples)
        });
        println!("{bpm} bpm: found {tempo:.2}; with hi-hats on eighths {with_hats:.2?}");
        // Hi-hats at twice a slow tempo are beats for most listeners as well.
        // Those as loud as the clicks at over 300 per minute make three of them a beat.
        let with_hats = with_hats.into_iter().take(if bpm <= 150.0 { 2 } else { 1 }).filter(|_| bpm >= 90.0);
        wrong.extend(with_hats.chain([tempo]).map(|found| [bpm, found]).filter(|[a, b]| (a - b).abs() > 0.5));
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn onsets_between_beats_are_told_from_beats() {
    let share = |samples: Vec<i16>, period_secs: f64| {
        let onsets = onset::strength(&Sound::new(samples, 1));
        tempo::between(&onsets, &track::beats(&onsets, period_secs * onset::FRAME_RATE))
    };
    let mut shares = Vec::new();
    for bpm in [150.0, 174.0, 190.0] {
        // Every second click as a beat, and every click as a beat with hi-hats between them.
        let plain = click_samples(bpm, 20.0);
        let mut hats = plain.clone();
        add_hats(&mut hats, 2.0 * bpm, 0.3);
        shares.push([share(plain.clone(), 120.0 / bpm), share(hats, 60.0 / bpm), share(plain, 60.0 / bpm)]);
    }
    println!("clicks, hi-hats, nothing between: {shares:.2?}");
    assert!(shares.iter().all(|[clicks, hats, nothing]| *clicks > tempo::AS_STRONG
        && *hats < tempo::AS_STRONG
        && *nothing < 0.2));
}

#[test]
fn quiet_clicks_in_noise_are_found_and_none_outside_their_part() {
    let (clean, times) = clicks(100.0, 5.0, [5.0, 25.0], 30.0, 0.4);
    let mut random = SplitMix64::new(3);
    let samples = clean.samples().iter().map(|&s| s.saturating_add((random.unit() * 700.0 - 350.0) as i16));
    let beats = find_beats(&Sound::new(samples.collect(), 1));
    assert!((beats.tempo.expect("a tempo") - 100.0).abs() < 1.0, "{:?}", beats.tempo);
    let near = |beat: &f64| times.iter().any(|time| (beat - time).abs() < 0.02);
    let count = beats.secs.iter().filter(|beat| near(beat)).count();
    assert!(count + 1 >= times.len() && beats.secs.len() <= times.len() + 1, "{count} of {:?}", beats.secs);
}

#[test]
fn noise_silence_tones_and_short_sounds_have_no_beats() {
    let length = 20 * RATE as usize;
    for seed in 0..4 {
        let mut random = SplitMix64::new(seed);
        let noise: Vec<i16> = (0..length).map(|_| Sound::quantised(random.unit() - 0.5)).collect();
        assert_eq!(find_beats(&Sound::new(noise, 1)), Beats::default(), "noise {seed}");
    }
    let tone = |i: usize| Sound::quantised(0.5 * (i as f32 * std::f32::consts::TAU * 440.0 / 48_000.0).sin());
    assert_eq!(find_beats(&Sound::new((0..length).map(tone).collect(), 1)), Beats::default(), "a tone");
    assert_eq!(find_beats(&Sound::new(vec![0; length], 2)), Beats::default(), "silence");
    assert_eq!(find_beats(&clicks(120.0, 0.0, [0.0, 2.0], 2.0, 0.5).0), Beats::default(), "two seconds");
    assert_eq!(find_beats(&Sound::default()), Beats::default());
    // Clicks at random times, two per second on average.
    let mut random = SplitMix64::new(11);
    let mut samples = vec![0_i16; length];
    for _ in 0..40 {
        let at = (random.unit() * (length - 2400) as f32) as usize;
        samples[at..at + 400].iter_mut().for_each(|s| *s = Sound::quantised(random.unit() - 0.5));
    }
    let beats = find_beats(&Sound::new(samples, 1));
    assert!(beats.secs.is_empty(), "irregular clicks: {beats:?}");
}
