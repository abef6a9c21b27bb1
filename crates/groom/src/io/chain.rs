//! Joins separate line segments into strands.

/// Strands as sequences of vertices.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Chains {
    /// Number of vertices of each strand.
    pub(super) counts: Vec<u32>,
    /// The first listed segment of each strand.
    pub(super) first_listed: Vec<u32>,
    /// The vertices of all strands, one strand after the other.
    pub(super) vertices: Vec<u32>,
}

/// Joins segments, given as pairs of vertices below `vertices`, that share a vertex. Where three segments or more meet,
/// strands end. A closed loop ends with its first vertex. A strand runs in the direction in which most of its segments
/// are listed, and strands are in the order of their first listed segments.
pub(super) fn chain(segments: &[[u32; 2]], vertices: usize) -> Chains {
    let is_line = |&[a, b]: &[u32; 2]| a != b;
    // The segments at vertex `v` are `at[first[v]..first[v + 1]]`.
    let mut first = vec![0_u32; vertices + 1];
    for segment in segments.iter().filter(|segment| is_line(segment)) {
        for &vertex in segment {
            first[vertex as usize + 1] += 1;
        }
    }
    for v in 0..vertices {
        first[v + 1] += first[v];
    }
    let mut at = vec![0_u32; first[vertices] as usize];
    let mut next = first.clone();
    for (index, segment) in segments.iter().enumerate().filter(|(_, segment)| is_line(segment)) {
        for &vertex in segment {
            at[next[vertex as usize] as usize] = index as u32;
            next[vertex as usize] += 1;
        }
    }
    drop(next);
    let at_vertex = |v: u32| &at[first[v as usize] as usize..first[v as usize + 1] as usize];
    // The other segment at a vertex where exactly two meet.
    let beyond = |segment: u32, v: u32| match *at_vertex(v) {
        [a, b] if a == segment => Some(b),
        [a, b] if b == segment => Some(a),
        _ => None,
    };
    let other_end = |segment: u32, v: u32| {
        let [a, b] = segments[segment as usize];
        if a == v { b } else { a }
    };
    let mut used = vec![false; segments.len()];
    let mut chains = Chains::default();
    for seed in 0..segments.len() as u32 {
        if used[seed as usize] || !is_line(&segments[seed as usize]) {
            continue;
        }
        let (mut segment, mut start) = (seed, segments[seed as usize][0]);
        while let Some(before) = beyond(segment, start).filter(|&before| before != seed) {
            (segment, start) = (before, other_end(before, start));
        }
        if beyond(segment, start) == Some(seed) {
            // A closed loop.
            (segment, start) = (seed, segments[seed as usize][0]);
        }
        let begin = chains.vertices.len();
        chains.vertices.push(start);
        let (mut at, mut forward) = (start, 0_i64);
        let mut current = Some(segment);
        while let Some(segment) = current.filter(|&segment| !used[segment as usize]) {
            used[segment as usize] = true;
            forward += if segments[segment as usize][0] == at { 1 } else { -1 };
            at = other_end(segment, at);
            chains.vertices.push(at);
            current = beyond(segment, at);
        }
        if forward < 0 {
            chains.vertices[begin..].reverse();
        }
        chains.first_listed.push(seed);
        chains.counts.push((chains.vertices.len() - begin) as u32);
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::chain;

    fn strands(segments: &[[u32; 2]], vertices: usize) -> Vec<Vec<u32>> {
        let chains = chain(segments, vertices);
        let mut rest = &chains.vertices[..];
        let mut take = |count: &u32| {
            let (strand, after) = rest.split_at(*count as usize);
            rest = after;
            strand.to_vec()
        };
        chains.counts.iter().map(&mut take).collect()
    }

    #[test]
    fn segments_become_strands_in_any_order() {
        let wanted = [vec![0, 1, 2, 3], vec![4, 5, 6]];
        for segments in [
            [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6]],
            [[2, 3], [5, 6], [0, 1], [1, 2], [4, 5]],
            // Most of the segments give the direction.
            [[1, 0], [1, 2], [2, 3], [4, 5], [5, 6]],
        ] {
            assert_eq!(strands(&segments, 7), wanted, "{segments:?}");
        }
        assert_eq!(strands(&[[3, 2], [2, 1]], 9), [[3, 2, 1]]);
    }

    #[test]
    fn forks_loops_and_points() {
        // Three strands from one root.
        assert_eq!(strands(&[[0, 1], [0, 2], [0, 3], [3, 4]], 5), [vec![0, 1], vec![0, 2], vec![0, 3, 4]]);
        assert_eq!(strands(&[[0, 1], [1, 2], [2, 0]], 3), [[0, 1, 2, 0]]);
        // The same segment twice is a loop of two.
        assert_eq!(strands(&[[0, 1], [0, 1]], 2), [[0, 1, 0]]);
        assert_eq!(strands(&[[1, 1]], 2), Vec::<Vec<u32>>::new());
        // A loop on a stalk.
        assert_eq!(strands(&[[0, 1], [1, 2], [2, 3], [3, 1]], 4), [vec![0, 1], vec![1, 2, 3, 1]]);
    }
}
