//! A page of the manual: Markdown as a list of blocks.

use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd};

/// A piece of text of one kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) text: String,
    pub(super) is_strong: bool,
    pub(super) is_emphasis: bool,
    pub(super) is_code: bool,
    /// Where a click leads.
    pub(super) link: Option<String>,
}

/// A part of a page.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Block {
    /// A heading; level 1 is the title of the page.
    Heading { level: usize, anchor: String, spans: Vec<Span> },
    /// A paragraph, or one of a list at that depth with its number or bullet.
    Text { depth: usize, marker: Option<String>, spans: Vec<Span> },
    /// Lines of a program or a command line.
    Code(String),
    /// A picture and what it shows.
    Picture { path: String, text: String },
    /// A row of a table; `widths` are the shares of its columns.
    Row { is_head: bool, widths: Vec<f32>, cells: Vec<Vec<Span>> },
    /// A line across.
    Rule,
}

/// The text of spans.
pub(super) fn text_of(spans: &[Span]) -> String {
    spans.iter().map(|span| span.text.as_str()).collect()
}

impl Block {
    /// Its text.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Heading { spans, .. } | Self::Text { spans, .. } => text_of(spans),
            Self::Code(text) | Self::Picture { text, .. } => text.clone(),
            Self::Row { cells, .. } => cells.iter().map(|cell| text_of(cell)).collect::<Vec<_>>().join("  "),
            Self::Rule => String::new(),
        }
    }

    fn spans(&self) -> impl Iterator<Item = &Span> {
        let (spans, cells): (&[Span], &[Vec<Span>]) = match self {
            Self::Heading { spans, .. } | Self::Text { spans, .. } => (spans, &[]),
            Self::Row { cells, .. } => (&[], cells),
            _ => (&[], &[]),
        };
        spans.iter().chain(cells.iter().flatten())
    }

    /// Whether it writes about the control of that name: as `*Name*` or `**Name**`, and best in a heading or at its start.
    fn mentions(&self, name: &str) -> Option<u8> {
        let is_name = |span: &Span| {
            let text = span.text.trim_end_matches('…');
            (span.is_emphasis || span.is_strong) && text.eq_ignore_ascii_case(name)
        };
        if let Self::Heading { spans, .. } = self {
            return text_of(spans).eq_ignore_ascii_case(name).then_some(0);
        }
        let at = self.spans().position(is_name)?;
        Some(if at == 0 { 1 } else { 2 })
    }
}

/// A page.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    pub(super) blocks: Vec<Block>,
}

impl Page {
    /// Reads Markdown.
    pub(super) fn read(text: &str) -> Self {
        let mut reader = Reader::default();
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            reader.take(event);
        }
        Self { blocks: reader.blocks }
    }

    /// Its title.
    pub(super) fn title(&self) -> String {
        self.blocks.first().map(Block::text).unwrap_or_default()
    }

    /// Its headings below the title: number of the block, level and text.
    pub(super) fn headings(&self) -> impl Iterator<Item = (usize, usize, String)> {
        self.blocks.iter().enumerate().skip(1).filter_map(|(at, block)| match block {
            Block::Heading { level, spans, .. } => Some((at, *level, text_of(spans))),
            _ => None,
        })
    }

    /// The block to which the anchor of a link leads.
    pub(super) fn block_at(&self, wanted: &str) -> Option<usize> {
        self.blocks
            .iter()
            .position(|block| matches!(block, Block::Heading { anchor, .. } if anchor == wanted))
    }

    /// The row of the table of settings that describes the one at `path`.
    pub(super) fn row_of(&self, path: &str) -> Option<usize> {
        let (section, name) = path.split_once('.')?;
        let code = |spans: &[Span], wanted: &str| spans.iter().any(|s| s.is_code && s.text == wanted);
        let start = self
            .blocks
            .iter()
            .position(|block| matches!(block, Block::Heading { spans, .. } if code(spans, section)))?;
        let row = |block: &Block| matches!(block, Block::Row { cells, .. } if cells.first().is_some_and(|cell| code(cell, name)));
        self.blocks.iter().skip(start).position(row).map(|at| start + at)
    }

    /// The block that writes most about the control of that name, and how well it fits, 0 is best.
    pub(super) fn mention(&self, name: &str) -> Option<(u8, usize)> {
        let found =
            self.blocks.iter().enumerate().filter_map(|(at, block)| Some((block.mentions(name)?, at)));
        found.min()
    }
}

/// The anchor that GitHub gives to a heading.
fn anchor_of(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// Makes blocks of the events of the parser.
#[derive(Default)]
struct Reader {
    blocks: Vec<Block>,
    spans: Vec<Span>,
    style: Span,
    /// The next number of each open list; `None` for bullets.
    lists: Vec<Option<u64>>,
    marker: Option<String>,
    code: Option<String>,
    picture: Option<String>,
    rows: Vec<Vec<Vec<Span>>>,
    cells: Vec<Vec<Span>>,
}

impl Reader {
    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Start(tag) => self.start(tag),
            Event::End(tag) => self.end(tag),
            Event::Text(text) => self.text(&text, false),
            Event::Code(text) => self.text(&text, true),
            Event::SoftBreak => self.text(" ", false),
            Event::HardBreak => self.text("\n", false),
            Event::Rule => self.blocks.push(Block::Rule),
            _ => {}
        }
    }

    fn text(&mut self, text: &str, is_code: bool) {
        // The fonts of the window have no arrows.
        let text = &*text.replace('→', "->").replace('←', "<-");
        if let Some(code) = &mut self.code {
            code.push_str(text);
            return;
        }
        let style = Span { is_code, ..self.style.clone() };
        match self.spans.last_mut() {
            Some(last) if (Span { text: String::new(), ..last.clone() }) == style => last.text.push_str(text),
            _ => self.spans.push(Span { text: text.to_owned(), ..style }),
        }
    }

    fn start(&mut self, tag: Tag<'_>) {
        match tag {
            Tag::Strong => self.style.is_strong = true,
            Tag::Emphasis => self.style.is_emphasis = true,
            Tag::Link { dest_url, .. } => self.style.link = Some(dest_url.into_string()),
            Tag::Image { dest_url, .. } => {
                self.paragraph();
                self.picture = Some(dest_url.into_string());
            }
            Tag::CodeBlock(_) => self.code = Some(String::new()),
            Tag::List(first) => {
                self.paragraph();
                self.lists.push(first);
            }
            Tag::Item => {
                self.marker = Some(match self.lists.last_mut() {
                    Some(Some(number)) => {
                        *number += 1;
                        format!("{}.", *number - 1)
                    }
                    _ => "•".to_owned(),
                });
            }
            _ => {}
        }
    }

    fn end(&mut self, tag: TagEnd) {
        match tag {
            TagEnd::Strong => self.style.is_strong = false,
            TagEnd::Emphasis => self.style.is_emphasis = false,
            TagEnd::Link => self.style.link = None,
            TagEnd::Image => {
                let text = text_of(&std::mem::take(&mut self.spans));
                let path = self.picture.take().unwrap_or_default();
                self.blocks.push(Block::Picture { path, text });
            }
            TagEnd::Heading(level) => {
                let spans = std::mem::take(&mut self.spans);
                let anchor = anchor_of(&text_of(&spans));
                self.blocks.push(Block::Heading { level: depth_of(level), anchor, spans });
            }
            TagEnd::Paragraph | TagEnd::Item => self.paragraph(),
            TagEnd::CodeBlock => {
                let code = self.code.take().unwrap_or_default();
                self.blocks.push(Block::Code(code.trim_end().to_owned()));
            }
            TagEnd::List(_) => {
                self.paragraph();
                self.lists.pop();
            }
            TagEnd::TableCell => self.cells.push(std::mem::take(&mut self.spans)),
            TagEnd::TableHead | TagEnd::TableRow => self.rows.push(std::mem::take(&mut self.cells)),
            TagEnd::Table => self.table(),
            _ => {}
        }
    }

    fn paragraph(&mut self) {
        let spans = std::mem::take(&mut self.spans);
        if spans.iter().any(|span| !span.text.trim().is_empty()) {
            let marker = self.marker.take();
            self.blocks.push(Block::Text { depth: self.lists.len(), marker, spans });
        }
    }

    fn table(&mut self) {
        let rows = std::mem::take(&mut self.rows);
        let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        // Columns with longer texts are wider, but less so than their texts are longer.
        let widths: Vec<f32> = (0..columns)
            .map(|column| {
                let length = |row: &Vec<Vec<Span>>| row.get(column).map_or(0, |c| text_of(c).chars().count());
                let most = rows.iter().map(length).max().unwrap_or(0);
                (most.clamp(6, 120) as f32).sqrt()
            })
            .collect();
        let sum: f32 = widths.iter().sum();
        let widths: Vec<f32> = widths.iter().map(|width| width / sum.max(1.0)).collect();
        for (i, cells) in rows.into_iter().enumerate() {
            self.blocks.push(Block::Row { is_head: i == 0, widths: widths.clone(), cells });
        }
    }
}

fn depth_of(level: HeadingLevel) -> usize {
    level as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_becomes_blocks() {
        let page = Page::read(
            "# Title\n\nText with *Name*, **Key**, `code` and [a link](x.md#y).\n\n## A *Head*, twice\n\n1. One\n2. Two\n   - In it\n\n\
             | a | b |\n|---|---|\n| `c` | d |\n\n```\nlovelock\n```\n\n![What it shows](pictures/x.jpg)\n",
        );
        assert_eq!(page.title(), "Title");
        let Block::Text { spans, marker: None, depth: 0 } = &page.blocks[1] else { panic!("{page:?}") };
        assert!(spans[1].is_emphasis && spans[3].is_strong && spans[5].is_code, "{spans:?}");
        assert_eq!(spans[7].link.as_deref(), Some("x.md#y"));
        assert_eq!(page.block_at("a-head-twice"), Some(2));
        assert!(matches!(&page.blocks[4], Block::Text { marker: Some(m), .. } if m == "2."), "{page:?}");
        assert!(matches!(&page.blocks[5], Block::Text { marker: Some(m), depth: 2, .. } if m == "•"));
        assert!(matches!(&page.blocks[6], Block::Row { is_head: true, .. }));
        assert_eq!(page.blocks[8], Block::Code("lovelock".to_owned()));
        assert!(
            matches!(&page.blocks[9], Block::Picture { path, .. } if path == "pictures/x.jpg"),
            "{page:?}"
        );
        assert_eq!(page.mention("name"), Some((2, 1)));
    }
}
