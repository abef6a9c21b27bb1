//! Tests of the whole program, run from the command line as a user runs it.

mod bench;
mod clusters;
mod compare;
mod films;
mod info;
mod kills;
mod methods;
mod portraits;
mod presets;
mod projects;
mod record;
mod refusals;
mod settings;
mod sound;
mod strokes;
mod tool;
