//! Between the boundary sectors of a hair shell volume.

use std::f32::consts::{PI, TAU};

use lovelock_satf::boundary::{Params, Sweep, VolumeRecords, circular_mean, wrapped};
use lovelock_satf::{Curl, Features};

use crate::database;

fn params() -> Params {
    let features = Features { optical_depth: 0.8, s_centroid: 0.4, t_centroid: 0.6, curl: Curl::Loose };
    Params { features, theta_v: 3.1, theta_l: -0.4 }
}

#[test]
fn means_of_angles_go_the_short_way_round() {
    let near = |a: f32, b: f32| wrapped(a - b).abs() < 1e-5;
    assert!(near(circular_mean(3.1, -3.1), PI));
    assert!(near(circular_mean(-3.0, 3.1), -3.0 - 0.5 * (TAU - 6.1)));
    assert!(near(circular_mean(0.2, 0.6), 0.4));
    assert!(near(circular_mean(0.2 + TAU, 0.6 - TAU), 0.4));
    assert!((0.5 * (3.1_f32 - 3.1)).abs() < 1e-6, "the control: the plain mean is on the other side");
    assert!((wrapped(3.0 * PI).abs() - PI).abs() < 1e-5 && (wrapped(-7.0) - (TAU - 7.0)).abs() < 1e-5);
}

#[test]
fn differences_have_comparable_units() {
    let from = params();
    let apart = |change: fn(&mut Params)| {
        let mut other = from;
        change(&mut other);
        from.distance(&other)
    };
    assert_eq!(apart(|_| ()), 0.0);
    // The same azimuth by another number, and one just across ±π.
    assert!(apart(|p| p.theta_v += TAU) < 1e-5);
    assert!((apart(|p| p.theta_v = -3.1) - (TAU - 6.2) / PI).abs() < 1e-5);
    assert!((apart(|p| p.theta_l += PI) - 1.0).abs() < 1e-5);
    assert!((apart(|p| p.features.optical_depth += 4.0) - 0.5).abs() < 1e-5);
    assert!((apart(|p| p.features.s_centroid += 0.3) - 0.3).abs() < 1e-5);
    assert!((apart(|p| p.features.t_centroid -= 0.3) - 0.3).abs() < 1e-5);
}

#[test]
fn between_two_identical_records_lies_the_record() {
    let (p, database) = (params(), database());
    let volume = VolumeRecords::new(&p, &p, Sweep::Two, false);
    let sector = database.find(&p.features);
    let record = database.sample(sector, p.theta_v, p.theta_l, 0.3, 0.0);
    for gamma in [0.0, 0.3, 1.0] {
        assert_eq!(volume.sample(database, gamma, 0.3, 0.0), record);
    }
    let other = Params { theta_l: 2.0, ..p };
    let mixed = VolumeRecords::new(&p, &other, Sweep::Two, false).sample(database, 0.5, 0.3, 0.0);
    assert!((mixed.1 - record.1).abs() > 1e-3, "the control");
}

#[test]
fn two_records_are_blended_along_the_volume() {
    let (bottom, database) = (params(), database());
    let mut top = bottom;
    top.theta_v = -1.0;
    top.features.optical_depth = 2.0;
    let volume = VolumeRecords::new(&bottom, &top, Sweep::PAPER, false);
    let at = |gamma: f32| volume.sample(database, gamma, 0.6, 1.0);
    let (low, high, quarter) = (at(0.0), at(1.0), at(0.25));
    assert!((quarter.0 - (0.75 * low.0 + 0.25 * high.0)).abs() < 1e-6);
    assert!((quarter.1 - (0.75 * low.1 + 0.25 * high.1)).abs() < 1e-6);
    assert!((low.0 - high.0).abs() > 0.05, "the control: they differ");
    // The volume above begins with the record with which this one ends: no seam.
    let above = VolumeRecords::new(&top, &bottom, Sweep::Two, false);
    assert_eq!(above.sample(database, 0.0, 0.6, 1.0), high);
}

#[test]
fn the_paper_sweeps_one_record_where_the_parameters_are_close() {
    let bottom = params();
    let near = Params { theta_v: -3.1, ..bottom };
    let far = Params { theta_v: -2.0, ..bottom };
    let volume = VolumeRecords::new(&bottom, &near, Sweep::PAPER, true);
    assert!(volume.top.is_none() && volume.literal);
    // The average of azimuths on both sides of ±π is π.
    assert!((volume.bottom.theta_v.abs() - PI).abs() < 1e-5);
    assert_eq!(volume.sample(database(), 0.0, 0.4, 0.0), volume.sample(database(), 0.9, 0.4, 0.0));
    assert!(VolumeRecords::new(&bottom, &far, Sweep::PAPER, true).top.is_some());
    assert!(VolumeRecords::new(&bottom, &near, Sweep::Two, true).top.is_some());
}
