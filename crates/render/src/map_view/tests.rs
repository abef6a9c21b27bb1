use std::sync::Arc;

use lovelock_base::random::SplitMix64;
use lovelock_groom::Strands;
use lovelock_picture::{MapForm, MapValue, MapView};
use lovelock_shadow::{Bounds, LightFrame, ShadowInput, ShadowMethod, ShadowSettings, cpu_shadow};

use super::paint::{color_at, opacity_at};
use super::*;
use crate::Camera;

/// The slab of hair, metres along the light (down) and across it.
const DEPTH: f32 = 0.2;
const WIDTH: f32 = 0.16;
const COUNT: usize = 60_000;
/// Length of each strand, across the light, metres.
const LENGTH: f32 = 0.008;
const STRAND_WIDTH: f32 = 2e-4;

/// What hair absorbs per metre: `s w` times the length of all hair over the volume.
fn absorption(extinction: f32) -> f32 {
    extinction * STRAND_WIDTH * LENGTH * COUNT as f32 / (DEPTH * WIDTH * WIDTH)
}

/// Short strands spread evenly over the slab.
fn slab() -> Strands {
    let mut random = SplitMix64::new(3);
    let mut strands = Strands::default();
    let mut first_point = vec![0];
    for i in 0..COUNT {
        let along = DEPTH * (i as f32 + random.unit()) / COUNT as f32;
        let across = [random.unit(), random.unit()].map(|u| WIDTH * (u - 0.5));
        let turned = i % 2 == 0;
        for side in [-0.5, 0.5] {
            let off = side * LENGTH;
            strands.x.push(across[0] + if turned { off } else { 0.0 });
            strands.y.push(-along);
            strands.z.push(across[1] + if turned { 0.0 } else { off });
        }
        first_point.push(strands.x.len() as u32);
    }
    strands.first_point = Arc::from(first_point);
    strands
}

/// Calls `with` with the field of the slab.
fn with_field<T>(method: ShadowMethod, extinction: f32, with: impl FnOnce(&Field) -> T) -> T {
    let strands = slab();
    let light = LightFrame::new(Vec3::NEG_Y);
    let input = ShadowInput {
        strands: &strands,
        strand_width: STRAND_WIDTH,
        extinction_scale: extinction,
        light,
        anchor: Vec3::ZERO,
        maps: 1,
        projected: None,
    };
    let mut shadow = cpu_shadow(method);
    shadow.build(&input, &ShadowSettings { method, ..ShadowSettings::default() }).expect("fits");
    let Bounds { min, max, .. } = Bounds::of_strands(&input);
    with(&Field { shadow: &*shadow, light, anchor: Vec3::ZERO, min, max, step: 0.01 })
}

/// Points in the middle of the slab across the light, at a depth.
fn at_depth(depth: f32) -> Vec<Vec3> {
    let across = |i: usize| 0.1 * (i as f32 / 19.0 - 0.5);
    (0..400).map(|i| Vec3::new(across(i % 20), -depth, across(i / 20))).collect()
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

#[test]
fn density_and_transmittance_of_an_even_slab_are_those_on_paper() {
    for method in [ShadowMethod::VoxelMap, ShadowMethod::OpacityMaps, ShadowMethod::Exact] {
        let [thin, dense] = [0.05, 0.1].map(|extinction| {
            with_field(method, extinction, |field| {
                let kappa = absorption(extinction);
                for depth in [0.05, 0.1, 0.15] {
                    let light = mean(&field.transmittance(&at_depth(depth)));
                    assert!((light - (-kappa * depth).exp()).abs() < 0.01, "{method}, {depth}: {light}");
                }
                // Along the whole depth, so that single strands do not matter.
                let all: Vec<Vec3> = (2..18).flat_map(|i| at_depth(0.01 * i as f32)).collect();
                let found = mean(&field.density(&all));
                assert!((found / kappa - 1.0).abs() < 0.1, "{method}: {found}, on paper {kappa}");
                assert_eq!(field.density(&at_depth(DEPTH + 0.05)), vec![0.0; 400], "{method}: behind");
                assert_eq!(field.density(&at_depth(-0.05)), vec![0.0; 400], "{method}: before");
                found
            })
        });
        // The control: half of the extinction is half of the density.
        assert!((dense / thin - 2.0).abs() < 0.1, "{method}: {dense} {thin}");
    }
}

fn grey(side: u32) -> Picture {
    Picture { width: side, height: side, rgba: [90, 90, 90, 255].repeat((side * side) as usize) }
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let at = 4 * (y * picture.width + x) as usize;
    [picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2]]
}

#[test]
fn a_pixel_of_a_slice_has_the_colour_of_the_map_there() {
    // From the side: the middle of the image shows the plane across the second axis at the middle of the slab.
    let light = LightFrame::new(Vec3::NEG_Y);
    let camera = Camera {
        eye: Vec3::new(0.0, -0.5 * DEPTH, 0.0) + 2.0 * light.y,
        target: Vec3::new(0.0, -0.5 * DEPTH, 0.0),
        fov_y: 0.3,
        shear: glam::Vec2::ZERO,
    };
    with_field(ShadowMethod::VoxelMap, 1.0, |field| {
        let view = MapView {
            value: MapValue::Transmittance,
            form: MapForm::AlongLightY,
            slice: 0.5,
            opacity: 0.7,
            ..MapView::default()
        };
        let drawn = |view: &MapView| {
            let mut picture = grey(65);
            draw_field(field, view, &mut Canvas::new(&mut picture, &camera));
            picture
        };
        let picture = drawn(&view);
        let middle = Vec3::new(0.0, -0.5 * DEPTH, 0.0);
        let at = middle + (0.5 * (field.min.y + field.max.y)) * light.y;
        let place = field.transmittance(&[at])[0];
        let opacity = opacity_at(MapValue::Transmittance, place, 0.7);
        let expected = color_at(place).map(|c| 90.0 + (255.0 * c - 90.0) * opacity);
        let found = pixel(&picture, 32, 32);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((f32::from(found) - expected).abs() < 4.0, "{found} {expected}, place {place}");
        }
        // Light falls downward: the top is lighter than the bottom, and outside nothing is drawn.
        let bright = |[r, g, b]: [u8; 3]| u32::from(r) + u32::from(g) + u32::from(b);
        assert!(bright(pixel(&picture, 32, 25)) > bright(pixel(&picture, 32, 40)) + 100);
        assert_eq!(pixel(&picture, 2, 32), [90; 3]);
        // The controls: another slice is another image, and a plane that is seen from its edge is at most a line.
        assert!(drawn(&MapView { slice: 0.1, ..view }) != picture);
        let edge = drawn(&MapView { form: MapForm::AcrossLight, ..view });
        let changed = (0..65).filter(|&y| pixel(&edge, 31, y) != [90; 3]).count();
        assert!(changed < 8, "{changed} rows");
    });
}

#[test]
fn points_are_drawn_only_where_there_is_hair() {
    let camera = Camera {
        eye: Vec3::new(0.3, 0.2, 1.0),
        target: Vec3::new(0.0, -0.1, 0.0),
        fov_y: 0.5,
        shear: glam::Vec2::ZERO,
    };
    with_field(ShadowMethod::VoxelMap, 1.0, |field| {
        let view = MapView { value: MapValue::Density, form: MapForm::Points, ..MapView::default() };
        let changed = |points: u32| {
            let mut picture = grey(96);
            draw_field(field, &MapView { points, ..view }, &mut Canvas::new(&mut picture, &camera));
            picture.rgba.chunks(4).filter(|pixel| pixel[..3] != [90; 3]).count()
        };
        let all = changed(24);
        assert!(all > 800, "{all}");
        // An extent ten times as large has ten times as much empty space.
        let wide = Field { min: 3.0 * field.min, max: 3.0 * field.max, ..*field };
        let mut picture = grey(96);
        draw_points(&wide, &MapView { points: 72, ..view }, &mut Canvas::new(&mut picture, &camera));
        let within = picture.rgba.chunks(4).filter(|pixel| pixel[..3] != [90; 3]).count();
        assert!(within < all + all / 4, "{within} {all}");
    });
}

#[test]
fn colours_and_opacities_are_finite_for_any_value() {
    for place in [f32::NAN, f32::NEG_INFINITY, -1.0, 0.0, 0.3, 1.0, 7.0, f32::INFINITY] {
        assert!(color_at(place).iter().all(|c| (0.0..=1.0).contains(c)), "{place}");
    }
    assert_eq!(color_at(0.0), color_at(f32::NAN));
    assert!(opacity_at(MapValue::Transmittance, 0.0, 1.0) > opacity_at(MapValue::Transmittance, 1.0, 1.0));
    assert!(opacity_at(MapValue::Density, 0.0, 1.0) < opacity_at(MapValue::Density, 1.0, 1.0));
}
