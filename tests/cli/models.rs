//! `models`, `doctor` and `--segmenter sam`, with the small networks of `tests/networks`.

use super::support::{Folder, Run, photo};

/// A folder that also holds some of the networks.
fn folder(networks: &[&str]) -> Folder {
    let folder = Folder::new();
    for name in networks {
        let path = format!("{}/tests/networks/{name}.onnx", env!("CARGO_MANIFEST_DIR"));
        folder.write(&format!("{name}.onnx"), std::fs::read(path).unwrap());
    }
    folder
}

const PAIR: &str = "models add sam_encoder.onnx sam_decoder.onnx --engine rten --name tiny";

#[test]
fn models_come_and_go() {
    let folder = folder(&["sam_encoder", "sam_decoder", "efficient_both"]);
    let none = folder.run("models list --json").succeeds().json();
    assert_eq!((&none["command"], &none["models"]), (&"models list".into(), &serde_json::json!([])));
    assert!(!folder.path("models").exists());
    folder.run(PAIR).succeeds();
    folder.run("models add efficient_both.onnx --engine rten --name other").succeeds();
    let list = folder.run("models list --json").succeeds().json()["models"].take();
    assert_eq!((&list[0]["name"], &list[0]["kind"]), (&"other".into(), &"EfficientSAM".into()));
    assert_eq!((&list[1]["name"], &list[1]["kind"]), (&"tiny".into(), &"SAM".into()));
    let file = &list[1]["files"][0];
    assert_eq!(
        (&file["file"], &file["role"], &file["bytes"]),
        (&"sam_encoder.onnx".into(), &"encoder".into(), &290.into())
    );
    assert_eq!(folder.read("models/tiny/sam_decoder.onnx"), folder.read("sam_decoder.onnx"));
    folder.run("models verify").succeeds();

    // An existing model is replaced only with `--force`.
    folder.run(PAIR).fails(1, "there is a model 'tiny' already");
    folder.run("models add efficient_both.onnx --engine rten --name tiny --force").succeeds();
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path("models/tiny")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["efficient_both.onnx", "model.json"]);

    folder.run("models remove tiny").succeeds();
    folder.run("models remove tiny").fails(1, "there is no model 'tiny'");
    folder.run("models remove other").succeeds();
    assert_eq!(std::fs::read_dir(folder.path("models")).unwrap().count(), 0);
}

#[test]
fn files_that_changed_are_found() {
    let folder = folder(&["sam_encoder", "sam_decoder"]);
    folder.run(PAIR).succeeds();
    let path = folder.path("models/tiny/sam_decoder.onnx");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[100] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    std::fs::remove_file(folder.path("models/tiny/sam_encoder.onnx")).unwrap();
    let run = folder.run("models verify").fails(1, "2 of 2 files are not as they were added");
    assert!(run.text().contains("tiny/sam_decoder.onnx: CHANGED"), "{}", run.text());
    assert!(run.text().contains("tiny/sam_encoder.onnx: MISSING"), "{}", run.text());

    for description in [
        "",
        "{}",
        r#"{"format":"vtex-model","version":1,"name":"tiny","kind":"SAM","files":[{"file":"../../photo.png","role":"both","bytes":1,"sha256":""}]}"#,
    ] {
        folder.write("models/tiny/model.json", description);
        for arguments in
            ["models list", "models verify", "models remove tiny", "analyze photo.png --segmenter sam"]
        {
            folder.run(arguments).fails(1, "does not describe a model");
        }
        folder.run("doctor --engine rten").succeeds();
    }
    assert!(folder.path("photo.png").exists());
}

#[test]
fn what_cannot_be_added_leaves_nothing_behind() {
    let folder = folder(&["sam_encoder", "sam_decoder", "sam2_decoder", "product"]);
    folder.write("broken.onnx", "hello");
    folder.write("notes.txt", "hello");
    folder.run(PAIR).succeeds();
    for (files, message) in [
        ("product.onnx", "Its signature is\n  a [?×300], b [300×?]"),
        ("sam_encoder.onnx", "the decoder is missing"),
        (
            "sam_encoder.onnx sam2_decoder.onnx",
            "'sam_encoder.onnx' is an encoder of SAM, 'sam2_decoder.onnx' is",
        ),
        ("broken.onnx", "'broken.onnx': rten cannot read it"),
        ("none.onnx", "cannot read 'none.onnx'"),
        ("notes.txt", "none of notes.txt is an ONNX file"),
        ("sam_encoder.onnx sam_encoder.onnx", "two files of a model would be called 'sam_encoder.onnx'"),
    ] {
        let run =
            folder.run(&format!("models add {files} --engine rten --name tiny --force")).fails(1, message);
        assert!(run.stderr.contains("hint: "), "{files}: {}", run.stderr);
        let left: Vec<_> =
            std::fs::read_dir(folder.path("models")).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["tiny"], "{files}");
        folder.run("models verify").succeeds();
    }
    folder.run("models add sam_encoder.onnx --name ../x").fails(2, "expected letters");
}

#[test]
fn masks_come_from_a_model_or_from_files() {
    let folder = folder(&["sam_encoder", "sam_decoder", "efficient_encoder", "efficient_decoder"]);
    let analyze = |more: &str| -> Run {
        folder.run(&format!(
            "analyze photo.png --engine rten --segmenter sam --force -o a.lib.json --seed 1 {more}"
        ))
    };
    analyze("").fails(1, "there is no model of Segment Anything");
    folder.run(PAIR).succeeds();
    let of = |run: Run| {
        run.succeeds();
        folder.read("a.lib.json")
    };
    let alone = of(analyze("-q"));
    let library: serde_json::Value = serde_json::from_slice(&alone).unwrap();
    assert_eq!(library["source"]["segmenter"], "sam");
    for more in ["--model tiny -t 1", "--encoder sam_encoder.onnx --decoder sam_decoder.onnx -t 2"] {
        assert!(of(analyze(more)) == alone, "{more}");
    }
    let run = analyze("-v --encoder efficient_encoder.onnx --decoder efficient_decoder.onnx").succeeds();
    assert!(run.stderr.contains("EfficientSAM, run by rten"), "{}", run.stderr);

    folder.run("models add sam_encoder.onnx sam_decoder.onnx --engine rten --name b").succeeds();
    analyze("").fails(2, "there are several models: b, tiny");
    analyze("--model none").fails(1, "there is no model 'none'");
    analyze("--encoder sam_encoder.onnx --decoder efficient_decoder.onnx").fails(1, "do not go together");
    analyze("--encoder photo.png").fails(1, "rten cannot read it");
    folder.run("analyze photo.png --model tiny").fails(2, "are for --segmenter sam");
    folder
        .run("analyze photo.png --segmenter sam --model tiny --onnxruntime photo.png")
        .fails(1, "cannot be loaded");
}

#[test]
fn the_doctor_tells_what_there_is_and_what_is_missing() {
    let folder = folder(&["sam_encoder", "sam_decoder"]);
    let report = folder.run("doctor --engine rten --threads 3 --json").succeeds().json();
    assert_eq!(report["command"], "doctor");
    assert_eq!((&report["engine"], &report["threads"]), (&"rten".into(), &3.into()));
    assert!(report["missing"][0].as_str().unwrap().contains("vtex models add"), "{report}");
    folder.run(PAIR).succeeds();
    let report = folder.run("doctor --engine rten --json").succeeds().json();
    assert_eq!((&report["models"][0]["name"], &report["missing"]), (&"tiny".into(), &serde_json::json!([])));
    let sum = report["models"][0]["files"][1]["sha256"].as_str().unwrap().to_owned();
    assert!(folder.run("doctor").succeeds().text().contains(&sum));
    let report = folder.run("doctor --onnxruntime photo.png --json").succeeds().json();
    assert!(report["missing"][0].as_str().unwrap().contains("cannot be loaded"), "{report}");
    assert!(report.get("engine").is_none(), "{report}");
}

#[test]
fn a_batch_notices_a_changed_network() {
    let folder = folder(&["sam_encoder", "sam_decoder"]);
    folder.write("photo.png", photo());
    let status = || {
        let line = "batch photo.png --out-dir out --size 40 --seed 1 --json --segmenter sam --engine rten \
                    --encoder sam_encoder.onnx --decoder sam_decoder.onnx";
        let run = folder.run(line);
        let first = run.text().lines().next().unwrap().to_owned();
        serde_json::from_str::<serde_json::Value>(&first).unwrap()["status"].as_str().unwrap().to_owned()
    };
    assert_eq!([status(), status()], ["done", "skipped"]);
    // By its name, the file may hold weights of the encoder.
    folder.write("sam_encoder.onnx.data", "more");
    assert_eq!([status(), status()], ["done", "skipped"]);
    folder.write("sam_encoder.onnx", "no network");
    assert_eq!(status(), "failed");
}

#[test]
fn what_is_no_model_is_said() {
    let folder = folder(&["sam_encoder", "sam_decoder"]);
    folder.run(PAIR).succeeds();
    std::fs::remove_file(folder.path("models/tiny/model.json")).unwrap();
    let run = folder.run("models verify").fails(1, "1 of 1 files are not as they were added");
    assert!(run.text().contains("tiny/model.json: MISSING"), "{}", run.text());
    let run = folder.run("models add photo.png --name photo").fails(1, "none of photo.png is an ONNX file");
    assert!(run.stderr.contains("hint: name encoder.onnx"), "{}", run.stderr);
    for device in ["con", "NUL", "com1", "lpt9"] {
        folder.run(&format!("models add sam_encoder.onnx --name {device}")).fails(2, "a device");
    }
    folder.run("models add sam_encoder.onnx sam_decoder.onnx --engine rten --name com").succeeds();
}
