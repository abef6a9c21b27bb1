//! Characters that the fonts of the program lack, with glyphs of the system's fonts.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::epaint::text::{FallbackRequest, FontInsert, RasterizedGlyph};
use egui::{
    ColorImage, Context, FontData, FontProvider, GlyphBitmap, GlyphRasterizer, GlyphRasterizerRequest, vec2,
};
use lovelock_glyphs::{Fonts, Glyph, Ink, Script, cluster};

use super::theme;

/// Gives egui a font of the system for a character that it lacks. The system's fonts are listed by a thread when the first such character
/// is shown; until then it is a box.
struct SystemFonts {
    ctx: Context,
    is_listing: AtomicBool,
}

impl FontProvider for SystemFonts {
    fn font_for(&self, request: &FallbackRequest<'_>) -> Option<FontInsert> {
        let first = request.cluster.chars().next()?;
        let Some(fonts) = Fonts::listed() else {
            self.list();
            return None;
        };
        // Pictures of emoji are drawn by the rasterizer.
        let face = fonts.face_for(first).filter(|face| face.has_outlines)?;
        let file: Arc<Vec<u8>> = Arc::clone(&face.data);
        let data = FontData::from_blob(file, face.index);
        Some(FontInsert::new(&face.name, data, Vec::new()))
    }
}

impl SystemFonts {
    /// Lists the fonts beside the window, and then has the window's text laid out again.
    fn list(&self) {
        if self.is_listing.swap(true, Ordering::Relaxed) {
            return;
        }
        let ctx = self.ctx.clone();
        let list = move || {
            Fonts::of_system();
            provide(&ctx);
        };
        if let Err(error) = std::thread::Builder::new().name("fonts".to_owned()).spawn(list) {
            tracing::warn!(%error, "the system's fonts were not listed");
        }
    }
}

/// Uses the system's fonts for characters that the window's fonts lack.
pub(super) fn provide(ctx: &Context) {
    let fonts = SystemFonts { ctx: ctx.clone(), is_listing: AtomicBool::new(false) };
    ctx.set_font_providers(vec![Arc::new(fonts)]);
    ctx.add_glyph_rasterizer(GlyphRasterizer::new("lovelock pictures", rasterized));
}

/// Scripts that were to be shown and for which the system has no font, each once.
pub(super) fn missing() -> Vec<Script> {
    Fonts::listed().map(Fonts::take_missing).unwrap_or_default()
}

/// A cluster without a font of outlines, such as an emoji, as pixels.
fn rasterized(request: &GlyphRasterizerRequest<'_>) -> Option<RasterizedGlyph> {
    let line = cluster(Fonts::listed()?, request.cluster, request.font_size_px)?;
    let left = line.glyphs.iter().map(|glyph| glyph.left).min()?;
    let top = line.glyphs.iter().map(|glyph| glyph.top).min()?;
    let right = line.glyphs.iter().map(|glyph| glyph.left + glyph.width as i32).max()?;
    let bottom = line.glyphs.iter().map(|glyph| glyph.top + glyph.height as i32).max()?;
    let size = [(right - left) as usize, (bottom - top) as usize];
    let mut image = ColorImage::filled(size, egui::Color32::TRANSPARENT);
    for glyph in &line.glyphs {
        put(&mut image, glyph, [(glyph.left - left) as usize, (glyph.top - top) as usize]);
    }
    let is_color = line.glyphs.iter().any(|glyph| matches!(glyph.ink, Ink::Color(_)));
    let bitmap = GlyphBitmap { image, offset_px: vec2(left as f32, top as f32), is_color };
    Some(RasterizedGlyph { bitmap, advance_px: line.width })
}

fn put(image: &mut ColorImage, glyph: &Glyph, [left, top]: [usize; 2]) {
    for at in 0..glyph.width * glyph.height {
        let color = match &glyph.ink {
            Ink::Coverage(alpha) => [255, 255, 255, alpha[at]],
            Ink::Color(rgba) => rgba[at],
        };
        if color[3] > 0 {
            image[(left + at % glyph.width, top + at / glyph.width)] = theme::of_picture(color);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::{Event, FontId, Key, MissingGlyphPolicy, Modifiers};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;

    const NAMES: [&str; 8] = ["笑い", "喜悦", "웃음", "ابتسامة عريضة", "חיוך רחב", "मुस्कान", "ยิ้ม", "😀"];

    /// Whether the system has fonts for all of a text.
    fn has_fonts(text: &str) -> bool {
        text.chars().all(|c| c.is_whitespace() || Fonts::of_system().face_for(c).is_some())
    }

    #[test]
    fn names_of_any_script_have_glyphs_where_the_system_has_a_font() {
        Fonts::of_system();
        let names: Vec<&str> = NAMES.into_iter().filter(|name| has_fonts(name)).collect();
        let shown = names.clone();
        // A glyph that nothing draws is a panic there.
        let mut harness = Harness::builder().with_context_setup(provide).build_ui(move |ui| {
            for name in &shown {
                ui.label(*name);
            }
        });
        harness.run();
        assert_eq!(harness.ctx.missing_glyph_policy(), MissingGlyphPolicy::Panic);
        for name in names {
            assert!(harness.query_by_label(name).is_some(), "{name}");
            let width = harness.ctx.fonts_mut(|fonts| {
                let text = (*name).to_owned();
                fonts.layout_no_wrap(text, FontId::proportional(14.0), theme::bright()).size().x
            });
            assert!(width > 8.0, "{name}: {width}");
        }
    }

    #[test]
    fn texts_from_the_right_can_be_typed() {
        Fonts::of_system();
        if !has_fonts(NAMES[3]) || !has_fonts(NAMES[4]) {
            return;
        }
        let mut harness = Harness::builder().with_context_setup(provide).build_ui_state(
            |ui, typed: &mut String| {
                let label = ui.label("Name");
                ui.text_edit_singleline(typed).labelled_by(label.id);
            },
            String::new(),
        );
        harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Name").focus();
        harness.run();
        for text in [NAMES[3], " a ", NAMES[4]] {
            harness.event(Event::Text(text.to_owned()));
            harness.run();
        }
        assert!(harness.state().starts_with(NAMES[3]), "{}", harness.state());
        for key in [Key::ArrowLeft, Key::ArrowRight, Key::Home, Key::End, Key::Backspace] {
            for modifiers in [Modifiers::NONE, Modifiers::SHIFT, Modifiers::CTRL | Modifiers::COMMAND] {
                harness.key_press_modifiers(modifiers, key);
                harness.run();
            }
        }
    }
}
