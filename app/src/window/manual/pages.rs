//! The pages of the manual and their pictures, which are part of the program.

use std::sync::OnceLock;

use super::page::Page;

/// A file of the manual.
pub(super) struct Source {
    /// Its name, which links use.
    pub(super) file: &'static str,
    text: &'static str,
    page: OnceLock<Page>,
}

impl Source {
    const fn new(file: &'static str, text: &'static str) -> Self {
        Self { file, text, page: OnceLock::new() }
    }

    /// The page, read when it is first needed.
    pub(super) fn page(&self) -> &Page {
        self.page.get_or_init(|| Page::read(self.text))
    }
}

macro_rules! pages {
    ($($file:literal),* $(,)?) => {
        [$(Source::new($file, include_str!(concat!("../../../../docs/", $file)))),*]
    };
}

/// The pages for users, in the order of the contents.
pub(super) static PAGES: [Source; 17] = pages![
    "user_guide.md",
    "styling.md",
    "portraits.md",
    "takes.md",
    "which_method.md",
    "comparing.md",
    "shadow_methods.md",
    "own_method.md",
    "papers.md",
    "simulation.md",
    "appearance.md",
    "satf.md",
    "settings.md",
    "file_formats.md",
    "pipelines.md",
    "farm.md",
    "performance.md",
];

macro_rules! pictures {
    ($($file:literal),* $(,)?) => {
        &[$(($file, include_bytes!(concat!("../../../../docs/", $file)))),*]
    };
}

/// The pictures of the pages by their paths.
static PICTURES: &[(&str, &[u8])] = pictures![
    "pictures/compare.jpg",
    "pictures/compare_window.jpg",
    "pictures/hair_with_grid.png",
    "pictures/hair_without_grid.png",
    "pictures/layers.jpg",
    "pictures/locks.jpg",
    "pictures/method_adaptive.jpg",
    "pictures/method_approximate_deep.jpg",
    "pictures/method_deep_opacity_maps.jpg",
    "pictures/method_deep_shadow_maps.jpg",
    "pictures/method_density_clustering.jpg",
    "pictures/method_fourier.jpg",
    "pictures/method_moments.jpg",
    "pictures/method_none.jpg",
    "pictures/method_occupancy_maps.jpg",
    "pictures/method_opacity_maps.jpg",
    "pictures/method_ray_traced.jpg",
    "pictures/method_voxel_map.jpg",
    "pictures/method_voxel_march.jpg",
    "pictures/portraits_dance.jpg",
    "pictures/portraits_dancer.jpg",
    "pictures/portraits_elder.jpg",
    "pictures/portraits_man.jpg",
    "pictures/portraits_rigs.jpg",
    "pictures/portraits_woman.jpg",
    "pictures/reference.jpg",
    "pictures/satf.jpg",
    "pictures/satf_curls.jpg",
    "pictures/satf_figures.jpg",
    "pictures/styling_bob.jpg",
    "pictures/styling_braid.jpg",
    "pictures/styling_brushes.jpg",
    "pictures/styling_brushes_dance.jpg",
    "pictures/styling_brushes_film.jpg",
    "pictures/styling_colours.jpg",
    "pictures/styling_curves.jpg",
    "pictures/styling_examples.jpg",
    "pictures/styling_fade.jpg",
    "pictures/styling_masks.jpg",
    "pictures/styling_morph.jpg",
];

/// The number of the page with that file name.
pub(super) fn number_of(file: &str) -> Option<usize> {
    PAGES.iter().position(|source| source.file == file)
}

/// Whether a link leads to a page of the manual or to the web. Other files lie beside the source.
pub(super) fn leads(link: &str) -> bool {
    let file = link.split_once('#').map_or(link, |(file, _)| file);
    link.starts_with("http") || file.is_empty() || number_of(file).is_some()
}

/// The file of a picture, JPEG or PNG.
pub(super) fn picture(path: &str) -> Option<&'static [u8]> {
    PICTURES.iter().find(|(known, _)| *known == path).map(|(_, file)| *file)
}

/// The path as the table of pictures stores it.
pub(super) fn key(path: &str) -> Option<&'static str> {
    PICTURES.iter().map(|(known, _)| *known).find(|known| *known == path)
}

#[cfg(test)]
mod tests {
    use super::super::page::{Block, Span};
    use super::*;

    fn spans(block: &Block) -> Vec<&Span> {
        match block {
            Block::Heading { spans, .. } | Block::Text { spans, .. } => spans.iter().collect(),
            Block::Row { cells, .. } => cells.iter().flatten().collect(),
            _ => Vec::new(),
        }
    }

    #[test]
    fn links_between_pages_lead_to_headings_and_pictures_are_there() {
        let mut links = 0;
        for source in &PAGES {
            let page = source.page();
            assert!(!page.title().is_empty() && page.blocks.len() > 5, "{}", source.file);
            for block in &page.blocks {
                if let Block::Picture { path, .. } = block {
                    let file = picture(path).unwrap_or_else(|| panic!("{}: {path}", source.file));
                    assert!(image::load_from_memory(file).is_ok(), "{path}");
                }
                for link in spans(block).into_iter().filter_map(|span| span.link.as_deref()) {
                    if link.starts_with("http") || !leads(link) {
                        continue;
                    }
                    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
                    let to = if file.is_empty() { Some(source) } else { number_of(file).map(|n| &PAGES[n]) };
                    let to = to.unwrap_or_else(|| panic!("{}: {link}", source.file));
                    assert!(
                        anchor.is_empty() || to.page().block_at(anchor).is_some(),
                        "{}: {link}",
                        source.file
                    );
                    links += 1;
                }
            }
        }
        assert!(links > 30, "{links}");
    }
}
