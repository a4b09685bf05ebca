//! `--config` and `--dump-config`.

use super::support::Folder;

#[test]
fn a_dump_holds_every_parameter_and_reads_back_as_itself() {
    let folder = Folder::new();
    let dump = folder.run("--dump-config").succeeds().text().to_owned();
    for key in [
        "#seed =",
        "#threads =",
        "segmenter = \"auto\"",
        "minimum-area = 5",
        "size = \"auto\"",
        "weights = [0.5, -0.4, -0.2, -0.5, -0.5]",
        "precision = 1",
        "scale = 1.0",
        "wrap = \"auto\"",
    ] {
        assert!(dump.lines().any(|l| l == key), "{key} is not in:\n{dump}");
    }
    folder.write("all.toml", &dump);
    for arguments in ["--config all.toml --dump-config", "synth --dump-config --config all.toml"] {
        assert_eq!(folder.run(arguments).succeeds().text(), dump);
    }
    insta::assert_snapshot!("dump-config", dump);
}

#[test]
fn options_win_over_the_file_and_the_file_over_defaults() {
    let folder = Folder::new();
    folder.write(
        "a.toml",
        "seed = 5\n[analyze]\nwrap = true\ncategories = 3\n[synth]\nsize = \"70x30\"\nmoves = 1\n",
    );
    let arguments =
        "texture --config a.toml --moves 2 --wrap=false --weights=-1,0,1,2,3 --expand --dump-config";
    let dump = folder.run(arguments).succeeds().text().to_owned();
    for line in [
        "seed = 5",
        "wrap = false",
        "categories = 3",
        "size = \"70x30\"",
        "moves = 2",
        "expand = true",
        "weights = [-1.0, 0.0, 1.0, 2.0, 3.0]",
        "detail-scale = 10.0",
    ] {
        assert!(dump.lines().any(|l| l == line), "{line} is not in:\n{dump}");
    }
    let run = folder.run("texture photo.png --config a.toml --json").succeeds().json();
    assert_eq!((&run["seed"], &run["size"]), (&5.into(), &serde_json::json!([70, 30])));
}

#[test]
fn mistakes_in_the_file_are_named() {
    let folder = Folder::new();
    for (content, message, hint) in [
        (
            "[analyze]\nminimum_area = 3",
            "unknown key 'minimum_area' in [analyze]",
            "did you mean 'minimum-area'?",
        ),
        ("[analyse]\n", "unknown key 'analyse'", "did you mean 'analyze'?"),
        ("sede = 3", "unknown key 'sede'", "did you mean 'seed'?"),
        ("size = 3", "unknown key 'size'", "'size' belongs in [synth]"),
        ("[synth]\nseed = 3", "unknown key 'seed' in [synth]", "at the top"),
        ("synth = 3", "'synth' in 'a.toml' is not a section", "write [synth]"),
        ("[synth]\nsize = \"big\"", "size = \"big\": expected 1000 or 1000x600", ""),
        ("[synth]\nmoves = \"2\"", "moves = \"2\": expected 0 to 100", ""),
        ("[synth]\nmirror = \"true\"", "mirror = \"true\": expected true or false", ""),
        ("[synth]\nmoves = \"two\"", "moves = \"two\": expected 0 to 100", ""),
        ("[synth]\nmoves = -2", "moves = -2: expected 0 to 100", ""),
        ("[synth]\nweights = [1, 2]", "weights = [1, 2]", ""),
        ("[analyze]\nsegmenter = \"magic\"", "magic", "regions"),
        ("[synth]\nsize = [1]", "size = [1]: expected 1000 or 1000x600", ""),
        ("[synth]\nsize = inf", "size = inf: expected 1000 or 1000x600", ""),
        ("[synth]\nedge = 3", "edge = 3: expected keep, clip or avoid", ""),
        ("[synth]\ncandidates = -1", "candidates = -1: expected 1 to 1000", ""),
        ("[synth]\nmirror = 2", "mirror = 2: expected true or false", ""),
        ("[synth]\nrotate = 1e308", "expected 0 to 180 degrees", ""),
        ("[analyze]\nfidelity = nan", "fidelity = nan: expected 0.05 to 5 px", ""),
        ("threads = 0", "threads = 0: expected 1 to 1024", ""),
        ("seed = -1", "seed = -1: expected a whole number", ""),
        ("seed = 1\nseed = 2", "cannot read 'a.toml'", "--dump-config"),
        ("[synth", "cannot read 'a.toml'", "--dump-config"),
    ] {
        folder.write("a.toml", content);
        let run = folder.run("synth x.lib.json --config a.toml").fails(2, message);
        assert!(run.stderr.contains(hint), "{content}: {}", run.stderr);
    }
    // Messages about very long lines are short and have one line.
    let long = "1".repeat(100_000);
    for content in [
        format!("[synth]\nsize = {long}"),
        format!("[synth]\nweights = [{}]", ["1.0"; 9000].join(", ")),
        format!("[synth]\nsize = \"{long}\" x"),
        format!("{long}x = 1"),
    ] {
        folder.write("a.toml", &content);
        let run = folder.run("synth x.lib.json --config a.toml").fails(2, "a.toml");
        assert!(run.stderr.len() < 1000 && run.stderr.lines().count() <= 2, "{}", run.stderr);
    }
    folder.run("synth x.lib.json --config none.toml").fails(1, "cannot read 'none.toml'");
    folder.write("a.toml", [0xff, 0xfe, 0x00]);
    folder.run("synth x.lib.json --config a.toml").fails(1, "cannot read 'a.toml'");
}

#[test]
fn threads_come_from_the_environment_too() {
    let folder = Folder::new();
    let with = |value: &str, arguments: &str| {
        let output = folder.command(arguments).env("VTEX_THREADS", value).output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    // The variable does not appear in dumped configurations.
    assert!(with("3", "--dump-config").1.contains("\n#threads =\n"));
    assert!(with("3", "doctor --json").1.contains("\"threads\": 3,"));
    assert!(with("3", "doctor --json -t 4").1.contains("\"threads\": 4,"));
    assert!(with("3", "--dump-config -t 4").1.contains("\nthreads = 4\n"));
    assert_eq!(with("many", "--dump-config").0, Some(2));
}
