//! The commands and links of the README and of the pages in `docs/` work.
#![cfg(all(unix, feature = "cli"))]

use image::{GrayImage, Luma, Rgb, RgbImage};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn readme() -> String {
    std::fs::read_to_string(root().join("README.md")).unwrap()
}

/// The pages for users and their places: the README, the tour, then those that go on from it.
fn pages() -> Vec<(PathBuf, String)> {
    let mut pages = vec![root().join("README.md"), root().join("docs/tour.md")];
    let folders = ["docs", "docs/measurements"].map(|folder| root().join(folder));
    let docs = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let docs = docs.map(|entry| entry.unwrap().path());
    let mut others: Vec<PathBuf> = docs.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    others.retain(|page| !pages.contains(page));
    others.sort();
    pages.extend(others);
    pages.into_iter().map(|page| (page.clone(), std::fs::read_to_string(page).unwrap())).collect()
}

/// Lines of the `sh` blocks that stand beneath a mark `<!-- tour -->`, in order.
fn tour(text: &str) -> Vec<&str> {
    let blocks = text.split("<!-- tour -->\n```sh\n").skip(1);
    blocks.flat_map(|block| block.split("```").next().unwrap_or_default().lines()).collect()
}

/// Every file beneath a folder, with its size.
fn files(folder: &Path) -> Vec<(String, u64)> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let mut found: Vec<_> = entries
        .map(|e| (e.file_name().to_string_lossy().into_owned(), e.metadata().unwrap().len()))
        .collect();
    found.sort();
    found
}

/// The shape and the maps that the tour names.
fn steering(folder: &Path) {
    let disc = r#"<svg xmlns="http://www.w3.org/2000/svg" width="90" height="90"><circle cx="45" cy="45" r="40"/></svg>"#;
    std::fs::write(folder.join("shape.svg"), disc).unwrap();
    let cage = |d: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="800" height="400"><path d="{d}"/></svg>"#)
    };
    std::fs::write(folder.join("cage.svg"), cage("M0 0H800V300H0z")).unwrap();
    std::fs::write(
        folder.join("bent-cage.svg"),
        cage("M0 0C250 120 550 120 800 0V300C550 420 250 420 0 300z"),
    )
    .unwrap();
    let tour = std::fs::read_to_string(root().join("docs/tour.md")).unwrap();
    let jobs = tour.split("```toml\n").nth(1).unwrap().split("```").next().unwrap().to_owned();
    std::fs::write(folder.join("jobs.toml"), jobs).unwrap();
    let fade = GrayImage::from_fn(256, 2, |x, _| Luma([x as u8]));
    fade.save(folder.join("fade.png")).unwrap();
    let ring = GrayImage::from_fn(90, 90, |x, y| {
        let (x, y) = (f64::from(x) - 44.5, f64::from(y) - 44.5);
        Luma([if (400.0..1600.0).contains(&(x * x + y * y)) { 255 } else { 0 }])
    });
    ring.save(folder.join("ring.png")).unwrap();
    let colours = [[20, 30, 90], [200, 40, 30], [250, 240, 220]];
    let flag = RgbImage::from_fn(30, 15, |x, _| Rgb(colours[x as usize / 10]));
    flag.save(folder.join("flag.png")).unwrap();
}

#[test]
fn the_tour_runs() {
    let folder = tempfile::tempdir().unwrap();
    let photo = image::open(root().join("examples/exemplars/terrazzo.png")).unwrap();
    photo.crop_imm(160, 160, 192, 160).save(folder.path().join("photo.jpg")).unwrap();
    let other = image::open(root().join("examples/exemplars/leaves.png")).unwrap();
    other.crop_imm(100, 100, 192, 160).save(folder.path().join("other.jpg")).unwrap();
    steering(folder.path());
    let program = Path::new(env!("CARGO_BIN_EXE_vtex")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let pages = pages();
    let lines: Vec<&str> = pages.iter().flat_map(|(_, text)| tour(text)).collect();
    assert!(lines.len() > 60, "{lines:?}");
    for line in lines {
        let mut shell = Command::new("sh");
        shell.args(["-c", line]).current_dir(folder.path()).env("PATH", &path).stdin(Stdio::null());
        let output = shell.output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}\n{message}");
        assert!(!message.contains("error") && !message.contains("panicked"), "{line}\n{message}");
        // Whatever it names as its result is there.
        let words: Vec<&str> = line.split_whitespace().collect();
        for pair in words.windows(2).filter(|p| ["-o", ">", "--save-masks"].contains(&p[0]) && p[1] != "-") {
            let size = std::fs::metadata(folder.path().join(pair[1])).map_or(0, |m| m.len());
            assert!(size > 0, "{line}: no {}", pair[1]);
        }
    }
    let found = files(folder.path());
    assert!(found.iter().all(|(_, size)| *size > 0), "{found:?}");
    for name in ["photo.lib.json", "man1", "stages"] {
        assert!(found.iter().any(|(file, _)| file == name), "no {name} in {found:?}");
    }
}

#[test]
fn links_lead_somewhere_and_pictures_are_small() {
    let mut links = 0;
    let pages = pages();
    let parts = pages.iter().flat_map(|(page, text)| text.split("](").skip(1).map(move |part| (page, part)));
    for (page, part) in parts {
        let target = part.split(')').next().unwrap();
        if target.starts_with("https://") {
            continue;
        }
        links += 1;
        let (file, _) = target.split_once('#').unwrap_or((target, ""));
        let file = page.parent().unwrap().join(file);
        let size =
            std::fs::metadata(&file).unwrap_or_else(|e| panic!("{}: {target}: {e}", page.display())).len();
        assert!(!target.ends_with(".png") || size < 200_000, "{target} has {size} bytes");
    }
    assert!(links > 30);
}

#[test]
fn the_readme_is_short() {
    let words = readme().split_whitespace().count();
    assert!(words < 1500, "{words} words");
}

#[test]
fn the_first_command_names_what_the_repository_holds() {
    let text = readme();
    let line = text.lines().find(|line| line.starts_with("cargo run --release -- texture ")).unwrap();
    let photo = line.split_whitespace().nth(5).unwrap();
    assert!(root().join(photo).is_file(), "{photo}");
}
