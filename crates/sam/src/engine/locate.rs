//! Search for ONNX Runtime's shared library. Only inspects folders; neither loads nor runs anything.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// [`RuntimeCandidate::by`] of a library whose path the caller gave.
pub const GIVEN: &str = "the path given";

/// A candidate for ONNX Runtime's shared library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RuntimeCandidate {
    /// Path of the library.
    pub path: PathBuf,
    /// How it was found, such as `VTEX_ONNXRUNTIME`.
    pub by: &'static str,
    /// Whether the user named it explicitly; then no other library is tried.
    pub named: bool,
}

/// Candidates in the order in which they are tried: the path given; the variables `VTEX_ONNXRUNTIME`
/// and `ORT_DYLIB_PATH`; the program's folder; the system's folders; Python's package `onnxruntime`
/// in the active environment, the environments of `PATH`, the user's packages, and those of pyenv.
///
/// A library named by `given` or by a variable is the only candidate, even if it does not exist.
pub fn locate(given: Option<&Path>) -> Vec<RuntimeCandidate> {
    let named = |path: PathBuf, by| vec![RuntimeCandidate { path, by, named: true }];
    if let Some(path) = given {
        return named(path.to_owned(), GIVEN);
    }
    for variable in ["VTEX_ONNXRUNTIME", "ORT_DYLIB_PATH"] {
        if let Some(path) = env::var_os(variable).filter(|v| !v.is_empty()) {
            return named(path.into(), variable);
        }
    }
    let (mut found, mut seen): (Vec<RuntimeCandidate>, Vec<PathBuf>) = (Vec::new(), Vec::new());
    let mut add = |folder: &Path, by| {
        for path in libraries(folder) {
            // The same file may be reachable through several folders and have several names.
            let file = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
            if !seen.contains(&file) {
                seen.push(file);
                found.push(RuntimeCandidate { path, by, named: false });
            }
        }
    };
    let beside = env::current_exe().ok().and_then(|program| Some(program.parent()?.to_owned()));
    if let Some(folder) = beside {
        add(&folder, "beside the program");
    }
    for folder in system_folders() {
        add(&folder, "the system's libraries");
    }
    for packages in package_folders() {
        add(&packages.join("onnxruntime").join("capi"), "Python's package onnxruntime");
    }
    found
}

/// Whether a file name is that of the library, such as `libonnxruntime.so`,
/// `libonnxruntime.so.1.22.0`, `libonnxruntime.1.22.0.dylib` or `onnxruntime.dll`. Libraries of its
/// execution providers do not count.
fn is_library(name: &str) -> bool {
    if cfg!(windows) {
        return name.eq_ignore_ascii_case("onnxruntime.dll");
    }
    let Some(rest) = name.strip_prefix("libonnxruntime.") else { return false };
    let version = |text: &str| text.chars().all(|c| c.is_ascii_digit() || c == '.');
    if cfg!(target_os = "macos") {
        return rest.strip_suffix("dylib").is_some_and(version);
    }
    rest.strip_prefix("so").is_some_and(version)
}

/// Libraries in a folder by name in descending order, so the newest comes first.
fn libraries(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<_> = children(folder).filter(|name| is_library(name)).collect();
    names.sort();
    names.iter().rev().map(|name| folder.join(name)).collect()
}

/// Names of a folder's entries; empty if the folder does not exist.
fn children(folder: &Path) -> impl Iterator<Item = String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok())
}

fn system_folders() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = Vec::new();
    for variable in ["LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH"] {
        folders.extend(env::var_os(variable).iter().flat_map(env::split_paths));
    }
    // An empty entry means the current folder, from which nothing may be loaded.
    folders.retain(|folder| folder.is_absolute());
    let multiarch = match env::consts::ARCH {
        "x86_64" => "/usr/lib/x86_64-linux-gnu",
        "aarch64" => "/usr/lib/aarch64-linux-gnu",
        _ => "/usr/lib",
    };
    if cfg!(unix) {
        let usual = ["/usr/local/lib", "/opt/homebrew/lib", multiarch, "/usr/lib64", "/usr/lib", "/lib"];
        folders.extend(usual.map(PathBuf::from));
    }
    folders
}

/// Folders with Python packages.
fn package_folders() -> Vec<PathBuf> {
    let mut folders = Vec::new();
    for variable in ["VIRTUAL_ENV", "CONDA_PREFIX"] {
        if let Some(prefix) = env::var_os(variable).map(PathBuf::from).filter(|p| p.is_absolute()) {
            packages_of(&prefix, &mut folders);
        }
    }
    for folder in env::var_os("PATH").iter().flat_map(env::split_paths).filter(|p| p.is_absolute()) {
        for program in ["python3", "python", "python.exe"] {
            let program = folder.join(program);
            if !program.is_file() {
                continue;
            }
            // The path as in the environment, then the target of the link.
            let prefixes = [Some(program.clone()), fs::canonicalize(&program).ok()];
            for program in prefixes.into_iter().flatten() {
                let Some(bin) = program.parent() else { continue };
                packages_of(if cfg!(windows) { bin } else { bin.parent().unwrap_or(bin) }, &mut folders);
            }
        }
    }
    if let Some(home) = env::home_dir().filter(|home| home.is_absolute()) {
        packages_of(&home.join(".local"), &mut folders);
        let pyenv = env::var_os("PYENV_ROOT").map_or_else(|| home.join(".pyenv"), PathBuf::from);
        let versions = pyenv.join("versions");
        let mut names: Vec<String> = children(&versions).collect();
        names.sort();
        for name in names.iter().rev() {
            packages_of(&versions.join(name), &mut folders);
        }
    }
    folders
}

/// Package folders below a prefix such as `/usr`, the newest Python first.
fn packages_of(prefix: &Path, folders: &mut Vec<PathBuf>) {
    let mut add = |folder: PathBuf| {
        if !folders.contains(&folder) {
            folders.push(folder);
        }
    };
    if cfg!(windows) {
        add(prefix.join("Lib").join("site-packages"));
        return;
    }
    for lib in ["lib", "lib64"] {
        let lib = prefix.join(lib);
        let number = |name: &str| -> Option<u32> { name.strip_prefix("python3.")?.parse().ok() };
        let mut versions: Vec<u32> = children(&lib).filter_map(|name| number(&name)).collect();
        versions.sort_unstable();
        for version in versions.iter().rev() {
            let python = lib.join(format!("python3.{version}"));
            add(python.join("site-packages"));
            add(python.join("dist-packages"));
        }
        add(lib.join("python3").join("dist-packages"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_is_given_is_the_only_one() {
        let path = Path::new("somewhere/none.so");
        let found = locate(Some(path));
        assert_eq!(found, [RuntimeCandidate { path: path.to_owned(), by: GIVEN, named: true }]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_the_library_itself_counts() {
        for name in ["libonnxruntime.so", "libonnxruntime.so.1", "libonnxruntime.so.1.22.0"] {
            assert!(is_library(name), "{name}");
        }
        for name in [
            "libonnxruntime_providers_shared.so",
            "libonnxruntime.so.sig",
            "libonnxruntime.a",
            "onnxruntime.dll",
            "",
        ] {
            assert!(!is_library(name), "{name}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn packages_of_the_newest_python_come_first() {
        let prefix = tempfile::tempdir().unwrap();
        for version in ["3.9", "3.12", "3.x"] {
            let capi = prefix.path().join(format!("lib/python{version}/site-packages/onnxruntime/capi"));
            fs::create_dir_all(&capi).unwrap();
            fs::write(capi.join("libonnxruntime.so.1.22.0"), "").unwrap();
        }
        let mut folders = Vec::new();
        packages_of(prefix.path(), &mut folders);
        let found: Vec<PathBuf> =
            folders.iter().flat_map(|folder| libraries(&folder.join("onnxruntime/capi"))).collect();
        let names: Vec<String> = found.iter().map(|path| path.display().to_string()).collect();
        assert_eq!(names.len(), 2);
        assert!(names[0].contains("python3.12") && names[1].contains("python3.9"), "{names:?}");
    }
}
