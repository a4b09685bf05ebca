//! Standard input and output, the summary, seeds.

use super::support::{Folder, is_document, library, photo};
use std::io::Read;
use std::process::Stdio;

#[test]
fn nothing_but_data_is_on_stdout() {
    let folder = Folder::with_library();
    let synth = folder.feed("synth - -o - --size 50 --seed 3 -vv", library()).succeeds();
    folder.run("synth photo.lib.json -o a.svg --size 50 --seed 3").succeeds();
    assert_eq!(synth.stdout, folder.read("a.svg"));
    assert!(!synth.stderr.is_empty());
    let analyze = folder.feed("analyze - --seed 7", &photo()).succeeds();
    assert!(is_document(&analyze.stdout, "vtex-library"));
    let render = folder.feed("render - --scale 2", &synth.stdout).succeeds();
    assert_eq!(image::load_from_memory(&render.stdout).unwrap().width(), 100);
    let texture = folder.feed("texture - -o - --size 50 --json", &photo()).succeeds();
    assert!(texture.stdout.starts_with(b"<?xml"));
    let summary: serde_json::Value = serde_json::from_str(&texture.stderr).unwrap();
    assert_eq!(summary["bytes"], texture.stdout.len());
    assert_eq!(folder.names(), ["a.svg", "photo.lib.json", "photo.png"]);
}

#[test]
fn the_summary_counts_what_was_written() {
    let folder = Folder::new();
    let run = folder.run("texture photo.png -o a.scene.json --size 120x90 --json").succeeds();
    assert_eq!(run.stderr, "");
    let summary = run.json();
    let scene: serde_json::Value = serde_json::from_slice(&folder.read("a.scene.json")).unwrap();
    // Empty layers and fields are left out of a scene's JSON.
    let length = |v: &serde_json::Value| v.as_array().map_or(0, Vec::len);
    assert_eq!(summary["counts"]["primaries"], length(&scene["layers"][2]["instances"]));
    assert_eq!(summary["counts"]["secondaries"], length(&scene["layers"][1]["instances"]));
    assert_eq!(summary["counts"]["background"], length(&scene["layers"][0]["field"]["points"]));
    assert_eq!(summary["bytes"], folder.read("a.scene.json").len());
    assert_eq!(summary["seed"], scene["parameters"]["seed"]);
    assert_eq!(summary["size"], serde_json::json!([120, 90]));
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let (wanted, got) = (number(&summary["coverage"]["wanted"]), number(&summary["coverage"]["got"]));
    assert!((0.0..=1.0).contains(&wanted) && (0.0..=1.0).contains(&got), "{wanted} {got}");
    let seconds = summary["seconds"].as_object().unwrap();
    let sum: f64 = seconds.iter().filter(|s| s.0 != "total").map(|s| number(s.1)).sum();
    assert!((sum - number(&seconds["total"])).abs() < 0.02, "{seconds:?}");
    assert!(summary["warnings"].is_array());
}

#[test]
fn a_seed_that_was_chosen_is_told_and_stored() {
    let folder = Folder::with_library();
    let run = folder.run("synth photo.lib.json --size 60 -o a.scene.json").succeeds();
    let told = run.stderr.lines().find_map(|l| l.strip_prefix("seed: ")).unwrap();
    let seed: u64 = told.split(' ').next().unwrap().parse().unwrap();
    let scene: serde_json::Value = serde_json::from_slice(&folder.read("a.scene.json")).unwrap();
    assert_eq!(scene["parameters"]["seed"], seed);
    // The same seed gives the same scene; two random seeds differ.
    folder.run(&format!("synth photo.lib.json --size 60 -o b.scene.json --seed {seed}")).succeeds();
    assert_eq!(folder.read("a.scene.json"), folder.read("b.scene.json"));
    folder.run("synth photo.lib.json --size 60 -o b.scene.json").succeeds();
    assert_ne!(folder.read("a.scene.json"), folder.read("b.scene.json"));
    folder.run("analyze photo.png --seed 18446744073709551615").succeeds();
    assert!(String::from_utf8(folder.read("photo.lib.json")).unwrap().contains("18446744073709551615"));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = Folder::with_library();
    for arguments in
        ["synth photo.lib.json -o - --size 400", "completions zsh", "inspect photo.lib.json", "--help"]
    {
        let mut command = folder.command(arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut start = [0; 10];
        let mut stdout = child.stdout.take().unwrap();
        stdout.read_exact(&mut start).unwrap();
        drop(stdout);
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments}: {stderr}");
        assert!(!stderr.contains("error") && !stderr.contains("panic"), "{arguments}: {stderr}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_stdout_is_reported() {
    let folder = Folder::with_library();
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    for arguments in
        ["synth photo.lib.json -o - --size 50", "inspect photo.lib.json", "models list", "--dump-config"]
    {
        let output = folder.command(arguments).stdout(full()).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {stderr}");
        assert!(stderr.starts_with("error: cannot write '-': "), "{arguments}: {stderr}");
    }
    // The message cannot be written, but the work is done.
    let output = folder.command("synth photo.lib.json --size 50").stderr(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn inspect_tells_the_same_to_people_and_programs() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 120 -o a.scene.json.gz --seed 4").succeeds();
    for name in ["photo.lib.json", "a.scene.json.gz"] {
        // The content of a file decides, not its name.
        std::fs::copy(folder.path(name), folder.path("plain")).unwrap();
        let json = folder.run("inspect plain --json").succeeds().json();
        let text = folder.run("inspect plain").succeeds().text().to_owned();
        let primaries = json["counts"]["primaries"].as_u64().unwrap();
        assert!(primaries > 0);
        let line = text.lines().find(|l| l.starts_with("primaries ")).unwrap();
        assert_eq!(line.split_whitespace().nth(1), Some(primaries.to_string().as_str()), "{text}");
        let categories = json["categories"].as_array().unwrap();
        let sum: f64 = categories.iter().map(|c| c["coverage"].as_f64().unwrap()).sum();
        assert!((sum - json["coverage"].as_f64().unwrap()).abs() < 1e-9);
        let members: u64 = categories.iter().map(|c| c["primaries"].as_u64().unwrap()).sum();
        assert_eq!(members, primaries);
        assert_eq!(json["bytes"], folder.read("plain").len());
        assert!(text.lines().all(|l| l == l.trim_end()), "{text}");
    }
}

#[test]
fn a_pattern_is_written_beside_the_result() {
    let folder = Folder::with_library();
    let run = folder.run("synth photo.lib.json --size 63 --tile both --pattern p.svg -o a.scene.json --json");
    assert_eq!(run.succeeds().json()["pattern"], "p.svg");
    folder.run("render a.scene.json -o a.png --pattern p.svgz").succeeds();
    let mut unpacked = String::new();
    flate2::read::GzDecoder::new(&folder.read("p.svgz")[..]).read_to_string(&mut unpacked).unwrap();
    assert_eq!(unpacked.as_bytes(), folder.read("p.svg"));
    assert!(unpacked.contains("<pattern id=\"texture\""));
    folder.run("synth photo.lib.json --size 63 --tile x -o b.scene.json").succeeds();
    folder.run("render b.scene.json --pattern b.svg").fails(1, "--tile");
    folder.run("synth photo.lib.json --size 60 -o c.svg").succeeds();
    folder.run("render c.svg --pattern d.svg").fails(2, "needs a scene");
    assert!(!folder.names().iter().any(|n| n == "b.svg" || n == "d.svg"));
}

#[test]
fn pdf_is_written_by_every_command_that_writes_a_scene() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 60 --seed 1 -o a.scene.json").succeeds();
    for command in [
        "synth photo.lib.json --size 60 --seed 1",
        "texture photo.png --size 60 --seed 1",
        "warp a.scene.json photo.lib.json --stretch 1.2",
        "render a.scene.json",
        "render photo.lib.json",
    ] {
        // A second run replaces vtex's own file with the same bytes.
        let run = folder.run(&format!("{command} -o a.pdf --json")).succeeds();
        let bytes = folder.read("a.pdf");
        assert_eq!(run.json()["bytes"], bytes.len());
        assert!(bytes.starts_with(b"%PDF-") && bytes.trim_ascii_end().ends_with(b"%%EOF"), "{command}");
        folder.run(&format!("{command} -o a.pdf")).succeeds();
        assert_eq!(folder.read("a.pdf"), bytes, "{command}");
    }
    folder.run("render a.pdf -o a.svg").fails(1, "a.pdf");
}

#[test]
fn a_limit_of_bytes_is_kept_and_what_it_cost_is_told() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 157 --seed 1 --tile -o a.scene.json").succeeds();
    let fine = "render a.scene.json --precision 2";
    let whole = folder.run(&format!("{fine} -o a.svg --pattern b.svg --json")).succeeds().json();
    assert!(whole.get("given_up").is_none());
    // The first reduction is one decimal less.
    folder.run("render a.scene.json --precision 1 -o c.svg --pattern d.svg").succeeds();
    let [most, pattern] = ["c.svg", "d.svg"].map(|name| folder.read(name).len());
    assert!(most < folder.read("a.svg").len() && pattern < folder.read("b.svg").len());
    let run = folder.run(&format!("{fine} -o e.svg --max-bytes {most} --json")).succeeds();
    let cost = serde_json::json!({
        "decimals": 1, "names": false, "tolerance": 0.0, "details": 0, "elements": 0, "primaries": 0,
        "background": 1.0, "colours": 0.0,
    });
    assert_eq!((&run.json()["given_up"], &run.json()["bytes"]), (&cost, &most.into()));
    assert_eq!(folder.read("e.svg"), folder.read("c.svg"));
    let told = folder.run(&format!("{fine} -o e.svg --max-bytes {most}")).succeeds().stderr;
    assert!(told.contains("reduced to stay within the limit of bytes: numbers have 1 decimal"), "{told}");
    folder.run(&format!("{fine} -o e.png --pattern e.svg --max-bytes {pattern}")).succeeds();
    assert_eq!(folder.read("e.svg"), folder.read("d.svg"));
    // The packed file fits without reductions.
    let run = folder.run(&format!("{fine} -o c.svgz --max-bytes {most} --json")).succeeds();
    assert!(run.json().get("given_up").is_none());

    folder.run(&format!("{fine} -o f.svg --max-bytes 0.5kB")).fails(1, "the smallest has ");
    folder.run(&format!("{fine} -o f.svg --max-bytes many")).fails(2, "expected 5MB");
    folder.run(&format!("{fine} -o f.svg --max-bytes 0")).fails(2, "expected 5MB");
    assert!(!folder.path("f.svg").exists());
    let told = folder.run(&format!("{fine} -o g.png --max-bytes 1MB")).succeeds().stderr;
    assert!(told.contains("--max-bytes has no effect here"), "{told}");

    // A PDF is reduced in the same way.
    folder.run(&format!("{fine} -o whole.pdf")).succeeds();
    let most = folder.read("whole.pdf").len() * 9 / 10;
    let run = folder.run(&format!("{fine} -o small.pdf --max-bytes {most} --json")).succeeds();
    assert!(folder.read("small.pdf").len() <= most && run.json().get("given_up").is_some());
    let run = folder.run(&format!("{fine} -o tiny.pdf --max-bytes 1")).fails(1, "no PDF of the scene fits");
    assert!(!run.stderr.contains("svg"), "{}", run.stderr);

    // A quarter of the bytes takes coarser outlines, most details, a coarser background, and says so.
    let most = folder.read("a.svg").len() / 4;
    let run = folder.run(&format!("{fine} -o quarter.svg --max-bytes {most}")).succeeds();
    assert!(folder.read("quarter.svg").len() <= most);
    for part in ["elements have no names", "details and", "times coarser"] {
        assert!(run.stderr.contains(part), "{}", run.stderr);
    }
    let most = folder.read("whole.pdf").len() / 2;
    folder.run(&format!("{fine} -o half.pdf --max-bytes {most}")).succeeds();
    assert!(folder.read("half.pdf").len() <= most);
}

#[test]
fn drawings_on_small_pages_have_two_decimals_in_every_command() {
    let folder = Folder::new();
    folder.write(
        "small.svg",
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24"><circle cx="5.13" cy="5" r="2.27" fill="#a03020"/><circle cx="16" cy="7.31" r="2.6"/><circle cx="9" cy="17" r="3.1"/><circle cx="19" cy="18" r="1.9"/></svg>"##,
    );
    folder.run("analyze small.svg --seed 1").succeeds();
    folder.run("synth small.lib.json --size 60 --seed 3 -o a.svg -o a.scene.json").succeeds();
    // A scene is written again as it was when it was made.
    folder.run("render a.scene.json -o again.svg").succeeds();
    assert_eq!(folder.read("again.svg"), folder.read("a.svg"));
    for (i, command) in [
        "edit a.scene.json --op flatten",
        "warp a.scene.json small.lib.json --stretch 1.5x1 --seed 2",
        "transfer --structure a.scene.json --appearance a.scene.json --seed 2",
        "animate a.scene.json --flow shear --frames 3 --seed 2",
        "animate a.scene.json a.scene.json --frames 3",
    ]
    .into_iter()
    .enumerate()
    {
        let of = |precision: u8| {
            let name = format!("{i}-{precision}.svg");
            folder.run(&format!("{command} --precision {precision} -o {name}")).succeeds();
            folder.read(&name)
        };
        let [none, one, two] = [0, 1, 2].map(of);
        assert!(one == two && none != one, "{command}");
    }
}

#[test]
fn axes_may_follow_after_a_space() {
    let folder = Folder::with_library();
    for (arguments, x, y) in [
        ("--tile", true, true),
        ("--tile x", true, false),
        ("--tile=y", false, true),
        ("--tile none", false, false),
    ] {
        folder.run(&format!("synth {arguments} photo.lib.json --size 63 -o a.scene.json")).succeeds();
        let scene: serde_json::Value = serde_json::from_slice(&folder.read("a.scene.json")).unwrap();
        assert_eq!(scene["tile"], serde_json::json!({ "x": x, "y": y }), "{arguments}");
    }
}

#[test]
fn eight_colours_are_eight() {
    let folder = Folder::new();
    // A picture of many colours: noise over a gradient.
    let picture = image::RgbImage::from_fn(120, 100, |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)) >> 9;
        image::Rgb([(2 * x) as u8, (2 * y + noise % 40) as u8, (x / 12 * 25 + noise % 30) as u8])
    });
    folder.write("photo.png", super::support::encode(&picture.into(), image::ImageFormat::Png));
    for (options, most) in [("--colors 8", 8), ("--colors 8 --max-paths 40", 8), ("--colors 1", 1)] {
        folder.run(&format!("vectorize photo.png {options} --seed 1 -o a.svg -f")).succeeds();
        let text = String::from_utf8(folder.read("a.svg")).unwrap();
        // Outside the metadata, every # that is not a reference begins a colour.
        let drawing = text.split("</metadata>").nth(1).unwrap().replace("url(#", "").replace("href=\"#", "");
        let names = drawing.split(['"', ':', ';']).filter(|part| part.starts_with('#'));
        let mut colours: Vec<&str> = names.collect();
        colours.sort_unstable();
        colours.dedup();
        assert!(!colours.is_empty() && colours.len() <= most, "{options}: {colours:?}");
        assert!(!drawing.contains("Gradient") && !drawing.contains("stop-color"), "{options}");
    }
}

#[test]
fn where_nothing_is_wanted_nothing_is_placed() {
    let folder = Folder::with_library();
    let black = image::GrayImage::new(8, 8);
    folder.write("black.png", super::support::encode(&black.into(), image::ImageFormat::Png));
    for (size, seed) in [(50, 1), (90, 2), (90, 3), (200, 4)] {
        for method in ["descriptor", "correspondence"] {
            let run = folder.run(&format!(
                "synth photo.lib.json --density black.png --size {size} --seed {seed} --method {method} --json"
            ));
            let counts = run.succeeds().json()["counts"].take();
            assert_eq!(
                (&counts["primaries"], &counts["secondaries"]),
                (&0.into(), &0.into()),
                "{size} {method}"
            );
        }
    }
}

#[test]
fn the_ground_is_as_asked_for() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 80 --seed 1 -o a.scene.json").succeeds();
    for (ground, pixel) in
        [("rebeccapurple", [0x66, 0x33, 0x99, 255]), ("#f80", [255, 136, 0, 255]), ("none", [0; 4])]
    {
        folder.run(&format!("render a.scene.json --background {ground} -o a.png -o a.svg")).succeeds();
        folder.run("render a.svg -o b.png").succeeds();
        for name in ["a.png", "b.png"] {
            let picture = image::load_from_memory(&folder.read(name)).unwrap().to_rgba8();
            let count = picture.pixels().filter(|p| p.0 == pixel).count();
            assert!(count > 500 && count < 6000, "{ground} {name}: {count}");
        }
    }
    folder.write("a.toml", "[render]\nbackground = \"none\"\n");
    folder.run("synth photo.lib.json --size 40 --config a.toml -o c.png").succeeds();
    assert!(image::load_from_memory(&folder.read("c.png")).unwrap().color().has_alpha());
    folder.run("render a.scene.json --background none -o c.pdf").succeeds();
    folder.run("render a.scene.json --background reddish -o c.png").fails(2, "a name such as red, or none");
}

#[test]
fn presets_set_what_they_say_and_options_win() {
    let folder = Folder::new();
    let dump =
        |arguments: &str| folder.run(&format!("{arguments} --dump-config")).succeeds().text().to_owned();
    let has = |text: &str, line: &str| text.lines().any(|l| l == line);
    assert_eq!(dump("texture --preset default"), dump("texture"));
    let poster = dump("vectorize --preset poster --max-paths 50");
    assert!(has(&poster, "colors = 12") && has(&poster, "max-paths = 50"), "{poster}");
    folder.write("a.toml", "[analyze]\nfidelity = 2.0\n[synth]\nmoves = 3\n");
    let fine = dump("texture --config a.toml --preset fine");
    assert!(has(&fine, "fidelity = 0.25") && has(&fine, "precision = 2"), "{fine}");
    folder.run("texture photo.png --size 50 --preset draft").succeeds();
    folder.run("analyze photo.png --preset best").fails(2, "expected draft, default, fine or poster");
}

/// Pixels per metre that a PNG states.
fn density(png: &[u8]) -> Option<[u32; 2]> {
    let at = png.windows(4).position(|name| name == b"pHYs")? + 4;
    let number = |k: usize| u32::from_be_bytes(std::array::from_fn(|i| png[at + 4 * k + i]));
    assert_eq!(png[at + 8], 1, "metres");
    Some([number(0), number(1)])
}

/// The start tag of an SVG.
fn root(svg: &[u8]) -> String {
    let text = String::from_utf8_lossy(svg);
    let (_, rest) = text.split_once("<svg ").unwrap();
    rest.split_once('>').unwrap().0.to_owned()
}

#[test]
fn lengths_are_written_exactly_in_every_format() {
    let folder = Folder::with_library();
    // 300 mm are 354.3 px at 30 dpi.
    let files = "-o a.svg -o a.pdf -o a.png -o a.scene.json -o a.svgz";
    let synth = "synth photo.lib.json --seed 1 --lattice off";
    let pattern = "--tile --pattern p.svg";
    let json = folder
        .run(&format!("{synth} --size 300mmx300mm --dpi 30 {pattern} {files} --json"))
        .succeeds()
        .json();
    assert_eq!(json["size"], serde_json::json!([354, 354]));
    assert_eq!(json["page"], serde_json::json!(["300mm", "300mm"]));
    let a = root(&folder.read("a.svg"));
    assert!(a.contains(r#"width="300mm" height="300mm" viewBox="0 0 354 354""#), "{a}");
    assert!(!a.contains("preserveAspectRatio"), "{a}");
    // 300 mm are 1133.858267… px of CSS.
    let by = 300.0 / 25.4 * 96.0 / 354.0;
    let pattern = String::from_utf8(folder.read("p.svg")).unwrap();
    assert!(pattern.contains(&format!("scale({by:.12} {by:.12})")), "{by}");
    let media_box = |name: &str| {
        let pdf = String::from_utf8_lossy(&folder.read(name)).into_owned();
        pdf.split_once("/MediaBox[0 0 ").unwrap().1.split_once(']').unwrap().0.to_owned()
    };
    assert_eq!(media_box("a.pdf"), "850.3937 850.3937");
    assert_eq!(density(&folder.read("a.png")), Some([1180, 1180]));
    // The scene keeps the page, whatever is made of it.
    folder.run("edit a.scene.json -o b.scene.json -o b.svg -o b.png --op 'rotate 30'").succeeds();
    folder.run("render b.scene.json -o c.svg -o c.pdf -o c.png --scale 2").succeeds();
    for name in ["b.svg", "c.svg"] {
        assert_eq!(root(&folder.read(name)), a, "{name}");
    }
    assert_eq!(media_box("c.pdf"), media_box("a.pdf"));
    assert_eq!(
        ["b.png", "c.png"].map(|name| density(&folder.read(name))),
        [Some([1180; 2]), Some([2360; 2])]
    );
    folder.run("warp a.scene.json photo.lib.json --stretch 2x1 -o d.svg").succeeds();
    assert!(root(&folder.read("d.svg")).contains(r#"width="600mm" height="300mm""#));
    folder.run("render a.scene.json --dpi 60 -o e.svg").succeeds();
    assert!(root(&folder.read("e.svg")).contains(r#"width="149.86mm""#), "an explicit --dpi wins");
    let told = folder.run("inspect a.scene.json").succeeds().text().to_owned();
    assert!(told.contains("300mm x 300mm"), "{told}");
}

#[test]
fn a_page_that_is_no_whole_number_of_pixels_is_stretched_to_be_exact() {
    let folder = Folder::with_library();
    let synth = "synth photo.lib.json --seed 1";
    for (size, dpi, stated) in [
        ("3mx1m", 4, r#"width="3000mm" height="1000mm" viewBox="0 0 472 157""#),
        ("1inx2cm", 150, r#"width="1in" height="2cm" viewBox="0 0 150 118""#),
        ("72ptx50pt", 100, r#"width="72pt" height="50pt" viewBox="0 0 100 69""#),
        ("29.7cmx210mm", 10, r#"width="29.7cm" height="210mm" viewBox="0 0 117 83""#),
    ] {
        folder.run(&format!("{synth} --size {size} --dpi {dpi} -o a.svg -o a.pdf --force")).succeeds();
        let root = root(&folder.read("a.svg"));
        assert!(root.contains(stated), "{size}: {root}");
        assert!(root.contains(r#"preserveAspectRatio="none""#), "{size}: {root}");
    }
    folder.run(&format!("{synth} --size 1in --dpi 144 -o c.pdf")).succeeds();
    let pdf = String::from_utf8_lossy(&folder.read("c.pdf")).into_owned();
    assert!(pdf.contains("/MediaBox[0 0 72 72]"), "an inch has 72 points");
    // Without lengths --dpi states the page.
    folder.run(&format!("{synth} --size 90x60 --dpi 150 -o d.svg")).succeeds();
    assert!(root(&folder.read("d.svg")).contains(r#"width="15.24mm" height="10.16mm" viewBox="0 0 90 60""#));
    folder.run(&format!("{synth} --size 90x60 -o e.svg")).succeeds();
    assert!(root(&folder.read("e.svg")).contains(r#"width="90" height="60" viewBox="0 0 90 60""#));
    folder.write("a.toml", "[synth]\nsize = '2inx1in'\n[render]\ndpi = 50\n");
    folder.run(&format!("{synth} --config a.toml -o f.svg")).succeeds();
    assert!(root(&folder.read("f.svg")).contains(r#"width="2in" height="1in" viewBox="0 0 100 50""#));
    folder.run(&format!("{synth} --size 9kg")).fails(2, "lengths in mm, cm, m, in or pt");
    folder.run(&format!("{synth} --size 100mm --dpi 0")).fails(2, "expected auto, or 1 to 9600");
    folder.run(&format!("{synth} --size 900m --dpi 96")).fails(2, "size");
}

#[test]
fn lengths_without_a_resolution_have_as_many_pixels_as_usual() {
    let folder = Folder::with_library();
    let size = |text: &str| {
        let run = folder.run(&format!("synth photo.lib.json --seed 1 --size {text} -o a.svg --force --json"));
        let size = run.succeeds().json()["size"].clone();
        [0, 1].map(|k| size[k].as_f64().unwrap())
    };
    for (text, proportion) in [("300mm", 1.0), ("3mx1m", 3.0)] {
        let [width, height] = size(text);
        assert!((0.9e6..1.1e6).contains(&(width * height)), "{text}: {width} x {height}");
        assert!((width / height / proportion - 1.0).abs() < 1e-9, "{text}: {width} x {height}");
    }
}

#[test]
fn a_heavy_texture_says_what_it_costs_and_what_to_type_instead() {
    let folder = Folder::new();
    let dot = |k: usize| format!(r#"<circle cx="{}" cy="{}" r=".4"/>"#, 2 * (k % 50) + 1, 2 * (k / 50) + 1);
    let dots: String = (0..1500).map(dot).collect();
    folder.write(
        "dots.svg",
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 60">{dots}</svg>"#),
    );
    let texture = "texture dots.svg --seed 1 --variation 0";
    let told = folder.run(&format!("{texture} --size 700x420 -o a.svg")).succeeds().stderr;
    assert!(told.contains("a canvas of 700 x 420 px is large for this exemplar: about 7"), "{told}");
    assert!(told.contains("hint: --size 200x120 has larger elements"), "{told}");
    let told = folder.run(&format!("{texture} --size 7inx4.2in --dpi 100 -o a.pdf")).succeeds().stderr;
    assert!(told.contains("a PDF of") && told.contains("--size 7inx4.2in without --dpi"), "{told}");
    let told = folder.run(&format!("{texture} -o b.svg")).succeeds().stderr;
    assert!(!told.contains("is large"), "{told}");
}

#[test]
fn a_tile_that_holds_no_whole_periods_names_the_size_that_does() {
    let folder = Folder::with_library();
    let told = folder.run("inspect photo.lib.json").succeeds().text().to_owned();
    assert!(told.contains("px: textures keep to them"), "{told}");
    let run = folder.run("synth photo.lib.json --size 50 --tile -o a.svg").fails(1, "whole rows");
    let size = run.stderr.split("give --size ").nth(1).and_then(|rest| rest.split(',').next()).unwrap();
    folder.run(&format!("synth photo.lib.json --size {size} --tile -o a.svg")).succeeds();
    folder.run("synth photo.lib.json --size 50 --tile --lattice off -o b.svg").succeeds();
    folder.run("synth photo.lib.json --size 50 --lattice 12 -o c.svg").fails(2, "one or two vectors");
    folder.run("synth photo.lib.json --size 50 --lattice 9,0,18,0 -o c.svg").fails(2, "different directions");
}

#[test]
fn categories_have_one_name_and_number_everywhere() {
    let folder = Folder::with_library();
    let names = |run: &str| {
        let found = folder.run(run).succeeds().json();
        let all = found["categories"].as_array().unwrap().iter();
        all.map(|c| (c["category"].as_u64().unwrap(), c["name"].as_str().unwrap().to_owned()))
            .collect::<Vec<_>>()
    };
    let known = names("inspect photo.lib.json --json");
    assert!(known.len() > 1 && known.iter().zip(1..).all(|((number, _), k)| *number == k), "{known:?}");
    folder.run("synth photo.lib.json --size 90 --seed 3 -o a.scene.json -o a.svg --css").succeeds();
    // Edits of colours do not change names of categories.
    folder.run("edit a.scene.json -o b.scene.json").fails(2, "nothing says what to do");
    let tint =
        ["edit", "a.scene.json", "-o", "b.scene.json", "-o", "b.svg", "--op", "tint #00ff00 --amount 0.9"];
    let run: super::support::Run = folder.command("").args(tint).output().unwrap().into();
    run.succeeds();
    for file in ["a.scene.json", "b.scene.json", "a.svg", "b.svg"] {
        let found = names(&format!("inspect {file} --json"));
        assert!(
            !found.is_empty() && found.iter().all(|one| known.contains(one)),
            "{file}: {found:?} {known:?}"
        );
    }
    let svg = String::from_utf8(folder.read("a.svg")).unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let mut counts = std::collections::BTreeMap::new();
    for group in document.descendants() {
        let Some(number) = group.attribute("class").and_then(|c| c.strip_prefix("category-")) else {
            continue;
        };
        let number: u64 = number.parse().unwrap();
        let name = &known[number as usize - 1].1;
        let label = group.attributes().find(|a| a.name() == "label").unwrap().value();
        assert!(label.starts_with(&format!("{name} ")), "{label}: {name}");
        assert!(svg.contains(&format!("--hue-{number})")) && svg.contains(&format!("/* {name} #")));
        *counts.entry(number).or_insert(0) += 1;
    }
    for (number, count) in counts {
        let operation = format!("delete --where category={number}");
        let mut edit = folder.command("edit a.scene.json -o c.svg -f --json");
        let run: super::support::Run = edit.args(["--op", &operation]).output().unwrap().into();
        assert_eq!(run.succeeds().json()["operations"][0]["matched"], count);
    }
    folder.run("inspect photo.lib.json a.scene.json -o page.html").succeeds();
    let page = String::from_utf8(folder.read("page.html")).unwrap();
    for (number, name) in &known {
        assert!(page.contains(&format!("\"id\":{number},\"name\":\"{name}\"")), "{number} {name}");
    }
    for wrong in ["category=0", "library=0"] {
        let mut edit = folder.command("edit a.scene.json -o c.svg -f");
        let run: super::support::Run =
            edit.args(["--op", &format!("delete --where {wrong}")]).output().unwrap().into();
        run.fails(2, "is numbered from 1");
    }
}

#[cfg(unix)]
#[test]
fn json_holds_nothing_that_acts_on_a_terminal() {
    let folder = Folder::with_library();
    let name = "a\u{202e}gnp\u{2066}\u{9b}2J.lib.json";
    folder.write(name, folder.read("photo.lib.json"));
    let missing = "b\u{202e}gnp\u{2066}\u{9b}2J.lib.json";
    for (arguments, name, piped) in
        [("inspect", name, false), ("synth --size 40 -o -", name, true), ("inspect", missing, false)]
    {
        let run: super::support::Run =
            folder.command(arguments).args([name, "--json"]).output().unwrap().into();
        let told = if piped { run.stderr } else { String::from_utf8(run.stdout).unwrap() };
        assert!(told.contains("\\u202e") && told.contains("\\u009b"), "{told}");
        assert!(!told.contains(['\u{202e}', '\u{2066}', '\u{9b}']), "{told}");
        let value: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert!(value.to_string().contains('\u{202e}'), "{told}");
    }
}
