//! What the layers of a column let through and reflect: the maps of reflectance and opacity, from the records of the database.

// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_satf::boundary::{Params, Sweep, VolumeRecords};
use lovelock_satf::{Cell, ClusterSettings, Database, Features, RecordLookup};

use crate::MAX_LIGHTS;
use crate::cpu::math::{exp, floor, index_of, log2, max, min, mix};
use crate::cpu::strand_points::LitParts;

/// Sine of the angle between eye and hair below which the azimuth of the eye is not defined well: five degrees.
const ALONG_HAIR: f32 = 0.087;
/// The most texels of a map, with one of both neighbours.
const TEXELS: usize = 32 + 2;

/// One layer of a column: a quadrilateral between two ribs and two sections.
pub(super) struct Layer {
    /// Pixels from the corner of the tile, and depths.
    pub corners: [[f32; 3]; 4],
    /// Ambient light and the light of each light.
    pub lit: [LitParts; 4],
    /// Boundary sectors at both sections, of the layer and of its neighbours to both sides: `[side][section]`.
    pub cells: [[Cell; 2]; 3],
    /// Optical depth of one strand at both sections.
    pub depths: [f32; 2],
    /// Thickness of the layer as a fraction of its radius.
    pub thickness: f32,
}

/// The angles at the corners of a layer.
#[derive(Clone, Copy)]
pub(super) struct Angles {
    /// Azimuths of the eye, without jumps from corner to corner.
    pub view: [f32; 4],
    /// Those of each light.
    pub lights: [[f32; 4]; MAX_LIGHTS],
    pub cos_view: [f32; 4],
    pub sin_view: f32,
}

impl Angles {
    /// The same for rays along a light.
    pub fn of_light(self, light: usize) -> Self {
        let view = self.lights[light];
        Self { view, cos_view: view.map(f32::cos), sin_view: 1.0, ..self }
    }

    /// The azimuth of a light in the middle.
    pub fn light_in_middle(&self, light: usize) -> f32 {
        0.25 * self.lights[light].iter().sum::<f32>()
    }

    /// The azimuths of the eye and of a light.
    fn at(&self, light: usize, u: f32, t: f32) -> [f32; 2] {
        [self.view, self.lights[light]].map(|of| bilinear(of, u, t))
    }
}

/// Between four corners: both ribs at the lower section, then at the upper one.
#[inline(always)]
pub(super) fn bilinear(of: [f32; 4], u: f32, t: f32) -> f32 {
    mix(mix(of[0], of[1], u), mix(of[2], of[3], u), t)
}

/// The maps of a layer: texels across a sector, at both of its boundary sectors, with a texel of the neighbouring sectors at both ends,
/// so that nothing jumps where records change.
pub(super) struct Map {
    texels: usize,
    /// Optical depth along the radius at both sections, for one strand whose arc is as long as its width.
    depths: [[f32; 2]; TEXELS],
    /// Reflectance at both sections under each light.
    reflected: [[[f32; 2]; TEXELS]; MAX_LIGHTS],
    /// Lights of which the reflectance is known.
    lights: usize,
    /// One over the mean reflectance under each light.
    pub inverse_mean: [f32; MAX_LIGHTS],
    is_nearest: bool,
}

impl Map {
    /// The maps of `layer` under so many lights, with texels of the level of detail `mip`.
    pub fn new(
        database: &Database,
        settings: &ClusterSettings,
        layer: &Layer,
        (angles, lights): (&Angles, usize),
        mip: f32,
    ) -> Self {
        let is_nearest = settings.lookup == RecordLookup::Nearest;
        // The maximum of NaN and 0 is 0.
        let mip = if is_nearest { 0.0 } else { min(max(mip, 0.0), 5.0) };
        let texels = 32 >> mip as usize;
        let mut map = Self {
            texels,
            depths: [[0.0; 2]; TEXELS],
            reflected: [[[0.0; 2]; TEXELS]; MAX_LIGHTS],
            lights: lights.min(MAX_LIGHTS),
            inverse_mean: [1.0; MAX_LIGHTS],
            is_nearest,
        };
        if is_nearest {
            map.fill_nearest(database, layer, angles);
        } else {
            map.fill(database, layer, angles, mip);
        }
        for (inverse_mean, reflected) in map.inverse_mean.iter_mut().zip(&map.reflected).take(map.lights) {
            let own = &reflected[1..=texels];
            let mean = own.iter().map(|[low, high]| low + high).sum::<f32>() / (2 * texels) as f32;
            *inverse_mean = 1.0 / max(mean, 0.02);
        }
        map
    }

    fn fill(&mut self, database: &Database, layer: &Layer, angles: &Angles, mip: f32) {
        let step = 1.0 / self.texels as f32;
        let share = min(angles.sin_view / ALONG_HAIR, 1.0);
        for k in 0..self.texels + 2 {
            let u = (k as f32 - 0.5) * step;
            let (side, inside) = match k {
                0 => (0, u + 1.0),
                k if k > self.texels => (2, u - 1.0),
                _ => (1, u),
            };
            let cells = layer.cells[side];
            let lights = self.lights;
            let read = |cell: Cell, t: f32| {
                let of = cell.sector(1.0);
                let mut reflected = [0.0; MAX_LIGHTS];
                let azimuths = angles.at(0, u, t);
                let (mut opacity, first) = database.sample_stored(of, azimuths, inside, mip);
                reflected[0] = first;
                for (light, reflected) in reflected.iter_mut().enumerate().take(lights).skip(1) {
                    *reflected = database.reflectance_stored(of, angles.at(light, u, t), inside, mip);
                }
                if share < 1.0 {
                    for (light, reflected) in reflected.iter_mut().enumerate().take(lights.max(1)) {
                        let any = database.stored_any_view(of, angles.at(light, u, t)[1], inside, mip);
                        *reflected = mix(any.1, *reflected, share);
                        if light == 0 {
                            opacity = mix(any.0, opacity, share);
                        }
                    }
                }
                (depth_of(opacity) * of.tau_ratio, reflected)
            };
            let [low, high] = cells;
            // Equal sectors are one record, swept from section to section.
            let both =
                if low.has_sector_of(high) { [read(low, 0.5); 2] } else { [read(low, 0.0), read(high, 1.0)] };
            self.depths[k] = [0, 1].map(|s| cells[s].strands() * both[s].0);
            for light in 0..lights {
                self.reflected[light][k] = both.map(|(_, reflected)| reflected[light]);
            }
        }
    }

    /// As published: for each light the nearest record of the average density, one for both sections where they are alike. The opacity is
    /// that of the first light's records.
    fn fill_nearest(&mut self, database: &Database, layer: &Layer, angles: &Angles) {
        for light in 0..self.lights.max(1) {
            let params = [0, 1].map(|section| {
                let [theta_v, theta_l] = angles.at(light, 0.5, section as f32);
                let optical_depth = layer.cells[1][section].strands() * layer.depths[section];
                Params { features: Features { optical_depth, ..Features::default() }, theta_v, theta_l }
            });
            let records = VolumeRecords::new(&params[0], &params[1], Sweep::PAPER, true);
            for k in 0..self.texels + 2 {
                let u = (k as f32 - 0.5) / self.texels as f32;
                for section in 0..2 {
                    let (opacity, reflected) = records.sample(database, section as f32, u, 0.0);
                    if light == 0 {
                        self.depths[k][section] = depth_of(opacity) / max(layer.depths[section], 1e-9);
                    }
                    self.reflected[light][k][section] = reflected;
                }
            }
        }
    }

    /// Opacity, and reflectance under each light, at places of the layer, both coordinates from 0 to 1, for rays whose azimuths have the
    /// cosines `cos_view`.
    #[inline(always)]
    pub fn at<const N: usize>(
        &self,
        layer: &Layer,
        [u, t]: [&[f32; N]; 2],
        cos_view: &[f32; N],
    ) -> ([f32; N], [[f32; N]; MAX_LIGHTS]) {
        let mut f = [0.0; N];
        let mut texel = [0; N];
        let [mut low, mut high] = [[[0.0; N]; 2]; 2];
        for lane in 0..N {
            let x = u[lane] * self.texels as f32 + 0.5;
            let x = if self.is_nearest { floor(x + 0.5) } else { x };
            // The mask of `index_of` keeps what is no number in range, and so does the minimum.
            let i = (index_of(floor(x)) as usize).min(TEXELS - 2);
            f[lane] = x - i as f32;
            texel[lane] = i;
            for section in 0..2 {
                low[section][lane] = self.depths[i][section];
                high[section][lane] = self.depths[i + 1][section];
            }
        }
        let mut opacity = [0.0; N];
        for lane in 0..N {
            let between = |section: usize| mix(low[section][lane], high[section][lane], f[lane]);
            let depth = mix(between(0) * layer.depths[0], between(1) * layer.depths[1], t[lane]);
            opacity[lane] = 1.0 - exp(-depth * curved(cos_view[lane], layer.thickness));
        }
        let mut reflected = [[0.0; N]; MAX_LIGHTS];
        for (reflected, of_light) in reflected.iter_mut().zip(&self.reflected).take(self.lights) {
            for lane in 0..N {
                for section in 0..2 {
                    low[section][lane] = of_light[texel[lane]][section];
                    high[section][lane] = of_light[texel[lane] + 1][section];
                }
            }
            for lane in 0..N {
                let between = |section: usize| mix(low[section][lane], high[section][lane], f[lane]);
                reflected[lane] = mix(between(0), between(1), t[lane]);
            }
        }
        (opacity, reflected)
    }
}

/// The optical depth of an opacity that is stored in eight bits.
fn depth_of(opacity: f32) -> f32 {
    -std::f32::consts::LN_2 * log2(max(1.0 - opacity, 0.5 / 255.0))
}

/// The way of a ray, whose azimuth has the cosine `cos`, through a layer as a fraction of that through a flat one of the same thickness, `thickness` being relative to the
/// radius. Near the silhouette a ray leaves the layer through the surface by which it came in; half of that way belongs to each of the
/// two faces.
#[inline(always)]
fn curved(cos: f32, thickness: f32) -> f32 {
    let cos = min(cos.abs(), 1.0);
    let inner = (1.0 - thickness) * (1.0 - thickness) - (1.0 - cos * cos);
    let way = cos - max(inner, 0.0).sqrt();
    way * max(cos, 1.0 / 6.0) / max(thickness, 1e-3)
}
