//! The sequence of beats that is strong and regular (section 2).

/// How much regularity counts against strength (the paper's `alpha`, for onset strengths with a deviation of 1).
const TIGHTNESS: f64 = 400.0;

/// The frames of the beats, for a period in frames.
pub(super) fn beats(onsets: &[f32], period: f64) -> Vec<usize> {
    let nearest = (period / 2.0).round().max(1.0) as usize;
    let farthest = (period * 2.0).round() as usize;
    // The cost of a step between two beats: F(dt) = -alpha (log(dt / period))².
    let costs: Vec<f64> =
        (nearest..=farthest).map(|step| -TIGHTNESS * (step as f64 / period).ln().powi(2)).collect();
    // The best score of a sequence that ends at each frame, and the beat before it.
    let (mut scores, mut before) =
        (Vec::<f64>::with_capacity(onsets.len()), Vec::with_capacity(onsets.len()));
    let strongest = onsets.iter().copied().fold(0.0_f32, f32::max);
    for (frame, &onset) in onsets.iter().enumerate() {
        let steps = (nearest..=farthest.min(frame)).zip(&costs);
        let best = steps
            .map(|(step, cost)| (scores[frame - step] + cost, frame - step))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            // A sequence may begin at any frame.
            .filter(|(score, _)| *score > 0.0);
        scores.push(f64::from(onset) + best.map_or(0.0, |(score, _)| score));
        before.push(best.map(|(_, frame)| frame));
    }
    // The last beat is the best of the last period.
    let tail = onsets.len().saturating_sub(period.ceil() as usize);
    let last = (tail..onsets.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b]));
    let mut found: Vec<usize> = std::iter::successors(last, |&frame| before[frame]).collect();
    found.reverse();
    // Beats before the first and after the last onset were only extrapolated.
    let least = 0.1 * strongest;
    let strength = |&frame: &usize| {
        let near = frame.saturating_sub(4)..(frame + 5).min(onsets.len());
        onsets[near].iter().copied().fold(f32::MIN, f32::max)
    };
    let is_strong = |frame: &usize| strength(frame) >= least;
    let first = found.iter().position(is_strong).unwrap_or(found.len());
    let end = found.iter().rposition(is_strong).map_or(first, |last| last + 1);
    found[first..end].to_vec()
}
