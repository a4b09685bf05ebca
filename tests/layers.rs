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

/// The module at the top of a file's path, such as `arrange` for `src/arrange/descriptor/mod.rs`.
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

/// The module of a file beneath a folder, such as `["commands", "edit"]`.
fn module_path(folder: &Path, file: &Path) -> Vec<String> {
    let below = file.strip_prefix(folder).unwrap().with_extension("");
    let parts = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned());
    parts.filter(|part| part != "mod").collect()
}

/// The modules that the code of module `own` of `cli` names, by `crate::cli::` or `super::`; its own
/// children by their names alone.
fn neighbours(text: &str, own: &[String], all: &BTreeSet<Vec<String>>) -> BTreeSet<Vec<String>> {
    let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = BTreeSet::new();
    let mut add = |base: &[String], path: &str| {
        let rest = path.split("::").map(|part| part.trim().to_owned());
        let full: Vec<String> = base.iter().cloned().chain(rest).collect();
        let known = (0..=full.len()).rev().map(|n| full[..n].to_vec()).find(|path| all.contains(path));
        found.extend(known.filter(|path| path != own));
    };
    for (at, _) in code.match_indices("::") {
        // Only where a path begins.
        let start = code[..at].rfind(|c: char| !is_name(c)).map_or(0, |i| i + 1);
        if code[..start].ends_with("::") {
            continue;
        }
        let mut path = &code[start..];
        let mut base = own.to_vec();
        if let Some(rest) = path.strip_prefix("crate::cli::") {
            (base, path) = (Vec::new(), rest);
        } else {
            while let Some(rest) = path.strip_prefix("super::") {
                base.pop();
                path = rest;
            }
        }
        let end = path.find(|c: char| !is_name(c) && c != ':').unwrap_or(path.len());
        match path[end..].strip_prefix('{').and_then(|group| group.split_once('}')) {
            Some((group, _)) => {
                group.split(',').for_each(|one| add(&base, &format!("{}{one}", &path[..end])))
            }
            None => add(&base, &path[..end]),
        }
    }
    found
}

#[test]
fn files_of_the_command_line_do_not_import_one_another_in_a_circle() {
    let folder = root().join("src/cli");
    let mut files = Vec::new();
    sources(&folder, &mut files);
    let all: BTreeSet<Vec<String>> = files.iter().map(|file| module_path(&folder, file)).collect();
    let mut left: Vec<(Vec<String>, BTreeSet<Vec<String>>)> = Vec::new();
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let own = module_path(&folder, file);
        let imports = neighbours(code, &own, &all);
        left.push((own, imports));
    }
    assert!(left.iter().filter(|(_, imports)| !imports.is_empty()).count() > 50);
    // Whatever imports nothing that is left cannot be part of a circle.
    loop {
        let names: BTreeSet<Vec<String>> = left.iter().map(|(own, _)| own.clone()).collect();
        let before = left.len();
        left.retain(|(_, imports)| imports.iter().any(|i| names.contains(i)));
        if left.len() == before {
            break;
        }
    }
    let names: Vec<String> = left.iter().map(|(own, _)| own.join("/")).collect();
    assert!(names.is_empty(), "these files import one another in a circle, or lead into one: {names:?}");
}

#[test]
fn a_circle_of_files_is_seen() {
    let path = |text: &str| text.split('/').map(str::to_owned).collect::<Vec<_>>();
    let all: BTreeSet<Vec<String>> = ["a", "a/b", "a/c", "d"].map(path).into_iter().collect();
    let text =
        "use super::c::{X, Y};\nuse crate::cli::d::Z;\n// super::super::q\nlet a = super::super::a::f();";
    let found: Vec<String> = neighbours(text, &path("a/b"), &all).into_iter().map(|p| p.join("/")).collect();
    assert_eq!(found, ["a", "a/c", "d"]);
    assert_eq!(neighbours("use b::T;", &path("a"), &all).len(), 1);
}
