//! What every operation can do.

use std::fmt::Debug;

use lovelock_base::settings::{AnySettings, Settings};
use lovelock_groom::Hairstyle;

use crate::{Ramp, Scope};

/// What an operation changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The guides, which are simulated.
    Shape,
    /// Only the drawn strands.
    Strands,
    /// Colours.
    Colour,
    /// How hair moves.
    Motion,
}

/// What a kind of operation is called.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The id in files and on the command line.
    pub id: &'static str,
    /// The name in the window.
    pub label: &'static str,
    /// What it does to hair.
    pub text: &'static str,
    /// What it changes.
    pub subject: Subject,
}

/// A curve along the strand that an operation has besides the layer's own.
#[derive(Clone, Copy, Debug)]
pub struct RampInfo {
    /// The name in files.
    pub name: &'static str,
    /// The name in the window.
    pub label: &'static str,
    /// What it changes.
    pub text: &'static str,
}

/// An operation of a hairstyle: settings, and what they do.
///
/// An operation changes nothing where [`Scope::at`] is 0.
pub trait Operate: Settings + Debug + PartialEq {
    /// What it is called.
    const KIND: Kind;
    /// Its curves along the strand.
    const RAMPS: &'static [RampInfo] = &[];

    /// Changes a hairstyle.
    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>);

    /// Whether it was made for this hairstyle.
    fn fits(&self, _style: &Hairstyle) -> bool {
        true
    }

    /// One of [`Operate::RAMPS`] by its index.
    fn ramp(&self, _index: usize) -> &Ramp {
        unreachable!("an operation without ramps was asked for one")
    }

    /// The same, to be changed.
    fn ramp_mut(&mut self, _index: usize) -> &mut Ramp {
        unreachable!("an operation without ramps was asked for one")
    }

    /// Lists of numbers that it keeps besides its settings, by their names in files.
    fn lists(&self) -> Vec<(&'static str, Vec<f32>)> {
        Vec::new()
    }

    /// Takes one of those lists.
    fn set_list(&mut self, _name: &str, _numbers: Vec<f32>) {}

    /// Packed data that it keeps besides its settings, by their names in files.
    fn texts(&self) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// Takes one of those texts.
    ///
    /// # Errors
    /// What is wrong with the text, in one sentence.
    fn set_text(&mut self, _name: &str, _text: &str) -> Result<(), String> {
        Ok(())
    }
}

/// An [`Operate`] of any kind.
pub trait AnyOperation: AnySettings {
    /// What it is called.
    fn kind(&self) -> &'static Kind;
    /// Its curves along the strand.
    fn ramps(&self) -> &'static [RampInfo];
    /// One of its curves.
    fn ramp(&self, index: usize) -> &Ramp;
    /// The same, to be changed.
    fn ramp_mut(&mut self, index: usize) -> &mut Ramp;
    /// See [`Operate::apply`].
    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>);
    /// See [`Operate::fits`].
    fn fits(&self, style: &Hairstyle) -> bool;
    /// See [`Operate::lists`].
    fn lists(&self) -> Vec<(&'static str, Vec<f32>)>;
    /// See [`Operate::set_list`].
    fn set_list(&mut self, name: &str, numbers: Vec<f32>);
    /// See [`Operate::texts`].
    fn texts(&self) -> Vec<(&'static str, String)>;
    /// See [`Operate::set_text`].
    ///
    /// # Errors
    /// What is wrong with the text, in one sentence.
    fn set_text(&mut self, name: &str, text: &str) -> Result<(), String>;
    /// As settings.
    fn settings(&self) -> &dyn AnySettings;
    /// The same, to be changed.
    fn settings_mut(&mut self) -> &mut dyn AnySettings;
}

impl<T: Operate> AnyOperation for T {
    fn kind(&self) -> &'static Kind {
        &T::KIND
    }

    fn ramps(&self) -> &'static [RampInfo] {
        T::RAMPS
    }

    fn ramp(&self, index: usize) -> &Ramp {
        Operate::ramp(self, index)
    }

    fn ramp_mut(&mut self, index: usize) -> &mut Ramp {
        Operate::ramp_mut(self, index)
    }

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        Operate::apply(self, style, scope);
    }

    fn fits(&self, style: &Hairstyle) -> bool {
        Operate::fits(self, style)
    }

    fn lists(&self) -> Vec<(&'static str, Vec<f32>)> {
        Operate::lists(self)
    }

    fn set_list(&mut self, name: &str, numbers: Vec<f32>) {
        Operate::set_list(self, name, numbers);
    }

    fn texts(&self) -> Vec<(&'static str, String)> {
        Operate::texts(self)
    }

    fn set_text(&mut self, name: &str, text: &str) -> Result<(), String> {
        Operate::set_text(self, name, text)
    }

    fn settings(&self) -> &dyn AnySettings {
        self
    }

    fn settings_mut(&mut self) -> &mut dyn AnySettings {
        self
    }
}
