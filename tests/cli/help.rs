//! Help, version, completions and manual pages.

use super::support::{Folder, vtex};

/// The output of the program for a command line.
fn printed(arguments: &str) -> String {
    Folder::new().run(arguments).succeeds().text().to_owned()
}

/// All commands and those below them, as the manual has a page for each.
fn commands() -> Vec<String> {
    let folder = Folder::new();
    folder.run("man pages").succeeds();
    let pages = std::fs::read_dir(folder.path("pages")).unwrap();
    let name = |page: std::io::Result<std::fs::DirEntry>| {
        let name = page.unwrap().file_name().into_string().unwrap();
        // No name of a command has a hyphen.
        Some(name.strip_suffix(".1")?.strip_prefix("vtex-")?.replace('-', " "))
    };
    let mut found: Vec<String> = pages.filter_map(name).filter(|name| !name.starts_with("help")).collect();
    found.sort();
    assert!(found.iter().any(|name| name == "models add"), "{found:?}");
    found
}

#[test]
fn help_of_every_command() {
    insta::assert_snapshot!("vtex", printed("--help"));
    let mut all_short = printed("-h");
    for command in &commands() {
        let help = printed(&format!("{command} --help"));
        if command == "models" || !command.starts_with("models") {
            assert!(help.contains("Examples:\n  vtex "), "{command} has no example");
        }
        assert!(help.lines().all(|l| l.chars().count() <= 80), "{command}: {help}");
        let short = printed(&format!("{command} -h"));
        assert!(short.lines().count() <= 40 && short.len() <= help.len(), "{command}: {short}");
        assert!(short.lines().all(|l| l.chars().count() <= 80), "{command}: {short}");
        all_short += &format!("\n=== {command}\n{short}");
        insta::assert_snapshot!(command.replace(' ', "-"), help);
        if !command.contains(' ') {
            assert_eq!(help, printed(&format!("help {command}")), "{command}");
        }
    }
    insta::assert_snapshot!("short", all_short);
    insta::assert_snapshot!("edit-list", printed("edit --list"));
}

#[test]
fn every_option_says_its_range_or_default() {
    for command in &commands() {
        let help = printed(&format!("{command} --help")).replace(['\n'], " ");
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in help.split(" --").skip(1) {
            let takes_number = part.contains("<NUMBER>") || part.contains("<PX>") || part.contains("<SIZE>");
            if takes_number && !part.starts_with("size") {
                assert!(part.contains("default:") && part.contains(" to "), "{command}: --{part}");
            }
        }
    }
}

#[test]
fn version_names_the_program() {
    assert_eq!(printed("--version"), format!("vtex {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn examples_of_the_help_can_be_parsed() {
    // The examples fail only because their files do not exist.
    for command in commands() {
        let help = printed(&format!("{command} --help"));
        let examples = help.split("Examples:").nth(1).unwrap_or_default();
        for line in examples.lines().filter_map(|l| l.trim().strip_prefix("vtex ")) {
            let arguments = line.split(['|', '>']).next().unwrap();
            let reads = !["completions", "doctor", "integrate", "man", "models", "edit --list"]
                .iter()
                .any(|c| arguments.starts_with(c));
            if !reads && !arguments.starts_with("models add") {
                continue;
            }
            let quoted = arguments.split('\'').enumerate();
            let words = quoted.flat_map(|(k, part)| match k % 2 {
                0 => part.split_whitespace().collect(),
                _ => vec![part],
            });
            let empty = tempfile::tempdir().unwrap();
            let output = vtex().args(words).current_dir(&empty).output().unwrap();
            let stderr = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(1), "{line}: {stderr}");
            assert!(stderr.contains("cannot read"), "{line}: {stderr}");
        }
    }
}

#[test]
fn completions_name_commands_and_options() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = printed(&format!("completions {shell}"));
        for word in ["texture", "analyze", "secondary-tolerance", "debug-dir"] {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
    }
    Folder::new().run("completions tcsh").fails(2, "tcsh");
    // Options with a few values complete these values instead of files.
    let bash = printed("completions bash");
    for (option, values) in [
        ("--edge", "keep clip avoid"),
        ("--tile", "none both x y"),
        ("--format", "svg svgz pdf png scene.json"),
        ("--preset", "draft default fine poster"),
        ("--method", "auto correspondence descriptor"),
        ("--shading", "flat gradient"),
    ] {
        let option = format!("{option})");
        let offered = bash.split(&option).skip(1);
        let first: Vec<String> = offered.map(|rest| rest.chars().take(120).collect()).collect();
        assert!(
            first.iter().any(|rest| rest.contains(&format!("compgen -W \"{values}"))),
            "{option}: {first:?}"
        );
    }
}

#[test]
fn manual_pages_are_written() {
    let folder = Folder::new();
    folder.run("man pages/man1").succeeds();
    for name in [
        "vtex",
        "vtex-texture",
        "vtex-analyze",
        "vtex-synth",
        "vtex-tune",
        "vtex-render",
        "vtex-inspect",
        "vtex-models",
        "vtex-models-add",
    ] {
        let page = String::from_utf8(folder.read(&format!("pages/man1/{name}.1"))).unwrap();
        assert!(page.contains(".SH OPTIONS"), "{name}");
        let title = page.lines().find(|l| l.starts_with(".TH ")).unwrap();
        assert!(title.starts_with(&format!(".TH {name} 1 ")) && title.contains("vtex 0."), "{title}");
    }
    let page = String::from_utf8(folder.read("pages/man1/vtex-analyze.1")).unwrap();
    assert!(page.contains("secondary\\-tolerance"), "{page}");
    let page = String::from_utf8(folder.read("pages/man1/vtex.1")).unwrap();
    assert!(
        !page.contains("vtex\\-help") && !folder.path("pages/man1/vtex-help-texture.1").exists(),
        "{page}"
    );
}
