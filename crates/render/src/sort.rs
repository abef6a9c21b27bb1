//! Segments from far to near.

use rayon::prelude::*;

/// Sorts segments by the depth of their middle, far first, by a counting sort on 16-bit depths.
///
/// Buffers are kept from frame to frame. The order of segments of equal depth is that of their index, so that
/// the same frame always gives the same picture.
#[derive(Debug, Default)]
pub(crate) struct DepthSort {
    depths: Vec<f32>,
    keys: Vec<u16>,
    counts: Vec<u32>,
    order: Vec<u32>,
}

impl DepthSort {
    /// `first_points` names the first point of each segment; `depth_of` gives a point's distance along the view.
    pub fn sort(&mut self, first_points: &[u32], depth_of: impl Fn(usize) -> f32 + Sync) -> &[u32] {
        self.depths.clear();
        first_points
            .par_iter()
            .map(|&first| {
                let middle = 0.5 * (depth_of(first as usize) + depth_of(first as usize + 1));
                if middle.is_finite() { middle } else { 0.0 }
            })
            .collect_into_vec(&mut self.depths);
        let (near, far) = self
            .depths
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(near, far), &d| (near.min(d), far.max(d)));
        let scale = if far > near { 65535.0 / (far - near) } else { 0.0 };
        self.depths.par_iter().map(|&d| ((far - d) * scale) as u16).collect_into_vec(&mut self.keys);

        self.counts.clear();
        self.counts.resize(1 << 16, 0);
        for &key in &self.keys {
            self.counts[key as usize] += 1;
        }
        let mut sum = 0;
        for count in &mut self.counts {
            let here = *count;
            *count = sum;
            sum += here;
        }
        self.order.resize(first_points.len(), 0);
        for (&first, &key) in first_points.iter().zip(&self.keys) {
            let slot = &mut self.counts[key as usize];
            self.order[*slot as usize] = first;
            *slot += 1;
        }
        &self.order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_comes_first() {
        let z: Vec<f32> = (0..1000).map(|i| ((i * 7919) % 1000) as f32 * 0.01).collect();
        let firsts: Vec<u32> = (0..999).collect();
        let mut sort = DepthSort::default();
        let order = sort.sort(&firsts, |i| z[i]).to_vec();
        let middle = |i: u32| 0.5 * (z[i as usize] + z[i as usize + 1]);
        // One key is the 65,535th part of the range: nothing may be out of order by more.
        assert!(order.windows(2).all(|w| middle(w[0]) >= middle(w[1]) - 10.0 / 65535.0));
        let mut all = order;
        all.sort_unstable();
        assert_eq!(all, firsts, "every segment is drawn once");
    }

    #[test]
    fn equal_and_non_finite_depths_keep_every_segment() {
        let mut sort = DepthSort::default();
        let firsts = [4, 8, 15];
        assert_eq!(sort.sort(&firsts, |_| 1.0), firsts);
        let mut order = sort.sort(&firsts, |i| if i == 8 { f32::NAN } else { i as f32 }).to_vec();
        order.sort_unstable();
        assert_eq!(order, firsts);
        assert!(sort.sort(&[], |_| 0.0).is_empty());
    }
}
