//! `vtex edit`, and edits as `vtex inspect` prints them.

use super::support::{Folder, Run};
use serde_json::json;

/// Runs `vtex edit` with operations that hold spaces.
fn edit(folder: &Folder, arguments: &str, operations: &[&str]) -> Run {
    let mut command = folder.command(&format!("edit {arguments}"));
    operations.iter().for_each(|operation| {
        command.args(["--op", operation]);
    });
    command.output().unwrap().into()
}

fn with_scene() -> Folder {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o a.scene.json --size 120 --seed 5").succeeds();
    folder
}

#[test]
fn what_was_done_is_told_by_inspect() {
    let folder = with_scene();
    let chain = ["thin 0.5 --layer secondary", "tint #ff0000 --where area>20"];
    edit(&folder, "a.scene.json -o b.scene.json", &chain[..1]).succeeds();
    edit(&folder, "b.scene.json -o c.scene.json.gz --seed 9", &chain[1..]).succeeds();
    let told = folder.run("inspect c.scene.json.gz --json").succeeds().json();
    let thin = json!({ "thin": { "keep": 0.5, "order": "blue-noise" } });
    let tint = json!({ "tint": { "colour": "#ff0000", "amount": 0.5, "share": 1.0 } });
    let large = json!([{ "compare": { "quantity": "area", "comparison": "more", "limit": 20.0 } }]);
    let records = json!([
        { "operation": { "edit": { "action": thin, "layer": "secondary" } }, "seed": 5 },
        { "operation": { "edit": { "action": tint, "where": large } }, "seed": 9 },
    ]);
    assert_eq!(told["edits"], records);
    let run = folder.run("inspect c.scene.json.gz").succeeds();
    let text = run.text();
    assert!(text.contains("   1  thin keep=0.5 order=blue-noise layer=secondary\n"), "{text}");
    assert!(text.contains("   2  tint amount=0.5 colour=#ff0000 share=1 where area>20 (seed 9)\n"), "{text}");
    assert!(folder.run("inspect a.scene.json --json").succeeds().json().get("edits").is_none());
    let unknown = edit(&folder, "a.scene.json -o d.scene.json", &["thin 0.5 --layer secondry"]);
    let run = unknown.fails(2, "the scene has no layer 'secondry'");
    assert!(run.stderr.contains("--layer takes background, secondary, primary"), "{}", run.stderr);
}

#[test]
fn records_of_older_programs_are_read_and_told() {
    let folder = with_scene();
    let mut scene: serde_json::Value = serde_json::from_slice(&folder.read("a.scene.json")).unwrap();
    scene["edits"] = json!([{ "operation": "tint #ff0000 --amount 0.4", "seed": 5 }]);
    folder.write("old.scene.json", serde_json::to_vec(&scene).unwrap());
    edit(&folder, "old.scene.json -o new.scene.json", &["thin 0.5"]).succeeds();
    let run = folder.run("inspect new.scene.json").succeeds();
    assert!(run.text().contains("   1  tint #ff0000 --amount 0.4\n"), "{}", run.text());
    assert!(run.text().contains("   2  thin keep=0.5 order=blue-noise\n"), "{}", run.text());
}

#[test]
fn what_matches_nothing_is_told() {
    let folder = with_scene();
    let idle = ["delete --where category=77", "recolor --from #00ff00 --to #000000 --reach 0.1"];
    let run = edit(&folder, "a.scene.json -o b.scene.json", &idle).succeeds();
    for operation in idle {
        let said = format!("'{operation}' matches nothing: the scene stays as it was");
        assert!(run.stderr.contains(&said), "{}", run.stderr);
    }
}
