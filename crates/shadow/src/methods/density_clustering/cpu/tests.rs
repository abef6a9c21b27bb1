use super::super::ClusterSeeds;
use super::*;

fn method(clusters: u32, seeds: ClusterSeeds) -> Clustering {
    let mut settings = ShadowSettings::default();
    settings.density_clustering =
        DensityClusteringSettings { clusters, seeds, ..settings.density_clustering };
    Clustering::new(&settings)
}

fn filled(method: &Clustering, fragments: &[(f32, f32)]) -> Vec<Bin> {
    let mut record = vec![Bin { start: 9.0, per_depth: 9.0, optical_depth: 9.0 }; method.cells()];
    let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
    method.fill(&mut fragments, &mut record);
    record
}

const SEEDS: [ClusterSeeds; 3] = [ClusterSeeds::Uniform, ClusterSeeds::TowardLight, ClusterSeeds::Histogram];

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-5
}

#[test]
fn an_even_distribution_is_recovered_exactly() {
    // One cluster: σ = W / √12, so that ±√3 σ is the whole width.
    let fragments: Vec<_> = (0..1000).map(|i| (0.2 + 0.4 * (i as f32 + 0.5) / 1000.0, 2e-3)).collect();
    let method = method(1, ClusterSeeds::Uniform);
    let record = filled(&method, &fragments);
    for (depth, before) in
        [(0.1, 0.0), (0.2, 0.0), (0.3, 0.5), (0.4, 1.0), (0.5, 1.5), (0.6, 2.0), (2.0, 2.0)]
    {
        let found = method.depth_before(&[], &record, depth);
        // A thousand points have a deviation of 1e-6 less than the continuum.
        assert!((found - before).abs() < 1e-4, "at {depth}: {found}");
    }
}

#[test]
fn one_fragment_and_many_at_one_depth_are_a_step() {
    for seeds in SEEDS {
        for clusters in 1..=8 {
            let method = method(clusters, seeds);
            for n in [1, 5] {
                let record = filled(&method, &vec![(0.5, 0.25); n]);
                for (depth, part) in [(0.0, 0.0), (0.499_99, 0.0), (0.5, 0.0), (0.500_01, 1.0), (2.0, 1.0)] {
                    let found = method.depth_before(&[], &record, depth);
                    assert_eq!(found, 0.25 * part * n as f32, "{seeds:?}, {clusters}: at {depth}");
                }
            }
        }
    }
}

#[test]
fn clusters_without_hair_or_spread_leave_the_others_alone() {
    // Two depths and up to eight clusters: two clusters have no spread, and the others are empty.
    for seeds in SEEDS {
        for clusters in 2..=8 {
            let method = method(clusters, seeds);
            let record = filled(&method, &[(0.2, 0.5), (0.2, 0.25), (0.8, 1.0)]);
            let cases = [(0.19, 0.0), (0.21, 0.75), (0.5, 0.75), (0.79, 0.75), (0.81, 1.75), (2.0, 1.75)];
            for (depth, before) in cases {
                let found = method.depth_before(&[], &record, depth);
                assert!(close(found, before), "{seeds:?}, {clusters}: {found} at {depth}");
            }
        }
    }
}

#[test]
fn hair_without_optical_depth_casts_nothing() {
    for clusters in 1..=8 {
        let method = method(clusters, ClusterSeeds::Histogram);
        let record = filled(&method, &[(0.2, 0.0), (0.4, 0.0), (0.9, 0.0)]);
        for depth in [0.1, 0.3, 0.5, 2.0] {
            assert_eq!(method.depth_before(&[], &record, depth), 0.0);
        }
    }
}

#[test]
fn bins_that_overlap_meet_half_way_and_hold_their_centres() {
    // The first bin extends far over the centre of the second.
    let ranges = ranges(&[0.4, 0.5, 0.9], &[0.2, 0.01, 0.0], 0.002, 3);
    let (first, second, third) = (ranges[0], ranges[1], ranges[2]);
    assert_eq!(first.1, second.0);
    assert!((0.4..=0.5).contains(&first.1) && first.0 < 0.4 && second.1 > 0.5);
    // Without overlap nothing is moved, and a cluster without spread has the least width.
    assert!((third.1 - third.0 - 0.002).abs() < 1e-9 && third.0 > second.1);
    // Half way, where both centres lie outside the overlap.
    let [a, b] = super::ranges(&[0.3, 0.6], &[0.1, 0.1], 0.0, 2);
    let expected = 0.5 * (f64::from(0.3_f32) + f64::from(0.6_f32));
    assert!((a.1 - expected).abs() < 1e-9 && a.1 == b.0);
}

#[test]
fn all_of_the_hair_counts_wherever_it_falls() {
    // Fragments outside all bins go to the nearest one: none is lost or counted twice.
    let mut state = 7_u64;
    let mut unit = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    for case in 0..500 {
        let fragments: Vec<_> = (0..=case % 40).map(|_| (unit().powi(3), 0.01 + unit())).collect();
        let sum: f32 = fragments.iter().map(|f| f.1).sum();
        for seeds in SEEDS {
            let method = method(1 + case % 8, seeds);
            let record = filled(&method, &fragments);
            let total: f32 = record.iter().map(|bin| bin.optical_depth).sum();
            assert!((total - sum).abs() < 1e-4 * sum, "{total} of {sum}");
            // Bins do not overlap, and transmittance never rises.
            let mut last = 0.0;
            for step in 0..=100 {
                let before = method.depth_before(&[], &record, step as f32 * 0.0105 - 0.01);
                assert!(before >= last - 1e-5 && before <= sum * 1.0001, "{before} after {last}");
                last = before;
            }
        }
    }
}

#[test]
fn the_merged_deviation_is_that_of_the_pass_that_found_the_centres() {
    // If no hair changes its cluster, both are the same.
    let fragments = [(0.1, 1.0), (0.12, 1.0), (0.35, 0.5), (0.6, 1.0), (0.63, 2.0), (0.88, 1.0), (0.9, 1.0)];
    let mut settings = ShadowSettings::default();
    settings.density_clustering.seeds = ClusterSeeds::Uniform;
    let exact = filled(&Clustering::new(&settings), &fragments);
    settings.density_clustering.deviation = ClusterDeviation::Merged;
    let merged = filled(&Clustering::new(&settings), &fragments);
    for (a, b) in exact.iter().zip(&merged) {
        // One sums offsets from the seed, the other offsets from the centre.
        assert!(close(a.start, b.start) && close(1.0 / a.per_depth, 1.0 / b.per_depth), "{a:?}, {b:?}");
        assert_eq!(a.optical_depth, b.optical_depth);
    }
}
