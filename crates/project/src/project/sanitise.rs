//! Clamps all values to their ranges, so that no file and no slider can break an image.

use std::f32::consts::PI;

use glam::Vec3;
use lovelock_base::numbers::within;
use lovelock_groom::HairTie;
use lovelock_motion::{ColliderEdits, FieldEdit};
use lovelock_render::{Light, MAX_LIGHTS, MOST_PIXELS, MOST_SIDE, ShadowSettings};

use super::super::Project;
use super::PROJECT_VERSION;
use super::contender::Contender;
use super::generic::differences;
use super::sections::{
    CameraSection, CompareSection, Marker, MotionSection, RecordingSection, TimelineSection,
};
use crate::error::{Place, Problem, ProblemKind};
use crate::tracks::Track;

impl Project {
    /// The project with every value inside its range.
    pub(crate) fn in_range(&self) -> Self {
        let mut project = self.clone();
        project.version = PROJECT_VERSION;
        project.motion = motion(&self.motion);
        project.body.colliders = colliders(&self.body.colliders);
        project.hair.groom = self.hair.groom.clamped();
        project.hair.import = self.hair.import.in_range();
        project.hair.ties = self.hair.ties.iter().take(HairTie::MOST).map(HairTie::clamped).collect();
        project.hair.cut = self.hair.cut.clamped();
        project.look = self.look.clamped();
        project.simulation = self.simulation.clamped();
        project.shadow = shadow(&self.shadow);
        project.lights = self.lights.iter().take(MAX_LIGHTS).map(light).collect();
        project.camera = camera(&self.camera);
        project.picture = self.picture.clamped();
        project.recording = recording(&self.recording);
        project.compare = compare(&self.compare);
        project.timeline = timeline(&self.timeline);
        project
    }

    /// The project with every value inside its range, and a problem for each value that was changed.
    pub fn sanitised(&self) -> (Self, Vec<Problem>) {
        let project = self.in_range();

        let mut problems = Vec::new();
        let mut note = |place, changes: Vec<String>| {
            problems
                .extend(changes.into_iter().map(|change| Problem::new(place, ProblemKind::Adjusted, change)));
        };
        note(Place::Motion, differences(&self.motion, &project.motion));
        note(Place::Hair, differences(&self.hair, &project.hair));
        note(Place::Look, differences(&self.look, &project.look));
        note(Place::Simulation, differences(&self.simulation, &project.simulation));
        note(Place::Shadow, differences(&self.shadow, &project.shadow));
        note(Place::Camera, differences(&self.camera, &project.camera));
        note(Place::Picture, differences(&self.picture, &project.picture));
        note(Place::Recording, differences(&self.recording, &project.recording));
        for (before, after) in self.compare.panes.iter().zip(&project.compare.panes) {
            note(Place::Compare, differences(before, after));
        }
        let (found, kept) = (self.compare.panes.len(), project.compare.panes.len());
        if found != kept {
            note(Place::Compare, vec![format!("there were {found} panes; there are {kept} now")]);
        }
        let preroll_of = |timeline: &TimelineSection| TimelineSection {
            preroll_secs: timeline.preroll_secs,
            ..TimelineSection::default()
        };
        note(Place::Timeline, differences(&preroll_of(&self.timeline), &preroll_of(&project.timeline)));
        let lost = self.timeline.markers.len() - project.timeline.markers.len();
        if lost > 0 {
            note(Place::Timeline, vec![format!("{lost} markers without a time, or too many, were left out")]);
        }
        let keys =
            |project: &Self| project.timeline.tracks.iter().map(|track| track.keys.len()).sum::<usize>();
        let lost = keys(self) - keys(&project);
        if lost > 0 {
            note(
                Place::Timeline,
                vec![format!("{lost} keys of tracks without a time or a value, or too many, were left out")],
            );
        }
        for (before, after) in self.lights.iter().zip(&project.lights) {
            // Any length of direction is fine; it is only told where it was no direction at all.
            let mut before = before.clone();
            if before.direction.is_finite() && before.direction.length_squared() > 0.0 {
                before.direction = after.direction;
            }
            note(Place::Lights, differences(&before, after));
        }
        if self.lights.len() > MAX_LIGHTS {
            let found = self.lights.len();
            note(
                Place::Lights,
                vec![format!(
                    "there were {found} lights; the first {MAX_LIGHTS}, the most there can be, are kept"
                )],
            );
        }
        (project, problems)
    }
}

/// Changes of shapes inside their ranges, each name of a length that can be shown.
fn colliders(edits: &ColliderEdits) -> ColliderEdits {
    let named = edits.shapes.iter().filter(|(name, _)| name.chars().count() <= LONGEST_COLLIDER);
    let shapes = named.take(MOST_COLLIDERS).map(|(name, edit)| (name.clone(), edit.clamped()));
    let field = FieldEdit { lift: edits.field.lift_m(), ..edits.field };
    ColliderEdits { shapes: shapes.collect(), field }
}

/// As many shapes as a body can have, and as long a name as a joint.
const MOST_COLLIDERS: usize = 1000;
const LONGEST_COLLIDER: usize = 400;

/// Markers that have a time, each name of a length that can be shown, and tracks that have keys.
fn timeline(timeline: &TimelineSection) -> TimelineSection {
    let good = timeline.markers.iter().filter(|marker| marker.secs.is_finite() && marker.secs >= 0.0);
    let markers = good.take(TimelineSection::MOST_MARKERS).map(|marker| Marker {
        secs: marker.secs,
        name: marker.name.chars().take(TimelineSection::LONGEST_NAME).collect(),
    });
    let tracks = timeline.tracks.iter().filter_map(Track::in_range).take(Track::MOST);
    let default = TimelineSection::default().preroll_secs;
    TimelineSection {
        markers: markers.collect(),
        tracks: tracks.collect(),
        preroll_secs: within(timeline.preroll_secs, 0.0, TimelineSection::MOST_PREROLL_SECS, default),
    }
}

fn within_cube(value: Vec3, half: f32, default: Vec3) -> Vec3 {
    if value.is_nan() { default } else { value.clamp(Vec3::splat(-half), Vec3::splat(half)) }
}

/// The farthest second of a clip that can be named: a day.
const MOST_CLIP_SECS: f32 = 86_400.0;

fn motion(motion: &MotionSection) -> MotionSection {
    MotionSection {
        speed: within(motion.speed, 0.1, 4.0, 1.0),
        loop_blend_secs: within(motion.loop_blend_secs, 0.0, 2.0, 0.5),
        start_secs: within(motion.start_secs, 0.0, MOST_CLIP_SECS, 0.0),
        end_secs: motion.end_secs.filter(|end| !end.is_nan()).map(|end| end.clamp(0.0, MOST_CLIP_SECS)),
        ..motion.clone()
    }
}

fn shadow(shadow: &ShadowSettings) -> ShadowSettings {
    let scales = ShadowSettings::EXTINCTION_SCALES;
    let d = ShadowSettings::default();
    let mut shadow = *shadow;
    shadow.extinction_scale =
        within(shadow.extinction_scale, *scales.start(), *scales.end(), d.extinction_scale);
    let ShadowSettings {
        method: _,
        extinction_scale: _,
        voxel_map,
        opacity_maps,
        deep_opacity_maps,
        density_clustering,
        occupancy_maps,
        exact,
    } = &mut shadow;

    voxel_map.resolution = voxel_map.safe_resolution();
    voxel_map.head_size = within(voxel_map.head_size, 0.05, 1.0, d.voxel_map.head_size);
    voxel_map.point_extinction = within(voxel_map.point_extinction, 0.0, 1e4, d.voxel_map.point_extinction);

    opacity_maps.resolution = opacity_maps.safe_resolution();
    opacity_maps.slices = opacity_maps.safe_slices();

    deep_opacity_maps.resolution = deep_opacity_maps.safe_resolution();
    deep_opacity_maps.layers = deep_opacity_maps.safe_layers();
    deep_opacity_maps.depth_share = deep_opacity_maps.safe_depth_share();

    density_clustering.resolution = density_clustering.safe_resolution();
    density_clustering.clusters = density_clustering.safe_clusters();
    density_clustering.steps = density_clustering.safe_steps();

    occupancy_maps.resolution = occupancy_maps.safe_resolution();
    occupancy_maps.slices = occupancy_maps.safe_slices();
    occupancy_maps.slabs = occupancy_maps.safe_slabs();

    exact.resolution = exact.safe_resolution();
    exact.memory_limit_bytes = exact.safe_memory_limit_bytes();
    shadow
}

/// The light in range; a direction of any length but zero is kept as it is.
fn light(light: &Light) -> Light {
    let mut clamped = light.clamped();
    if light.direction.is_finite() && light.direction.try_normalize().is_some() {
        clamped.direction = light.direction;
    }
    clamped
}

fn camera(camera: &CameraSection) -> CameraSection {
    let d = CameraSection::default();
    let azimuth = if !camera.azimuth.is_finite() {
        d.azimuth
    } else if camera.azimuth.abs() > PI {
        (camera.azimuth + PI).rem_euclid(2.0 * PI) - PI
    } else {
        camera.azimuth
    };
    CameraSection {
        mode: camera.mode,
        follow_offset: within_cube(camera.follow_offset, 3.0, d.follow_offset),
        follow_secs: within(camera.follow_secs, 0.0, 4.0, d.follow_secs),
        fixed_target: within_cube(camera.fixed_target, 20.0, d.fixed_target),
        azimuth,
        elevation: within(camera.elevation, -1.5, 1.5, d.elevation),
        distance: within(camera.distance, 0.1, 30.0, d.distance),
        fov_y: within(camera.fov_y, 0.05, 2.0, d.fov_y),
    }
}

fn recording(recording: &RecordingSection) -> RecordingSection {
    let fps = if recording.fps.is_nan() { 30.0 } else { recording.fps.clamp(1.0, 240.0) };
    let first_frame = recording.first_frame.min(10_000_000);
    let width = recording.width.clamp(16, MOST_SIDE);
    let mut height = recording.height.clamp(16, MOST_SIDE);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        // Even, as films need it.
        height = (MOST_PIXELS / u64::from(width)) as u32 & !1;
    }
    RecordingSection {
        width,
        height,
        fps,
        first_frame,
        subframes: recording.subframes.clamp(1, RecordingSection::MOST_SUBFRAMES),
        shutter_degrees: within(recording.shutter_degrees, 0.0, 360.0, 180.0),
        end_frame: recording.end_frame.map(|end| end.clamp(first_frame + 1, 20_000_000)),
        ..recording.clone()
    }
}

/// The panes in range, as many as are drawn; the default ones where there are none.
fn compare(compare: &CompareSection) -> CompareSection {
    if compare.panes.is_empty() {
        return CompareSection::default();
    }
    let pane = |pane: &Contender| {
        let (low, high) = (*Contender::SCALES.start(), *Contender::SCALES.end());
        Contender { shadow: shadow(&pane.shadow), scale: within(pane.scale, low, high, high), ..pane.clone() }
    };
    CompareSection { panes: compare.panes.iter().take(CompareSection::MOST_PANES).map(pane).collect() }
}
