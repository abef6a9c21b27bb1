use super::*;

fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    (0..width * height)
        .flat_map(|i| {
            let [r, g, b] = pixel(i % width, i / width);
            [r, g, b, 255]
        })
        .collect()
}

fn of(width: u32, height: u32, a: &[u8], b: &[u8]) -> FlipMap {
    flip(&Image::new(width, height, a).unwrap(), &Image::new(width, height, b).unwrap()).unwrap()
}

/// The authors' program.
fn published(width: u32, height: u32, a: &[u8], b: &[u8]) -> Vec<f32> {
    let image = |rgba: &[u8]| {
        let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(width, height, &rgb)
    };
    let map = nv_flip::flip(image(a), image(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    map.to_vec()
}

/// An image of stripes as thin as hair, noise and flat colour, from a seed.
fn scene(seed: u32) -> impl Fn(u32, u32) -> [u8; 3] {
    move |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503) ^ seed.wrapping_mul(97)) >> 7;
        let stripe = (x + y * seed / 3) % (3 + seed) < 2;
        match (x / 20 + y / 13) % 3 {
            0 => [if stripe { 200 } else { 20 }, 90, (seed * 37) as u8],
            1 => [noise as u8, (noise >> 8) as u8, 128],
            _ => [(x * 3) as u8, (y * 5) as u8, (seed * 11) as u8],
        }
    }
}

#[test]
fn every_pixel_matches_the_authors_program() {
    for (width, height, seeds) in [(97, 61, (1, 2)), (64, 64, (2, 5)), (5, 3, (3, 4)), (1, 40, (1, 7))] {
        let [a, b] = [seeds.0, seeds.1].map(|seed| picture(width, height, scene(seed)));
        let map = of(width, height, &a, &b);
        let expected = published(width, height, &a, &b);
        let largest = map.values.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // Measured: at most 3.8e-5, because the authors' program sums in another order and takes roots of small numbers.
        assert!(largest < 2e-4, "{width}x{height}: {largest}");
        let mean = expected.iter().sum::<f32>() / expected.len() as f32;
        assert!((map.mean() - f64::from(mean)).abs() < 2e-5, "{} {mean}", map.mean());
    }
}

#[test]
fn equal_images_do_not_differ_and_the_farthest_colours_differ_by_one() {
    let a = picture(40, 30, scene(3));
    let same = of(40, 30, &a, &a);
    assert_eq!((same.mean(), same.percentile(1.0), same.weighted_percentile(0.99)), (0.0, 0.0, 0.0));
    let [green, blue] = [[0, 255, 0], [0, 0, 255]].map(|rgb| picture(40, 30, move |_, _| rgb));
    let most = of(40, 30, &green, &blue);
    assert!(most.values.iter().all(|value| (value - 1.0).abs() < 1e-4), "{:?}", &most.values[..3]);
    // The order of the arguments does not matter. Negative control: their contents do.
    assert!((of(40, 30, &blue, &green).mean() - most.mean()).abs() < 1e-6);
    assert!(of(40, 30, &green, &a).mean() < 0.99);
}

#[test]
fn percentiles_by_hand() {
    let map = FlipMap { width: 4, height: 1, values: vec![0.4, 0.1, 0.3, 0.2] };
    assert!((map.mean() - 0.25).abs() < 1e-7);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "{a} {b}");
    near(map.percentile(0.5), 0.2);
    near(map.percentile(0.99), 0.4);
    near(map.percentile(0.0), 0.1);
    // Weights .1 .2 .3 .4: half of their sum is reached within the third.
    near(map.weighted_percentile(0.5), 0.3);
    near(map.weighted_percentile(0.99), 0.4);
    near(FlipMap { width: 0, height: 0, values: vec![] }.percentile(0.5), 0.0);
    near(map.percentile(f64::NAN), 0.1);
}

#[test]
fn images_of_different_size_are_refused() {
    let [a, b] = [[0; 16], [0; 16]];
    let error = flip(&Image::new(4, 1, &a).unwrap(), &Image::new(2, 2, &b).unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "an image of 2 x 2 pixels cannot be compared with one of 4 x 1");
}
