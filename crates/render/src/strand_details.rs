//! Properties of strand points that do not change over time.

use std::sync::Arc;

use lovelock_groom::Hairstyle;
use lovelock_groom::fine::{FineStrands, lock_numbers};

/// One packed word per point, and the list of segments. Rebuilt when the hairstyle changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct StrandDetails {
    style: Option<Arc<Hairstyle>>,
    /// The number of fine strands; 0 for the stored ones.
    fine: usize,
    /// See [`pack_detail`].
    pub words: Vec<u32>,
    /// First point of each segment, in the order of strands.
    pub segments: Arc<Vec<u32>>,
}

impl StrandDetails {
    /// Rebuilds if the hairstyle has changed. Returns whether it has.
    pub fn follow(&mut self, style: &Arc<Hairstyle>) -> bool {
        if self.fine == 0 && self.style.as_ref().is_some_and(|old| Arc::ptr_eq(old, style)) {
            return false;
        }
        self.fine = 0;
        let mut segments = Vec::with_capacity(style.strands.segments());
        self.words.clear();
        self.words.resize(style.strands.points(), 0);
        let locks = lock_numbers(&style.strands);
        for (s, ends) in style.strands.first_point.windows(2).enumerate() {
            let (first, end) = (ends[0], ends[1]);
            segments.extend(first..end.saturating_sub(1).max(first));
            for i in first..end {
                self.words[i as usize] = pack_detail(
                    style.strands.taper.get(i as usize).copied().unwrap_or(1.0),
                    (i - first) as f32 / (end - first - 1).max(1) as f32,
                    style.strands.shade.get(s).copied().unwrap_or(0.5),
                    (i == first, i + 1 == end),
                    locks.get(s).copied().unwrap_or(0),
                );
            }
        }
        (self.style, self.segments) = (Some(Arc::clone(style)), Arc::new(segments));
        true
    }

    /// Rebuilds for all strands of a list if `style` or the list has changed. Returns whether it has.
    pub fn follow_fine(&mut self, style: &Arc<Hairstyle>, fine: &FineStrands, list_changed: bool) -> bool {
        let count = fine.strands.len();
        let same_style = self.style.as_ref().is_some_and(|old| Arc::ptr_eq(old, style));
        if same_style && !list_changed && self.fine == count {
            return false;
        }
        let set = &style.strands;
        let points = fine.points_per_strand;
        let last = points.saturating_sub(1).max(1);
        let of_strand = |i: usize| (i * points) as u32..(i * points + points.saturating_sub(1)) as u32;
        let mut segments = Vec::with_capacity(count * points.saturating_sub(1));
        segments.extend((0..count).flat_map(of_strand));
        self.segments = Arc::new(segments);
        self.words.clear();
        self.words.reserve(count * points);
        let locks = lock_numbers(&style.strands);
        for strand in &fine.strands {
            let ends = set.first_point.get(strand.parents[0] as usize..).unwrap_or(&[]);
            let own = match ends {
                [first, end, ..] => set.taper.get(*first as usize..*end as usize).unwrap_or(&[]),
                _ => &[],
            };
            for k in 0..points {
                let along = k as f32 / last as f32;
                let at = (along * own.len().saturating_sub(1) as f32).round() as usize;
                let taper = own.get(at).copied().unwrap_or(1.0);
                let shade = f32::from(strand.shade) / 255.0;
                let lock = locks.get(strand.parents[0] as usize).copied().unwrap_or(0);
                self.words.push(pack_detail(taper, along, shade, (k == 0, k == last), lock));
            }
        }
        (self.style, self.fine) = (Some(Arc::clone(style)), count);
        true
    }
}

/// Taper, position along the strand (0 root, 1 tip) and shade in 8 bits each, then whether the point is the first and whether it
/// is the last of its strand, and a random number of the lock in 6 bits.
fn pack_detail(taper: f32, along: f32, shade: f32, (first, last): (bool, bool), lock: u8) -> u32 {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    byte(taper)
        | byte(along) << 8
        | byte(shade) << 16
        | u32::from(first) << 24
        | u32::from(last) << 25
        | u32::from(lock) << 26
}
