//! A light that turns slightly from frame to frame while nothing else moves, to measure unwanted changes.

use glam::{Quat, Vec3};
use lovelock_groom::Strands;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{Light, Picture, Renderer, light_frame};
use lovelock_shadow::{LightFrame, ShadowInput};

use super::hair::{Hair, LitHair};
use super::stability::{SMALL, drawn, fits};
use super::truth::{Truth, converge_at};
use super::work::CheckCancel;
use crate::changes::ChangeReport;
use crate::report::{FootprintTruth, NamedTruth, Reference};

/// Number of steps of the light.
const STEPS: usize = 8;

/// Angle per step, degrees.
const DEGREES: f32 = 0.1;

/// Hair with fewer points is evaluated completely; otherwise every fourth tile of a grid on both axes, because the cost of the
/// ground truth grows with the evaluated area.
const FEW_POINTS: usize = 4096;

/// Number of tiles of that grid per axis.
const TILES: f32 = 16.0;

/// The evaluated tile of four, on each axis.
const TILE: [u32; 2] = [1, 2];

/// The directions of the light, and the ground truth for each.
pub(super) struct LightSweep {
    directions: Vec<Vec3>,
    /// The evaluated strand points.
    points: Vec<usize>,
    /// Transmittance per ground truth and direction; `None` if unknown.
    truths: Vec<Option<Vec<Vec<f32>>>>,
}

impl LightSweep {
    /// Computes the ground truth for every direction; `check_cancel` is called before each. `reference` receives the convergence (of
    /// the one that changed most) and the missing ones.
    ///
    /// # Errors
    /// The error of `check_cancel`. The inner error says what does not fit in memory, with numbers.
    pub(super) fn new(
        lit: LitHair,
        known: &[Truth],
        reference: &mut Reference,
        mut check_cancel: impl FnMut() -> Result<(), ProjectError>,
    ) -> Result<Result<Self, String>, ProjectError> {
        let LitHair { hair, project, light } = lit;
        let input = hair.shadow_input(project, light);
        let first = input.light;
        let strands = &hair.strands;
        let points = patches(strands, &first);
        if let Err(refused) = fits("a light that turns", STEPS as u64 + 1, points.len(), known.len()) {
            return Ok(Err(refused));
        }
        let directions = directions(first.x);
        let [x, y, z] = [&strands.x, &strands.y, &strands.z].map(|axis| picked(axis, &points));
        let mut worst: Option<FootprintTruth> = None;
        let mut truths = Vec::with_capacity(known.len());
        for known in known {
            let mut frames = Vec::with_capacity(directions.len());
            // If it fails without turning, another note says so.
            for &direction in directions.iter().filter(|_| known.transmittance.is_ok()) {
                check_cancel()?;
                match converge_at(&turned(&input, light, direction), &known.settings, [&x, &y, &z]) {
                    (Ok(found), facts) => {
                        frames.push(found);
                        if worst.as_ref().is_none_or(|worst| worst.change < facts.change) {
                            worst = Some(facts);
                        }
                    }
                    (Err(error), _) => {
                        reference.refused.push(format!("the truth under a light that turns: {error}"));
                        break;
                    }
                }
            }
            truths.push((frames.len() == directions.len()).then_some(frames));
        }
        reference.others.extend(worst.map(|facts| NamedTruth::new("light that turns".to_owned(), &facts)));
        Ok(Ok(Self { directions, points, truths }))
    }

    /// Changes with the settings of `project`, compared with the ground truth of this number.
    ///
    /// # Errors
    /// As rendering, or the error of `check_cancel`, which is called before each draw.
    pub(super) fn watch(
        &self,
        renderer: &mut Renderer,
        (hair, project): (&Hair, &Project),
        truth: usize,
        check_cancel: &mut CheckCancel,
    ) -> Result<ChangeReport, ProjectError> {
        let mut lit = project.clone();
        let first = lit.lights.iter().position(|light| light.enabled);
        lit.lights = first.map(|at| lit.lights[at].clone()).into_iter().collect();
        let mut frames = Vec::with_capacity(self.directions.len());
        for &direction in &self.directions {
            check_cancel()?;
            lit.lights.iter_mut().for_each(|light| *light = turned_light(light, direction, hair.head()));
            frames.push(picked(&drawn(renderer, &hair.frame_input(&lit))?, &self.points));
        }
        // Rendering without lights clears the axes of the map, so that the next render is not affected.
        lit.lights.clear();
        renderer.picture(&hair.frame_input(&lit), SMALL, SMALL, &mut Picture::default())?;
        Ok(ChangeReport::new(&frames, self.truths.get(truth).and_then(Option::as_ref)))
    }
}

/// The input with another light direction, with axes as in rendering.
fn turned<'a>(input: &ShadowInput<'a>, light: &Light, direction: Vec3) -> ShadowInput<'a> {
    let frame = if light.stands() {
        light_frame(&turned_light(light, direction, input.anchor), input.anchor)
    } else {
        input.light.transported(direction)
    };
    ShadowInput { light: frame, ..*input }
}

/// A light with another direction. One that stands somewhere goes around the head.
fn turned_light(light: &Light, direction: Vec3, head: Vec3) -> Light {
    let mut turned = light.clone();
    turned.direction = direction;
    if turned.stands() {
        turned.stand_before(head, light.position.distance(head));
    }
    turned
}

/// Directions that start at `first` (unit length) and turn sideways about the perpendicular axis nearest to the vertical.
fn directions(first: Vec3) -> Vec<Vec3> {
    let axis = Vec3::Y.reject_from_normalized(first).try_normalize().unwrap_or(Vec3::X);
    (0..=STEPS).map(|step| Quat::from_axis_angle(axis, DEGREES.to_radians() * step as f32) * first).collect()
}

/// The evaluated points: all of them if there are few, otherwise those in evenly spaced tiles across the light.
fn patches(strands: &Strands, light: &LightFrame) -> Vec<usize> {
    let count = strands.points();
    let across = |point: usize| {
        let p = light.light_from_world(Vec3::new(strands.x[point], strands.y[point], strands.z[point]));
        [p.y, p.z]
    };
    let finite = |point: &usize| across(*point).iter().all(|at| at.is_finite());
    let all = || (0..count).filter(finite);
    if count <= FEW_POINTS {
        return all().collect();
    }
    let mut low = [f32::INFINITY; 2];
    let mut high = [f32::NEG_INFINITY; 2];
    for at in all().map(across) {
        for axis in 0..2 {
            (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
        }
    }
    let size = ((high[0] - low[0]).max(high[1] - low[1]) / TILES).max(f32::MIN_POSITIVE);
    let within = |point: &usize| {
        let at = across(*point);
        (0..2).all(|axis| ((at[axis] - low[axis]) / size) as u32 % 4 == TILE[axis])
    };
    let chosen: Vec<usize> = all().filter(within).collect();
    // Hair outside all tiles is just a few strands.
    if chosen.is_empty() { all().take(FEW_POINTS).collect() } else { chosen }
}

fn picked(values: &[f32], points: &[usize]) -> Vec<f32> {
    points.iter().filter_map(|point| values.get(*point)).copied().collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use lovelock_render::ShadowSettings;

    use super::*;

    #[test]
    fn the_light_turns_by_a_tenth_of_a_degree_a_step() {
        for first in [Vec3::NEG_Y, Vec3::X, Vec3::new(-0.5, -0.7, -0.5).normalize_or_zero()] {
            let directions = directions(first);
            assert_eq!(directions.len(), STEPS + 1);
            assert_eq!(directions[0], first);
            for pair in directions.windows(2) {
                // The angle from its sine, which is accurate in single precision.
                let degrees = pair[0].cross(pair[1]).length().asin().to_degrees();
                assert!((degrees - 0.1).abs() < 1e-4, "{degrees}");
            }
            let whole = directions[0].cross(directions[STEPS]).length().asin().to_degrees();
            assert!((whole - 0.1 * STEPS as f32).abs() < 1e-3, "{whole}");
        }
    }

    /// `layers` sheets, 0.1 mm apart from height 0 down, each of touching strands along z.
    fn sheets(layers: u32, width: f32) -> Strands {
        let mut made = Strands::default();
        let mut first_point = vec![0];
        for layer in 0..layers {
            for strand in -50..50 {
                for z in [-0.005, 0.005] {
                    made.x.push((strand as f32 + 0.618 * layer as f32 % 1.0) * width);
                    made.y.push(-1e-4 * layer as f32);
                    made.z.push(z);
                }
                first_point.push(made.x.len() as u32);
            }
        }
        made.first_point = Arc::from(first_point);
        made
    }

    /// The ground truth below uniform sheets is known: at an angle, each sheet absorbs 1 / cosine times as much optical depth.
    #[test]
    fn the_ground_truth_of_sheets_follows_the_cosine() {
        let width = 2e-4;
        let strands = sheets(40, width);
        let first = Vec3::new(1.0, -1.0, 0.0).normalize_or_zero();
        let light = LightFrame::new(first);
        let input = ShadowInput {
            strands: &strands,
            strand_width: width,
            extinction_scale: 0.02,
            light,
            anchor: Vec3::ZERO,
            maps: 1,
            projected: None,
        };
        let settings = ShadowSettings::default();
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let at = |i: usize| [0.001 + 1e-5 * (i % 100) as f32, -0.0045, 1e-5 * i as f32 - 0.002][axis];
            (0..400).map(at).collect::<Vec<f32>>()
        });
        let sun = Light::default();
        let logarithm = |degrees: f32| {
            let direction = Quat::from_axis_angle(Vec3::Z, degrees.to_radians()) * first;
            let (found, facts) = converge_at(&turned(&input, &sun, direction), &settings, [&x, &y, &z]);
            assert!(facts.converged, "{facts:?}");
            let found = found.expect("fits");
            found.iter().map(|t| -f64::from(*t).ln()).sum::<f64>() / found.len() as f64
        };
        let cosine = |degrees: f64| (45.0 + degrees).to_radians().cos();
        // 40 sheets; measured 1.1312 of 1.1314.
        let before = logarithm(0.0);
        assert!((before * cosine(0.0) - 0.8).abs() < 1e-3, "{before}");
        // 1.01434 of 1.01431 measured.
        let flatter = logarithm(0.8) / before;
        assert!((flatter - cosine(0.0) / cosine(0.8)).abs() < 2e-4, "{flatter}");
        // Negative control: the other way it decreases.
        let steeper = logarithm(-0.8) / before;
        assert!((steeper - cosine(0.0) / cosine(-0.8)).abs() < 2e-4 && steeper < 1.0, "{steeper}");
    }

    #[test]
    fn patches_are_a_sixteenth_of_the_hair_from_everywhere() {
        let grid = |edge: usize| {
            let mut strands = Strands::default();
            for i in 0..edge * edge {
                strands.x.push((i % edge) as f32 / edge as f32);
                strands.y.push(0.3);
                strands.z.push((i / edge) as f32 / edge as f32);
            }
            strands.first_point = Arc::from([0, (edge * edge) as u32]);
            strands
        };
        let light = LightFrame::default();
        let many = grid(320);
        let chosen = patches(&many, &light);
        let part = chosen.len() as f64 / (320.0 * 320.0);
        assert!((part - 1.0 / 16.0).abs() < 0.005, "{part}");
        let mean = chosen.iter().map(|point| many.x[*point]).sum::<f32>() / chosen.len() as f32;
        assert!((mean - 0.5).abs() < 0.1, "{mean}");
        // All points of little hair, except NaN.
        let mut few = grid(20);
        few.x[7] = f32::NAN;
        assert_eq!(patches(&few, &light).len(), 399);
        // Hair at one place.
        let mut heap = grid(100);
        heap.x.fill(0.5);
        heap.z.fill(0.5);
        assert_eq!(patches(&heap, &light).len(), FEW_POINTS);
        assert_eq!(patches(&Strands::default(), &light), [0; 0]);
    }
}
