//! Files of the command line, and rooms of a crate, do not import one another in a circle. Between crates the
//! compiler prevents circles.

use crate::pages::{files, read, root};
use std::collections::BTreeSet;
use std::path::Path;

/// Crates with a circle: `relations`, `board` and `standing` of the first, `layout` and `scenes` of the second.
const WITH_A_CIRCLE: [&str; 2] = ["cluster", "testing"];

/// Each module with the modules that it imports.
type Imports = Vec<(Vec<String>, BTreeSet<Vec<String>>)>;

/// The modules that import one another in a circle, or lead into one.
fn circle(mut left: Imports) -> Vec<String> {
    // Repeatedly removes modules that import none of the remaining ones: they are not part of a circle.
    loop {
        let names: BTreeSet<Vec<String>> = left.iter().map(|(own, _)| own.clone()).collect();
        let before = left.len();
        left.retain(|(_, imports)| imports.iter().any(|i| names.contains(i)));
        if left.len() == before {
            return left.iter().map(|(own, _)| own.join("/")).collect();
        }
    }
}

/// The text of a file without its tests.
fn code(file: &Path) -> String {
    read(file).split("#[cfg(test)]\nmod tests {").next().unwrap().to_owned()
}

/// The module of a file beneath a folder, such as `["commands", "edit"]`.
fn module_path(folder: &Path, file: &Path) -> Vec<String> {
    let below = file.strip_prefix(folder).unwrap().with_extension("");
    let parts = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned());
    parts.filter(|part| part != "mod").collect()
}

/// The modules that the code of module `own` names: by a path from `top`, by `super::`, or, for its children,
/// by name.
fn neighbours(text: &str, own: &[String], top: &str, all: &BTreeSet<Vec<String>>) -> BTreeSet<Vec<String>> {
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
        // Only the beginnings of paths are examined.
        let start = code[..at].rfind(|c: char| !is_name(c)).map_or(0, |i| i + 1);
        if code[..start].ends_with("::") {
            continue;
        }
        let mut path = &code[start..];
        let mut base = own.to_vec();
        if let Some(rest) = path.strip_prefix(top) {
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
    let mut found = Vec::new();
    files(&folder, "rs", &mut found);
    let all: BTreeSet<Vec<String>> = found.iter().map(|file| module_path(&folder, file)).collect();
    let imports = |file: &std::path::PathBuf| {
        let own = module_path(&folder, file);
        let imports = neighbours(&code(file), &own, "crate::cli::", &all);
        (own, imports)
    };
    let left: Imports = found.iter().map(imports).collect();
    assert!(left.iter().filter(|(_, imports)| !imports.is_empty()).count() > 50);
    let names = circle(left);
    assert!(names.is_empty(), "these files import one another in a circle, or lead into one: {names:?}");
}

#[test]
fn rooms_of_a_crate_do_not_import_one_another_in_a_circle() {
    let crates = std::fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let mut seen = 0;
    let left_out = |path: &Path| WITH_A_CIRCLE.iter().any(|name| path.ends_with(name));
    for folder in crates.filter(|path| !left_out(path)) {
        let (folder, mut found) = (folder.join("src"), Vec::new());
        files(&folder, "rs", &mut found);
        let room = |file: &Path| module_path(&folder, file)[..1].to_vec();
        let head = read(&folder.join("lib.rs"));
        let is_test = |file: &Path| {
            let is_for_tests = head.contains(&format!("#[cfg(test)]\nmod {};", room(file)[0]));
            is_for_tests || file.ends_with("tests.rs") || file.ends_with("testing.rs")
        };
        found.retain(|file| !file.ends_with("lib.rs") && !is_test(file));
        let rooms: BTreeSet<Vec<String>> = found.iter().map(|file| room(file)).collect();
        let imports = |own: &Vec<String>| {
            let of_room = found.iter().filter(|file| room(file) == *own);
            let imports = of_room
                .flat_map(|file| neighbours(&code(file), &module_path(&folder, file), "crate::", &rooms))
                .filter(|room| room != own);
            (own.clone(), imports.collect())
        };
        let names = circle(rooms.iter().map(imports).collect());
        assert!(names.is_empty(), "{}: {names:?} import one another in a circle", folder.display());
        seen += rooms.len();
    }
    assert!(seen > 30, "{seen} rooms");
}

#[test]
fn a_circle_of_files_is_seen() {
    let path = |text: &str| text.split('/').map(str::to_owned).collect::<Vec<_>>();
    let all: BTreeSet<Vec<String>> = ["a", "a/b", "a/c", "d"].map(path).into_iter().collect();
    let text =
        "use super::c::{X, Y};\nuse crate::cli::d::Z;\n// super::super::q\nlet a = super::super::a::f();";
    let found: Vec<String> =
        neighbours(text, &path("a/b"), "crate::cli::", &all).into_iter().map(|p| p.join("/")).collect();
    assert_eq!(found, ["a", "a/c", "d"]);
    assert_eq!(neighbours("use b::T;", &path("a"), "crate::cli::", &all).len(), 1);
}

#[test]
fn a_circle_is_told_from_a_chain() {
    let of = |pairs: &[(&str, &str)]| {
        let names = ["a", "b", "c"];
        let imports = |own: &str| {
            let all = pairs.iter().filter(|(from, _)| *from == own);
            all.map(|(_, to)| vec![(*to).to_owned()]).collect::<BTreeSet<_>>()
        };
        circle(names.iter().map(|own| (vec![(*own).to_owned()], imports(own))).collect())
    };
    assert!(of(&[("a", "b"), ("b", "c"), ("a", "c")]).is_empty());
    assert_eq!(of(&[("a", "b"), ("b", "c"), ("c", "b")]), ["a", "b", "c"]);
}
