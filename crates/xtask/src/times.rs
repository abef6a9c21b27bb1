//! How long each test took, and which took too long.

use std::fmt::Write as _;

/// The most that a test of the short suite may take on two cores without other work, seconds.
const MAX_SECS: f64 = 5.0;

/// On slow machines a test may take this share of the time of all tests instead.
const MAX_SHARE: f64 = 0.01;

/// Why some tests of the short suite may take longer, and the ends of their names. Their crates are built and drawn with every day, and
/// nothing shorter shows the same.
const MAY_BE_SLOW: [(&str, &[&str]); 4] = [
    (
        "a software adapter draws what the processor draws",
        &[
            "transmittance_is_that_of_the_definition_with_every_filter",
            "images_stay_on_the_device_and_nothing_waits_or_is_created",
            "every_shadow_method_looks_the_same_on_both",
            "lamps_look_the_same_on_both",
            "the_same_by_both_backends",
            "a_list_that_was_too_short_grows_to_what_is_needed",
            "frames_reuse_their_memory",
            "maps_of_several_lights_keep_apart_and_answers_lie_in_their_bytes",
            "strands_appear_gradually_as_their_number_grows",
            "nothing_pops_while_eye_or_light_turn",
            "the_cpu_gives_the_same_bytes_for_any_threads_and_vectors",
            "an_image_whose_list_was_too_short_shows_the_one_before",
            "broken_hair_and_broken_points_are_as_in_the_definition",
            "a_moved_light_a_dropped_slab_and_a_swapped_method_are_found_out",
            "nothing_appears_at_once_while_the_camera_comes_closer",
            "quick_and_plain_agree_on_hair_and_everywhere",
            "every_answer_is_a_transmittance",
            "transmittance_is_that_of_the_definition_wherever_the_light_stands",
            "soft_and_hard_lights_share_a_picture",
            "both_backends_agree_on_soft_shadows",
            "the_penumbra_of_a_card_is_that_on_paper_for_every_method",
            "what_is_held_is_no_more_than_was_counted",
            "random_input_leaves_the_window_working",
            "a_lost_device_leaves_a_sentence_and_the_motion_goes_on",
            "the_host_may_change_during_playback",
            "a_step_is_that_of_the_cpu",
            "a_link_that_falls_on_a_ball_rests_where_the_triangle_closes",
            "what_does_not_fit_is_refused_with_its_bytes_and_leaves_all_lit",
            "a_light_between_strands_and_anywhere_else_gives_finite_light",
            "maps_share_the_limit",
            "the_times_of_every_method_are_those_of_its_work",
        ],
    ),
    (
        "seconds of a dance are simulated",
        &[
            "lengths_hold_and_nothing_enters_the_body_over_the_dance",
            "hair_dragged_while_paused_settles_after_release",
            "one_two_and_eight_threads_give_the_same_bytes",
            "hair_settles_within_two_seconds_after_a_turn",
            "shipped_styles_are_good_over_the_dance_and_hair_in_a_storm_with_one_substep_is_not",
            "a_seek_gives_the_frame_of_playing_from_its_station",
            "locks_of_long_hair_stay_as_narrow_as_at_rest",
            "a_tie_holds_the_hair_in_its_ring_and_the_tail_swings",
            "the_shipped_dance_keeps_its_lengths_at_60_hertz",
            "frames_are_not_interpolated_across_a_seek",
            "every_shipped_style_grows_and_takes_all_of_its_layers",
        ],
    ),
    (
        "the program or the window is used as a whole",
        &[
            "pages_give_back_what_they_held_when_they_are_left",
            "a_click_adopts_a_variant_in_one_undo_step",
            "shift_and_two_clicks_breed_in_one_undo_step",
            "locks_hold_and_other_variants_come",
            "a_report_is_written_in_the_background_with_its_options",
            "the_brush_lies_on_the_hair_of_the_image",
            "panels_fit_the_width",
            "a_report_has_the_documented_keys_and_files",
            "a_second_recording_to_the_same_output_is_rejected",
            "a_full_disk_ends_a_recording_with_an_error_and_leaves_no_output",
            "every_stage_of_a_scene_is_measured",
            "a_recorded_film_can_be_read_back",
            "a_take_reads_files_outside_its_folder_only_if_they_are_named",
            "a_film_has_the_sound_of_its_frames",
            "frames_outside_a_take_are_rejected_with_its_range",
            "a_stopped_sequence_is_resumed_and_other_settings_are_refused_by_name",
            "a_sequence_and_a_film_have_the_same_simulation",
            "films_show_it_and_curves_name_the_frame",
            "images_are_compared_with_the_reference_of_their_own_backend",
            "every_method_is_drawn_measured_and_written",
            "what_is_finished_stays_when_it_is_stopped",
            "the_truth_of_every_light_counts",
            "sweeps_run_a_method_over_its_settings",
            "a_method_is_written_checked_and_compared",
        ],
    ),
    (
        "every byte of a file is damaged",
        &[
            "broken_files_are_refused_or_read_without_a_panic",
            "a_changed_bit_is_found_and_affects_only_its_chunk",
            "ten_minutes_of_a_dragged_slider_stay_small",
        ],
    ),
];

/// How many tests are printed.
const PRINTED: usize = 10;

/// The time of each test, seconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times {
    tests: Vec<(String, f64)>,
    /// The time of all cores while the tests ran, divided by what the tests had of it, at least 1: other work on the machine makes it larger,
    /// and so do cores that had nothing to do.
    pub(crate) crowding: f64,
}

impl Times {
    /// Adds the test of a line of `cargo test` with times.
    pub(crate) fn see(&mut self, line: &str) {
        self.tests.extend(of_line(line));
    }

    /// The slowest tests, a line each.
    pub(crate) fn report(&self) -> String {
        let mut text = String::new();
        if self.tests.is_empty() {
            return text;
        }
        let _ = writeln!(
            text,
            "The slowest of {} tests, which had {:.0} % of the time of all cores:",
            self.tests.len(),
            100.0 / self.crowding.max(1.0)
        );
        for (name, secs) in self.sorted().into_iter().take(PRINTED) {
            let _ = writeln!(text, "{secs:>8.1} s  {name}");
        }
        text
    }

    /// Fails if a test took too long, even with all cores to itself, and is not among [`MAY_BE_SLOW`]. A test may have waited for the threads
    /// of another one: `again` runs the slow ones by their names without the others, and those that are quick then are good.
    pub(crate) fn check(&self, again: impl FnOnce(&[String]) -> anyhow::Result<Self>) -> anyhow::Result<()> {
        let (mut slow, limit) = self.slow();
        if !slow.is_empty() {
            let names: Vec<_> = slow.iter().map(|(name, _)| (*name).to_owned()).collect();
            let alone = again(&names)?;
            slow.retain_mut(|(name, secs)| {
                let found = alone.tests.iter().find(|(of, _)| of == name);
                *secs = found.map_or(*secs, |(_, alone)| secs.min(*alone));
                *secs > limit
            });
        }
        let slow: Vec<_> = slow.iter().map(|(name, secs)| format!("{name} took {secs:.1} s")).collect();
        anyhow::ensure!(
            slow.is_empty(),
            "a test of the short suite must take at most {limit:.0} s, be in the long suite or be listed in times.rs: {}",
            slow.join(", ")
        );
        Ok(())
    }

    /// The tests that took longer than the limit and may not, and the limit, seconds.
    fn slow(&self) -> (Vec<(&str, f64)>, f64) {
        let crowding = self.crowding.max(1.0);
        let all: f64 = self.tests.iter().map(|(_, secs)| secs / crowding).sum();
        let limit = MAX_SECS.max(MAX_SHARE * all);
        let is_listed =
            |name: &str| MAY_BE_SLOW.iter().any(|(_, listed)| listed.iter().any(|end| name.ends_with(end)));
        let alone = self.sorted().into_iter().map(|(name, secs)| (name, secs / crowding));
        (alone.filter(|(name, secs)| *secs > limit && !is_listed(name)).collect(), limit)
    }

    fn sorted(&self) -> Vec<(&str, f64)> {
        let mut all: Vec<_> = self.tests.iter().map(|(name, secs)| (name.as_str(), *secs)).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }
}

/// The name and the seconds of the test in a line without colours.
fn of_line(line: &str) -> Option<(String, f64)> {
    // test scene::tests::a_name ... ok <0.123s>
    let (name, rest) = line.strip_prefix("test ")?.split_once(" ... ")?;
    let secs = rest.trim_end().strip_suffix("s>")?.rsplit_once('<')?.1;
    Some((name.split(' ').next()?.to_owned(), secs.parse().ok()?))
}

/// CPU time of the programs that this one has started and that have ended, seconds; `None` where the system does not tell.
pub(crate) fn cpu_secs_of_children() -> Option<f64> {
    // A tick is a hundredth of a second on every Linux that is known. The name may contain anything, so count from its closing bracket.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(13);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}

#[cfg(test)]
mod tests {
    use super::{Times, cpu_secs_of_children, of_line};

    #[test]
    fn times_are_found_in_lines() {
        let found = |line| of_line(line).map(|(name, secs)| format!("{name} {secs}"));
        assert_eq!(found("test a::b ... ok <0.123s>\n").as_deref(), Some("a::b 0.123"));
        assert_eq!(found("test a - should panic ... ok <61.5s>").as_deref(), Some("a 61.5"));
        for other in [
            "test a::b ... ok",
            "test a ... ignored",
            "test result: ok. 3 passed",
            "     Summary [   5.1s] 3 tests run",
        ] {
            assert_eq!(found(other), None, "{other}");
        }
    }

    #[test]
    fn slow_tests_are_those_that_are_slow_without_other_work() {
        let mut times = Times { crowding: 2.0, ..Times::default() };
        for line in
            ["test slow ... ok <12.0s>", "test kept_waiting ... ok <9.0s>", "test quick ... ok <0.1s>"]
        {
            times.see(line);
        }
        let same = |names: &[String]| {
            assert_eq!(names, ["slow"]);
            Ok(Times { tests: vec![("slow".to_owned(), 5.5)], crowding: 1.0 })
        };
        let said = times.check(same).expect_err("a slow test").to_string();
        assert!(said.ends_with(": slow took 5.5 s"), "{said}");
        // One that only waited for another is quick alone.
        let quick = |_: &[String]| Ok(Times { tests: vec![("slow".to_owned(), 0.5)], crowding: 1.0 });
        assert!(times.check(quick).is_ok());
        // On a machine on which all tests take long, none of them is slow.
        (0..4000).for_each(|_| times.see("test other ... ok <2.0s>"));
        assert!(times.check(|_| Err(anyhow::anyhow!("nothing is slow"))).is_ok());
        assert!(times.report().lines().nth(1).is_some_and(|line| line.ends_with("12.0 s  slow")));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_time_of_children_is_known() {
        assert!(cpu_secs_of_children().is_some_and(|secs| secs >= 0.0));
    }
}
