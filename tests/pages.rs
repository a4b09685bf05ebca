//! Paths in the pages exist, and so do the items of the code that ARCHITECTURE.md names.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Largest size of ARCHITECTURE.md, in bytes.
const LARGEST: usize = 12_000;

pub(super) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub(super) fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// All files beneath a folder whose names end in `.` and `extension`, in order.
pub(super) fn files(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            files(&path, extension, found);
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
}

/// ARCHITECTURE.md, README.md and all pages of `docs`.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("ARCHITECTURE.md"), root().join("README.md")];
    files(&root().join("docs"), "md", &mut pages);
    pages
}

/// The texts in backticks of a page, without its blocks of code.
fn quoted(page: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut in_block = false;
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
        } else if !in_block {
            found.extend(line.split('`').skip(1).step_by(2));
        }
    }
    found
}

/// Whether a text is a path in the repository: it begins with one of its folders, or has the extension of a
/// source file or page.
fn is_path(text: &str) -> bool {
    if text.contains(|c: char| c.is_whitespace() || "*<>$".contains(c)) {
        return false;
    }
    let first = text.split('/').next().unwrap_or_default();
    let in_folder =
        text.contains('/') && !first.is_empty() && !first.starts_with("..") && root().join(first).is_dir();
    in_folder || text.ends_with(".rs") || text.ends_with(".md")
}

/// The paths of a page that do not exist.
fn missing_paths(page: &str) -> Vec<&str> {
    let mut missing = quoted(page);
    missing.retain(|text| is_path(text) && !root().join(text).exists());
    missing
}

/// Whether a text is Rust: `Type`, `Type::method`, `module::function` or `function()`.
fn is_rust(text: &str) -> bool {
    let known = |c: char| c.is_alphanumeric() || "_:()<>".contains(c);
    let named = text.starts_with(|c: char| c.is_uppercase()) && text.contains(|c: char| c.is_lowercase());
    text.chars().all(known) && (named || text.contains("::") || text.ends_with("()"))
}

/// The words of a text: names and numbers.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Names that occur in the code, and those of functions among them.
#[derive(Default)]
struct Names {
    all: BTreeSet<String>,
    functions: BTreeSet<String>,
}

impl Names {
    fn add(&mut self, code: &str) {
        for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let mut before = "";
            for word in words(line) {
                if before == "fn" {
                    self.functions.insert(word.to_owned());
                }
                self.all.insert(word.to_owned());
                before = word;
            }
        }
    }

    /// Those of the sources in `crates` and `src`.
    fn of_sources() -> Self {
        let mut sources = Vec::new();
        for folder in ["crates", "src"] {
            files(&root().join(folder), "rs", &mut sources);
        }
        assert!(sources.len() > 300, "{} sources", sources.len());
        let mut names = Self::default();
        sources.iter().for_each(|source| names.add(&read(source)));
        names
    }

    /// The items of a page that do not occur.
    fn missing<'a>(&self, page: &'a str) -> Vec<&'a str> {
        let occurs = |text: &str| {
            let is_function = text.ends_with("()");
            let last = words(text).last().unwrap_or_default();
            words(text).all(|word| self.all.contains(word)) && (!is_function || self.functions.contains(last))
        };
        let mut missing = quoted(page);
        missing.retain(|text| is_rust(text) && !occurs(text));
        missing
    }
}

#[test]
fn paths_of_the_pages_exist() {
    let mut count = 0;
    for page in pages() {
        let text = read(&page);
        count += quoted(&text).into_iter().filter(|text| is_path(text)).count();
        let missing = missing_paths(&text);
        assert!(missing.is_empty(), "{} names {missing:?}", page.display());
    }
    assert!(count > 50, "{count} paths");
}

#[test]
fn items_of_the_architecture_exist() {
    let text = read(&root().join("ARCHITECTURE.md"));
    let count = quoted(&text).into_iter().filter(|text| is_rust(text)).count();
    assert!(count > 30, "{count} items");
    let missing = Names::of_sources().missing(&text);
    assert!(missing.is_empty(), "ARCHITECTURE.md names {missing:?}");
}

#[test]
fn the_architecture_is_short() {
    let size = read(&root().join("ARCHITECTURE.md")).len();
    assert!(size <= LARGEST, "{size} bytes");
}

#[test]
fn what_is_missing_is_seen() {
    let page = "`src/lib.rs` and `src/nothing.rs`, `nowhere.md`, `vtex/models`, `cargo run src/x.rs`\n\
                ```sh\n`src/in_a_block.rs`\n```\n`tests`, `tests/nothing`, `crates/*`, `../src/nothing`";
    assert_eq!(missing_paths(page), ["src/nothing.rs", "nowhere.md", "tests/nothing"]);

    let mut names = Names::default();
    names.add("// Commented\npub struct Known;\nimpl Known { pub fn made() {} }\nlet other = 1;");
    let page =
        "`Known` `Known::made` `made()` `Vec<Known>` `other()` `Known::lost` `Commented` `--made` `other`";
    assert_eq!(names.missing(page), ["Vec<Known>", "other()", "Known::lost", "Commented"]);
}
