//! `cargo xtask docs`: the tables of settings in the documents, as the program prints them.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::fs;
use std::process::Command;

/// Documents with marked tables of settings.
const PAGES: [&str; 2] = ["simulation.md", "shadow_methods.md"];

/// Writes `docs/settings.md` and every marked table: what is between `<!-- settings: SECTION -->` and `<!-- end -->`.
pub(crate) fn run() -> anyhow::Result<()> {
    tool::build_programs()?;
    let docs = tool::root().join("docs");
    fs::write(docs.join("settings.md"), printed(None)?)?;
    for page in PAGES {
        let path = docs.join(page);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        fs::write(&path, renewed(&text, |section| printed(Some(section)))?)?;
    }
    Ok(())
}

/// What the program prints of a section; the whole page without one.
fn printed(section: Option<&str>) -> anyhow::Result<String> {
    let output = Command::new(tool::program()).args(["settings", "--markdown"]).args(section).output()?;
    ensure!(output.status.success(), "lovelock settings: {}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8(output.stdout)?)
}

/// The text with what `table` makes of the section between the marks of each block.
fn renewed(text: &str, table: impl Fn(&str) -> anyhow::Result<String>) -> anyhow::Result<String> {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("<!-- settings: ") {
        let (section, old) = after.split_once(" -->").context("a mark of settings without its end")?;
        let (_, after) = old.split_once("<!-- end -->").context("a table of settings without its end")?;
        for part in [before, "<!-- settings: ", section, " -->\n\n", &table(section)?, "\n<!-- end -->"] {
            out.push_str(part);
        }
        rest = after;
    }
    Ok(out + rest)
}

#[cfg(test)]
mod tests {
    use super::renewed;

    #[test]
    fn what_is_between_the_marks_is_replaced() {
        let text = "a\n<!-- settings: x.y -->\nold\n<!-- end -->\nb <!-- settings: z --><!-- end -->";
        let new = renewed(text, |section| Ok(format!("| {section} |\n"))).expect("marks");
        assert_eq!(
            new,
            "a\n<!-- settings: x.y -->\n\n| x.y |\n\n<!-- end -->\nb <!-- settings: z -->\n\n| z |\n\n<!-- end -->"
        );
        assert_eq!(renewed(&new, |section| Ok(format!("| {section} |\n"))).expect("marks"), new, "only once");
        assert!(renewed("<!-- settings: x -->", |_| Ok(String::new())).is_err());
    }
}
