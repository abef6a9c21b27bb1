//! The list of the images, each with how it is made.

/// An image of the documents.
pub(super) struct Recipe {
    /// The name of its file in `docs/pictures`, without the extension.
    pub(super) name: &'static str,
    pub(super) source: Source,
}

/// What an image shows. Options are those of `lovelock`, with spaces between them.
pub(super) enum Source {
    /// The window, opened with these options.
    Window(&'static str),
    /// The upper part of the page that `lovelock compare` writes with these options.
    Page(&'static str),
    /// A frame that `lovelock record` renders with these options.
    Frame(&'static str),
    /// A contact sheet that `lovelock presets` draws with these options.
    Sheet(&'static str),
    /// A hairstyle at rest, step by step.
    Steps { view: &'static str, steps: &'static [Step] },
    /// Each layer of an example alone, with its label. The layers have the numbers from 101 on and are off in the example.
    Layers { example: &'static str, view: &'static str, labels: &'static [&'static str] },
    /// Hair at rest after the first of the recorded strokes, for each of these numbers of strokes.
    Strokes { view: &'static str, counts: &'static [u32] },
    /// Hair after all recorded strokes, at these frames of the dance.
    Dance { view: &'static str, frames: &'static [u32] },
    /// A film of the strokes during the dance, at these seconds.
    Film { view: &'static str, secs: &'static [u32] },
    /// A hairstyle at rest with each of these options, by their labels.
    Rows { view: &'static str, columns: usize, options: &'static [(&'static str, &'static str)] },
    /// A figure of the program, by the options that choose it, from five sides in three lights.
    Portraits { figure: &'static str },
    /// The dance, at these seconds.
    Instants { view: &'static str, columns: usize, secs: &'static [f32] },
    /// Limp hair on a plate, drawn by the example `brush` of the simulation.
    Plate,
}

/// One image of a hairstyle that is made step by step.
pub(super) struct Step {
    pub(super) options: &'static [&'static str],
    /// The numbers of the layers that are off.
    pub(super) off: &'static [u32],
}

/// A head that fills the image.
pub(super) const PORTRAIT: &str = "--set camera.fov_y=0.28 --set camera.distance=1.5 --set camera.follow_offset=0,0.015,0 \
                        --set picture.strand_detail=2";

/// Fair hair in one light from the front, so that the shadow of a method can be seen, with more options.
macro_rules! shaded {
    ($options:literal) => {
        concat!(
            "--size 220x260 --set lights.1.enabled=false --set lights.2.enabled=false --set lights.0.softness=0 \
             --set look.eumelanin=0.25 ",
            $options
        )
    };
}

/// Locks.
const SHADED: &str = shaded!(
    "--preset long-waves --set picture.exposure_stops=1 --set camera.distance=1.15 --set camera.azimuth=1.7 \
     --set camera.follow_offset=0.02,-0.09,0"
);
/// Locks from near, where texels can be seen.
const NEAR: &str = shaded!(
    "--preset long-waves --set picture.exposure_stops=1 --set camera.distance=0.6 --set camera.azimuth=1.7 \
     --set camera.follow_offset=0.02,-0.02,0"
);
/// Few strands, each of which casts a shadow that can be seen.
const SPARSE: &str = shaded!(
    "--preset long-straight --set picture.exposure_stops=1.7 --set picture.ambient=0.1 --set picture.strands=fixed \
     --set picture.strand_number=2000 --set camera.distance=0.45 --set camera.azimuth=1.8 \
     --set camera.follow_offset=0.02,0.05,0"
);
/// Strands in a large light.
const SOFT: &str = shaded!(
    "--preset long-straight --set picture.exposure_stops=1.5 --set picture.ambient=0.1 --set lights.0.shadow_samples=16 \
     --set lights.0.angular_radius=0.5 --set picture.strands=fixed --set picture.strand_number=4000 \
     --set camera.distance=0.6 --set camera.azimuth=1.9 --set camera.follow_offset=0.02,-0.02,0"
);

/// A method beside the exact shadow, and where it fails.
const fn method(name: &'static str, options: &'static [(&'static str, &'static str)]) -> Recipe {
    method_on(SHADED, name, options)
}

/// As [`method`], in another view.
const fn method_on(
    view: &'static str,
    name: &'static str,
    options: &'static [(&'static str, &'static str)],
) -> Recipe {
    Recipe { name, source: Source::Rows { view, columns: 3, options } }
}

/// The first tile of [`method`].
const EXACT: (&str, &str) = ("exact", "--shadow exact");

const BOB: &str = "--preset docs/examples/shaved-side-bob.lovelockstyle";
/// The hem of the bob before its last steps.
const HEM: &str = "--set hair.stack.2.length.height=-0.115 --set hair.stack.2.length.tilt=0 \
                   --set hair.stack.2.length.slope=-0.1";
const BRAID: &str = "--preset docs/examples/half-up-braid.lovelockstyle";
const FADE: &str = "--preset docs/examples/coily-fade.lovelockstyle";

/// Every image that can be made.
pub(super) const RECIPES: &[Recipe] = &[
    Recipe { name: "window", source: Source::Window("--after 19.5") },
    Recipe {
        name: "frame",
        source: Source::Frame(
            "--preset long --fps 2 --frames 5..6 --size 900x560 --set camera.distance=1.0 \
             --set camera.azimuth=-0.6 --set camera.follow_offset=0,-0.05,0",
        ),
    },
    Recipe {
        name: "compare",
        source: Source::Page(
            "--frame 45 --size 960x540 --backend cpu --methods voxel-map,opacity-maps,deep-opacity-maps,moments,voxel-march,exact",
        ),
    },
    Recipe { name: "compare_window", source: Source::Window("--panes --after 12") },
    Recipe {
        name: "method_none",
        source: Source::Rows {
            view: SHADED,
            columns: 4,
            options: &[
                EXACT,
                ("none", "--shadow none"),
                ("exact, from the light", "--shadow exact --set camera.azimuth=0.9"),
                ("none, from the light", "--shadow none --set camera.azimuth=0.9"),
            ],
        },
    },
    method(
        "method_voxel_map",
        &[
            EXACT,
            ("128 cells", "--shadow voxel-map"),
            (
                "24, closest",
                "--shadow voxel-map --set shadow.voxel_map.resolution=24 --set shadow.voxel_map.filter=closest",
            ),
        ],
    ),
    method(
        "method_opacity_maps",
        &[
            EXACT,
            ("128 slices", "--shadow opacity-maps"),
            ("8 slices", "--shadow opacity-maps --set shadow.opacity_maps.slices=8"),
        ],
    ),
    method(
        "method_deep_opacity_maps",
        &[
            EXACT,
            ("4 layers", "--shadow deep-opacity-maps"),
            (
                "3 thick layers",
                "--shadow deep-opacity-maps --set shadow.deep_opacity_maps.layers=3 --set shadow.deep_opacity_maps.depth_share=1 \
                 --set shadow.deep_opacity_maps.growth=even",
            ),
        ],
    ),
    method(
        "method_density_clustering",
        &[
            EXACT,
            ("4 clusters", "--shadow density-clustering"),
            ("1 cluster", "--shadow density-clustering --set shadow.density_clustering.clusters=1"),
        ],
    ),
    method_on(
        NEAR,
        "method_occupancy_maps",
        &[
            EXACT,
            ("128 slices", "--shadow occupancy-maps"),
            (
                "4 slabs, 64, nearest",
                "--shadow occupancy-maps --set shadow.occupancy_maps.slabs=4 --set shadow.occupancy_maps.resolution=64 \
                 --set shadow.occupancy_maps.filter=nearest",
            ),
        ],
    ),
    method_on(
        SPARSE,
        "method_deep_shadow_maps",
        &[
            EXACT,
            ("16 nodes", "--shadow deep-shadow-maps"),
            (
                "8 nodes, e = 0.25",
                "--shadow deep-shadow-maps --set shadow.deep_shadow_maps.nodes=8 --set shadow.deep_shadow_maps.tolerance=0.25",
            ),
        ],
    ),
    method(
        "method_approximate_deep",
        &[
            EXACT,
            ("2 mm", "--shadow approximate-deep"),
            ("0.2 mm", "--shadow approximate-deep --set shadow.approximate_deep.spacing=0.0002"),
        ],
    ),
    method(
        "method_fourier",
        &[
            EXACT,
            ("7 terms", "--shadow fourier"),
            (
                "3 terms, map's depth",
                "--shadow fourier --set shadow.fourier.terms=3 --set shadow.fourier.depth_range=map",
            ),
        ],
    ),
    method_on(
        SPARSE,
        "method_adaptive",
        &[
            EXACT,
            ("8 nodes", "--shadow adaptive"),
            ("4 nodes", "--shadow adaptive --set shadow.adaptive.nodes=4"),
        ],
    ),
    method(
        "method_moments",
        &[
            EXACT,
            ("4 moments", "--shadow moments"),
            (
                "16 bits, bias 100",
                "--shadow moments --set shadow.moments.bits=16 --set shadow.moments.bias=100 \
                 --set shadow.moments.overestimation=0",
            ),
        ],
    ),
    method(
        "method_voxel_march",
        &[
            EXACT,
            ("128 cells", "--shadow voxel-march"),
            (
                "32 cells, steps of 4",
                "--shadow voxel-march --set shadow.voxel_march.resolution=32 --set shadow.voxel_march.step=4",
            ),
        ],
    ),
    method_on(
        SOFT,
        "method_ray_traced",
        &[
            EXACT,
            ("4 rays", "--shadow ray-traced"),
            ("1 ray: hard shadow", "--shadow ray-traced --set shadow.ray_traced.rays=1"),
        ],
    ),
    Recipe {
        name: "layers",
        source: Source::Window(
            "docs/examples/shaved-side-bob.lovelockstyle --mask 6 --set motion.source=Rest \
             --set camera.distance=1.4 --after 12",
        ),
    },
    Recipe {
        name: "styling_examples",
        source: Source::Sheet(
            "--columns 1 --dance 6 --size 200x250 --set camera.distance=1.7 \
             --set camera.follow_offset=0,0.03,0 \
             --preset docs/examples/shaved-side-bob.lovelockstyle \
             --preset docs/examples/half-up-braid.lovelockstyle \
             --preset docs/examples/coily-fade.lovelockstyle",
        ),
    },
    Recipe {
        name: "styling_masks",
        source: Source::Layers {
            example: "masks",
            view: "--set camera.azimuth=1.9 --set camera.elevation=0.4 --set camera.distance=0.9 \
                   --set camera.follow_offset=0,0.06,0",
            labels: &[
                "Left side",
                "Right side",
                "Front",
                "Back",
                "Top",
                "Below a height",
                "Crown",
                "Nape",
                "Temples",
                "Middle line",
                "Patch",
            ],
        },
    },
    Recipe {
        name: "styling_curves",
        source: Source::Layers {
            example: "curves",
            view: "--set camera.azimuth=2.6 --set camera.distance=1.8 --set camera.follow_offset=0,-0.1,0",
            labels: &["Constant", "Linear", "Tip", "Root", "Bell", "Both ends"],
        },
    },
    Recipe {
        name: "styling_colours",
        source: Source::Layers {
            example: "colours",
            view: "--set camera.azimuth=0.8 --set camera.elevation=0.2 --set camera.distance=1.6 \
                   --set camera.follow_offset=0,-0.05,0",
            labels: &["Natural colour", "Dye", "Gradient", "Highlights", "Grey", "Streak"],
        },
    },
    Recipe {
        name: "styling_brushes",
        source: Source::Strokes {
            view: "--size 230x290 --set camera.distance=1.65 --set camera.follow_offset=0,-0.06,0",
            counts: &[0, 1, 5, 7, 11, 15],
        },
    },
    Recipe {
        name: "styling_brushes_dance",
        source: Source::Dance {
            view: "--size 230x290 --set camera.distance=1.9",
            frames: &[3, 5, 8, 11, 14, 17],
        },
    },
    Recipe {
        name: "styling_brushes_film",
        source: Source::Film {
            view: "--set picture.backend=cpu --set recording.width=230 --set recording.height=290 \
                   --set recording.fps=3 --set camera.distance=1.65",
            secs: &[1, 9, 18, 21, 28, 39],
        },
    },
    Recipe {
        name: "styling_morph",
        source: Source::Steps {
            view: "--preset bob --morph long-waves --size 230x290 --set camera.distance=1.7 \
                   --set camera.follow_offset=0,-0.06,0",
            steps: &[
                Step { options: &["--set hair.morph.amount=0"], off: &[] },
                Step { options: &["--set hair.morph.amount=0.25"], off: &[] },
                Step { options: &["--set hair.morph.amount=0.5"], off: &[] },
                Step { options: &["--set hair.morph.amount=0.75"], off: &[] },
                Step { options: &["--set hair.morph.amount=1"], off: &[] },
            ],
        },
    },
    Recipe {
        name: "styling_bob",
        source: Source::Steps {
            view: "--size 230x290 --set camera.distance=1.15 --set camera.follow_offset=0,0.02,0",
            steps: &[
                Step { options: &["--preset bob"], off: &[] },
                Step { options: &[BOB, HEM], off: &[4, 5, 6] },
                Step { options: &[BOB, HEM], off: &[5, 6] },
                Step { options: &[BOB], off: &[5, 6] },
                Step { options: &[BOB], off: &[6] },
                Step { options: &[BOB], off: &[] },
            ],
        },
    },
    Recipe {
        name: "styling_braid",
        source: Source::Steps {
            view: "--size 230x290 --set camera.azimuth=2.5 --set camera.distance=1.6 \
                   --set camera.follow_offset=0,-0.06,0",
            steps: &[
                Step { options: &["--preset long-waves"], off: &[] },
                Step { options: &[BRAID], off: &[2, 3, 4] },
                Step { options: &[BRAID], off: &[3, 4] },
                Step { options: &[BRAID], off: &[4] },
                Step { options: &[BRAID], off: &[] },
            ],
        },
    },
    Recipe {
        name: "styling_fade",
        source: Source::Steps {
            view: "--size 230x290 --set camera.azimuth=0.9 --set camera.distance=1.1 \
                   --set camera.follow_offset=0,0.08,0",
            steps: &[
                Step { options: &["--preset coils"], off: &[] },
                Step { options: &[FADE], off: &[3, 4, 5, 6] },
                Step { options: &[FADE], off: &[5, 6] },
                Step { options: &[FADE], off: &[6] },
                Step { options: &[FADE], off: &[] },
            ],
        },
    },
    Recipe { name: "portraits_dancer", source: Source::Portraits { figure: "--preset long" } },
    Recipe {
        name: "portraits_man",
        source: Source::Portraits { figure: "--set body.source=Man --preset side-part" },
    },
    Recipe {
        name: "portraits_woman",
        source: Source::Portraits { figure: "--set body.source=Woman --preset coils" },
    },
    Recipe {
        name: "portraits_elder",
        source: Source::Portraits { figure: "--set body.source=Elder --preset bob --set look.grey=0.85" },
    },
    Recipe {
        name: "portraits_dance",
        source: Source::Instants {
            view: "--preset long --lights soft-beauty --size 220x275",
            columns: 4,
            secs: &[0.3, 1.5, 2.7, 3.9, 5.1, 6.3, 7.5, 8.7],
        },
    },
    Recipe {
        name: "portraits_rigs",
        source: Source::Rows {
            view: PORTRAIT,
            columns: 4,
            options: &[
                ("Soft beauty", "--size 300x375 --preset long --lights soft-beauty"),
                ("Three-point", "--size 300x375 --preset long --lights three-point"),
                ("Rim at night", "--size 300x375 --preset long --lights rim-at-night"),
                ("Flat", "--size 300x375 --preset long --lights flat"),
            ],
        },
    },
    Recipe { name: "hair_with_grid", source: Source::Plate },
    Recipe { name: "hair_without_grid", source: Source::Plate },
];
