//! `vtex inspect -o`: the page, its photograph, and refusals.

use super::support::Folder;

/// The ids of the pictures on a page.
fn pictures(page: &[u8]) -> Vec<String> {
    let text = std::str::from_utf8(page).unwrap();
    assert!(text.starts_with("<!DOCTYPE html>\n<!-- Written by vtex "));
    let tags = text.split("<script type=\"text/plain\" id=\"").skip(1);
    tags.map(|tag| tag.split('"').next().unwrap().to_owned()).collect()
}

#[test]
fn a_page_shows_what_is_given_and_found() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o out.scene.json --size 120 --seed 3").succeeds();
    let told = folder.run("inspect photo.lib.json out.scene.json -o report.html --json").succeeds().json();
    assert_eq!((&told["command"], &told["output"]), (&"inspect".into(), &"report.html".into()));
    let page = folder.read("report.html");
    assert_eq!(told["bytes"], page.len());
    assert_eq!(pictures(&page), ["photo-0", "textons-0", "result"]);
    // Neither the order of the files matters, nor beside which of them the photograph is.
    let swapped = folder.run("inspect out.scene.json photo.lib.json -o -").succeeds().stdout;
    assert_eq!(swapped, page);
    // A page of vtex is replaced, a foreign one is not.
    folder.run("inspect out.scene.json -o report.html").succeeds();
    folder.write("mine.html", "<!DOCTYPE html>\n<p>mine</p>");
    folder.run("inspect out.scene.json -o mine.html").fails(1, "was not written by vtex");
    folder.run("inspect out.scene.json -o mine.html --force").succeeds();
}

#[test]
fn the_photograph_is_the_one_that_was_analysed() {
    let folder = Folder::with_library();
    let named = folder.run("inspect photo.lib.json -o named.html --exemplar photo.png").succeeds();
    assert!(!named.stderr.contains("warning"), "{}", named.stderr);
    std::fs::rename(folder.path("photo.png"), folder.path("moved.png")).unwrap();
    folder.run("inspect photo.lib.json -o none.html").succeeds();
    assert_eq!(pictures(&folder.read("none.html")), ["textons-0"]);
    folder.run("inspect photo.lib.json -o moved.html --exemplar moved.png").succeeds();
    assert_eq!(pictures(&folder.read("moved.html")), ["photo-0", "textons-0"]);
    // Another file with the name of the photograph.
    let mut other = folder.read("moved.png");
    other.push(0);
    folder.write("photo.png", other);
    folder.run("inspect photo.lib.json -o other.html").succeeds();
    assert_eq!(pictures(&folder.read("other.html")), ["textons-0"]);
    let told = folder.run("inspect photo.lib.json -o other.html --exemplar photo.png").succeeds();
    assert!(told.stderr.contains("'photo.png' is not the photograph"), "{}", told.stderr);
}

#[test]
fn a_name_does_not_lead_to_other_folders() {
    let folder = Folder::with_library();
    let text = String::from_utf8(folder.read("photo.lib.json")).unwrap();
    std::fs::create_dir(folder.path("inner")).unwrap();
    folder.write("inner/photo.lib.json", text.replace("\"photo.png\"", "\"../photo.png\""));
    folder.run("inspect inner/photo.lib.json -o report.html").succeeds();
    assert_eq!(pictures(&folder.read("report.html")), ["textons-0"]);
}

#[test]
fn what_makes_no_page_is_refused() {
    let folder = Folder::with_library();
    folder.run("synth photo.lib.json -o out.scene.json --size 60 --seed 3").succeeds();
    for (arguments, code, message) in [
        ("inspect photo.lib.json out.scene.json", 2, "several files are shown on a page only"),
        ("inspect photo.lib.json -o report.txt", 2, "cannot tell the format"),
        ("inspect out.scene.json out.scene.json -o a.html", 2, "is a second scene"),
        ("inspect - - -o a.html", 2, "'-' stands for more than one file"),
        ("inspect photo.png -o a.html", 1, "contains an image"),
        ("inspect photo.lib.json -o a.html --exemplar none.png", 1, "cannot read 'none.png'"),
        ("inspect photo.lib.json -o a.html --exemplar out.scene.json", 1, "contains a scene"),
        ("inspect photo.lib.json -o missing/a.html", 1, "cannot write"),
    ] {
        folder.run(arguments).fails(code, message);
    }
    let run = folder.run("inspect photo.lib.json --exemplar photo.png");
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert!(!folder.names().iter().any(|name| name.ends_with(".html")));
}
