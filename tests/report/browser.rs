//! Clicks through the page in headless Chromium. Skipped with a note if it is not installed.

use super::subject::{made, page};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use vtex::geometry::{BezPath, Outline};
use vtex::raster::colour::Colour;
use vtex::scene::{Domain, Edge, EditRecord, Recorded, Scene, Shadow, Stroke, Transfer, TransferMode};

/// Clicks through the page and leaves what it saw in an element `outcome`.
const CLICKS: &str = include_str!("clicks.js");

/// The first browser on the search path.
fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    names.iter().flat_map(|name| folders.iter().map(move |f| f.join(name))).find(|file| file.is_file())
}

/// Opens a page, lets the clicks run, and returns the outcome and what was logged to the console.
fn click(browser: &Path, page: &str) -> (Value, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.html");
    let (before, after) = page.rsplit_once("</body>").unwrap();
    std::fs::write(&file, format!("{before}<script>{CLICKS}</script></body>{after}")).unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--window-size=1280,900", "--force-color-profile=srgb", "--enable-logging=stderr"])
        .args(["--virtual-time-budget=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}", file.display()))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let logged = String::from_utf8_lossy(&output.stderr);
    let outcome = dom.split_once("<pre id=\"outcome\">").unwrap_or_else(|| panic!("no outcome: {logged}")).1;
    let outcome = outcome.split_once("</pre>").unwrap().0.replace("&lt;", "<").replace("&gt;", ">");
    let console = logged.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned);
    (serde_json::from_str(&outcome.replace("&amp;", "&")).unwrap(), console.collect())
}

/// A triangle whose edge keeps primaries whole.
fn domain() -> Domain {
    let mut path = BezPath::new();
    path.move_to((20.0, 20.0));
    path.line_to((220.0, 40.0));
    path.line_to((60.0, 180.0));
    path.close_path();
    Domain { outline: Outline::new(&path).unwrap(), edge: Edge::Keep }
}

/// Shadows beneath all primaries and lines around them.
fn edit(scene: &mut Scene) {
    for instance in scene.layers.iter_mut().filter(|l| l.role.is_individual()).flat_map(|l| &mut l.instances)
    {
        instance.shadow = Some(Shadow { offset: [3.0, 3.0], opacity: 0.5, blur: 3.0 });
        instance.stroke = Some(Stroke { width: 4.0, colour: Colour([200, 30, 30]) });
    }
    let (appearance, mode) = (vec!["moss.png".into()], TransferMode::Mean);
    let operation = Recorded::Transfer(Transfer { appearance, mode, scale: 0.5 });
    scene.edits = vec![EditRecord { operation, seed: 1 }];
}

#[test]
fn the_page_works_by_clicking() {
    let Some(browser) = browser() else {
        eprintln!("SKIPPED: there is no Chromium or Chrome on the search path, so no page was clicked");
        return;
    };
    let made = made();
    let both = page(&made.libraries, Some(&made.scene), &made.photos()).0;
    let (seen, console) = click(&browser, &both);
    assert_eq!(console, Vec::<String>::new(), "{seen}");
    assert_eq!(seen["errors"], Value::Array(Vec::new()), "{seen}");
    assert_eq!(seen["panes"], serde_json::json!(["Exemplar", "Reconstruction", "Result"]));
    // Switching off each layer and a category changes the picture, and switching it on again restores it.
    for layer in ["background", "secondary", "primary", "details", "ellipses", "category"] {
        assert!(seen["changed"][layer].as_f64().unwrap() > 0.0, "{layer}: {seen}");
    }
    assert_eq!(seen["restored"], 0, "{seen}");
    assert_eq!(seen["slider"], serde_json::json!([50, 52, 75]), "{seen}");
    assert!(seen["clip"].as_str().unwrap().contains("75%"), "{seen}");
    // All pictures have the same zoom, and the same position as far as there is room.
    assert!(seen["zoomed"].as_f64().unwrap() > 1.2, "{seen}");
    assert_eq!(seen["scales"], 1, "all pictures have one scale: {seen}");
    assert!(seen["moved"].as_f64().unwrap() > 10.0, "{seen}");
    assert_eq!(seen["chosen"], true, "{seen}");
    assert!(seen["maps"].as_u64().unwrap() == 2 && seen["mapColours"].as_u64().unwrap() > 2, "{seen}");
    assert!(seen["plots"].as_u64().unwrap() > 4, "{seen}");
    assert_ne!(seen["themes"][0], seen["themes"][1], "{seen}");
    assert_eq!(seen["wide"], 0, "nothing sticks out to the right: {seen}");

    let mut shaped = made.scene.clone();
    shaped.content.domain = Some(domain());
    edit(&mut shaped.content);
    for text in [page(&made.libraries, None, &[]).0, page(&[], Some(&shaped), &[]).0] {
        let (seen, console) = click(&browser, &text);
        assert_eq!((console, &seen["errors"]), (Vec::new(), &Value::Array(Vec::new())), "{seen}");
        assert_eq!(seen["panes"].as_array().unwrap().len(), 1, "{seen}");
        assert!(seen["changed"]["primary"].as_f64().unwrap() > 0.0, "{seen}");
        let edited = text.contains("transfer appearance=moss.png");
        assert_eq!(seen["edits"], usize::from(edited), "{seen}");
        // Without details a primary keeps its outline stroke and hides no more of others.
        let [with, without] = [0, 1].map(|k| seen["lines"][k].as_u64().unwrap());
        assert!(without >= with && (with > 0) == edited, "{seen}");
    }
}
