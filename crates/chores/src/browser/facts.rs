//! The state of a page after loading, and its network requests.

use anyhow::{Context as _, ensure};
use serde::Deserialize;

/// The state of a page after loading.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Facts {
    /// Whether its script finished.
    pub(crate) ran: bool,
    /// Number of images in the page.
    pub(crate) pictures: u32,
    /// Number of images that did not load.
    pub(crate) broken: u32,
    /// Height of the page in CSS pixels.
    pub(crate) height: u32,
    /// Addresses that the page requested, without local files.
    pub(crate) requests: Vec<String>,
}

impl Facts {
    /// Reads the page after loading, and the browser's network log.
    ///
    /// The page's script stores its findings in attributes of the root element: `data-state`, `data-pictures`, `data-broken`
    /// and `data-height`.
    pub(crate) fn read(dom: &str, log: &[u8]) -> anyhow::Result<Self> {
        let root =
            dom.split_once("<html").and_then(|(_, rest)| rest.split_once('>')).map_or("", |(root, _)| root);
        let attribute = |name: &str| {
            let (_, value) = root.split_once(&format!(" data-{name}=\""))?;
            value.split_once('"').map(|(value, _)| value)
        };
        let number = |name: &str| attribute(name).and_then(|value| value.parse().ok()).unwrap_or(0);
        Ok(Self {
            ran: attribute("state") == Some("ready"),
            pictures: number("pictures"),
            broken: number("broken"),
            height: number("height"),
            requests: requests(log)?,
        })
    }

    /// Checks that the page loaded completely and without network requests.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        ensure!(self.requests.is_empty(), "the page made network requests: {}", self.requests.join(", "));
        ensure!(self.ran, "the script of the page did not finish");
        ensure!(self.pictures > 0, "the page has no images");
        ensure!(self.broken == 0, "{} of {} images did not load", self.broken, self.pictures);
        ensure!(self.height > 0, "the page has no height");
        Ok(())
    }
}

#[derive(Deserialize)]
struct Log {
    events: Vec<Event>,
}

#[derive(Deserialize)]
struct Event {
    params: Option<Parameters>,
}

#[derive(Deserialize)]
struct Parameters {
    url: Option<String>,
    initiator: Option<String>,
}

/// Addresses that the page requested. Requests of the browser itself have no origin.
fn requests(log: &[u8]) -> anyhow::Result<Vec<String>> {
    let log: Log = serde_json::from_slice(log).context("could not read the browser's network log")?;
    let mut found = Vec::new();
    for parameters in log.events.into_iter().filter_map(|event| event.params) {
        let (Some(url), Some(initiator)) = (parameters.url, parameters.initiator) else { continue };
        let local = ["file:", "data:", "blob:", "chrome:"].iter().any(|scheme| url.starts_with(scheme));
        if initiator != "not an origin" && !local && !found.contains(&url) {
            found.push(url);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::Facts;

    const LOG: &str = r#"{"constants": {}, "events": [
        {"type": 1, "params": {"url": "https://updates.example/own", "initiator": "not an origin"}},
        {"type": 1, "params": {"url": "file:///report/a.png", "initiator": "null"}},
        {"type": 2, "params": {"host": "updates.example"}}, {"type": 3}
    ], "polledData": []}"#;
    const PAGE: &str = r#"<!DOCTYPE html><html lang="en" data-state="ready" data-pictures="12" data-broken="0"
        data-height="3400"><head><title data-state="no"></title></head></html>"#;

    fn check(page: &str, log: &str) -> Result<Facts, String> {
        let facts = Facts::read(page, log.as_bytes()).map_err(|error| error.to_string())?;
        facts.check().map(|()| facts).map_err(|error| error.to_string())
    }

    #[test]
    fn a_whole_page_is_good() {
        let page = PAGE.replace('\n', " ");
        let facts = check(&page, LOG).unwrap();
        assert_eq!(facts, Facts { ran: true, pictures: 12, broken: 0, height: 3400, requests: vec![] });
    }

    #[test]
    fn each_fault_is_named() {
        let fault =
            |from: &str, to: &str| check(&PAGE.replace('\n', " ").replace(from, to), LOG).unwrap_err();
        assert!(fault("ready", "half").contains("script"));
        assert!(fault("pictures=\"12\"", "").contains("no images"));
        assert_eq!(fault("broken=\"0\"", "broken=\"3\""), "3 of 12 images did not load");
        assert!(fault("3400", "tall").contains("height"));
        let log = LOG.replace("file:///report/a.png", "http://example.org/a.png");
        assert!(check(PAGE, &log).unwrap_err().contains("network requests: http://example.org/a.png"));
        assert!(check(PAGE, "no log").is_err());
        assert!(check("", LOG).is_err());
    }
}
