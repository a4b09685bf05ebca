//! `vtex metrics`.

use super::support::Folder;

#[test]
fn a_picture_and_its_copy_are_the_same() {
    let folder = Folder::new();
    let found = folder.run("metrics photo.png photo.png --json").succeeds().json();
    assert_eq!(found["emd_rgb"], 0.0);
    assert_eq!(found["exemplar_size"], serde_json::json!([96, 80]));
    assert!((found["ssim"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    assert!(found["ms_ssim"].is_null() && found["coherence"].is_number(), "{found}");
    let text = folder.run("metrics photo.png photo.png").succeeds().text().to_owned();
    for word in ["emd_lab", "psd_2d", "swd", "lapvar", "acf_peak", "96 x 80 px"] {
        assert!(text.contains(word), "{word} is not in {text}");
    }
}

#[test]
fn whatever_can_be_drawn_is_compared() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 96x80 --seed 1 -o a.scene.json").succeeds();
    folder.run("render a.scene.json -o a.svg").succeeds();
    folder.run("render a.scene.json -o a.png").succeeds();
    let compare = |file: &str| folder.run(&format!("metrics photo.png {file} --json")).succeeds().json();
    let [scene, svg, png] = ["a.scene.json", "a.svg", "a.png"].map(compare);
    assert_eq!(scene["lbp"], png["lbp"]);
    let apart = (scene["emd_rgb"].as_f64().unwrap() - svg["emd_rgb"].as_f64().unwrap()).abs();
    assert!(apart < 1.0, "{apart}");
    // The reconstruction is nearer to the photograph than a texture.
    let library = compare("photo.lib.json");
    assert!(library["ssim"].as_f64() > scene["ssim"].as_f64());
    // What is drawn can be enlarged, a picture cannot.
    for found in [&scene, &svg, &library] {
        let contours = &found["contours"];
        assert!(contours["share"].as_f64() > Some(0.01), "{contours}");
        assert!(contours["spurious"].as_f64() <= contours["share"].as_f64(), "{contours}");
        // Outlines are crisp.
        assert!(contours["width_result"].as_f64() < contours["width_exemplar"].as_f64(), "{contours}");
    }
    assert!(png["contours"].is_null());
    let text = folder.run("metrics photo.png a.svg").succeeds().text().to_owned();
    assert!(text.contains("contours, enlarged") && text.contains("spurious"), "{text}");
    // At twice the size the measures are the same with `--scale 2`.
    folder.run("render a.scene.json -o twice.png --scale 2").succeeds();
    let twice = folder.run("metrics photo.png twice.png --scale 2 --json").succeeds().json();
    assert_eq!(twice["result_size"], serde_json::json!([96, 80]));
    assert!((twice["emd_rgb"].as_f64().unwrap() - png["emd_rgb"].as_f64().unwrap()).abs() < 2.0);
}

#[test]
fn a_library_and_its_scene_are_compared_by_their_elements() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json --size 200x160 --seed 1 -o a.scene.json").succeeds();
    let found = folder.run("metrics photo.lib.json a.scene.json --json").succeeds().json();
    let share = |of: &str| found["coverage"][of].as_f64().unwrap();
    assert!((share("exemplar") - share("result")).abs() < 0.1, "{found}");
    assert!(found["repetition"]["textons"].as_u64() > Some(1), "{found}");
    assert_eq!(
        found["correlation"]["distances"].as_array().unwrap().len(),
        found["correlation"]["curves"][0]["result"].as_array().unwrap().len()
    );
    let text = folder.run("metrics photo.lib.json a.scene.json").succeeds().text().to_owned();
    assert!(text.contains("coverage") && text.contains("primaries used"), "{text}");
    // A library of another photograph.
    let other = String::from_utf8(folder.read("photo.lib.json")).unwrap();
    let sum = serde_json::from_str::<serde_json::Value>(&other).unwrap()["source"]["sha256"].clone();
    folder.write("other.lib.json", other.replace(sum.as_str().unwrap(), &"0".repeat(64)));
    folder.run("metrics other.lib.json a.scene.json").fails(1, "was not made from 'other.lib.json'");
    folder.run("metrics photo.lib.json a.scene.json --scale 2").fails(2, "--scale is for pictures");
}

#[test]
fn what_cannot_be_compared_is_told() {
    let folder = Folder::new();
    folder.write("bad.png", "no picture");
    folder.run("metrics photo.png bad.png").fails(1, "cannot decode 'bad.png'");
    folder.run("metrics none.png photo.png").fails(1, "cannot read 'none.png'");
    folder.run("metrics - -").fails(2, "'-' stands for more than one file");
    folder.run("metrics photo.png photo.png --scale 0").fails(2, "expected 0.01 to 100");
    folder.run("metrics photo.png photo.png --scale 10").fails(1, "'result' cannot be analysed");
}
