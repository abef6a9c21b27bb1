//! `cargo xtask test --browser`: checks the page of a comparison in Chromium.

pub(crate) mod chromium;
mod facts;

use anyhow::{Context as _, bail, ensure};
use chromium::Browser;
use facts::Facts;
use lovelock_xtask::{system, tool};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Compares methods on a small scene, opens the page and checks the result. A screenshot of the page is saved in `target`.
pub(crate) fn run() -> anyhow::Result<()> {
    system::prepare_browser()?;
    let folder = tool::root().join("target/browser");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("could not remove {}", folder.display()))?;
    }
    fs::create_dir_all(&folder)?;
    let report = folder.join("report");
    compare(&folder, &report)?;
    let browser = Browser::new(folder.join("profile"));
    let page = report.join("report.html");
    let facts = browser.open(&page)?;
    facts.check()?;
    controls(&browser, &page, &folder)?;
    let picture = folder.join("report.png");
    browser.screenshot(&page, &picture, facts.height)?;
    println!(
        "browser: the page runs, {} images, no network requests; see {}",
        facts.pictures,
        picture.display()
    );
    Ok(())
}

/// Methods with and without slices, texels and errors.
const METHODS: &str = "none,voxel-map,opacity-maps,deep-shadow-maps,moments,exact";

/// Runs `lovelock compare` on the small scene.
fn compare(folder: &Path, report: &Path) -> anyhow::Result<()> {
    let project = folder.join("small.lovelock");
    fs::write(&project, include_str!("small.lovelock"))?;
    let mut lovelock = Command::new(tool::program());
    lovelock.arg("compare").arg(&project).arg("-o").arg(report);
    lovelock.args(["--frames", "4..7", "--methods", METHODS, "--backend", "cpu", "--size", "240x180"]);
    tool::run(&mut lovelock)
}

/// Negative controls: pages that must fail, each with one fault.
fn controls(browser: &Browser, page: &Path, folder: &Path) -> anyhow::Result<()> {
    let good = fs::read_to_string(page)?;
    let asks = r#"<img src="http://localhost:9/picture.png">"#;
    let (policy, free) = ("http-equiv=\"Content-Security-Policy\"", "name=\"ignored\"");
    ensure!(good.contains(policy) && good.contains("<script>"), "the page has no policy or no script");
    for (name, broken) in [
        // Outside its folder the page has no images.
        ("images", good.clone()),
        ("script", good.replacen("<script>", "<script>throw new Error('control');", 1)),
        ("network", good.replacen(policy, free, 1).replacen("</body>", &format!("{asks}</body>"), 1)),
    ] {
        // In the folder of the good page its images exist.
        let beside = if name == "images" { folder } else { page.parent().unwrap_or(folder) };
        let path = beside.join(format!("control_{name}.html"));
        fs::write(&path, broken)?;
        let outcome = browser.open(&path).and_then(|facts: Facts| facts.check());
        fs::remove_file(&path)?;
        match outcome {
            Ok(()) => bail!("a page with broken {name} passed"),
            Err(error) => ensure!(
                error.to_string().contains(name),
                "a page with broken {name} failed for another reason: {error:#}"
            ),
        }
    }
    Ok(())
}
