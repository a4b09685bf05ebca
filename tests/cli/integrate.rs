//! `integrate`: the extension of Inkscape and the plug-in of GIMP.

use super::support::{Folder, Run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Each program, a file of its extension, and the text that marks such files.
const HOSTS: [(&str, &str, &str); 2] = [
    ("inkscape", "vtex_boxes.py", "Part of the extension of vtex for Inkscape"),
    ("gimp", "vtex_commands.py", "Part of the plug-in of vtex for GIMP"),
];

/// The files directly in a folder, by name.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.path().is_file());
    files.map(|f| (f.file_name().into_string().unwrap(), std::fs::read(f.path()).unwrap())).collect()
}

/// The files of an extension in the repository.
fn sources(host: &str) -> BTreeMap<String, Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("integrations").join(host);
    let mut files = content(&folder);
    files.retain(|name, _| name.starts_with("vtex"));
    assert!(files.len() >= 2, "{host}");
    files
}

/// Checks that exactly the files of the repository are in a folder, and the path of the program.
fn assert_installed(folder: &Path, host: &str) {
    let mut installed = content(folder);
    let program = String::from_utf8(installed.remove("vtex_program.txt").unwrap()).unwrap();
    let canonical = |path: &str| std::fs::canonicalize(path).unwrap();
    assert_eq!(canonical(program.trim()), canonical(env!("CARGO_BIN_EXE_vtex")));
    let expected = sources(host);
    assert_eq!(installed.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in &expected {
        assert!(&installed[name] == bytes, "{host}: {name}");
    }
}

/// A folder with an empty folder `new/vtex`.
fn prepared() -> (Folder, PathBuf) {
    let folder = Folder::new();
    let target = folder.path("new/vtex");
    std::fs::create_dir_all(&target).unwrap();
    (folder, target)
}

fn integrate(folder: &Folder, host: &str, more: &str) -> Run {
    folder.run(&format!("integrate {host} --folder new/vtex {more}"))
}

#[test]
fn every_file_is_installed_once() {
    for (host, ..) in HOSTS {
        let folder = Folder::new();
        let target = folder.path("new/vtex");
        let run = integrate(&folder, host, "").succeeds();
        assert!(run.stderr.starts_with("installed in 'new/vtex': restart "), "{}", run.stderr);
        assert!(run.stderr.contains("Texture (vtex)"), "{}", run.stderr);
        assert_installed(&target, host);
        let times = || -> Vec<_> {
            let entries = std::fs::read_dir(&target).unwrap().map(|entry| entry.unwrap());
            entries.map(|e| (e.file_name(), e.metadata().unwrap().modified().unwrap())).collect()
        };
        let before = times();
        let run = integrate(&folder, host, "").succeeds();
        assert!(run.stderr.starts_with("already installed in 'new/vtex'"), "{}", run.stderr);
        assert_eq!(times(), before);
        let report = integrate(&folder, host, "--json").succeeds().json();
        assert_eq!((&report["host"], &report["written"]), (&host.into(), &0.into()));
        assert_eq!(integrate(&folder, host, "-q").succeeds().stderr, "");
    }
}

#[cfg(unix)]
#[test]
fn the_plug_in_of_gimp_can_be_started() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let path = folder.path("new/vtex/vtex.py");
    let is_executable = || std::fs::metadata(&path).unwrap().permissions().mode() & 0o100 != 0;
    integrate(&folder, "gimp", "").succeeds();
    assert!(is_executable());
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
    integrate(&folder, "gimp", "").succeeds();
    assert!(is_executable());
    folder.run("integrate gimp --folder new").fails(2, "only in a folder with the name 'vtex'");
}

#[test]
fn a_file_of_others_stops_the_installation() {
    for (host, file, mark) in HOSTS {
        for name in [file, "vtex_program.txt"] {
            let (folder, target) = prepared();
            std::fs::write(target.join(name), "mine").unwrap();
            let run = integrate(&folder, host, "").fails(1, "is not part of the ");
            assert!(run.stderr.contains("hint: "), "{}", run.stderr);
            assert_eq!(content(&target), BTreeMap::from([(name.to_owned(), b"mine".to_vec())]));
        }
        // A folder in place of a file.
        let (folder, target) = prepared();
        std::fs::create_dir(target.join(file)).unwrap();
        integrate(&folder, host, "").fails(1, "is not part of the ");
        assert!(content(&target).is_empty());

        // Files of another version are replaced, with the path beside them.
        let (folder, target) = prepared();
        std::fs::write(target.join(file), format!("# {mark}.\nold")).unwrap();
        std::fs::write(target.join("vtex_program.txt"), "/elsewhere/vtex\n").unwrap();
        std::fs::write(target.join("notes.txt"), "mine").unwrap();
        integrate(&folder, host, "").succeeds();
        assert_eq!(std::fs::read(target.join("notes.txt")).unwrap(), b"mine");
        std::fs::remove_file(target.join("notes.txt")).unwrap();
        assert_installed(&target, host);
    }
}

#[test]
fn only_own_files_are_removed() {
    for (host, file, _) in HOSTS {
        let folder = Folder::new();
        let target = folder.path("new/vtex");
        integrate(&folder, host, "").succeeds();
        let count = content(&target).len();
        let cache = target.join("__pycache__");
        std::fs::create_dir(&cache).unwrap();
        let stem = file.strip_suffix(".py").unwrap();
        std::fs::write(cache.join(format!("{stem}.cpython-311.pyc")), "").unwrap();
        let run = integrate(&folder, host, "--remove").succeeds();
        assert_eq!(run.stderr, format!("removed {count} files from 'new/vtex'\n"));
        assert!(!target.exists() && folder.path("new").exists());
        let run = integrate(&folder, host, "--remove").succeeds();
        assert_eq!(run.stderr, "no files of vtex in 'new/vtex'\n");

        integrate(&folder, host, "").succeeds();
        std::fs::write(target.join(file), "mine").unwrap();
        std::fs::write(target.join("notes.txt"), "mine").unwrap();
        std::fs::create_dir(&cache).unwrap();
        for name in [format!("{stem}.cpython-311.pyc").as_str(), "notes.cpython-311.pyc"] {
            std::fs::write(cache.join(name), "mine").unwrap();
        }
        let report = integrate(&folder, host, "--remove --json").succeeds().json();
        assert_eq!(report["removed"], count - 1);
        assert_eq!(content(&target).into_keys().collect::<Vec<_>>(), ["notes.txt", file]);
        assert_eq!(content(&cache).len(), 2);
    }
    Folder::new().run("integrate gimp --remove --check").fails(2, "cannot be used with");
}

/// With programs that stand for Inkscape, GIMP and Python.
#[cfg(target_os = "linux")]
mod check {
    use super::{Folder, HOSTS, Run, content};
    use std::os::unix::fs::PermissionsExt;

    /// Writes a program `bin/NAME` that prints a line.
    fn fake(folder: &Folder, name: &str, line: &str) {
        std::fs::create_dir_all(folder.path("bin")).unwrap();
        let path = folder.path(&format!("bin/{name}"));
        std::fs::write(&path, format!("#!/bin/sh\necho '{line}'\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// Runs `integrate` where `PATH` is `bin`.
    fn integrate(folder: &Folder, host: &str, more: &str) -> Run {
        let mut command = folder.command(&format!("integrate {host} --folder new/vtex {more}"));
        command.env("PATH", folder.path("bin")).output().unwrap().into()
    }

    #[test]
    fn what_is_missing_is_reported() {
        let folder = Folder::new();
        let run = integrate(&folder, "inkscape", "--check").fails(1, "Inkscape was not found");
        assert!(run.stderr.contains("python3 was not found; 15 files of the extension"), "{}", run.stderr);
        assert!(run.stderr.contains("hint: install Inkscape 1.2 or newer"), "{}", run.stderr);
        assert!(run.stderr.contains("run 'vtex integrate inkscape' without --check"), "{}", run.stderr);
        assert!(!folder.path("new").exists());

        fake(&folder, "inkscape", "Inkscape 1.1.2 (0a00cf5339, 2022-02-04)");
        fake(&folder, "python3", "3.11.2 numpy tinycss2");
        integrate(&folder, "inkscape", "").succeeds();
        let run = integrate(&folder, "inkscape", "--check").fails(1, "inkscape' is Inkscape 1.1.2; ");
        assert!(run.stderr.contains("python3' lacks numpy, tinycss2\n"), "{}", run.stderr);
        assert!(run.stderr.contains("apt install python3-numpy python3-tinycss2"), "{}", run.stderr);
        fake(&folder, "python3", "3.9.2");
        integrate(&folder, "inkscape", "--check").fails(1, "python3' is Python 3.9.2");

        fake(&folder, "inkscape", "Inkscape 1.4 (e7c3feb100, 2024-10-09)");
        fake(&folder, "python3", "3.11.2");
        let run = integrate(&folder, "inkscape", "--check").succeeds();
        assert!(run.text().contains("vtex_fill.inx: installed"), "{}", run.text());
        let report = integrate(&folder, "inkscape", "--check --json").succeeds().json();
        assert_eq!(
            (&report["found"]["version"], &report["missing"]),
            (&"1.4".into(), &serde_json::json!([]))
        );
        assert_eq!(report["python"]["version"], "3.11.2");

        fake(&folder, "gimp", "GNU Image Manipulation Program version 2.10.34");
        integrate(&folder, "gimp", "").succeeds();
        integrate(&folder, "gimp", "--check").fails(1, "gimp' is GIMP 2.10.34");
        fake(&folder, "gimp-3.0", "GNU Image Manipulation Program version 3.0.4");
        integrate(&folder, "gimp", "--check").succeeds();
    }

    #[test]
    fn the_state_of_each_file_is_reported() {
        for (host, file, mark) in HOSTS {
            let folder = Folder::new();
            fake(&folder, "inkscape", "Inkscape 1.4");
            fake(&folder, "gimp", "GIMP 3.0.4");
            fake(&folder, "python3", "3.12.1");
            integrate(&folder, host, "").succeeds();
            integrate(&folder, host, "--check").succeeds();
            let target = folder.path("new/vtex");
            for (text, state) in [(format!("# {mark}.\nold"), "differs"), ("mine".into(), "foreign")] {
                std::fs::write(target.join(file), text).unwrap();
                let before = content(&target);
                let run = integrate(&folder, host, "--check --json");
                assert_eq!(run.code, Some(1));
                let files = run.json()["files"].take();
                let of = |name: &str| files.as_array().unwrap().iter().find(|f| f["file"] == name).cloned();
                assert_eq!(of(file).unwrap()["state"], state);
                assert_eq!(of("vtex_program.txt").unwrap()["state"], "installed");
                assert_eq!(content(&target), before);
            }
            std::fs::remove_file(target.join(file)).unwrap();
            integrate(&folder, host, "--check")
                .fails(1, &format!("1 of {} files", content(&target).len() + 1));
        }
    }

    #[test]
    fn a_program_without_a_version_is_accepted() {
        let folder = Folder::new();
        fake(&folder, "gimp", "");
        integrate(&folder, "gimp", "").succeeds();
        let report = integrate(&folder, "gimp", "--check --json").succeeds().json();
        assert_eq!(report["found"]["version"], "unknown version");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_usual_folder_is_that_of_the_program() {
    let run = |folder: &Folder, host: &str, variables: &[(&str, &str)]| {
        let mut command = folder.command(&format!("integrate {host}"));
        command.env("HOME", folder.path("home")).env_remove("XDG_CONFIG_HOME");
        command.env_remove("INKSCAPE_PROFILE_DIR").env_remove("GIMP3_DIRECTORY");
        for (name, below) in variables {
            command.env(name, folder.path(below));
        }
        Run::from(command.output().unwrap()).succeeds()
    };
    let folder = Folder::new();
    run(&folder, "inkscape", &[]);
    assert_installed(&folder.path("home/.config/inkscape/extensions/vtex"), "inkscape");
    run(&folder, "inkscape", &[("INKSCAPE_PROFILE_DIR", "profile")]);
    assert_installed(&folder.path("profile/extensions/vtex"), "inkscape");
    run(&folder, "gimp", &[]);
    assert_installed(&folder.path("home/.config/GIMP/3.0/plug-ins/vtex"), "gimp");
    for version in ["2.10", "3.2", "3.10", "4.0"] {
        std::fs::create_dir_all(folder.path(&format!("config/GIMP/{version}"))).unwrap();
    }
    run(&folder, "gimp", &[("XDG_CONFIG_HOME", "config")]);
    assert_installed(&folder.path("config/GIMP/3.10/plug-ins/vtex"), "gimp");
    run(&folder, "gimp", &[("GIMP3_DIRECTORY", "own")]);
    assert_installed(&folder.path("own/plug-ins/vtex"), "gimp");
}
