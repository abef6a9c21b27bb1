//! The hairstyles that methods are measured on.
#![allow(dead_code, unreachable_pub, missing_docs)] // A module of tests and benchmarks, each of which uses its part.

use glam::{Affine3A, Vec3};
use lovelock_groom::{
    GroomSettings, GuideFrame, HairLook, Hairstyle, ImportSettings, PlainHead, Preset, Strands, import,
    interpolate, load_hair,
};
use lovelock_shadow::{LightFrame, ShadowInput};

use crate::common::{EXTINCTION, SplitMix64, strands};

/// Strands, and their width.
pub struct Groom {
    pub name: &'static str,
    pub strands: Strands,
    pub width: f32,
    pub extinction_scale: f32,
}

/// Light from above and in front, nearly that of the default project.
pub const LIGHT: Vec3 = Vec3::new(0.4, -1.0, -0.5);

impl Groom {
    pub fn input(&self) -> ShadowInput<'_> {
        ShadowInput {
            strands: &self.strands,
            strand_width: self.width,
            extinction_scale: self.extinction_scale,
            light: LightFrame::new(LIGHT),
            anchor: Vec3::new(0.0, 0.11, 0.0),
            maps: 1,
            projected: None,
        }
    }

    fn of(name: &'static str, strands: Strands) -> Self {
        let width = HairLook::default().shadow_width(strands.count());
        Self { name, strands, width, extinction_scale: EXTINCTION }
    }

    fn at_rest(name: &'static str, style: &Hairstyle) -> Self {
        let mut strands = Strands::default();
        interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
        Self::of(name, strands)
    }

    /// A strand alone.
    pub fn one_strand() -> Self {
        let line = (0..30).map(|i| Vec3::new(0.002 * i as f32, 0.1 - 0.005 * i as f32, 0.001 * i as f32));
        Self { width: 2e-3, ..Self::of("one strand", strands(&[line.collect()])) }
    }

    /// Straight strands across the light, spread uniformly in a box: 0.1 m along it, 0.1 m across.
    pub fn slab() -> Self {
        let light = LightFrame::new(LIGHT);
        let mut random = SplitMix64::new(3);
        let strand = |i: usize| {
            let middle = 0.05 * random.signed_vec3();
            let along = if i.is_multiple_of(2) { Vec3::Y } else { Vec3::Z };
            let at = |part: i32| light.world_from_light(middle + 0.004 * part as f32 * along);
            (-2..=2).map(at).collect::<Vec<_>>()
        };
        let made: Vec<_> = (0..12_000).map(strand).collect();
        Self { width: 4e-4, ..Self::of("slab", strands(&made)) }
    }

    /// A slanted bundle that widens toward its tips.
    pub fn tuft() -> Self {
        let mut random = SplitMix64::new(8);
        let strand = |_| {
            let offset = Vec3::new(random.signed(), 0.0, random.signed()) * random.unit();
            let turn = 6.0 * random.unit();
            let at = |part: usize| {
                let t = part as f32 / 40.0;
                let curl = 0.003 * Vec3::new((turn + 12.0 * t).cos(), 0.0, (turn + 12.0 * t).sin());
                Vec3::new(0.08 * t, 0.1 - 0.16 * t, 0.02 * t) + (0.006 + 0.014 * t) * offset + curl
            };
            (0..=40).map(at).collect::<Vec<_>>()
        };
        let made: Vec<_> = (0..1200).map(strand).collect();
        Self { width: 3e-4, ..Self::of("tuft", strands(&made)) }
    }

    /// A preset as the default project grows it.
    pub fn preset(preset: Preset) -> Self {
        let scalp = PlainHead.scalp(40);
        let style = lovelock_groom::grow(&GroomSettings::preset(preset), &scalp, &PlainHead);
        Self::at_rest(preset.id(), &style.expect("a preset grows"))
    }

    /// The published hairstyle from a file; `None` if the file is missing.
    pub fn straight() -> Option<Self> {
        let path = lovelock_testkit::data_dir()?.join("hair/yuksel/straight.hair");
        let file = load_hair(&path).expect("straight.hair is read");
        let style = import(&file, &ImportSettings::default(), &PlainHead.scalp(40)).expect("it is imported");
        Some(Self::at_rest("straight.hair", &style))
    }

    /// The grooms for comparisons of the two backends; those with most strands are left to the long suite.
    pub fn for_both_backends() -> Vec<Self> {
        let mut all = vec![Self::one_strand(), Self::tuft(), Self::preset(Preset::Smooth)];
        all.extend(Self::of_the_long_suite());
        all
    }

    /// The grooms on which the errors of methods are measured.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::tuft(), Self::preset(Preset::Smooth), Self::preset(Preset::Curly)];
        all.extend(Self::of_the_long_suite());
        all
    }

    fn of_the_long_suite() -> impl Iterator<Item = Self> {
        lovelock_testkit::suite::is_long()
            .then(|| Self::straight().into_iter().chain([Self::slab()]))
            .into_iter()
            .flatten()
    }
}
