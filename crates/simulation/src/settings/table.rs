//! The tables of [`SimulationSettings`] and its parts.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Part, PartMut, Setting, Settings, Unit};

use super::{Locks, MAX_SUBSTEPS, Repulsion, RepulsionMode, SimulationSettings, Wind};
use crate::integrator::{Integrator, MAX_SWEEPS};

impl Settings for SimulationSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, stiffness_root),
            [0.0, 200.0],
            "Root stiffness",
            "How stiff wisps are near the scalp. High values keep the shape of the style, low ones \
             let it swing.",
        )
        .symbol("√B, of a beam")
        .unit(Unit::PER_SECOND)
        .soft([0.0, 60.0]),
        Setting::number(
            field!(Self, stiffness_tip),
            [0.0, 200.0],
            "Tip stiffness",
            "How stiff wisps are at their ends. Low values make tips lag and flick.",
        )
        .symbol("√B, of a beam")
        .unit(Unit::PER_SECOND)
        .soft([0.0, 60.0]),
        Setting::number(
            field!(Self, stiffness_bias),
            [0.05, 0.95],
            "Stiffness bias",
            "Share of the change from root to tip stiffness reached at the middle of a wisp. 50 % is a straight line.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, bend_damping),
            [0.0, 0.2],
            "Bend damping",
            "How soon a bent wisp stops swaying.",
        )
        .symbol("γ h")
        .unit(Unit::SECONDS_AS_MS),
        Setting::number(
            field!(Self, hold),
            [0.0, 60.0],
            "Hold",
            "Pull toward the styled shape, strongest at the roots, like hair spray.",
        )
        .unit(Unit::PER_SECOND),
        Setting::number(
            field!(Self, hold_reach),
            [0.02, 2.0],
            "Hold reach",
            "How far from the roots hold acts. Longer values keep more of the style.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([0.02, 1.0]),
        Setting::number(
            field!(Self, settle),
            [0.0, 20.0],
            "Settling",
            "How soon hair comes to rest on the head after a movement.",
        )
        .unit(Unit::PER_SECOND),
        Setting::count(
            field!(Self, clamped_links),
            [0, 2],
            "Root attachment",
            "How wisps leave the scalp: free to turn, or fixed in the styled direction for one or two links.",
        )
        .offered(&[0, 1, 2])
        .named(&["Hinged", "As drawn", "As drawn, firmly"]),
        Setting::number(
            field!(Self, gravity),
            [0.0, 30.0],
            "Gravity",
            "Acceleration by gravity. Higher values make hair fall faster.",
        )
        .symbol("g")
        .unit(Unit::METRES_PER_SECOND2),
        Setting::number(
            field!(Self, style_support),
            [0.0, 1.0],
            "Style support",
            "How much of its own weight the style carries at rest. 100 % keeps the styled shape, lower values let it sag.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, weight),
            [0.2, 5.0],
            "Weight",
            "How heavy hair is. Heavy hair hangs and swings, light hair floats and keeps its shape.",
        )
        .unit(Unit::TIMES),
        Setting::number(
            field!(Self, weight_tip),
            [0.2, 5.0],
            "Weight at tips",
            "Weight at the tips, as a share of that at the roots.",
        )
        .unit(Unit::FRACTION)
        .soft([0.2, 2.0]),
        Setting::number(
            field!(Self, drag),
            [0.0, 20.0],
            "Air",
            "How strongly the air slows hair, and how strongly wind carries it.",
        )
        .unit(Unit::PER_SECOND),
        Setting::number(
            field!(Self, drag_tip),
            [0.0, 5.0],
            "Air at tips",
            "Effect of the air at the tips, as a share of that at the roots.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 3.0]),
        Setting::number(
            field!(Self, air_shelter),
            [0.0, 1.0],
            "Air shelter",
            "How strongly outer hair shields inner hair from air.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, friction),
            [0.0, 2.0],
            "Skin friction",
            "How strongly hair sticks to the head, by Coulomb's law.",
        )
        .symbol("μ"),
        Setting::number(
            field!(Self, cloth_friction),
            [0.0, 2.0],
            "Cloth friction",
            "How strongly hair sticks to shoulders, back and clothes, by Coulomb's law.",
        )
        .symbol("μ"),
        Setting::number(
            field!(Self, hair_friction),
            [0.0, 2.0],
            "Hair friction",
            "How strongly hair sticks to other hair. Higher values bring it to rest sooner.",
        )
        .symbol("μ"),
        Setting::number(
            field!(Self, hair_friction_tip),
            [0.0, 5.0],
            "Hair friction tips",
            "Hair friction at the tips, as a share of that at the roots.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 2.0]),
        Setting::number(
            field!(Self, skin_margin),
            [0.0, 0.03],
            "Skin margin",
            "Distance that hair keeps from the body.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, layering),
            [0.0, 1.0],
            "Layering",
            "How much of their height over the skull wisps keep when they are pressed down, up to 25 mm.",
        )
        .unit(Unit::FRACTION),
        Setting::choice::<Integrator>(
            field!(Self, integrator),
            "Integrator",
            "The method that keeps links at their length. Direct solves all links at once: wisps do \
             not stretch, and more substeps swing more accurately. Relaxation, as first published, \
             corrects one link after the other: wisps stretch. Follow the leader places each point \
             behind the one before: it is the fastest, but its motion depends on the number of \
             substeps, so set that first.",
        ),
        Setting::count(
            field!(Self, relaxation_sweeps),
            [1, MAX_SWEEPS as u64],
            "Iterations",
            "Relaxation iterations per substep. More iterations stretch less and take longer.",
        )
        .logarithmic(),
        Setting::number(
            field!(Self, follow_damping),
            [0.0, 1.0],
            "Velocity damping",
            "Fraction of the next point's correction that is subtracted from a point's velocity. With low values wisps gain energy.",
        )
        .symbol("s, s_damping in Müller, Kim and Chentanez 2012")
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, substeps),
            [1, MAX_SUBSTEPS as u64],
            "Substeps",
            "Steps of the solver per sixtieth of a second. More substeps are more accurate and take \
             longer; fast motion of the head raises the number.",
        )
        .symbol("dt / h"),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![
            ("wind".into(), &self.wind),
            ("locks".into(), &self.locks),
            ("repulsion".into(), &self.repulsion),
        ]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![
            ("wind".into(), &mut self.wind),
            ("locks".into(), &mut self.locks),
            ("repulsion".into(), &mut self.repulsion),
        ]
    }
}

impl Settings for Wind {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, speed), [0.0, 30.0], "Wind speed", "Mean speed of the wind.")
            .symbol("w")
            .unit(Unit::METRES_PER_SECOND),
        Setting::direction_or_zero(
            field!(Self, direction),
            "Wind direction",
            "Direction in which the wind blows. A zero vector is still air.",
        ),
        Setting::number(
            field!(Self, gusts),
            [0.0, 1.0],
            "Gusts",
            "How far gusts raise and lower the speed of the wind.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, turbulence),
            [0.0, 1.0],
            "Turbulence",
            "Speed of eddies that move neighbouring wisps apart, as a share of the speed of the \
             wind.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, sheltering),
            [0.0, 1.0],
            "Sheltering",
            "How strongly the body shields the hair behind it from wind.",
        )
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, seed),
            [0, u32::MAX as u64],
            "Wind seed",
            "Seed of the random numbers of the wind.",
        )
        .soft([0.0, 999.0]),
    ];
}

impl Settings for Locks {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, cohesion),
            [0.0, 240.0],
            "Lock cohesion",
            "How firmly the hair of a lock stays together. Low values let locks fray, high ones keep them as narrow as in the style.",
        )
        .unit(Unit::PER_SECOND),
        Setting::number(
            field!(Self, cohesion_tip),
            [0.0, 2.0],
            "Cohesion at tips",
            "Lock cohesion at the tips, as a share of that at the roots.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, friction),
            [0.0, 60.0],
            "Lock friction",
            "How quickly the strands of a lock adopt a common motion.",
        )
        .unit(Unit::PER_SECOND),
        Setting::number(
            field!(Self, opening),
            [0.0, 3.0],
            "Lock opening",
            "How much wider a lock may become while it moves fast.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 1.0]),
    ];
}

impl Settings for Repulsion {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<RepulsionMode>(
            field!(Self, mode),
            "Repulsion",
            "How crowded hair pushes apart: down the gradient of its density, or away from the \
             centre of a cell that is too dense, as published.",
        ),
        Setting::number(
            field!(Self, strength),
            [0.0, 1.0],
            "Repulsion strength",
            "How strongly crowded hair pushes apart. Higher values keep more volume.",
        )
        .symbol("k")
        .unit(Unit::METRES2_PER_SECOND2),
        Setting::number(
            field!(Self, threshold),
            [1.0, 10.0],
            "Density threshold",
            "Multiple of the density at rest above which hair pushes apart.",
        )
        .symbol("τ")
        .unit(Unit::TIMES)
        .decimals(1),
        Setting::number(
            field!(Self, anisotropy),
            [0.0, 1.0],
            "Anisotropy",
            "How much the push depends on the direction of the hair. At 100 % hair pushes only \
             across strands, harder where wisps cross than where they are parallel, and wisps slide \
             along each other.",
        )
        .symbol("a")
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, cohesion),
            [0.0, 20.0],
            "Cohesion",
            "How quickly wisps adopt the motion of their neighbours.",
        )
        .unit(Unit::PER_SECOND),
    ];
}

impl Choices for RepulsionMode {
    const ALL: &'static [Self] = &[Self::Pressure, Self::Centre];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Pressure => ("pressure", "Pressure"),
            Self::Centre => ("centre", "Cell centre"),
        }
    }
}
