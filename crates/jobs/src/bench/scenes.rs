//! The measured scenes.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use lovelock_base::settings::Settings;
use lovelock_groom::{GroomSettings, HairShading, Preset};
use lovelock_project::Project;
use lovelock_project::project::parse_project;
use lovelock_render::{HairDrawing, ShadowMethod, StrandCount, Transparency};
use lovelock_simulation::Integrator;

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
    /// 400,000 hairs of 5 segments on the whole skin of a four-legged body.
    Fur400k,
    /// A lawn of 100,000 blades in the wind.
    Lawn,
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
    /// As many of these strands as make 1,071 guides, simulated by the default method.
    Simulate1k,
    /// 10,050 of them.
    Simulate10k,
    /// 100,098 of them.
    Simulate100k,
}

impl BenchScene {
    /// All of them, by paper and from small to large.
    pub const ALL: [Self; 24] = [
        Self::Smooth,
        Self::Curly,
        Self::Smooth500k,
        Self::Smooth1M,
        Self::Smooth2M,
        Self::Woman300k,
        Self::Dog2M,
        Self::Fur400k,
        Self::Lawn,
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
        Self::Simulate1k,
        Self::Simulate10k,
        Self::Simulate100k,
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
            Self::Fur400k => "fur-400k",
            Self::Lawn => "lawn",
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
            Self::Simulate1k => "simulate-1k",
            Self::Simulate10k => "simulate-10k",
            Self::Simulate100k => "simulate-100k",
        }
    }

    /// Width and height, pixels.
    pub const fn size(self) -> (u32, u32) {
        if self.is_of_occupancy_maps() { (800, 600) } else { (1280, 720) }
    }

    /// Whether it is only simulated, by every method with rigid links, and not rendered.
    pub const fn is_simulated_alone(self) -> bool {
        matches!(self, Self::Simulate402) || self.simulates_strands()
    }

    /// The methods with rigid links by which it is simulated.
    pub(super) const fn integrators(self) -> &'static [Integrator] {
        match self {
            Self::Simulate1k | Self::Simulate10k | Self::Simulate100k => &[Integrator::Direct],
            _ => &Integrator::ALL,
        }
    }

    /// Whether it takes more memory or time than many machines have, so that it is measured only if it is named.
    pub(super) const fn is_huge(self) -> bool {
        self.is_of_crowd() || matches!(self, Self::Simulate100k)
    }

    /// Whether each strand is simulated individually.
    pub(super) const fn simulates_strands(self) -> bool {
        matches!(self, Self::Simulate20k | Self::Simulate1k | Self::Simulate10k | Self::Simulate100k)
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

    /// The project of the documents that the scene is, by its name.
    const fn example(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Fur400k => Some(("fur.lovelock", include_str!("../../../../docs/examples/fur.lovelock"))),
            Self::Lawn => Some(("lawn.lovelock", include_str!("../../../../docs/examples/lawn.lovelock"))),
            _ => None,
        }
    }

    /// The measured project: three lights with `voxel-map`, blended; or, as in the paper, one light with `occupancy-maps` of
    /// 512 x 512 texels and `occupancy-order`. Scenes of clusters have three lights with `occupancy-maps`. Scenes without rendering move at a quarter of the speed, where four substeps are
    /// enough.
    pub fn project(self) -> Project {
        if let Some((name, text)) = self.example() {
            let parsed = parse_project(Path::new(name), text).map(|(project, _)| project);
            let mut project = parsed.unwrap_or_default();
            project.compare.shading = HairShading::KajiyaKayPublished;
            return project.compared();
        }
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
            | Self::Fur400k
            | Self::Lawn
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
            Self::Simulate1k => groom.strands_per_wisp = 8,
            Self::Simulate10k => groom.strands_per_wisp = 75,
            Self::Simulate100k => groom.strands_per_wisp = 747,
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
}

/// The distance from which a head is 24 pixels high in an image of 720 rows, metres.
const FAR: f32 = 20.3;

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
    use lovelock_motion::RestDistance;

    use super::*;

    #[test]
    fn the_examples_are_projects_without_problems() {
        for scene in [BenchScene::Fur400k, BenchScene::Lawn] {
            let (name, text) = scene.example().expect("an example");
            let (project, problems) = parse_project(Path::new(name), text).expect(name);
            assert!(problems.is_empty(), "{name}: {problems:?}");
            let drawn = scene.project();
            assert!(
                (&drawn.hair, &drawn.body, &drawn.camera) == (&project.hair, &project.body, &project.camera),
                "{name}"
            );
            assert_eq!(project.sanitised().0, project, "{name}: every value lies in its range");
        }
    }

    #[test]
    fn fur_and_grass_grow_on_the_whole_skin() {
        for (scene, area) in [(BenchScene::Fur400k, 0.55..0.9), (BenchScene::Lawn, 2.2..2.6)] {
            let mut project = scene.project();
            (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (60, 10);
            let loaded = crate::bench::load(&project).expect("a scene");
            let scalp = &loaded.style.scalp;
            assert_eq!(scalp.positions.len(), loaded.body.mesh.positions.len(), "{scene}");
            let found = scalp.hairy_area(project.hair.groom.hairline);
            assert!(area.contains(&found), "{scene}: {found} m²");
            // No ball that a sheet lies on is taken for a skull.
            let has_skull = loaded.colliders.iter().any(|collider| collider.name == "skull");
            assert!(!(has_skull && scene == BenchScene::Lawn), "{scene}");
            // Tips stand out of it.
            let (guides, skin) = (&loaded.style.guides, RestDistance::new(&loaded.body));
            let last = guides.points_per_guide - 1;
            let out = (0..guides.count()).filter(|&g| skin.distance(guides.point(g, last)).0 > 0.002);
            let out = out.count();
            assert!(10 * out > 9 * guides.count(), "{scene}: {out} of {} tips", guides.count());
        }
    }

    #[test]
    fn names_read_back_and_others_are_refused() {
        for scene in BenchScene::ALL {
            assert_eq!(scene.id().parse(), Ok(scene));
        }
        assert!("wig".parse::<BenchScene>().unwrap_err().contains("smooth-2m"));
    }

    #[test]
    fn scenes_have_the_published_numbers_of_strands() {
        for (scene, strands, segments) in [
            (BenchScene::Smooth, 3350, 100_500),
            (BenchScene::Curly, 3350, 201_000),
            (BenchScene::Woman300k, 20_000, 300_000),
            (BenchScene::Dog2M, 400_000, 2_000_000),
            (BenchScene::Fur400k, 400_000, 2_000_000),
            (BenchScene::Lawn, 100_000, 600_000),
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
