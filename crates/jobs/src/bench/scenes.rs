//! The measured scenes and their published figures.

use std::fmt;
use std::str::FromStr;

use lovelock_base::settings::Settings;
use lovelock_groom::{GroomSettings, HairShading, Preset};
use lovelock_project::Project;
use lovelock_render::{HairDrawing, ShadowMethod, StrandCount, Transparency};

/// A measured scene: the default project with more or other hair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchScene {
    /// The published smooth hairstyle: 134 wisps of 25 strands of 30 segments.
    Smooth,
    /// The published curly hairstyle: the same wisps, twice the segments.
    Curly,
    /// Half a million segments.
    Smooth500k,
    /// A million segments.
    Smooth1M,
    /// Two million segments.
    Smooth2M,
    /// 20,000 strands of 15 segments, as many as the woman of Sintorn and Assarsson 2009 has.
    Woman300k,
    /// 400,000 strands of 5 segments, as many as the dog of Sintorn and Assarsson 2009 has; short fur on a head.
    Dog2M,
    /// The smooth hairstyle as images show it by default, with fibres that scatter: the whole figure in the image.
    Far,
    /// The same with head and shoulders in the image.
    Middle,
    /// The same with the head filling the image, and 25,000 strands.
    Near,
    /// As near, with 100,000 strands: a still image.
    Still,
    /// 40 wisps of 525 strands drawn as clusters.
    Clusters,
    /// The same hair drawn as its stored strands.
    ClustersStrands,
    /// The clusters seen from so far that the head is 24 pixels high.
    ClustersFar,
    /// The same hair from there, drawn as its stored strands.
    ClustersFarStrands,
    /// The same clusters on 20 heads in one image, each 24 pixels high.
    ClustersCrowd,
    /// The same heads, with the stored strands.
    ClustersCrowdStrands,
    /// The guides of the published smooth hairstyle, simulated by each method without rendering: 402 of 30 links.
    Simulate402,
    /// The same with each of 20,100 strands simulated individually.
    Simulate20k,
}

impl BenchScene {
    /// All of them, by paper and from small to large.
    pub const ALL: [Self; 19] = [
        Self::Smooth,
        Self::Curly,
        Self::Smooth500k,
        Self::Smooth1M,
        Self::Smooth2M,
        Self::Woman300k,
        Self::Dog2M,
        Self::Far,
        Self::Middle,
        Self::Near,
        Self::Still,
        Self::Clusters,
        Self::ClustersStrands,
        Self::ClustersFar,
        Self::ClustersFarStrands,
        Self::ClustersCrowd,
        Self::ClustersCrowdStrands,
        Self::Simulate402,
        Self::Simulate20k,
    ];

    /// The stable name for the command line and reports.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Curly => "curly",
            Self::Smooth500k => "smooth-500k",
            Self::Smooth1M => "smooth-1m",
            Self::Smooth2M => "smooth-2m",
            Self::Woman300k => "woman-300k",
            Self::Dog2M => "dog-2m",
            Self::Far => "far",
            Self::Middle => "middle",
            Self::Near => "near",
            Self::Still => "still",
            Self::Clusters => "clusters",
            Self::ClustersStrands => "clusters-strands",
            Self::ClustersFar => "clusters-far",
            Self::ClustersFarStrands => "clusters-far-strands",
            Self::ClustersCrowd => "clusters-crowd",
            Self::ClustersCrowdStrands => "clusters-crowd-strands",
            Self::Simulate402 => "simulate-402",
            Self::Simulate20k => "simulate-20k",
        }
    }

    /// Width and height, pixels.
    pub const fn size(self) -> (u32, u32) {
        if self.is_of_occupancy_maps() { (800, 600) } else { (1280, 720) }
    }

    /// Whether it is only simulated, by every method with rigid links, and not rendered.
    pub const fn is_simulated_alone(self) -> bool {
        matches!(self, Self::Simulate402 | Self::Simulate20k)
    }

    /// Whether each strand is simulated individually.
    pub(super) const fn simulates_strands(self) -> bool {
        matches!(self, Self::Simulate20k)
    }

    /// Whether it is one of Sintorn and Assarsson 2009.
    const fn is_of_occupancy_maps(self) -> bool {
        matches!(self, Self::Woman300k | Self::Dog2M)
    }

    /// Whether it compares clusters with the strands for which they stand.
    const fn is_of_clusters(self) -> bool {
        matches!(self, Self::Clusters | Self::ClustersStrands) || self.is_of_far_clusters()
    }

    /// Whether it compares them on heads that are small in the image.
    const fn is_of_far_clusters(self) -> bool {
        matches!(self, Self::ClustersFar | Self::ClustersFarStrands) || self.is_of_crowd()
    }

    /// Whether it has many heads. Its body is that of one of them.
    pub(super) const fn is_of_crowd(self) -> bool {
        matches!(self, Self::ClustersCrowd | Self::ClustersCrowdStrands)
    }

    /// The measured project: three lights with `voxel-map`, blended; or, as in the paper, one light with `occupancy-maps` of
    /// 512 x 512 texels and `occupancy-order`. Scenes of clusters have three lights with `occupancy-maps`. Scenes without rendering move at a quarter of the speed, where four substeps are
    /// enough.
    pub fn project(self) -> Project {
        let mut project = Project::default();
        project.set_preset(if self == Self::Curly { Preset::Curly } else { Preset::Smooth });
        if matches!(self, Self::Far | Self::Middle | Self::Near | Self::Still) {
            (project.camera.distance, project.picture.strands, project.picture.strand_number) = match self {
                Self::Far => (4.0, StrandCount::BySize, 0.0),
                Self::Middle => (1.6, StrandCount::BySize, 0.0),
                Self::Near => (0.7, StrandCount::Fixed, 25_000.0),
                _ => (0.7, StrandCount::Fixed, 100_000.0),
            };
            project.picture = project.picture.clamped();
            return project;
        }
        // As the papers: the stored strands, shaded by Kajiya-Kay.
        project.compare.shading = HairShading::KajiyaKayPublished;
        project = project.compared();
        let groom = &mut project.hair.groom;
        match self {
            Self::Smooth
            | Self::Curly
            | Self::Simulate402
            | Self::Far
            | Self::Middle
            | Self::Near
            | Self::Still => {}
            Self::Clusters
            | Self::ClustersStrands
            | Self::ClustersFar
            | Self::ClustersFarStrands
            | Self::ClustersCrowd
            | Self::ClustersCrowdStrands => {
                (groom.wisps, groom.strands_per_wisp) = (40, 525);
            }
            Self::Simulate20k => groom.strands_per_wisp = 150,
            // 134 wisps of 30 segments per strand: 4,020 segments for each strand of a wisp.
            Self::Smooth500k => groom.strands_per_wisp = 125,
            Self::Smooth1M => groom.strands_per_wisp = 249,
            Self::Smooth2M => groom.strands_per_wisp = 498,
            Self::Woman300k => {
                (groom.wisps, groom.strands_per_wisp, groom.segments_per_strand) = (200, 100, 15);
            }
            Self::Dog2M => {
                *groom = GroomSettings {
                    wisps: 1000,
                    strands_per_wisp: 400,
                    segments_per_strand: 5,
                    length: 0.05,
                    layering: 0.0,
                    length_variation: 0.3,
                    face_framing: 0.0,
                    part_strength: 0.0,
                    root_lift: 1.0,
                    hold: 0.15,
                    ends: 0.0,
                    wave: 0.0,
                    ..*groom
                };
                // Every strand is a hair.
                project.look.real_hairs = 400_000.0;
            }
        }
        if self.is_of_clusters() {
            project.shadow.method = ShadowMethod::OccupancyMaps;
            if matches!(self, Self::Clusters | Self::ClustersFar | Self::ClustersCrowd) {
                project.picture.draw = HairDrawing::Clusters;
            }
            project.camera.distance = if self.is_of_far_clusters() { FAR } else { 1.0 };
        }
        if self.is_simulated_alone() {
            project.motion.speed = 0.25;
            // Long enough to swing, and short because 20,100 strands are slow.
            project.timeline.preroll_secs = 0.5;
        }
        if self.is_of_occupancy_maps() {
            project.shadow.method = ShadowMethod::OccupancyMaps;
            project.shadow.occupancy_maps.resolution = 512;
            project.picture.transparency = Transparency::OccupancyOrder;
            project.lights.truncate(1);
            // Only the head, as in the paper's figures.
            project.camera.distance = 1.0;
        }
        project
    }

    /// Published time of a stage, a pass or the whole frame, milliseconds, if any.
    ///
    /// `smooth` and `curly`: Bertails, Ménier, Cani 2005, table 2 (a Pentium 4 at 3 GHz). Animation and collisions correspond to
    /// our simulation including interpolation of strands, density and transmittance to our shadow, filtering and drawing to our
    /// rendering. `simulate-402` compares the same with the method of the paper.
    ///
    /// `woman-300k` and `dog-2m`: Sintorn, Assarsson 2009 (a `GeForce` GTX 280). The rates of figure 1 are those of an image. The paper's table has passes of another frame, of 20,000 strands (see [`BenchScene::published_note`]): its
    /// occupancy and slab-size maps are one pass here, its shadow map of the background the body's depth, its
    /// composition our last pass.
    #[expect(clippy::match_same_arms, reason = "the table's figures, which are equal by chance")]
    pub fn published_ms(self, name: &str) -> Option<f64> {
        let ms = match (self, name) {
            (Self::Smooth, "simulate") => 67.0 + 3.0,
            (Self::Smooth, "shadow") => 38.0 + 15.0,
            (Self::Smooth, "draw") => 37.0,
            (Self::Curly, "simulate") => 254.0 + 3.0,
            (Self::Curly, "shadow") => 62.0 + 15.0,
            (Self::Curly, "draw") => 53.0,
            (Self::Smooth | Self::Curly, "frame") => {
                ["simulate", "shadow", "draw"].iter().filter_map(|stage| self.published_ms(stage)).sum()
            }
            (Self::Simulate402, "simulate/relaxation") => 67.0 + 3.0,
            (Self::Woman300k, "picture") => 1e3 / 37.3,
            (Self::Dog2M, "picture") => 1e3 / 17.2,
            (Self::Woman300k | Self::Dog2M, pass) => {
                return PASSES.iter().find(|(name, _)| *name == pass).map(|(_, ms)| *ms);
            }
            _ => return None,
        };
        Some(ms)
    }

    /// A note about the published figures.
    pub const fn published_note(self) -> Option<&'static str> {
        match self {
            Self::Woman300k | Self::Dog2M => Some(
                "published: Sintorn, Assarsson 2009, GeForce GTX 280; the picture is this scene's in figure 1, the stages \
                 and passes are those of the paper's table, of a frame with 20,000 strands that took 31.6 ms in all",
            ),
            Self::Simulate402 => Some(
                "published: Bertails, Ménier, Cani 2005, a Pentium 4 at 3 GHz: animation with the interpolation of strands 67 ms, \
                 collisions 3 ms",
            ),
            _ => None,
        }
    }
}

/// The distance from which a head is 24 pixels high in an image of 720 rows, metres.
const FAR: f32 = 20.3;

/// The table of Sintorn, Assarsson 2009, milliseconds, by our stages and passes.
const PASSES: [(&str, f64); 11] = [
    ("interpolate", 2.9),
    ("shadow", 2.54 + 2.56 + 2.89),
    ("shadow/range", 2.54),
    ("shadow/occupancy", 2.56 + 2.89),
    ("draw", 2.63 + 1.8 + 1.88 + 0.5 + 1.0 + 12.8 + 0.1),
    ("draw/body-depth", 0.5),
    ("draw/body", 1.0),
    ("draw/range", 2.63),
    ("draw/occupancy", 1.8 + 1.88),
    ("draw/light", 12.8),
    ("draw/picture", 0.1),
];

impl fmt::Display for BenchScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

impl FromStr for BenchScene {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|scene| scene.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|scene| scene.id()).collect();
            format!("unknown scene `{id}`: must be one of {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use lovelock_base::settings::Settings;

    use super::*;

    #[test]
    fn names_read_back_and_others_are_refused() {
        for scene in BenchScene::ALL {
            assert_eq!(scene.id().parse(), Ok(scene));
        }
        assert!("wig".parse::<BenchScene>().unwrap_err().contains("smooth-2m"));
    }

    #[test]
    fn the_published_parts_sum_to_what_the_papers_print() {
        assert_eq!(BenchScene::Smooth.published_ms("frame"), Some(160.0));
        // The print says 557 ms for the curly one; its parts sum to this.
        assert_eq!(BenchScene::Curly.published_ms("frame"), Some(387.0));
        assert_eq!(BenchScene::Smooth1M.published_ms("frame"), None);
        let of = |name: &str| BenchScene::Woman300k.published_ms(name).expect(name);
        let begins = |start: &str| -> f64 {
            PASSES.iter().filter(|(name, _)| name.starts_with(start)).map(|(_, ms)| ms).sum()
        };
        // Except for 0.01 ms of keyframes.
        assert!((of("interpolate") + of("shadow") + of("draw") - 31.6).abs() < 1e-9);
        assert!((begins("shadow/") - of("shadow")).abs() < 1e-9);
        assert!((begins("draw/") - of("draw")).abs() < 1e-9);
        assert_eq!((1e3 / of("picture")).round(), 37.0);
        assert_eq!(BenchScene::Dog2M.published_ms("frame"), None, "it has no simulation in it");
    }

    #[test]
    fn scenes_have_the_published_numbers_of_strands() {
        for (scene, strands, segments) in [
            (BenchScene::Smooth, 3350, 100_500),
            (BenchScene::Curly, 3350, 201_000),
            (BenchScene::Woman300k, 20_000, 300_000),
            (BenchScene::Dog2M, 400_000, 2_000_000),
            (BenchScene::Clusters, 21_000, 630_000),
            (BenchScene::ClustersFarStrands, 21_000, 630_000),
            (BenchScene::ClustersCrowd, 21_000, 630_000),
            (BenchScene::Simulate402, 3350, 100_500),
            (BenchScene::Simulate20k, 20_100, 603_000),
        ] {
            let groom = scene.project().hair.groom;
            assert_eq!((groom.strand_count(), groom.segment_count()), (strands, segments), "{scene}");
            assert_eq!(groom.clamped(), groom, "{scene}: it grows as it is asked");
        }
        let drawn = |scene: BenchScene| {
            let project = scene.project();
            (project.picture.draw, project.picture.strands, project.shadow.method)
        };
        let maps = ShadowMethod::OccupancyMaps;
        assert_eq!(drawn(BenchScene::Clusters), (HairDrawing::Clusters, StrandCount::Stored, maps));
        assert_eq!(drawn(BenchScene::ClustersFarStrands), (HairDrawing::Strands, StrandCount::Stored, maps));
        assert_eq!(drawn(BenchScene::ClustersCrowd), drawn(BenchScene::Clusters));
        assert_eq!(drawn(BenchScene::ClustersCrowdStrands), drawn(BenchScene::ClustersFarStrands));
        let grown = crate::bench::load(&BenchScene::Woman300k.project()).expect("a scene");
        let strands = &grown.style.strands;
        assert_eq!((strands.count(), strands.segments()), (20_000, 300_000));
    }
}
