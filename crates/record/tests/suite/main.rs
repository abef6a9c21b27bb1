//! Tests of films, sequences and takes through the public interface, in one program: each further one would link everything again.

#[path = "../take_scene/mod.rs"]
mod take_scene;

mod film_kill;
mod outside;
mod outside_sound;
mod sequence_kill;
mod take_damage;
mod take_kill;
mod take_layout;
mod take_play;
mod take_regrown;
