//! Exit codes, messages, hints, colours.

use super::support::{Folder, Run, encode};
use image::{GrayImage, ImageFormat};

#[test]
fn wrong_usage_exits_with_2() {
    let folder = Folder::with_library();
    for (arguments, message) in [
        ("synth", "<LIBRARY>"),
        ("synth photo.lib.json --sizes 7", "--sizes"),
        ("synth photo.lib.json --size 0", "1000x600"),
        ("synth photo.lib.json --size 10x", "1000x600"),
        ("synth photo.lib.json --size 100001", "100000"),
        ("synth photo.lib.json --seed -1", "--seed"),
        ("synth photo.lib.json --seed 18446744073709551616", "18446744073709551615"),
        ("synth photo.lib.json --candidates 0", "expected 1 to 1000"),
        ("synth photo.lib.json --weights 1,2", "five numbers"),
        ("synth photo.lib.json --weights a.b", "five numbers with commas between, or a name"),
        ("synth - --weights tuned", "beside no file"),
        ("tune - --seeds 2", "must be a file"),
        ("tune photo.lib.json --name 7", "at least one letter"),
        ("tune photo.lib.json --seeds 0", "expected 1 to 100"),
        ("tune photo.lib.json --evaluations 9", "expected 10 to 100000"),
        ("synth photo.lib.json --weights 1,2,3,4,11", "-10 to 10"),
        ("synth photo.lib.json --weights 1,2,3,4,NaN", "-10 to 10"),
        ("synth photo.lib.json --threads 0", "--threads"),
        ("synth photo.lib.json -q -v", "--quiet"),
        ("synth photo.lib.json -o out.jpg", "cannot tell the format from the name 'out.jpg'"),
        ("synth photo.lib.json -o out.lib.json", "cannot tell the format"),
        ("synth photo.lib.json --color sometimes", "sometimes"),
        ("synth photo.lib.json --tile=z", "expected none, both, x or y"),
        ("synth photo.lib.json --pattern p.svg", "both axes"),
        ("synth photo.lib.json --tile x --pattern p.svg", "both axes"),
        ("synth photo.lib.json --tile --pattern p.png", "--pattern a name that ends in .svg or .svgz"),
        ("synth photo.lib.json -o p.svg --tile --pattern p.svg", "name the same file"),
        ("synth photo.lib.json --domain a.svg --domain-mask a.png", "--domain-mask"),
        ("synth photo.lib.json --map a.png", "--map is for several libraries"),
        ("synth photo.lib.json b.lib.json", "2 libraries are given, and nothing that says which is where"),
        (
            "synth photo.lib.json b.lib.json c.lib.json --map a.png --map b.png",
            "2 times --map is given for 3 libraries",
        ),
        ("synth - - --map a.png", "'-' stands for more than one file"),
        ("synth - --density -", "'-' stands for more than one file"),
        ("texture photo.png --map a.png", "--map"),
        ("warp a.scene.json photo.lib.json", "nothing says how to bend the scene"),
        ("warp a.scene.json photo.lib.json --stretch 0.01", "expected 1.5 or 1.5x2, 0.1 to 10 each"),
        ("warp a.scene.json photo.lib.json --cage a.svg", "--to"),
        ("warp a.scene.json photo.lib.json --cage a.svg --to b.svg --stretch 2", "--stretch"),
        ("warp a.scene.json", "<LIBRARY>"),
        ("edit a.scene.json", "nothing says what to do to the scene"),
        ("edit --op flatten", "no input is given"),
        ("edit a.scene.json --op flaten", "there is no operation 'flaten'"),
        ("edit a.scene.json --op=thin", "nothing says how much to keep"),
        ("edit a.scene.json --op flatten -o a.scene.json", "name the same file"),
        ("warp - - --stretch 2", "'-' stands for more than one file"),
        ("analyze photo.png --minimum-area 0", "expected 1 to 1000000 px of area"),
        ("synth photo.lib.json --candidates -1", "'-1' for '--candidates <NUMBER>': expected 1 to 1000"),
        ("synth photo.lib.json --rotate x", "'x' for '--rotate <NUMBER>': expected 0 to 180 degrees"),
        ("synth photo.lib.json --rotate 1e308", "expected 0 to 180 degrees"),
        ("synth photo.lib.json --threads 9999", "expected 1 to 1024"),
        ("analyze photo.png --fidelity NaN", "expected 0.05 to 5 px"),
        ("analyze photo.png --detail-sigma -1", "expected 0 to 10 px"),
        ("analyze photo.png --secondary-minimum 9 --secondary-maximum 8", "at most secondary-maximum"),
        ("analyze photo.png --segmenter magic", "magic"),
        ("analyze photo.png --masks a.png --segmenter regions", "--masks"),
        ("analyze photo.png --save-masks a.jpg", "cannot tell the format"),
        ("analyze photo.png -o photo.svg", "cannot tell the format"),
        ("render photo.lib.json --scale 0", "expected 0.01 to 100"),
        ("frobnicate", "frobnicate"),
    ] {
        folder.run(arguments).fails(2, message);
        assert_eq!(folder.names(), ["photo.lib.json", "photo.png"], "{arguments} left something");
    }
    let nothing = folder.run("");
    assert_eq!((nothing.code, nothing.stdout.len()), (Some(2), 0));
    assert!(nothing.stderr.contains("Usage: vtex"));
}

#[test]
fn what_fails_says_why_and_what_to_try() {
    let folder = Folder::with_library();
    folder.write("empty.png", b"");
    folder.write("text.txt", b"hello");
    folder.write("photo.heic", b"\0\0\0\x18ftypheic\0\0\0\0mif1heic\0\0\0\0meta");
    folder.run("synth photo.lib.json -o scene.svg --size 50").succeeds();
    for (arguments, message, hint) in [
        ("analyze none.png", "cannot read 'none.png': ", "hint: check the spelling"),
        (
            "analyze empty.png",
            "cannot decode 'empty.png' as an image: the file is empty",
            "hint: SVG, PNG, JPEG",
        ),
        ("analyze text.txt", "cannot decode 'text.txt'", "hint: SVG, PNG, JPEG"),
        ("analyze photo.heic", "'photo.heic' is a HEIC picture", "hint: export it as JPEG or PNG"),
        ("texture photo.heic", "'photo.heic' is a HEIC picture", "hint: export it as JPEG or PNG"),
        ("vectorize photo.heic", "'photo.heic' is a HEIC picture", "hint: export it as JPEG or PNG"),
        ("synth photo.lib.json --density photo.heic", "a HEIC picture", "hint: export it as JPEG or PNG"),
        (
            "analyze photo.lib.json",
            "'photo.lib.json' contains a library, not an image",
            "hint: make a texture",
        ),
        ("synth photo.png", "'photo.png' contains an image, not a library", "hint: make a library"),
        ("synth scene.svg", "'scene.svg' contains an SVG, not a library", "hint: "),
        ("synth text.txt", "'text.txt' is not a valid vtex-library file", "hint: make a library"),
        ("inspect text.txt", "contains something else", "hint: libraries are made by"),
        ("render photo.png -o new.png", "contains an image", "hint: "),
        (
            "synth photo.lib.json -o nowhere/out.svg",
            "cannot write 'nowhere/out.svg'",
            "hint: the folder does not",
        ),
        ("analyze photo.png --masks none.png", "cannot read 'none.png'", "hint: check the spelling"),
        ("analyze photo.png --masks text.txt", "'text.txt' is not a valid", ""),
        ("texture photo.png --debug-dir photo.png", "cannot write 'photo.png'", ""),
    ] {
        let run = folder.run(arguments).fails(1, message);
        assert!(run.stderr.contains(hint), "{arguments}: {}", run.stderr);
        assert!(run.stdout.is_empty());
    }
    // A path below a file cannot be written, even by root.
    folder.run("synth photo.lib.json -o photo.png/out.svg").fails(1, "cannot write 'photo.png/out.svg'");
    folder.run("render scene.svg -o other.svg").fails(2, "is an SVG already");
}

#[test]
fn files_that_do_not_steer_say_so_before_the_work() {
    let folder = Folder::with_library();
    let page = |inner: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{inner}</svg>"#)
    };
    folder.write("open.svg", page(r#"<path d="M1 1H5V5"/>"#));
    folder.write("black.png", encode(&GrayImage::new(8, 8).into(), ImageFormat::Png));
    folder.write("text.txt", "hello");
    let libraries = "photo.lib.json photo.lib.json photo.lib.json";
    for (arguments, message, hint) in [
        ("--domain none.svg", "cannot read 'none.svg'", "spelling"),
        ("--domain photo.png", "'photo.png' contains an image, not an SVG", "--domain-mask"),
        ("--domain text.txt", "'text.txt' cannot be used as a shape", "must be an SVG"),
        ("--domain open.svg", "its path is open", "end its path data with Z"),
        ("--domain-mask open.svg", "'open.svg' contains an SVG, not an image", "--domain"),
        ("--domain-mask black.png", "nothing in it is white", "white is inside"),
        ("--domain-mask text.txt", "cannot decode 'text.txt'", "PNG"),
        (
            "--density photo.lib.json",
            "'photo.lib.json' contains a library, not an image",
            "a map is a picture",
        ),
    ] {
        for command in ["synth photo.lib.json", "texture photo.png"] {
            let run = folder.run(&format!("{command} {arguments} -o out.svg")).fails(1, message);
            assert!(run.stderr.contains(hint), "{arguments}: {}", run.stderr);
        }
    }
    let run = folder.run(&format!("synth {libraries} --map black.png -o out.svg"));
    run.fails(1, "it has 1 colour; 3 are needed for 3 libraries");
    assert!(!folder.path("out.svg").exists());
}

#[test]
fn a_warp_that_cannot_be_says_why() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 60 --seed 1").succeeds();
    folder.run("analyze photo.png -o other.lib.json --detail-minimum 20 --categories 3").succeeds();
    let page = |d: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="60" height="60"><path d="{d}"/></svg>"#)
    };
    folder.write("square.svg", page("M0 0H60V60H0z"));
    folder.write("mirrored.svg", page("M0 0V60H60V0z"));
    folder.write("triangle.svg", page("M0 0H60V60z"));
    folder.write("crossed.svg", page("M0 0H60L0 60H60z"));
    folder.write("two.svg", page("M0 0H20V20H0zM30 30h9v9z"));
    for (arguments, message, hint) in [
        (
            "photo.lib.json --cage square.svg --to triangle.svg",
            "the cage before has 4 sides, the cage after 3",
            "points",
        ),
        ("photo.lib.json --cage square.svg --to mirrored.svg", "opposite directions", "moving the points"),
        ("photo.lib.json --cage square.svg --to crossed.svg", "crosses itself", "undo the crossing"),
        ("photo.lib.json --cage two.svg --to square.svg", "it has 2 rings", "a cage is one ring"),
        (
            "photo.lib.json --cage photo.png --to square.svg",
            "contains an image, not an SVG",
            "a cage is drawn",
        ),
        ("other.lib.json --stretch 2", "its elements are not those of the scene", "made from"),
        ("photo.lib.json photo.lib.json --stretch 2", "the scene was made without it", "made from"),
        ("photo.png --stretch 2", "'photo.png' contains an image, not a library", "vtex analyze"),
    ] {
        let run = folder.run(&format!("warp a.scene.json {arguments} -o out.svg")).fails(1, message);
        assert!(run.stderr.contains(hint), "{arguments}: {}", run.stderr);
    }
    let run = folder.run("warp photo.lib.json photo.lib.json --stretch 2 -o out.svg").fails(1, "not a scene");
    assert!(run.stderr.contains("make a scene with"), "{}", run.stderr);
    assert!(!folder.path("out.svg").exists());
}

#[test]
fn colours_only_where_they_are_wanted() {
    let folder = Folder::with_library();
    let coloured = |arguments: &str, no_color: bool| {
        let mut command = folder.command(arguments);
        if no_color {
            command.env("NO_COLOR", "1");
        }
        let output = command.output().unwrap();
        output.stdout.contains(&0x1b) || output.stderr.contains(&0x1b)
    };
    for arguments in ["inspect photo.lib.json", "inspect none.json", "synth --sizes", "--help"] {
        assert!(!coloured(arguments, false), "{arguments} in a pipe");
        assert!(coloured(&format!("{arguments} --color always"), false), "{arguments} always");
        assert!(coloured(&format!("{arguments} --color=always"), true), "{arguments} always wins");
        assert!(!coloured(&format!("{arguments} --color never"), false), "{arguments} never");
    }
}

#[test]
fn quiet_prints_nothing_and_verbose_more() {
    let folder = Folder::with_library();
    let length = |flags: &str| {
        let run = folder.run(&format!("synth photo.lib.json --size 60 {flags}")).succeeds();
        assert!(run.stdout.is_empty());
        run.stderr.len()
    };
    assert_eq!(length("-q"), 0);
    let (plain, more, most) = (length(""), length("-v"), length("-vv"));
    assert!(0 < plain && plain < more && more < most, "{plain} {more} {most}");
}

#[test]
fn a_scale_without_effect_is_said() {
    let folder = Folder::with_library();
    let run = folder.run("render photo.lib.json -o a.svg --scale 2").succeeds();
    assert!(run.stderr.contains("--scale has no effect"), "{}", run.stderr);
}

#[test]
fn messages_say_what_is_wrong_in_a_line() {
    let folder = Folder::with_library();
    let photo = folder.read("photo.png");
    folder.write("cut.png", &photo[..photo.len() * 2 / 3]);
    let mut damaged = photo.clone();
    damaged[photo.len() / 2..photo.len() / 2 + 40].fill(0x55);
    folder.write("damaged.png", damaged);
    let picture = image::load_from_memory(&photo).unwrap();
    for (name, format) in
        [("cut.bmp", ImageFormat::Bmp), ("cut.gif", ImageFormat::Gif), ("cut.tiff", ImageFormat::Tiff)]
    {
        let whole = encode(&picture, format);
        folder.write(name, &whole[..whole.len() / 2]);
    }
    folder.write("broken.lib.json", "[1");
    folder.write("broken.scene.json", "{\"width\": 3");
    folder.write("newer.scene.json", "{\"format\":\"vtex-scene\",\"version\":99}");
    folder.write("text.svg", "<svg");
    folder.write("empty.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"0\" height=\"0\"/>");
    for (arguments, message, hint) in [
        ("analyze cut.png", "'cut.png' as an image: the file ends in the middle", "complete"),
        ("analyze damaged.png", "cannot decode 'damaged.png' as an image: ", "complete"),
        ("analyze cut.bmp", "the file ends in the middle", ""),
        ("analyze cut.gif", "cannot decode 'cut.gif' as an image: ", ""),
        ("analyze cut.tiff", "cannot decode 'cut.tiff' as an image: ", ""),
        ("analyze broken.lib.json -o new.lib.json", "contains a library, not an image", "vtex synth"),
        ("synth broken.lib.json", "'broken.lib.json' is not a valid vtex-library file: ", "vtex analyze"),
        ("render broken.scene.json", "'broken.scene.json' is not a valid vtex-scene file: ", "vtex synth"),
        ("inspect broken.scene.json", "line 1 column", ""),
        ("render newer.scene.json", "this vtex reads version", "update vtex"),
        ("render text.svg -o a.png", "cannot draw 'text.svg': ", ""),
        ("render empty.svg -o a.png", "width, height or viewBox", ""),
        ("analyze photo.png -o nowhere/a.lib.json", "No such file", "create it first"),
        ("analyze .", "cannot read '.'", "vtex batch"),
    ] {
        let run = folder.run(arguments).fails(1, message);
        assert!(run.stderr.contains(hint), "{arguments}: {}", run.stderr);
        assert!(run.stderr.lines().count() <= 2, "{}", run.stderr);
        for inner in [
            "ChunkType",
            "entity not found",
            "failed to fill",
            "parsing failed cause",
            "{",
            "Format error",
            "deflate",
            "struct ",
        ] {
            assert!(!run.stderr.contains(inner), "{arguments}: {}", run.stderr);
        }
    }
}

#[test]
fn nothing_foreign_acts_on_the_terminal() {
    let folder = Folder::with_library();
    let text = String::from_utf8(folder.read("photo.lib.json")).unwrap();
    let named =
        text.replace("\"file\":\"photo.png\"", "\"file\":\"\\u001b[31mred\\u001b]0;title\\u0007\\u009b\"");
    assert_ne!(named, text);
    folder.write("named.lib.json", named);
    let colour = text.replacen("\"colour\":\"#", "\"colour\":\"\\u001b[2J#", 1);
    assert_ne!(colour, text);
    folder.write("colour.lib.json", colour);
    folder.write("xml.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"><a\u{9b}31m></svg>");
    folder.write("a.toml", "[synth]\nedge = \"\\u001b[2J\"\n\"\\u001b[31m\" = 3\n");
    let escape = "\u{1b}[31mx";
    let mut lines: Vec<Vec<&str>> = [
        "inspect named.lib.json",
        "synth colour.lib.json",
        "render xml.svg -o a.png",
        "synth photo.lib.json --config a.toml",
    ]
    .iter()
    .map(|line| line.split(' ').collect())
    .collect();
    lines.extend([
        vec!["analyze", escape],
        vec!["synth", "photo.lib.json", "-o", escape],
        vec!["synth", "photo.lib.json", "--size", escape],
        vec!["synth", "photo.lib.json", escape, "--frob"],
        vec!["synth", "photo.lib.json", "--weights", escape],
        vec!["edit", "a.scene.json", "--op", escape],
        vec!["render", "photo.lib.json", "-o", "\u{1b}[31mx.png"],
    ]);
    for arguments in lines {
        for colour in ["never", "always"] {
            let output = folder.command("").args(&arguments).args(["--color", colour]).output().unwrap();
            let printed = [output.stdout, output.stderr].concat();
            let printed = String::from_utf8(printed).unwrap();
            // Only colours of vtex may remain.
            let printed = printed.replace("\u{1b}[1m\u{1b}[31merror", "error");
            assert!(
                !printed.contains("\u{1b}[31m") || !printed.contains("[31mx"),
                "{arguments:?} {printed:?}"
            );
            assert!(!printed.contains("\u{1b}[31mred") && !printed.contains("\u{1b}[31mx"), "{printed:?}");
            let acts = |c: char| c.is_control() && c != '\n' && (c != '\u{1b}' || colour == "never");
            assert!(!printed.contains(acts), "{arguments:?} {printed:?}");
            assert!(!printed.contains("\u{1b}[2J") && !printed.contains("\u{1b}]"), "{printed:?}");
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn what_never_ends_is_given_up_early() {
    let folder = Folder::with_library();
    let began = std::time::Instant::now();
    folder.run("analyze /dev/zero -o a.lib.json").fails(1, "'/dev/zero' as an image: its format");
    folder.run("synth /dev/zero -o a.svg").fails(1, "'/dev/zero'");
    folder.run("synth photo.lib.json --size 40 --density /dev/zero -o a.svg").fails(1, "/dev/zero");
    folder.run("synth photo.lib.json --config /dev/zero -o a.svg").fails(1, "'/dev/zero' is too large");
    assert!(began.elapsed() < std::time::Duration::from_secs(5), "{:?}", began.elapsed());
}

#[test]
fn what_was_meant_is_guessed() {
    let folder = Folder::with_library();
    for (line, hint) in [
        ("photo.png", "did you mean 'vtex texture photo.png'?"),
        ("photo.lib.json", "did you mean 'vtex synth photo.lib.json'?"),
        ("texture photo.png out.svg", "give the output with -o, as in -o out.svg"),
        ("texture photo.png --width 500", "--size 1000x600"),
        ("edit a.scene.json --op tint red", "put the operation in quotes: --op \"tint red\""),
        ("recolor a.svg", "vtex edit SCENE --op \"recolor --from"),
        ("colour a.svg", "vtex edit SCENE --op \"recolor --from"),
        ("palette a.svg", "vtex edit SCENE --op \"palette "),
        ("raster photo.png -o a.svg", "hint: give --output a name that ends in .png\n"),
    ] {
        let run = folder.run(line).fails(2, "");
        assert!(
            run.stderr.contains(&format!("hint: {hint}")) || run.stderr.contains(hint),
            "{line}: {}",
            run.stderr
        );
    }
    folder.run("texture *.jpg").fails(1, "cannot read '*.jpg'");
    assert!(folder.run("texture *.jpg").stderr.contains("does not expand it"));
}

#[test]
fn other_words_for_the_same_are_taken() {
    let folder = Folder::with_library();
    let synth = "synth photo.lib.json --size 63 --seed 1";
    for (given, meant) in [
        ("--tile=true", "--tile=both"),
        ("--tile=false", "--tile=none"),
        ("--background transparent", "--background none"),
    ] {
        folder.run(&format!("{synth} {given} -o a.svg")).succeeds();
        folder.run(&format!("{synth} {meant} -o b.svg")).succeeds();
        assert!(folder.read("a.svg") == folder.read("b.svg"), "{given}");
    }
    folder.run("vectorize photo.png --seed 1 --colours 5 -o a.svg").succeeds();
    folder.run("vectorize photo.png --seed 1 --colors 5 -o b.svg").succeeds();
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    folder.run("render photo.lib.json --width 192 -o wide.png").succeeds();
    assert_eq!(image::load_from_memory(&folder.read("wide.png")).unwrap().width(), 192);
    folder.run("batch photo.lib.json -o out --size 60").succeeds();
    assert!(folder.path("out/photo.svg").exists());
}

#[test]
fn an_svg_says_what_it_is_and_where_its_scene_comes_from() {
    let folder = Folder::new();
    folder.run("texture photo.png -o out.svg --size 60 --seed 5").succeeds();
    let told = folder.run("inspect out.svg").succeeds().text().to_owned();
    for word in ["seed         5", "60 x 60 px", "photo.png", "fidelity 0.5", "--again out.svg"] {
        assert!(told.contains(word), "{word}: {told}");
    }
    let json = folder.run("inspect out.svg --json").succeeds().json();
    assert_eq!((&json["seed"], &json["recipe"]["command"]), (&5.into(), &"texture".into()));
    assert!(json["categories"].as_array().is_some_and(|list| !list.is_empty()));
    let run: Run = folder.command("edit out.svg --op").arg("thin 0.5").output().unwrap().into();
    let run = run.fails(1, "contains an SVG, not a scene");
    assert!(run.stderr.contains("vtex texture PHOTO --again out.svg -o out.scene.json"), "{}", run.stderr);
    folder.run("analyze photo.png --seed 5").succeeds();
    folder.run("synth photo.lib.json -o made.svg --size 60 --seed 5").succeeds();
    let run = folder.run("edit made.svg --op flatten").fails(1, "contains an SVG, not a scene");
    let hint = "repeat the command that wrote it, with --seed 5 -o made.scene.json";
    assert!(run.stderr.contains(hint) && !run.stderr.contains("--again"), "{}", run.stderr);
    folder.write("plain.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>");
    folder.run("inspect plain.svg").fails(1, "does not say how it was made");
}

#[test]
fn errors_are_objects_for_programs() {
    let folder = Folder::new();
    let run = folder.run("texture none.jpg --json").fails(1, "cannot read 'none.jpg'");
    let json = run.json();
    assert!(json["error"].as_str().is_some_and(|text| text.contains("none.jpg")));
    assert_eq!((&json["exit"], json["hint"].is_string()), (&1.into(), true));
}

#[test]
fn folders_are_taken_with_their_drawings() {
    let folder = Folder::with_library();
    std::fs::create_dir(folder.path("in")).unwrap();
    folder.write("in/garden.svg", include_bytes!("../../examples/drawings/garden.svg"));
    folder.run("synth photo.lib.json --size 60 -o in/result.svg").succeeds();
    folder.run("batch in --out-dir out --size 300").succeeds();
    // Files that vtex has written are not exemplars.
    assert!(folder.path("out/garden.svg").exists() && !folder.path("out/result.svg").exists());
}

#[test]
fn what_is_wrong_with_a_drawing_is_what_is_said() {
    let folder = Folder::new();
    let svg = |inner: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="90" height="90">{inner}</svg>"#)
    };
    let round =
        svg(r#"<clipPath id="c"><circle r="9"/></clipPath><path d="M0 0h9v9z" clip-path="url(#c)"/>"#);
    let utf16: Vec<u8> = format!("\u{feff}{round}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    folder.write("utf16.svg", utf16);
    folder.write("empty.svg", "");
    folder.write("nested.svg", svg(&format!("{}{}", "<g>".repeat(3000), "</g>".repeat(3000))));
    folder.write("far.svg", svg(r#"<clipPath id="c"><path d="M-1e9 -1e9h2e9v2e9h-2e9z"/></clipPath><g clip-path="url(#c)"><circle r="5"/></g>"#));
    folder.write("round.svg", round);
    folder.write("zz.svg", svg(&format!(r#"<path d="M5 5{}"/>"#, "Z".repeat(25_000))));
    folder.write("shapes.svg", svg(&"<g/>".repeat(400_000)));
    for command in ["analyze", "texture", "vectorize", "render"] {
        let fails = |file: &str, message: &str, hint: &str| {
            let run = folder.run(&format!(
                "{command} {file} -o out.{}",
                if command == "analyze" { "lib.json" } else { "png" }
            ));
            let stderr = run.stderr.clone();
            run.fails(1, message);
            assert!(stderr.contains(hint), "{stderr}");
        };
        fails("utf16.svg", "it is UTF-16 text", "save it as UTF-8");
        fails("empty.svg", "empty", "is the file complete?");
        fails("nested.svg", "nests more than 1024 elements", "ungroup it");
        fails("far.svg", "reaches further", "far outside the page");
        fails("zz.svg", "closed more than 1000 times in a row", "delete the repeated Z");
        if command != "render" {
            fails("round.svg", "clipped by something else than one convex polygon", "--lenient");
            fails("shapes.svg", "400001 shapes", "simplify it in the program that made it");
        }
    }
    folder.write("plain.svg", svg(r#"<rect width="90" height="90"/>"#));
    let run = folder
        .run("transfer --onto photo.png --appearance plain.svg -o out.svg --quiet")
        .fails(1, "wider than a pixel");
    assert!(!run.stderr.contains("from above"), "{}", run.stderr);
}

#[test]
fn a_texture_without_elements_is_warned_of() {
    let folder = Folder::new();
    // One line that goes on across the border: no method that places whole elements has any.
    let line = "<path d='M-9 20 H60' stroke='#a00' stroke-width='4'/>";
    folder.write(
        "line.svg",
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='40' height='40'>{line}</svg>"),
    );
    folder.run("analyze line.svg -o line.lib.json").succeeds();
    let run =
        folder.run("synth line.lib.json --method descriptor --size 200 --seed 1 -o none.svg").succeeds();
    for said in [
        "warning: the texture has no elements; the library has 1: the border cuts all",
        "hint: leave out --method",
    ] {
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    assert!(run.stderr.contains("0 elements in 0 categories, elements cover 0 %"), "{}", run.stderr);
    let run = folder.run("synth line.lib.json --size 200 --seed 1 -o some.svg").succeeds();
    assert!(!run.stderr.contains("warning") && run.stderr.contains("in 1 category"), "{}", run.stderr);
    // What cannot turn stays as it is.
    let run = folder.run("synth line.lib.json --rotate 20 --size 200 --seed 1 -o turned.svg").succeeds();
    for said in ["warning: no element is turned, mirrored or resized", "in 1 category"] {
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    // Without --method, nobody is told to leave it out.
    let run =
        folder.run("synth line.lib.json --density photo.png --size 200 --seed 1 -o thin.svg").succeeds();
    assert!(run.stderr.contains("hint: leave out --density and --weights"), "{}", run.stderr);
    folder.write("none.masks.png", encode(&GrayImage::new(96, 80).into(), ImageFormat::Png));
    let run = folder.run("texture photo.png --masks none.masks.png --size 60 --seed 1 -o a.svg").succeeds();
    assert!(run.stderr.contains("no primary element was found"), "{}", run.stderr);
    assert!(!run.stderr.contains("leave out --method"), "{}", run.stderr);
}

#[test]
fn a_picture_that_is_drawn_as_it_is_has_no_warning_of_placing() {
    let folder = Folder::new();
    let photo = image::load_from_memory(&folder.read("photo.png")).unwrap().crop_imm(0, 0, 48, 48);
    folder.write("small.png", encode(&photo, ImageFormat::Png));
    let placed = folder.run("texture small.png --seed 1 --size 50 --wrap=off -o a.svg").succeeds();
    assert!(placed.stderr.contains("repetition will show"), "{}", placed.stderr);
    let drawn = folder.run("vectorize small.png --seed 1 -o b.svg").succeeds();
    assert!(!drawn.stderr.contains("warning"), "{}", drawn.stderr);
}

#[test]
fn an_svg_is_recognised_behind_a_long_comment() {
    let folder = Folder::new();
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='40'><circle cx='20' cy='20' r='6'/></svg>";
    folder.write("a.svg", format!("<?xml version='1.0'?><!-- {} -->{svg}", "long > ".repeat(9000)));
    folder.run("analyze a.svg").succeeds();
    folder.run("render a.svg -o a.png").succeeds();
    let pack = |bytes: &[u8]| {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut packed, bytes).unwrap();
        packed.finish().unwrap()
    };
    folder.write("a.svgz", pack(&folder.read("a.svg")));
    folder.run("render a.svgz -o b.png").succeeds();
    assert!(folder.read("a.png") == folder.read("b.png"));
}

#[test]
fn foreign_objects_are_counted() {
    let folder = Folder::new();
    let foreign =
        "<foreignObject width='9' height='9'><p xmlns='http://www.w3.org/1999/xhtml'>a</p></foreignObject>";
    let shapes = format!(
        "<rect width='40' height='40' fill='#fff'/>{foreign}{foreign}<circle cx='20' cy='20' r='6'/>"
    );
    folder.write(
        "a.svg",
        format!("<svg xmlns='http://www.w3.org/2000/svg' width='40' height='40'>{shapes}</svg>"),
    );
    let run = folder.run("render a.svg -o a.png").succeeds();
    assert!(
        run.stderr.contains("'a.svg' contains 2 <foreignObject>, which vtex does not draw"),
        "{}",
        run.stderr
    );
    let run = folder.run("analyze a.svg -o a.lib.json").succeeds();
    assert!(run.stderr.contains("2 <foreignObject> are left out: turn them into paths"), "{}", run.stderr);
}

#[test]
fn words_fit_what_they_are_about() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 60 --seed 1 -o a.scene.json").succeeds();
    let scene = String::from_utf8(folder.read("a.scene.json")).unwrap();
    folder.write("b.scene.json", scene.replacen("60", &format!("\"{}\"", "z".repeat(900)), 1));
    let run = folder.run("render b.scene.json -o b.png").fails(1, "at line 1 column");
    assert!(run.stderr.lines().next().unwrap().chars().count() < 320, "{}", run.stderr);
    folder.run("texture photo.png --layer-order 1,x").fails(2, "expected numbers of layers, counted from 0");
    folder.run("layers photo.png --layer-order 1,x").fails(2, "expected numbers of layers, counted from 0");
    let run = folder.run("synth photo.lib.json --size 60 --seed 1 --exclude moss -o c.svg").succeeds();
    assert!(run.stderr.contains("there is no category 'moss' to exclude; known are "), "{}", run.stderr);
    let tiny =
        "<svg xmlns='http://www.w3.org/2000/svg' width='0.0002' height='0.0003'><path d='M0 0H1V1z'/></svg>";
    folder.write("tiny.svg", tiny);
    folder.run("analyze tiny.svg").fails(1, "its page has 0.0002 x 0.0003 units");
    let run = folder.run("synth tiny.svg -o t.svg").fails(1, "'tiny.svg' contains an SVG, not a library");
    assert!(run.stderr.contains("'vtex analyze'"), "{}", run.stderr);
    // A shape that holds a third of the canvas wants less than the exemplar has.
    let shape =
        "<svg xmlns='http://www.w3.org/2000/svg' width='90' height='90'><path d='M0 0H30V90H0z'/></svg>";
    folder.write("shape.svg", shape);
    let run = folder.run("synth photo.lib.json --size 90 --seed 1 --domain shape.svg -o d.svg").succeeds();
    assert!(
        run.stderr.contains("of the canvas (") && run.stderr.contains(" wanted there, "),
        "{}",
        run.stderr
    );
}
