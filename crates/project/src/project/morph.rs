//! The hairstyle on its way to another one.

use lovelock_base::field;
use lovelock_base::settings::{AnySettings, Info, Kind, Setting, Settings, Unit, Value, entries, set_value};
use lovelock_groom::HairLook;
use lovelock_simulation::SimulationSettings;
use serde::{Deserialize, Serialize};

use super::{HairSection, Project};

/// The hairstyle on its way to another one; see [`lovelock_style::Morph`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MorphSection {
    /// How far it is on its way, 0 to 1.
    pub amount: f32,
    /// Both ends; none where the hairstyle is only itself.
    pub ends: Option<Box<MorphEnds>>,
}

/// What a morph leads from and to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MorphEnds {
    /// Name of the other style in the interface.
    pub name: String,
    /// The hair of the other style. That of the first is [`Project::hair`].
    pub hair: HairSection,
    /// Colours of both.
    pub look: [HairLook; 2],
    /// How both move.
    pub simulation: [SimulationSettings; 2],
}

impl Settings for MorphSection {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, amount),
        [0.0, 1.0],
        "Morph",
        "How far the hairstyle is on its way to the other one: shape, colours and how it moves.",
    )
    .unit(Unit::FRACTION)];

    fn reconcile(&mut self) {
        if let Some(ends) = &mut self.ends {
            ends.name = ends.name.chars().filter(|c| !c.is_control()).take(80).collect();
            ends.hair.clamp();
            ends.look.iter_mut().for_each(AnySettings::clamp);
            ends.simulation.iter_mut().for_each(AnySettings::clamp);
        }
    }
}

impl Project {
    /// Begins a morph to the hairstyle of `other`; one that was going on begins again from the present hairstyle.
    pub fn start_morph(&mut self, name: impl Into<String>, other: &Self) {
        let ends = MorphEnds {
            name: name.into(),
            hair: other.hair.clone(),
            look: [self.look, other.look],
            simulation: [self.simulation, other.simulation],
        };
        self.morph = MorphSection { amount: 0.0, ends: Some(Box::new(ends)) };
    }

    /// Moves the morph to `amount`, with the colours and the simulation between those of its ends.
    pub fn set_morph(&mut self, amount: f32) {
        self.morph.amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        if let Some(ends) = &self.morph.ends {
            let [a, b] = &ends.look;
            self.look = mixed(a, b, self.morph.amount);
            let [a, b] = &ends.simulation;
            self.simulation = mixed(a, b, self.morph.amount);
        }
    }

    /// Ends the morph at one of its hairstyles: the other one from the middle on.
    pub fn end_morph(&mut self) {
        let Some(ends) = self.morph.ends.take() else { return };
        let MorphEnds { hair, look, simulation, .. } = *ends;
        let last = usize::from(self.morph.amount >= 0.5);
        (self.look, self.simulation) = (look[last], simulation[last]);
        if last == 1 {
            self.hair = hair;
        }
        self.morph = MorphSection::default();
    }
}

/// Settings between two: numbers and colours are mixed, everything else is that of the nearer one.
fn mixed<S: Settings>(a: &S, b: &S, amount: f32) -> S {
    let (from, to, part) = (entries(a), entries(b), f64::from(amount));
    let mut out = if amount < 0.5 { a.clone() } else { b.clone() };
    for (from, to) in from.into_iter().zip(to) {
        if from.value == to.value || from.path != to.path {
            continue;
        }
        let (x, y) = (from.value.numbers(), to.value.numbers());
        let is_logarithmic = matches!(from.info, Info { kind: Kind::Number(range), .. } if range.logarithmic);
        let mix = |(x, y): (&f64, &f64)| {
            if is_logarithmic && *x > 0.0 && *y > 0.0 {
                (x.ln() * (1.0 - part) + y.ln() * part).exp()
            } else {
                x * (1.0 - part) + y * part
            }
        };
        let numbers: Vec<f64> = x.iter().zip(&y).map(mix).collect();
        let both = !matches!((from.value, to.value), (Value::None, _) | (_, Value::None));
        if let Some(value) = from.value.with_numbers(&numbers).filter(|_| both && x.len() == y.len()) {
            set_value(&mut out, &from.path, value);
        }
    }
    if amount <= 0.0 {
        a.clone()
    } else if amount >= 1.0 {
        b.clone()
    } else {
        out.clamped()
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::Preset;

    use super::*;

    fn morphing() -> (Project, Project) {
        let mut project = Project::default();
        let mut other = Project::default();
        other.set_preset(Preset::Curly);
        project.start_morph("Curls", &other);
        (project, other)
    }

    #[test]
    fn the_ends_are_the_styles_and_the_middle_is_between() {
        let (mut project, other) = morphing();
        let first = Project::default();
        project.set_morph(0.0);
        assert_eq!((project.look, project.simulation), (first.look, first.simulation));
        project.set_morph(1.0);
        assert_eq!((project.look, project.simulation), (other.look, other.simulation));
        project.set_morph(0.25);
        let expected = 0.75 * first.look.eumelanin + 0.25 * other.look.eumelanin;
        assert!((project.look.eumelanin - expected).abs() < 1e-6);
        assert_ne!(first.look.eumelanin, other.look.eumelanin);
        project.set_morph(f32::NAN);
        assert_eq!(project.look, first.look);
    }

    #[test]
    fn a_morph_ends_at_the_nearer_style() {
        for (amount, is_other) in [(0.3, false), (0.7, true)] {
            let (mut project, other) = morphing();
            project.set_morph(amount);
            project.end_morph();
            let expected = if is_other { other } else { Project::default() };
            assert_eq!((&project.hair, project.look), (&expected.hair, expected.look));
            assert_eq!(project.morph, MorphSection::default());
        }
    }
}
