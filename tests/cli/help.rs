//! Help, version, completions and manual pages.

use super::support::{Folder, vtex};

/// What the program prints for a command line.
fn printed(arguments: &str) -> String {
    Folder::new().run(arguments).succeeds().text().to_owned()
}

/// All commands: those that the help lists in groups, and the hidden ones.
fn commands() -> Vec<String> {
    let help = printed("--help");
    let groups = help.split_once("Make:").unwrap().1.split_once("Options:").unwrap().0;
    let names = groups.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let found: Vec<String> = names.chain(["completions", "man"]).map(str::to_owned).collect();
    assert_eq!(found.len(), 22, "{found:?}");
    found
}

#[test]
fn help_of_every_command() {
    insta::assert_snapshot!("vtex", printed("--help"));
    for command in &commands() {
        let help = printed(&format!("{command} --help"));
        assert!(help.contains("Examples:\n  vtex "), "{command} has no example");
        if command != "man" && command != "models" {
            // Short help is short: what is used most, and where the rest is.
            let short = printed(&format!("{command} -h"));
            let more = short.lines().position(|l| l.contains("--help' says more")).unwrap_or(99);
            assert!(more <= 13 && short.lines().count() <= more + 1, "{command}: {short}");
            assert!(short.len() < help.len(), "{command}");
            assert!(short.lines().all(|l| l.chars().count() <= 80), "{command}: {short}");
        }
        assert!(help.lines().all(|l| l.chars().count() <= 80), "{command}: {help}");
        assert_eq!(help, printed(&format!("help {command}")), "{command}");
        insta::assert_snapshot!(command.as_str(), help);
    }
    insta::assert_snapshot!("edit-list", printed("edit --list"));
    insta::assert_snapshot!("models-add", printed("models add --help"));
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
    // Everything but the files is accepted: what fails is reading, not the usage.
    let commands = [
        "texture",
        "vectorize",
        "analyze",
        "synth",
        "warp",
        "transfer",
        "stylize",
        "animate",
        "check",
        "tune",
        "render",
        "inspect",
        "metrics",
        "batch",
        "models add",
    ];
    for command in commands {
        let help = printed(&format!("{command} --help"));
        let examples = help.split("Examples:").nth(1).unwrap();
        for line in examples.lines().filter_map(|l| l.trim().strip_prefix("vtex ")) {
            let arguments = line.split(['|', '>']).next().unwrap();
            let empty = tempfile::tempdir().unwrap();
            let output = vtex().args(arguments.split_whitespace()).current_dir(&empty).output().unwrap();
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
    // Values are offered where there are few, not files.
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
}
