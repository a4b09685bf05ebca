//! The commands and links of the README and of the pages in `docs/` work.
#![cfg(all(unix, feature = "cli"))]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};

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

/// Options that precede the name of a result.
const RESULTS: [&str; 8] =
    ["-o", ">", "--save-masks", "--save-layers", "--pattern", "--debug-dir", "--out-dir", "man"];

/// The `sh` blocks beneath a mark `<!-- test: NAME -->`: their names and lines, in the order of the pages.
fn blocks(pages: &[(PathBuf, String)]) -> Vec<(&str, Vec<&str>)> {
    let marked = pages.iter().flat_map(|(_, text)| text.split("<!-- test: ").skip(1));
    marked
        .map(|part| {
            let (name, rest) = part.split_once(" -->\n```sh\n").unwrap();
            (name, rest.split("```").next().unwrap().lines().collect())
        })
        .collect()
}

/// The files and folders that a command names as its results.
fn results(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let named = words.windows(2).filter(|pair| RESULTS.contains(&pair[0]) && pair[1] != "-");
    let mut results: Vec<String> = named.map(|pair| pair[1].to_owned()).collect();
    if let ["vtex", "analyze", photo] = words[..] {
        results.push(photo.replace(".jpg", ".lib.json"));
    }
    results
}

/// Runs a command and checks that its results exist.
fn run_line(folder: &Path, line: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_vtex")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("sh");
    shell.args(["-c", line]).current_dir(folder).env("PATH", path).stdin(Stdio::null());
    let output = shell.output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}\n{message}");
    assert!(!message.contains("error") && !message.contains("panicked"), "{line}\n{message}");
    for result in results(line) {
        let size = std::fs::metadata(folder.join(&result)).map_or(0, |m| m.len());
        assert!(size > 0, "{line}: no {result}");
    }
}

/// The files that a command names and does not make, and that are not there.
fn missing<'a>(folder: &Path, line: &'a str) -> impl Iterator<Item = &'a str> {
    let words = line.split_whitespace().map(|word| word.trim_matches(['\'', '"']));
    let (folder, results) = (folder.to_owned(), results(line));
    words.filter(move |word| !results.iter().any(|result| result == word) && !folder.join(word).exists())
}

/// Runs those of the commands that make a file, if there are any.
fn make(folder: &Path, file: &str, commands: &[&str]) {
    let maker = commands.iter().rposition(|line| results(line).iter().any(|result| result == file));
    if let Some(at) = maker {
        missing(folder, commands[at]).for_each(|file| make(folder, file, &commands[..at]));
        run_line(folder, commands[at]);
    }
}

/// Writes two photographs and what the pages name beside them.
fn prepare(folder: &Path, pages: &[(PathBuf, String)]) {
    let photo = image::open(root().join("examples/exemplars/terrazzo.png")).unwrap();
    photo.crop_imm(160, 160, 192, 160).save(folder.join("photo.jpg")).unwrap();
    let other = image::open(root().join("examples/exemplars/leaves.png")).unwrap();
    other.crop_imm(100, 100, 192, 160).save(folder.join("other.jpg")).unwrap();
    crate::cli::support::steering(folder);
    let jobs = pages[1].1.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    std::fs::write(folder.join("jobs.toml"), jobs).unwrap();
}

/// Runs a block in its own folder. Files of earlier blocks that it needs are made once for all blocks.
fn run(name: &str) {
    static IS_PREPARED: Mutex<bool> = Mutex::new(false);
    let made = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
    let pages = pages();
    let blocks = blocks(&pages);
    let at = blocks.iter().position(|block| block.0 == name).unwrap();
    let earlier: Vec<&str> = blocks[..at].iter().flat_map(|block| block.1.clone()).collect();
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path(), &pages);
    for line in &blocks[at].1 {
        for file in missing(folder.path(), line) {
            let mut is_prepared = IS_PREPARED.lock().unwrap_or_else(PoisonError::into_inner);
            if !*is_prepared {
                let _ = std::fs::remove_dir_all(&made);
                std::fs::create_dir(&made).unwrap();
                prepare(&made, &pages);
                *is_prepared = true;
            }
            if !made.join(file).exists() {
                make(&made, file, &earlier);
            }
            if made.join(file).is_file() {
                std::fs::copy(made.join(file), folder.path().join(file)).unwrap();
            }
        }
        run_line(folder.path(), line);
    }
}

/// A test for each block.
macro_rules! tests {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            run(stringify!($name));
        })*

        #[test]
        fn every_block_has_a_test() {
            let pages = pages();
            let names: Vec<&str> = blocks(&pages).into_iter().map(|block| block.0).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

tests! {
    readme_texture readme_two_steps
    in_one_go in_two_steps tiles print_sizes methods lattices shapes_and_maps warps edits interpolations layers
    layered_textures pixels pictures vectorized_photographs contents inspection masks configuration batches
    manuals
    metrics tuning
    recipe_tile recipe_print recipe_game recipe_programs recipe_small recipe_colourways recipe_fill recipe_plotter
    recipe_batch
    style_rules colours_of_categories colourway numbers_of_categories
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
