//! `vtex batch`.

use super::support::{Folder, Run, encode, photo};
use serde_json::Value;

/// A folder whose subfolder `photos` holds two photographs and another file.
fn photos() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("photos")).unwrap();
    folder.write("photos/a.png", photo());
    folder.write("photos/b.png", "no picture");
    let turned = image::load_from_memory(&photo()).unwrap().rotate90();
    folder.write("photos/c.PNG", encode(&turned, image::ImageFormat::Png));
    folder.write("photos/notes.txt", "not looked at");
    folder
}

const BATCH: &str = "batch photos --out-dir out --size 60 --segmenter regions";

/// The lines of `--json`: those of the jobs, and the total.
fn lines(run: &Run) -> (Vec<Value>, Value) {
    let mut all: Vec<Value> = run.text().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let total = all.pop().unwrap();
    (all, total)
}

fn statuses(run: &Run) -> Vec<String> {
    lines(run).0.iter().map(|job| job["status"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn canvases_and_pages_are_those_of_a_single_command() {
    let folder = Folder::with_library();
    let swatch = r#"<circle cx="3" cy="3" r="1.2"/><circle cx="9" cy="10" r=".8" fill="red"/>"#;
    let swatch = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 13.9 14.3">{swatch}</svg>"#);
    folder.write("swatch.svg", swatch);
    folder.run("analyze swatch.svg --seed 1").succeeds();
    for (name, options) in [("swatch", ""), ("swatch", "--size 200mm"), ("photo", "--size 300mm --dpi 12")] {
        let shared = format!("--seed 1 {options}");
        folder.run(&format!("batch {name}.lib.json --out-dir out {shared} --force")).succeeds();
        folder.run(&format!("synth {name}.lib.json -o alone.svg {shared} --force")).succeeds();
        assert_eq!(folder.read(&format!("out/{name}.svg")), folder.read("alone.svg"), "{name} {options}");
    }
}

#[test]
fn a_failure_does_not_stop_the_others_and_the_rest_is_resumed() {
    let folder = photos();
    let run = folder.run(&format!("{BATCH} --seed 7"));
    assert_eq!(run.code, Some(1));
    for said in [
        "[2/3] photos/b.png",
        "error: photos/b.png: cannot decode 'photos/b.png'",
        "hint: ",
        "2 done, 0 skipped (done before), 1 failed",
        "1 of 3 jobs failed",
        "hint: mend what the errors say, then run the same again",
    ] {
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    let first = [folder.read("out/a.svg"), folder.read("out/c.svg")];
    // The result of a batch equals that of a single command.
    folder.run("texture photos/a.png --size 60 --segmenter regions --seed 7 -o alone.svg").succeeds();
    assert_eq!(first[0], folder.read("alone.svg"));

    folder.write("photos/b.png", photo());
    std::fs::remove_file(folder.path("out/c.svg")).unwrap();
    let run = folder.run(&format!("{BATCH} --seed 7 --json")).succeeds();
    assert_eq!(statuses(&run), ["skipped", "done", "done"]);
    assert_eq!(first, [folder.read("out/a.svg"), folder.read("out/c.svg")]);
    assert_eq!(lines(&run).1["done"], 2);
    // Jobs with other parameters or another input are done again.
    let run = folder.run(&format!("{BATCH} --seed 8 --json")).succeeds();
    assert_eq!(statuses(&run), ["done"; 3]);
    folder.write("photos/a.png", folder.read("photos/c.PNG"));
    assert_eq!(statuses(&folder.run(&format!("{BATCH} --seed 8 --json"))), ["done", "skipped", "skipped"]);
    assert_eq!(statuses(&folder.run(&format!("{BATCH} --seed 8 --json --force"))), ["done"; 3]);
}

#[test]
fn without_a_seed_what_was_done_with_any_is_skipped() {
    let folder = photos();
    let run = folder.run(&format!("{BATCH} --json"));
    assert_eq!(statuses(&run), ["done", "failed", "done"]);
    let seed = &lines(&run).0[0]["seed"];
    let run = folder.run(&format!("{BATCH} --json"));
    assert_eq!(statuses(&run), ["skipped", "failed", "skipped"]);
    assert_eq!(&lines(&run).0[0]["seed"], seed);
}

#[test]
fn shards_do_all_jobs_between_them() {
    let folder = Folder::with_library();
    for name in ["a", "b", "c"] {
        folder.write(&format!("{name}.lib.json"), folder.read("photo.lib.json"));
    }
    let shard = |i: u32| {
        let line = "batch a.lib.json b.lib.json c.lib.json --out-dir out --size 40 --seed 1 --json";
        let run = folder.run(&format!("{line} --format scene.json,png --shard {i}/2")).succeeds();
        lines(&run).0.iter().map(|j| j["job"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!((shard(1), shard(2)), (vec!["a".into(), "c".into()], vec!["b".into()]));
    assert!(folder.path("out/b.scene.json").is_file() && folder.path("out/b.png").is_file());
    assert!(folder.path("out/batch-2-of-2.jsonl").is_file());
    // A run without shards skips what shards have done.
    let all = "batch a.lib.json b.lib.json c.lib.json --out-dir out --size 40 --seed 1 --json --format png";
    assert_eq!(statuses(&folder.run(all)), ["skipped"; 3]);
}

#[test]
fn jobs_of_a_file_have_parameters_of_their_own() {
    let folder = Folder::with_library();
    std::fs::create_dir(folder.path("list")).unwrap();
    folder.write(
        "list/jobs.toml",
        "seed = 3\n[synth]\nsize = 50\n\n[[job]]\ninput = '../photo.lib.json'\n\n\
         [[job]]\ninput = '../photo.lib.json'\noutput = 'large'\nformat = 'scene.json, svgz'\nseed = 4\n\
         [job.synth]\nsize = '70x60'\n",
    );
    let run = folder.run("batch list/jobs.toml --out-dir out --json").succeeds();
    let (jobs, _) = lines(&run);
    assert_eq!((&jobs[0]["size"], &jobs[0]["seed"]), (&serde_json::json!([50, 50]), &3.into()));
    assert_eq!((&jobs[1]["size"], &jobs[1]["seed"]), (&serde_json::json!([70, 60]), &4.into()));
    assert!(folder.path("out/photo.svg").is_file() && folder.path("out/large.svgz").is_file());
    // The command line takes precedence over the file of jobs.
    let run = folder.run("batch list/jobs.toml --out-dir out --json --size 30").succeeds();
    assert_eq!(lines(&run).0[1]["size"], serde_json::json!([30, 30]));
}

#[test]
fn what_is_wrong_with_the_list_is_told_before_anything_starts() {
    let folder = Folder::with_library();
    let jobs = |text: &str| {
        folder.write("jobs.toml", text);
        folder.run("batch jobs.toml --out-dir out")
    };
    let one = "[[job]]\ninput = 'photo.png'\n";
    jobs("").fails(2, "'jobs.toml' has no jobs");
    jobs("[[job]]\noutput = 'x'").fails(2, "job 1 of 'jobs.toml' has no input");
    let run = jobs(&format!("{one}[job.synth]\nsiez = 3"))
        .fails(2, "job 1 of 'jobs.toml' has an unknown key 'siez' in [synth]");
    assert!(run.stderr.contains("did you mean 'size'?"), "{}", run.stderr);
    jobs(&format!("sede = 3\n{one}")).fails(2, "'jobs.toml' has an unknown key 'sede'");
    jobs(&format!("{one}[job.synth]\nsize = 0")).fails(2, "job 1 of 'jobs.toml': size = 0");
    jobs(&format!("{one}threads = 2")).fails(2, "'threads'");
    jobs(&format!("{one}output = '../x'")).fails(2, "output = \"../x\" is not a file name");
    jobs(&format!("{one}output = \"a\\nb\"")).fails(2, "is not a file name");
    jobs(&format!("{one}format = 'jpg'")).fails(2, "format = \"jpg\": expected svg");
    jobs(&format!("{one}{one}")).fails(2, "would have the same name, 'photo'");
    jobs("[[job]").fails(2, "cannot read 'jobs.toml'");
    folder.run("batch photo.png photo.lib.json --out-dir out").fails(2, "would have the same name, 'photo'");
    folder.run("batch jobs.toml photo.png --out-dir out").fails(2, "must stand alone");
    std::fs::create_dir(folder.path("in")).unwrap();
    folder.write("in/a.lib.json", folder.read("photo.lib.json"));
    folder
        .run("batch in/a.lib.json --out-dir in --format lib.json")
        .fails(2, "an input and a result name the same file");
    folder.run("batch - --out-dir out").fails(2, "standard input");
    folder.run("batch photo.png --out-dir out --shard 3/2").fails(2, "I from 1 to N");
    folder.run("batch photo.png --out-dir out --format gif").fails(2, "expected svg");
    folder.run("batch photo.png").fails(2, "--out-dir");
    std::fs::create_dir(folder.path("empty")).unwrap();
    folder.run("batch empty --out-dir out").fails(2, "there are no pictures and no SVGs in 'empty'");
    assert!(!folder.path("out").exists());
}

#[test]
#[cfg(unix)]
fn a_job_at_which_the_program_died_is_tried_once_more_and_takes_no_other_along() {
    let folder = Folder::with_library();
    folder.write(
        "jobs.toml",
        "seed = 3\n[[job]]\ninput = 'photo.lib.json'\noutput = 'large'\n[job.synth]\nsize = 1000\n\n\
         [[job]]\ninput = 'photo.lib.json'\noutput = 'small'\n[job.synth]\nsize = 40\n",
    );
    let line = "batch jobs.toml --out-dir out";
    let markers = || {
        let all = std::fs::read_dir(folder.path("out")).into_iter().flatten().flatten();
        let names = all.map(|entry| entry.file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(".running")).collect::<Vec<_>>()
    };
    let kill_during = |line: &str| {
        let before = markers();
        let mut child = folder.command(line).stderr(std::process::Stdio::null()).spawn().unwrap();
        let begun = || markers().iter().any(|name| !before.contains(name));
        while !begun() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(begun());
    };
    // A power cut: the job is done in the next run, with a warning.
    let other = "batch photo.lib.json --out-dir out --size 1000 --seed 1";
    kill_during(other);
    let run = folder.run(&format!("{other} --json")).succeeds();
    assert_eq!(statuses(&run), ["done"]);
    assert!(lines(&run).0[0]["warnings"].to_string().contains("another try"), "{}", run.text());
    assert_eq!(statuses(&folder.run(&format!("{other} --json"))), ["skipped"]);

    (0..2).for_each(|_| kill_during(line));
    for again in 0..2 {
        let run = folder.run(&format!("{line} --json"));
        assert_eq!(run.code, Some(1), "{}", run.stderr);
        assert_eq!(statuses(&run), ["failed", ["done", "skipped"][again]]);
        let job = &lines(&run).0[0];
        assert_eq!(job["died"], true);
        assert!(job["error"].as_str().unwrap().contains("killed twice during this job"), "{job}");
        assert!(job["hint"].as_str().unwrap().contains("--force=large"), "{job}");
        assert!(markers().is_empty());
    }
    // With other parameters it is another job.
    let run = folder.run(&format!("{line} --json --size 40")).succeeds();
    assert_eq!(statuses(&run), ["done", "skipped"]);
    // It is forced by its name, alone.
    let run = folder.run(&format!("{line} --force=lrage")).fails(2, "--force=lrage names no job");
    assert!(run.stderr.contains("did you mean 'large'?"), "{}", run.stderr);
    let run = folder.run(&format!("{line} --json --force=large")).succeeds();
    assert_eq!(statuses(&run), ["done", "skipped"]);
}
