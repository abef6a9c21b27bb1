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
    /// Limp hair on a plate, drawn by the example `brush` of the simulation.
    Plate,
}

/// One image of a hairstyle that is made step by step.
pub(super) struct Step {
    pub(super) options: &'static [&'static str],
    /// The numbers of the layers that are off.
    pub(super) off: &'static [u32],
}

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
    Recipe { name: "compare", source: Source::Page("--frame 45 --size 960x540 --backend cpu") },
    Recipe { name: "compare_window", source: Source::Window("--panes --after 12") },
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
    Recipe { name: "hair_with_grid", source: Source::Plate },
    Recipe { name: "hair_without_grid", source: Source::Plate },
];
