//! Writing, replacing and keeping of files.

#[cfg(unix)]
use super::support::on_terminal;
use super::support::{Folder, is_document, photo, unpack};
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn default_names_stand_in_the_current_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).unwrap();
    folder.write("sub/stone.png", photo());
    folder.run("analyze sub/stone.png").succeeds();
    folder.run("synth stone.lib.json --size 60").succeeds();
    folder.run("render stone.lib.json").succeeds();
    assert_eq!(folder.names(), ["photo.png", "stone.lib.json", "stone.png", "stone.svg", "sub"]);
    assert!(is_document(&folder.read("stone.lib.json"), "vtex-library"));
}

#[test]
fn the_extension_decides() {
    let folder = Folder::with_library();
    for name in ["a.svg", "a.svgz", "a.png", "a.scene.json", "a.scene.json.gz", "B.SVG"] {
        folder.run(&format!("synth photo.lib.json --size 50x40 --seed 1 -o {name}")).succeeds();
    }
    let svg = folder.read("a.svg");
    assert!(svg.starts_with(b"<?xml"));
    assert_eq!(folder.read("B.SVG"), svg);
    assert_eq!(unpack(&folder.path("a.svgz")), svg);
    let picture = image::load_from_memory(&folder.read("a.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (50, 40));
    let scene = folder.read("a.scene.json");
    assert!(is_document(&scene, "vtex-scene"));
    assert_eq!(unpack(&folder.path("a.scene.json.gz")), scene);
    // A scene is unchanged after reading and writing, and its SVG equals that of `synth`.
    folder.run("render a.scene.json.gz -o b.scene.json").succeeds();
    folder.run("render a.scene.json -o b.svg").succeeds();
    assert_eq!((folder.read("b.scene.json"), folder.read("b.svg")), (scene, svg));
    folder.run("analyze photo.png --seed 7 -o c.lib.json.gz").succeeds();
    assert_eq!(unpack(&folder.path("c.lib.json.gz")), folder.read("photo.lib.json"));
}

#[cfg(unix)]
#[test]
fn a_terminal_is_asked_before_a_picture_of_another_seed_is_replaced() {
    let folder = Folder::with_library();
    let synth = |name: &str, seed: u64| format!("synth photo.lib.json --size 40 --seed {seed} -o {name}");
    for name in ["a.svg", "a.svgz", "a.png"] {
        folder.run(&synth(name, 1)).succeeds();
        let first = folder.read(name);
        let ask = |arguments: &str, answer: &str| {
            let (code, shown) = on_terminal(folder.command(arguments), answer);
            (code, shown.contains("replace it? [y/N]"), folder.read(name) == first)
        };
        assert_eq!(ask(&synth(name, 2), "n\n"), (Some(1), true, true));
        assert_eq!(ask(&synth(name, 2), "\n"), (Some(1), true, true));
        // No question is asked for the same texture, nor with `--force`.
        assert_eq!(ask(&synth(name, 1), ""), (Some(0), false, true));
        assert_eq!(ask(&format!("{} --force", synth(name, 3)), ""), (Some(0), false, false));
        folder.run(&format!("{} -f", synth(name, 1))).succeeds();
        assert_eq!(ask(&synth(name, 2), "y\n"), (Some(0), true, false));
    }
    // Files without a readable seed are replaced without a question.
    for name in ["a.pdf", "a.scene.json"] {
        folder.run(&synth(name, 1)).succeeds();
        let (code, shown) = on_terminal(folder.command(&synth(name, 2)), "");
        assert_eq!((code, shown.contains("[y/N]")), (Some(0), false));
    }
    // Another photograph is another origin. Several files give one question.
    let texture = "texture photo.png --segmenter regions --size 40 --seed 1 --variants 3 -o t.svg";
    folder.run(texture).succeeds();
    let (code, _) = on_terminal(folder.command(texture), "");
    assert_eq!(code, Some(0));
    let mut other = photo();
    other.push(0);
    folder.write("photo.png", other);
    let (code, shown) = on_terminal(folder.command(texture), "n\n");
    assert_eq!(code, Some(1));
    assert!(shown.contains("'t-1.svg' contains another texture of photo.png"), "{shown}");
    assert!(shown.contains("and so do 2 more files; replace it? [y/N]"), "{shown}");
}

#[test]
fn scripts_are_told_the_seed_that_they_replace() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 40 --seed 71 -o a.svg").succeeds();
    let told = folder.run("synth photo.lib.json --size 40 --seed 72 -o a.svg").succeeds().stderr;
    assert!(
        told.contains("hint: 'a.svg' held another texture of photo.png: --seed 71, with its other options, makes it again"),
        "{told}"
    );
    // A seed alone would make another one where the size differs.
    let told = folder.run("synth photo.lib.json --size 50x30 --seed 73 -o a.svg").succeeds().stderr;
    assert!(told.contains("--seed 72 --size 40x40, with its other options, makes it again"), "{told}");
    folder.run("synth photo.lib.json --size 40 --seed 72 -o a.svg --force").succeeds();
    for silent in ["", " --quiet", " --force"] {
        let told = folder.run(&format!("synth photo.lib.json --size 50 --seed 72 -o a.svg{silent}"));
        assert!(!told.succeeds().stderr.contains("hint"));
    }
}

#[test]
fn only_files_of_vtex_are_replaced_unless_forced() {
    let folder = Folder::with_library();
    for name in ["a.svg", "a.svgz", "a.png", "a.scene.json", "a.scene.json.gz"] {
        let synth = format!("synth photo.lib.json --size 40 --seed 1 -o {name}");
        folder.write(name, "mine");
        let run = folder.run(&synth).fails(1, "exists and was not written by vtex");
        assert!(run.stderr.contains("--force"), "{}", run.stderr);
        assert_eq!(folder.read(name), b"mine");
        folder.run(&format!("{synth} --force")).succeeds();
        assert_ne!(folder.read(name), b"mine");
        folder.run(&synth).succeeds();
    }
    for name in ["m.png", "m.masks.json", "m.json.gz"] {
        let analyze = format!("analyze photo.png --save-masks {name}");
        folder.write(name, "mine");
        folder.run(&analyze).fails(1, "exists and was not written by vtex");
        folder.run(&format!("{analyze} -f")).succeeds();
        folder.run(&analyze).succeeds();
    }
    // A photograph is a foreign file.
    folder.run("render photo.lib.json -o photo.png").fails(1, "exists and was not written by vtex");
    assert_eq!(folder.read("photo.png"), photo());
}

#[test]
fn one_file_never_holds_two_things() {
    let folder = Folder::new();
    for (command, message) in [
        ("texture photo.png -o photo.png --force", "the photograph and -o name the same file"),
        (
            "analyze photo.png --save-masks a.lib.json -o a.lib.json --force",
            "-o and --save-masks name the same file",
        ),
        ("analyze photo.png --save-masks photo.png --force", "the photograph and --save-masks"),
        ("analyze photo.png --masks m.lib.json -o m.lib.json --force", "--masks and -o name the same file"),
        ("analyze photo.png --masks m.png --save-masks ./m.png --force", "--masks and --save-masks name"),
        (
            "synth photo.lib.json --domain photo.svg -o photo.svg --force",
            "--domain and -o name the same file",
        ),
        ("synth a.lib.json b.lib.json --map m.png -o m.png --force", "--map and -o name the same file"),
        (
            "warp a.scene.json p.lib.json --stretch 2 -o a.scene.json --force",
            "the scene and -o name the same file",
        ),
        (
            "texture photo.png --domain-mask m.png --save-masks m.png",
            "--domain-mask and --save-masks name the same file",
        ),
    ] {
        folder.run(command).fails(2, message);
    }
    assert_eq!(folder.read("photo.png"), photo());
}

#[test]
fn a_foreign_file_is_noticed_before_the_work() {
    let folder = Folder::new();
    folder.write("photo.texture.svg", "mine");
    // The program fails before it opens the photograph, which does not exist.
    folder.run("texture photo.jpg").fails(1, "'photo.texture.svg' exists");
}

#[test]
#[cfg(unix)]
fn a_disk_that_fills_up_leaves_the_old_file() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 40 --seed 1").succeeds();
    let old = folder.read("a.scene.json");
    let names = folder.names();
    // Files may grow to a few kilobytes only: writing fails half-way.
    let script = format!(
        "ulimit -f 2; exec '{}' synth photo.lib.json -o a.scene.json --size 300",
        env!("CARGO_BIN_EXE_vtex")
    );
    let output = Command::new("sh").args(["-c", &script]).current_dir(folder.path("")).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.starts_with("error: cannot write 'a.scene.json'"), "{stderr}");
    assert!(stderr.contains("(ulimit -f)") && !stderr.contains(".vtex-"), "{stderr}");
    assert_eq!(folder.read("a.scene.json"), old);
    assert_eq!(folder.names(), names);
}

#[test]
#[cfg(unix)]
fn an_interrupt_leaves_no_half_file() {
    let folder = Folder::with_library();
    let mut names = folder.names();
    names.push("stages".into());
    // Work for many seconds, so that the signal comes in its midst.
    let arguments = "synth photo.lib.json --size 6000 -o big.svg --debug-dir stages";
    let mut child = folder.command(arguments).stderr(Stdio::piped()).spawn().unwrap();
    // The folder for pictures is made once signals are watched for.
    while !folder.path("stages").exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(100));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert_eq!(folder.names(), names);
}

#[test]
fn the_segmenter_is_stored() {
    let folder = Folder::new();
    for (arguments, name) in
        [("", "texton"), ("--segmenter regions", "regions"), ("--segmenter felzenszwalb", "felzenszwalb")]
    {
        folder.run(&format!("analyze photo.png {arguments}")).succeeds();
        let json = folder.run("inspect photo.lib.json --json").succeeds().json();
        assert_eq!(json["segmenter"], name);
    }
}

#[test]
fn masks_saved_and_given_back_make_the_same_textons() {
    let folder = Folder::new();
    folder.run("analyze photo.png --seed 1 --save-masks m.masks.json.gz -o a.lib.json").succeeds();
    folder.run("analyze photo.png --seed 1 --masks m.masks.json.gz -o b.lib.json").succeeds();
    let library = |name: &str| {
        let mut value: serde_json::Value = serde_json::from_slice(&folder.read(name)).unwrap();
        value["source"]["segmenter"].take();
        value["sha256"].take();
        value
    };
    assert!(library("a.lib.json")["elements"].as_array().unwrap().len() > 5);
    assert_eq!(library("a.lib.json"), library("b.lib.json"));
}

#[test]
fn pictures_of_the_stages_are_written() {
    let folder = Folder::new();
    folder.run("texture photo.png --size 60 --debug-dir stages/here").succeeds();
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path("stages/here")).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    assert!(names.len() >= 4, "{names:?}");
    assert!(names[0].ends_with("01-masks.png"), "{names:?}");
    for path in &names {
        image::open(path).unwrap();
    }
    // A second run replaces the pictures, but not a foreign one, and the message names that.
    folder.run("texture photo.png --size 60 --debug-dir stages/here").succeeds();
    std::fs::write(&names[0], photo()).unwrap();
    folder.run("texture photo.png --size 60 --debug-dir stages/here").fails(1, "01-masks.png' exists");
}

#[test]
fn files_that_steer_are_read() {
    let folder = Folder::with_library();
    folder.write(
        "shape.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><circle cx="5" cy="5" r="4"/></svg>"#,
    );
    let ramp = image::GrayImage::from_fn(64, 4, |x, _| image::Luma([4 * x as u8]));
    folder.write("ramp.png", super::support::encode(&ramp.into(), image::ImageFormat::Png));
    let steered = "--size 60 --seed 1 --density ramp.png";
    folder.run(&format!("synth photo.lib.json --domain shape.svg {steered}")).succeeds();
    folder.run(&format!("texture photo.png --domain-mask ramp.png {steered} -o b.svg")).succeeds();
    let two = "synth photo.lib.json - --map ramp.png --size 60 --seed 1 --json";
    let run = folder.feed(two, &folder.read("photo.lib.json")).succeeds();
    // The result is named after the first library; the summary lists all.
    assert_eq!(run.json()["inputs"], serde_json::json!(["photo.lib.json", "-"]));
    assert_eq!(run.json()["output"], "photo.svg");
}

#[test]
fn scenes_are_warped() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 60 --seed 1").succeeds();
    let page = |d: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="80" height="70"><path d="{d}"/></svg>"#)
    };
    folder.write("square.svg", page("M0 0H60V60H0z"));
    folder.write("bent.svg", page("M0 0C20 30 60-10 80 10V70H10z"));
    let run = folder.run("warp a.scene.json photo.lib.json --stretch 2x1.5 --json").succeeds().json();
    assert_eq!((&run["size"], &run["seed"]), (&serde_json::json!([120, 90]), &1.into()));
    assert_eq!((&run["output"], &run["command"]), (&"a.warped.svg".into(), &"warp".into()));
    // The seed is that of the scene, so no seed is printed.
    let said = folder.run("warp a.scene.json photo.lib.json --stretch 2").succeeds().stderr;
    assert!(!said.contains("seed:"), "{said}");
    let cages = "--cage square.svg --to bent.svg --seed 5";
    let run =
        folder.run(&format!("warp a.scene.json photo.lib.json {cages} -o b.scene.json --json")).succeeds();
    assert_eq!((&run.json()["size"], &run.json()["seed"]), (&serde_json::json!([80, 70]), &5.into()));
    // A warped scene can be warped again, with the same result on any number of threads.
    let again = "warp b.scene.json photo.lib.json --stretch 0.9";
    folder.run(&format!("{again} -t 1 -o c.svg")).succeeds();
    folder.run(&format!("{again} -t 4 -o d.svg")).succeeds();
    assert_eq!(folder.read("c.svg"), folder.read("d.svg"));
}

#[test]
fn an_input_is_never_replaced_however_it_is_spelled() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 40 --seed 1 -o a.scene.json").succeeds();
    folder.write("c.svg", "# a configuration without parameters\n");
    folder.write("grey.png", folder.read("photo.png"));
    std::fs::create_dir(folder.path("sub")).unwrap();
    let mut spellings = vec!["./", "sub/../"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path("."), folder.path("link")).unwrap();
        spellings.push("link/");
    }
    for spelling in spellings {
        for (arguments, input, code) in [
            ("texture photo.png --force", "photo.png", 2),
            ("synth photo.lib.json --size 40 --density grey.png --force", "grey.png", 2),
            ("synth photo.lib.json --size 40 --config c.svg --force", "c.svg", 1),
            ("edit a.scene.json --op flatten", "a.scene.json", 2),
            ("render a.scene.json", "a.scene.json", 2),
            ("render a.scene.json --force", "a.scene.json", 2),
        ] {
            let before = folder.read(input);
            folder
                .run(&format!("{arguments} -o {spelling}{input}"))
                .fails(code, if code == 2 { "name the same file" } else { "has read it as an input" });
            assert_eq!(folder.read(input), before, "{arguments}");
        }
    }
}

#[test]
fn commands_do_not_replace_what_others_made() {
    let folder = Folder::with_library();
    folder.run("texture photo.png --size 50").succeeds();
    folder.run("vectorize photo.png").succeeds();
    folder.run("synth photo.lib.json --size 50").succeeds();
    folder.run("synth photo.lib.json --size 50 -o photo.scene.json").succeeds();
    folder.run("edit photo.scene.json --op flatten").succeeds();
    folder.run("warp photo.scene.json photo.lib.json --stretch 1.2").succeeds();
    folder.run("animate photo.scene.json photo.scene.json --at 0.5").succeeds();
    assert_eq!(
        folder.names(),
        [
            "photo.between.svg",
            "photo.edited.svg",
            "photo.lib.json",
            "photo.png",
            "photo.scene.json",
            "photo.svg",
            "photo.texture.svg",
            "photo.vector.svg",
            "photo.warped.svg"
        ]
    );
}

#[test]
fn what_was_changed_by_hand_is_not_replaced() {
    let folder = Folder::with_library();
    for name in ["a.svg", "a.svgz", "a.scene.json", "a.scene.json.gz", "a.png", "a.pdf"] {
        let synth = format!("synth photo.lib.json --size 40 --seed 1 -o {name}");
        folder.run(&synth).succeeds();
        folder.run(&synth).succeeds();
        let mut bytes = folder.read(name);
        if name.ends_with('z') {
            let text = String::from_utf8(unpack(&folder.path(name))).unwrap();
            let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            std::io::Write::write_all(
                &mut packed,
                text.replace("vtex", "mine").replacen("mine", "vtex", 1).as_bytes(),
            )
            .unwrap();
            bytes = packed.finish().unwrap();
        } else {
            let at = bytes.len() / 2;
            bytes[at] ^= 1;
        }
        folder.write(name, &bytes);
        let run = folder.run(&synth).fails(1, "was changed since vtex wrote it");
        assert!(run.stderr.contains("--force"), "{}", run.stderr);
        assert_eq!(folder.read(name), bytes);
        folder.run(&format!("{synth} -f")).succeeds();
    }
}

#[test]
fn several_outputs_come_of_one_run() {
    let folder = Folder::with_library();
    let alone = |name: &str| {
        folder.run(&format!("synth photo.lib.json --size 50 --seed 1 --scale 2 -o {name}")).succeeds();
        folder.read(name)
    };
    let expected = ["1.svg", "1.png", "1.pdf", "1.scene.json.gz"].map(alone);
    assert_eq!(image::load_from_memory(&expected[1]).unwrap().width(), 100);
    let names = "-o 2.svg -o 2.png -o 2.pdf -o 2.scene.json.gz";
    let run = folder.run(&format!("synth photo.lib.json --size 50 --seed 1 --scale 2 {names} --json"));
    let told = run.succeeds().json();
    assert_eq!((&told["output"], &told["bytes"]), (&"2.svg".into(), &expected[0].len().into()));
    assert_eq!(told["others"][0], serde_json::json!({ "output": "2.png", "bytes": expected[1].len() }));
    assert_eq!(["2.svg", "2.png", "2.pdf", "2.scene.json.gz"].map(|n| folder.read(n)), expected);
    for command in [
        "edit 1.scene.json.gz --op flatten",
        "render 1.scene.json.gz",
        "warp 1.scene.json.gz photo.lib.json --stretch 1.1",
        "vectorize photo.png",
        "animate 1.scene.json.gz 1.scene.json.gz --at 0.5",
        "animate 1.scene.json.gz 1.scene.json.gz --frames 2",
    ] {
        for name in ["3.svg", "3.png"] {
            let _ = std::fs::remove_file(folder.path(name));
        }
        let said = folder.run(&format!("{command} -o 3.svg -o 3.png")).succeeds().stderr;
        assert!(said.contains("3.png: "), "{said}");
        assert!(folder.read("3.svg").starts_with(b"<?xml") && folder.read("3.png").starts_with(b"\x89PNG"));
    }
    // `texture` also writes the library, and one of the outputs may be a pipe.
    let run = folder.run("texture photo.png --size 50 --seed 1 -o - -o t.lib.json --json").succeeds();
    assert!(run.stdout.starts_with(b"<?xml") && is_document(&folder.read("t.lib.json"), "vtex-library"));
    folder.run("synth photo.lib.json -o a.svg -o ./a.svg").fails(2, "name the same file");
    folder.run("synth photo.lib.json -o - -o -").fails(2, "name the same file");
    folder.run("synth photo.lib.json -o a.svg -o photo.lib.json").fails(2, "cannot tell the format");
}

#[test]
fn library_and_scene_are_kept_if_asked_for() {
    let folder = Folder::new();
    folder.run("texture photo.png --size 50 --seed 1 --keep").succeeds();
    let names = ["photo.png", "photo.texture.lib.json", "photo.texture.scene.json", "photo.texture.svg"];
    assert_eq!(folder.names(), names);
    // All three give the same picture.
    folder.run("synth photo.texture.lib.json --size 50 --seed 1 -o a.png").succeeds();
    folder.run("render photo.texture.scene.json -o b.png").succeeds();
    folder.run("render photo.texture.svg -o c.png").succeeds();
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
    folder.run("texture photo.png --size 50 -o x.png -o y.scene.json --keep").succeeds();
    assert!(folder.path("x.lib.json").exists() && !folder.path("x.scene.json").exists());
    folder.feed("texture - --size 50 --keep", &photo()).fails(2, "--keep");
}

#[test]
fn a_texture_is_made_again_from_what_it_says() {
    let folder = Folder::new();
    let ramp = image::GrayImage::from_fn(64, 4, |x, _| image::Luma([4 * x as u8]));
    folder.write("ramp.png", super::support::encode(&ramp.into(), image::ImageFormat::Png));
    let analysis = "--detail-scale 20 --fidelity 0.8 --segmenter regions --categories 3";
    let synthesis = "--size 94x60 --rotate 15 --precision 2 --expand --density ramp.png --tile x";
    folder.run(&format!("texture photo.png {analysis} {synthesis} -o a.svg")).succeeds();
    folder.run("texture photo.png --again a.svg -o b.svg").succeeds();
    assert_eq!(folder.read("a.svg"), folder.read("b.svg"));
    folder.run("texture photo.png --again b.svg -o c.svgz").succeeds();
    assert_eq!(unpack(&folder.path("c.svgz")), folder.read("a.svg"));
    folder.run("texture photo.png --again c.svgz -o d.svg --max-bytes 1MB").succeeds();
    // Options of the command line take precedence over the recipe.
    let run = folder.run("texture photo.png --again a.svg -o e.svg --size 63 --json").succeeds();
    assert_eq!(run.json()["size"], serde_json::json!([63, 63]));
    // Files that have changed since are refused.
    let turned = image::load_from_memory(&photo()).unwrap().rotate90();
    folder.write("other.png", super::support::encode(&turned, image::ImageFormat::Png));
    folder.run("texture other.png --again a.svg -o f.svg").fails(1, "is not the photograph");
    folder.write("ramp.png", folder.read("other.png"));
    folder.run("texture photo.png --again a.svg -o f.svg").fails(1, "is not the file of --density");
    folder.run("analyze photo.png").succeeds();
    folder.run("synth photo.lib.json --size 40 -o g.svg").succeeds();
    folder.run("texture photo.png --again g.svg").fails(1, "another command than 'vtex texture' wrote it");
    for other in ["photo.png", "photo.lib.json"] {
        folder.run(&format!("texture photo.png --again {other}")).fails(1, "does not say how it was made");
    }
}

#[test]
fn what_a_killed_process_left_is_removed_by_the_next() {
    let folder = Folder::with_library();
    std::fs::create_dir(folder.path("out")).unwrap();
    for name in ["out/.vtex-0aB9zZ.tmp", "out/.vtex-notes.txt", ".vtex-0aB9zZ.tmp"] {
        folder.write(name, "half a file");
    }
    folder.run("synth photo.lib.json --size 40 -o out/a.svg").succeeds();
    let all = std::fs::read_dir(folder.path("out")).unwrap();
    let mut names: Vec<_> = all.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, [".vtex-notes.txt", "a.svg"]);
    // Other folders are not searched.
    assert!(folder.path(".vtex-0aB9zZ.tmp").exists());
}

#[test]
#[cfg(unix)]
fn an_interrupt_while_a_file_is_made_to_fit_is_one() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 400 --seed 1 -o a.scene.json -o a.svg").succeeds();
    let most = folder.read("a.svg").len() * 98 / 100;
    let mut child = folder
        .command(&format!("animate a.scene.json a.scene.json -o frames --frames 2000 --max-bytes {most}"))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // After the first frame, nearly all time is spent on reducing frames.
    while !folder.path("frames/frame_0001.svg").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let mut stderr = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut stderr).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{stderr}");
    assert!(stderr.contains("error: interrupted"), "{stderr}");
}

#[test]
fn variants_are_numbered_by_their_seeds_and_analysed_once() {
    let folder = Folder::new();
    let run = folder.run("texture photo.png -o out.svg --keep --size 90 --seed 7 --variants 3").succeeds();
    assert_eq!(run.stderr.matches(" px, ").count(), 3, "{}", run.stderr);
    let wanted = ["out-7", "out-8", "out-9"];
    let mut names: Vec<String> =
        wanted.iter().flat_map(|n| [format!("{n}.scene.json"), format!("{n}.svg")]).collect();
    names.extend(["out.lib.json", "photo.png"].map(str::to_owned));
    assert_eq!(folder.names(), names);
    let scenes = wanted.map(|name| folder.read(&format!("{name}.svg")));
    assert!(scenes[0] != scenes[1] && scenes[1] != scenes[2]);
    // A variant equals the texture of its seed alone, from the same library.
    folder.run("synth out.lib.json -o alone.scene.json --size 90 --seed 8").succeeds();
    assert!(folder.read("alone.scene.json") == folder.read("out-8.scene.json"));
    // A variant can be made again by its own recipe.
    folder.run("texture photo.png --again out-8.svg -o again.svg").succeeds();
    assert!(folder.read("again.svg") == folder.read("out-8.svg"));
    folder.run("synth out.lib.json -o - --variants 2").fails(2, "several variants");
    folder.run("synth out.lib.json --variants 0").fails(2, "expected 1 to 1000");
}
