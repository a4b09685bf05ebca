//! Imports only point down: the table of ARCHITECTURE.md, read and compared with the sources.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A row of the table: a module or the binary, and what it may import.
struct Layer {
    name: String,
    imports: BTreeSet<String>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Rows ``| `src/name…` | `a` `b` | … |``, from the top layer to the lowest.
fn layers() -> Vec<Layer> {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| `src/"));
    rows.map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let quoted =
            |cell: &str| -> Vec<String> { cell.split('`').skip(1).step_by(2).map(Into::into).collect() };
        let name = quoted(cells[1])[0].trim_start_matches("src/").trim_end_matches('/').to_owned();
        let name = name.trim_end_matches(".rs").to_owned();
        Layer { name, imports: quoted(cells[2]).into_iter().collect() }
    })
    .collect()
}

/// All Rust files beneath a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The module at the top of a file's path, such as `synth` for `src/synth/primaries/mod.rs`.
fn module(path: &Path) -> String {
    let below = path.strip_prefix(root().join("src")).unwrap();
    let first = below.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

/// What follows `crate::` or `vtex::` in the code of a file: names of modules, or of items at the
/// top of the crate.
fn imports(text: &str, prefix: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in text.lines().map(str::trim_start).filter(|line| !line.starts_with("//")) {
        for (at, _) in line.match_indices(prefix) {
            let before = line[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let rest = &line[at + prefix.len()..];
            let first = |path: &str| -> String {
                path.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
            };
            match rest.strip_prefix('{').map(|group| group.split_once('}')) {
                None => found.extend([first(rest)]),
                Some(Some((group, _))) if !group.contains('{') => found.extend(group.split(',').map(first)),
                // A group over several lines, or within another: a module that no row allows.
                Some(_) => found.extend(["{".to_owned()]),
            }
        }
    }
    // Items of lib.rs: its constant, and what it lifts out of the lowest modules.
    found.remove("PROGRAM");
    for (item, module) in [("Error", "error"), ("Result", "error"), ("Progress", "progress")] {
        if found.remove(item) {
            found.insert(module.to_owned());
        }
    }
    found
}

#[test]
fn the_table_points_down_only() {
    let layers = layers();
    assert!(layers.len() > 10, "the table has {} rows", layers.len());
    for (i, layer) in layers.iter().enumerate() {
        let below: BTreeSet<String> = layers[i + 1..].iter().map(|l| l.name.clone()).collect();
        let upward: Vec<&String> = layer.imports.difference(&below).collect();
        assert!(upward.is_empty(), "src/{} may not import {upward:?}: not below it in the table", layer.name);
    }
}

#[test]
fn sources_import_only_what_the_table_allows() {
    let layers = layers();
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    assert!(files.len() > 50);
    for file in files {
        let name = module(&file);
        if name == "lib" {
            continue; // it only names the modules
        }
        let layer = layers.iter().find(|l| l.name == name);
        let layer = layer.unwrap_or_else(|| panic!("ARCHITECTURE.md has no row for src/{name}"));
        let text = std::fs::read_to_string(&file).unwrap();
        // Tests may use all that lies below.
        let at = layers.iter().position(|l| l.name == name).unwrap();
        let below: BTreeSet<String> = layers[at..].iter().map(|l| l.name.clone()).collect();
        let own = BTreeSet::from([name.clone()]);
        let allowed: BTreeSet<String> = layer.imports.union(&own).cloned().collect();
        let only_tests = file.ends_with("tests.rs") || file.ends_with("testing.rs");
        let (code, tests) = match text.split_once("#[cfg(test)]\nmod tests {") {
            _ if only_tests => ("", text.as_str()),
            Some(parts) => parts,
            None => (text.as_str(), ""),
        };
        // The binary sees the library from outside, as any other program.
        let prefix = if name == "main" || name == "cli" { "vtex::" } else { "crate::" };
        for (part, allowed) in [(code, &allowed), (tests, &below)] {
            let found = imports(part, prefix);
            let wrong: Vec<&String> = found.difference(allowed).collect();
            assert!(
                wrong.is_empty(),
                "{} imports {wrong:?}, which ARCHITECTURE.md does not allow",
                file.display()
            );
        }
    }
}

#[test]
fn an_upward_import_is_seen() {
    let text = "//! crate::a\nuse crate::b::C;\nlet x = crate::d::e(crate::PROGRAM);\nuse crate::{f, g::H};\nmycrate::i\nuse crate::{\n    j,\n};";
    let found: Vec<String> = imports(text, "crate::").into_iter().collect();
    assert_eq!(found, ["b", "d", "f", "g", "{"]);
}
