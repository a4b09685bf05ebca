//! Libraries and scenes that are damaged or hostile.

use super::support::{Folder, library};
use serde_json::{Value, json};

fn value() -> Value {
    serde_json::from_slice(library()).unwrap()
}

#[test]
fn broken_invariants_are_named() {
    let folder = Folder::new();
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 20] = [
        (|v| v["version"] = json!(3), "version 3; this vtex reads version 2"),
        (|v| v["format"] = json!("vtex-something"), "vtex-something"),
        (|v| v["coverage"] = json!(1.5), "coverage = 1.5"),
        (|v| v["coverage"] = json!(null), "null"),
        (|v| v["extra"] = json!(1), "unknown field `extra`"),
        (|v| v["source"]["parameters"] = json!(7), "parameters: found integer `7`, expected an object"),
        (|v| v["elements"][0]["category"] = json!(60000), "elements[0].category is 60000"),
        (|v| v["layers"][2]["instances"][0] = json!(4_000_000), "instances[0].element is 4000000"),
        (|v| v["layers"][1]["name"] = json!("primary"), "layers[2].name 'primary' is empty or used twice"),
        (|v| v["elements"][0]["shapes"] = json!([]), "elements[0] has no shapes"),
        (|v| v["elements"][0]["shapes"][0]["outline"] = json!("M0 0L1e300 0 1 1z"), "out of range"),
        (|v| v["elements"][0]["shapes"][0]["outline"] = json!("M0 0Lnan 0z"), "line 1"),
        (|v| v["elements"][0]["shapes"][0]["outline"] = json!(""), "elements[0] is empty"),
        (|v| v["elements"][0]["centroid"] = json!([-5, 1e9]), "outside the exemplar"),
        (|v| v["elements"][0]["colour"] = json!("red"), "'red' is not a colour"),
        (|v| v["source"]["width"] = json!(4_000_000_000u32), "4000000000"),
        (
            |v| v["arrangement"]["runs"] = json!([0, 4_294_967_295u32, 0, 4_294_967_295u32]),
            "8589934590 pixels",
        ),
        (|v| v["arrangement"]["runs"] = json!([4_000_000_000u32, 1]), "names primary 4000000000"),
        (|v| v["descriptor_half"] = json!(4_000_000_000u32), "descriptor_half"),
        (|v| v["layers"][0]["field"]["points"][0]["x"] = json!(1e300), "layers[0].field.points[0]"),
    ];
    for (change, message) in changes {
        let mut library = value();
        change(&mut library);
        folder.write("bad.lib.json", serde_json::to_vec(&library).unwrap());
        for command in ["synth bad.lib.json -o a.svg", "render bad.lib.json -o a.png", "inspect bad.lib.json"]
        {
            let run = folder.run(command);
            assert_eq!(run.code, Some(1), "{command} {message}: {}", run.stderr);
            if command.starts_with("synth") {
                run.fails(1, message);
            }
        }
    }
    assert_eq!(folder.names(), ["bad.lib.json", "photo.png"]);
}

#[test]
fn a_library_cut_short_anywhere_is_refused() {
    let folder = Folder::new();
    let whole = library();
    for part in 0..12 {
        folder.write("cut.lib.json", &whole[..whole.len() * part / 12]);
        let run = folder.run("synth cut.lib.json -o a.svg");
        assert_eq!(run.code, Some(1), "{part}: {}", run.stderr);
        assert!(run.stderr.contains("hint: "), "{}", run.stderr);
    }
    folder.run("analyze photo.png -o whole.lib.json.gz").succeeds();
    let packed = folder.read("whole.lib.json.gz");
    folder.write("cut.lib.json.gz", &packed[..packed.len() / 2]);
    folder.run("synth cut.lib.json.gz -o a.svg").fails(1, "damaged gzip data");
}

#[test]
fn text_that_is_not_json_is_refused() {
    let folder = Folder::new();
    let deep = "[".repeat(100_000);
    let not_a_number = String::from_utf8(library().to_vec()).unwrap().replacen(
        "\"coverage\":",
        "\"coverage\":NaN,\"x\":",
        1,
    );
    for text in
        [deep.as_str(), "{}", "{\"format\":7}", "null", "{\"format\":\"vtex-library\"}", &not_a_number]
    {
        folder.write("bad.lib.json", text);
        folder.run("synth bad.lib.json").fails(1, "is not a valid vtex-library file");
    }
}

#[test]
fn scenes_are_checked_too() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o good.scene.json --size 60").succeeds();
    let scene: Value = serde_json::from_slice(&folder.read("good.scene.json")).unwrap();
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 6] = [
        (|v| v["version"] = json!(9), "version 9"),
        (|v| v["width"] = json!(4_000_000_000u32), "4000000000"),
        (
            |v| v["layers"][2]["instances"][0]["element"] = json!(4_000_000_000u32),
            "layers[2].instances[0].element",
        ),
        (|v| v["layers"][2]["instances"][0]["transform"][4] = json!(1e300), "transform is out of range"),
        (
            |v| v["layers"][2]["instances"][1]["id"] = v["layers"][2]["instances"][0]["id"].clone(),
            "used twice",
        ),
        (|v| v["elements"][0]["library"] = json!(7), "elements[0].library is 7"),
    ];
    for (change, message) in changes {
        let mut bad = scene.clone();
        change(&mut bad);
        folder.write("bad.scene.json", serde_json::to_vec(&bad).unwrap());
        folder.run("render bad.scene.json").fails(1, message);
        folder.run("inspect bad.scene.json").fails(1, message);
    }
    // A picture larger than memory is refused before it is drawn.
    let mut large = scene;
    (large["width"], large["height"]) = (json!(100_000), json!(100_000));
    folder.write("large.scene.json", serde_json::to_vec(&large).unwrap());
    folder.run("render large.scene.json --scale 100").fails(1, "too large");
}

#[test]
fn braces_and_not_the_seal_are_blamed() {
    let folder = Folder::with_library();
    let sealed = String::from_utf8(library().to_vec()).unwrap();
    assert!(sealed.contains("\"sha256\":") && sealed.ends_with("}\n"));
    let fails = |text: String, message: &str| {
        folder.write("bad.lib.json", text);
        let run = folder.run("inspect bad.lib.json").fails(1, message);
        assert!(!run.stderr.contains("sha256") && run.stderr.len() < 300, "{}", run.stderr);
    };
    fails(sealed.trim_end().strip_suffix('}').unwrap().into(), "a } is missing");
    fails(format!("{sealed}}}\n"), "a } is too many");
    // If a brace is missing, the seal becomes a field of another object.
    let at = sealed.find("}],\"layers\"").unwrap();
    fails(format!("{}{}", &sealed[..at], &sealed[at + 1..]), "line 1");
    fails(
        sealed.replacen("\"descriptor_half\":", "\"descriptor_haf\":", 1),
        "unknown field `descriptor_haf` at line 1",
    );
}
