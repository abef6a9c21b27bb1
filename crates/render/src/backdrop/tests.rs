use std::sync::Arc;

use glam::Vec3;
use lovelock_appearance::environment::{BackdropPicture, BackdropPixels};
use lovelock_picture::{PictureFit, PictureSettings};

use super::resample::{Reduced, halvings, lay};
use super::{Backdrop, LaidBackdrop, encoded_of, linear_of, mixed, source};

fn laid(picture: BackdropPicture, settings: &PictureSettings, size: [u32; 2]) -> LaidBackdrop {
    let mut backdrop = Backdrop::default();
    backdrop.lay(source(&Arc::new(picture), settings, size), crate::cpu::encode);
    Arc::unwrap_or_clone(backdrop.laid.expect("laid"))
}

/// A picture whose left half is `a` and whose right half is `b`.
fn halves(a: u8, b: u8) -> BackdropPicture {
    let pixels = (0..64 * 32).map(|i| if i % 64 < 32 { [a, a, a, 255] } else { [b, b, b, 255] }).collect();
    BackdropPicture::from_pixels([64, 32], BackdropPixels::Display(pixels)).expect("a picture")
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1.5 / 1023.0
}

#[test]
fn a_picture_keeps_its_colours_at_any_size_and_exposure() {
    for (size, exposure_stops) in [([640, 320], 0.0), ([16, 8], 0.0), ([64, 32], 3.0)] {
        let settings = PictureSettings { exposure_stops, ..PictureSettings::default() };
        let laid = laid(halves(40, 200), &settings, size);
        let row = size[1] as usize / 2;
        for (x, byte) in [(1, 40.0), (size[0] as usize - 2, 200.0)] {
            assert!(near(laid.color(x, row)[1], byte / 255.0), "{size:?}: {:?}", laid.color(x, row));
        }
    }
    // The control: brightness does change them.
    let settings = PictureSettings { background_stops: -1.0, ..PictureSettings::default() };
    let half = laid(halves(200, 200), &settings, [64, 32]).color(9, 9)[0];
    assert!(near(half, encoded_of(0.5 * linear_of(200.0 / 255.0))), "{half}");
}

#[test]
fn a_fitted_picture_has_borders_of_the_background_and_a_filled_one_none() {
    let settings = PictureSettings { background_top: Vec3::ZERO, ..PictureSettings::default() };
    let of =
        |background_fit| laid(halves(200, 200), &PictureSettings { background_fit, ..settings }, [64, 64]);
    let (fit, fill) = (of(PictureFit::Fit), of(PictureFit::Fill));
    let middle = 200.0 / 255.0;
    assert!(near(fit.color(32, 32)[0], middle) && near(fill.color(32, 32)[0], middle));
    assert!(fit.color(32, 2)[0] < 0.02 && near(fill.color(32, 2)[0], middle), "{:?}", fit.color(32, 2));
}

#[test]
fn a_blur_spreads_an_edge_by_its_width() {
    let settings = PictureSettings { background_blur: 0.05, ..PictureSettings::default() };
    let size = [400, 200];
    let soft = laid(halves(0, 255), &settings, size);
    // One standard deviation, 10 pixels, from the edge: the bell's integral is 0.841.
    let light = linear_of(soft.color(210, 100)[0]);
    assert!((light - 0.85).abs() < 0.03, "{light}");
    let sharp = laid(halves(0, 255), &PictureSettings::default(), size);
    assert!(sharp.color(210, 100)[0] > 0.99, "the control");
}

#[test]
fn light_is_exposed_and_tone_mapped() {
    let picture = || {
        let pixels = vec![[0.18, 0.18, 0.18]; 8 * 4];
        BackdropPicture::from_pixels([8, 4], BackdropPixels::Light(pixels)).expect("a picture")
    };
    let of = |exposure_stops: f32| {
        let settings = PictureSettings { exposure_stops, ..PictureSettings::default() };
        laid(picture(), &settings, [8, 4]).color(4, 2)[0]
    };
    let mut truth = [[0.18], [0.18], [0.18]];
    crate::cpu::encode(&mut truth, 1.0);
    assert!(near(of(0.0), truth[0][0]) && of(1.0) > of(0.0) + 0.05, "{} {}", of(0.0), of(1.0));
}

#[test]
fn an_edge_is_mixed_by_its_coverage_as_a_screen_emits_it() {
    let (dark, bright) = ([0.2; 3], [0.9; 3]);
    let quarter = mixed(dark, bright, 0.25)[0];
    let truth = encoded_of(0.75 * linear_of(0.2) + 0.25 * linear_of(0.9));
    assert!((quarter - truth).abs() < 1e-5);
    assert_eq!(mixed(dark, bright, 1.0), bright);
    assert!((mixed(dark, bright, 0.0)[0] - 0.2).abs() < 1e-5);
}

/// Stripes of light and dark, 40 pixels each, of 641 by 320 pixels: the width is no multiple of a power of 2.
fn stripes() -> Arc<BackdropPicture> {
    let pixels =
        (0..641 * 320).map(|i| if i % 641 / 40 % 2 == 0 { [230, 230, 230, 255] } else { [20, 20, 20, 255] });
    let pixels = BackdropPixels::Display(pixels.collect());
    Arc::new(BackdropPicture::from_pixels([641, 320], pixels).expect("a picture"))
}

#[test]
fn a_reduced_copy_looks_as_the_whole_picture() {
    let picture = stripes();
    let of = source(&picture, &PictureSettings::default(), [78, 39]);
    assert_eq!(halvings(&of), 3);
    let laid = |halvings| {
        let pixels = lay(&of, &Reduced::new(&picture, halvings), crate::cpu::encode);
        LaidBackdrop { size: of.size, pixels, number: 1 }
    };
    let whole = laid(0);
    let farthest = |other: &LaidBackdrop| {
        let away = |x: usize| (linear_of(whole.color(x, 20)[1]) - linear_of(other.color(x, 20)[1])).abs();
        (0..78).map(away).fold(0.0, f32::max)
    };
    let (near, far) = (farthest(&laid(3)), farthest(&laid(7)));
    assert!(near < 0.15 && far > 2.0 * near, "{near}; the control, a copy that is too small: {far}");
}

#[test]
fn a_copy_of_about_the_size_of_the_image_is_kept_for_other_settings() {
    let picture = stripes();
    let mut backdrop = Backdrop::default();
    let settings = PictureSettings::default();
    let mut numbers = vec![0];
    let mut copy = |settings: PictureSettings, size: [u32; 2]| {
        backdrop.lay(source(&picture, &settings, size), crate::cpu::encode);
        numbers.push(backdrop.laid.as_ref().expect("laid").number);
        // One to two texels for each pixel.
        assert!(backdrop.bytes() <= 16 * 81 * 40 + 4 * 78 * 39, "{}", backdrop.bytes());
        let texels = &backdrop.copy.as_ref().expect("a copy").1.texels;
        (texels.as_ptr(), texels.len())
    };
    let first = copy(settings, [78, 39]);
    for other in [
        PictureSettings { background_stops: 1.0, ..settings },
        PictureSettings { background_blur: 0.02, ..settings },
        PictureSettings { background_top: Vec3::X, ..settings },
    ] {
        assert_eq!(copy(other, [78, 39]), first);
    }
    assert_eq!(copy(settings, [74, 37]), first, "a little smaller");
    assert_ne!(copy(settings, [32, 16]), first, "the control, a much smaller image");
    assert_eq!(numbers, [0, 1, 2, 3, 4, 5, 6]);
}
