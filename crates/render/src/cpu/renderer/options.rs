//! How a renderer works: what it keeps and leaves out, and what ends it.

use lovelock_base::simd::Width;

use super::CpuRenderer;
use crate::cpu::interrupt::Interrupt;
use crate::cpu::placed::PlacedScene;

impl CpuRenderer {
    /// A renderer whose loops are compiled for `width`, which the CPU must support: for tests of equality.
    ///
    /// # Panics
    /// If the CPU does not support such vectors.
    pub fn with_width(width: Width) -> Self {
        assert!(width.is_available(), "{width:?} on a processor without");
        Self { placed: PlacedScene::new(width), ..Self::default() }
    }

    /// A renderer that computes everything anew for each picture, also what has not changed since the one before.
    #[must_use]
    pub fn keeping_nothing(self) -> Self {
        Self { keeps: false, ..self }
    }

    /// A renderer that computes light at every strand point and the body's shadow at every pixel, also where they vary evenly: what others
    /// are compared with.
    #[must_use]
    pub fn without_shortcuts(mut self) -> Self {
        self.placed.is_exact = true;
        self
    }

    /// A renderer that computes the light of every strand point before any is drawn, also of those that show in no pixel: what others are
    /// compared with.
    #[must_use]
    pub fn lighting_hidden_points(mut self) -> Self {
        self.placed.lights_hidden = true;
        self
    }

    /// Whether results are kept for the next picture while nothing moves, which is so at first. Times of repeated pictures only mean
    /// something without.
    pub fn set_keeping(&mut self, keeps: bool) {
        self.keeps = keeps;
    }

    /// Sets whether the following pictures may show only what has moved, which is not so at first. Then, where nothing but hair has moved since
    /// the last picture, and in less than half of its tiles, only those are drawn over it. Their shadows are those of the last picture. The
    /// statistics of such a picture tell its share: see [`FrameStats::redrawn`](crate::FrameStats::redrawn). Pictures are drawn whole where all
    /// strand points are shaded first, as in all modes of transparency but [`Transparency::Sorted`](crate::Transparency::Sorted).
    pub fn set_hurrying(&mut self, hurries: bool) {
        self.hurries = hurries;
    }

    /// Sets what ends the following pictures early, with [`RenderError::Interrupted`](crate::RenderError::Interrupted); `None` at first.
    pub fn set_interrupt(&mut self, interrupt: Option<Interrupt>) {
        self.interrupt = interrupt;
    }
}
