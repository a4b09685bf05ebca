//! `vtex edit`, and edits as `vtex inspect` prints them.

use super::support::{Folder, Run, photo};
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

/// Name, members and colour of each category, as `vtex inspect` reports them.
fn categories(folder: &Folder, file: &str) -> Vec<(String, String)> {
    let told = folder.run(&format!("inspect {file} --json")).succeeds().json();
    let of = |c: &serde_json::Value, key: &str| c[key].to_string();
    let listed = told["categories"].as_array().unwrap().iter();
    listed.map(|c| (c["name"].as_str().unwrap().to_owned(), of(c, "colour") + &of(c, "mean_area"))).collect()
}

#[test]
fn names_of_categories_do_not_depend_on_the_seed() {
    let folder = Folder::new();
    folder.write("photo.png", photo());
    for options in ["", "--categories 4"] {
        for seed in [1, 2] {
            folder
                .run(&format!("analyze photo.png -o {seed}.lib.json --seed {seed} --force {options}"))
                .succeeds();
            folder
                .run(&format!("texture photo.png -o {seed}.svg -o {seed}.scene.json --size 120 --seed {seed} --force {options}"))
                .succeeds();
        }
        let [one, two] = [1, 2]
            .map(|seed| vtex::library::Library::read(&folder.path(&format!("{seed}.lib.json"))).unwrap());
        let of = |library: &vtex::library::Library| {
            library.primaries().iter().map(|p| (p.area, p.category)).collect::<Vec<_>>()
        };
        assert_eq!((of(&one), one.category_names()), (of(&two), two.category_names()));
        assert_eq!(categories(&folder, "1.lib.json"), categories(&folder, "2.lib.json"));
        let covered: Vec<f64> = one.categories.iter().map(|c| c.coverage).collect();
        assert!(covered.is_sorted_by(|a, b| a >= b), "{covered:?}");
        let names = [1, 2].map(|seed| {
            let scene = vtex::scene::Scene::read(&folder.path(&format!("{seed}.scene.json"))).unwrap();
            scene.libraries[0].categories.clone()
        });
        assert_eq!(names, [one.category_names(), two.category_names()]);
    }
}

#[test]
fn categories_are_selected_by_name_as_by_number() {
    let folder = with_scene();
    let names: Vec<String> = categories(&folder, "photo.lib.json").into_iter().map(|c| c.0).collect();
    assert!(names.len() > 1, "{names:?}");
    let elements = |text: &str| {
        edit(&folder, "a.scene.json -o b.scene.json --force", &[text]).succeeds();
        vtex::scene::Scene::read(&folder.path("b.scene.json")).unwrap().layers
    };
    let (first, shout) = (&names[0], names[0].to_uppercase());
    let by_number = elements("delete --where category=1");
    assert_eq!(elements(&format!("delete --where 'category={first}'")), by_number);
    assert_eq!(elements(&format!("delete --where category=\"{shout}\"")), by_number);
    assert_eq!(
        elements(&format!("delete --where 'category!={first}|2'")),
        elements("delete --where category!=1|2")
    );
    let unknown = edit(&folder, "a.scene.json -o c.scene.json", &["delete --where category=sky"]);
    let run = unknown.fails(2, "the scene has no category 'sky'");
    assert!(run.stderr.contains(&format!("the categories are {}", names.join(", "))), "{}", run.stderr);
    let told = |exclude: &str| {
        let run = folder.run(&format!(
            "synth photo.lib.json -o d.scene.json --size 120 --seed 5 --force --exclude '{exclude}'"
        ));
        (run.succeeds().stderr, vtex::scene::Scene::read(&folder.path("d.scene.json")).unwrap().layers)
    };
    assert!(told("sky").0.contains(&format!("known are {}", names.join(", "))));
    assert_eq!(told("1").1, told(first).1);
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
