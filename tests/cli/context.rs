//! `vtex synth --context`: a region is filled beside a drawing that stays.
#![cfg(feature = "curves")]

use super::support::Folder;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use vtex::geometry::{BezPath, Outline, PathEl, Point, Vec2, parse_path};
use vtex::import::as_drawn;
use vtex::output::svg;
use vtex::synth::reconstruct;

/// Four waves in four colours.
const COLOURED: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 120 80" width="480" height="320">
<rect width="100%" height="100%" fill="#f4efe6"/><g fill="none" stroke-width="3">
<path stroke="#2f5d62" d="M-60 15c20 0 40-10 60-10s40 10 60 10s40-10 60-10s40 10 60 10"/>
<path stroke="#e07a5f" d="M-60 35c20 0 40-10 60-10s40 10 60 10s40-10 60-10s40 10 60 10"/>
<path stroke="#81b29a" d="M-60 55c20 0 40-10 60-10s40 10 60 10s40-10 60-10s40 10 60 10"/>
<path stroke="#f2cc8f" d="M-60 75c20 0 40-10 60-10s40 10 60 10s40-10 60-10s40 10 60 10"/></g></svg>"##;

fn svg_of(size: [u32; 2], inner: &str) -> String {
    let [w, h] = size;
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}">{inner}</svg>"#)
}

/// A path with its curves as forty lines each.
fn flatten(path: &BezPath, mut each: impl FnMut(PathEl)) {
    let mut at = Point::ORIGIN;
    for element in path.elements() {
        match *element {
            PathEl::CurveTo(b, c, d) => (1..=40).for_each(|k| {
                let t = f64::from(k) / 40.0;
                let [p, q, r] = [at.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
                each(PathEl::LineTo(p.lerp(q, t).lerp(q.lerp(r, t), t)));
            }),
            other => each(other),
        }
        at = element.end_point().unwrap_or(at);
    }
}

/// A drawing, its left half as another, the region of the right half, and the ends of lines at the border.
struct Halved {
    ends: Vec<Point>,
}

impl Halved {
    /// Writes `whole.svg`, `whole.lib.json`, `half.svg` and `region.svg`.
    fn new(folder: &Folder, drawing: &str) -> Self {
        folder.write("whole.svg", drawing);
        folder.run("analyze whole.svg -o whole.lib.json").succeeds();
        let library = as_drawn(drawing.as_bytes(), "whole.svg", &()).unwrap();
        let size = [library.source.width, library.source.height];
        let [w, h] = size.map(f64::from);
        // Beside all points of the drawings.
        let border = (w / 2.0).floor() + 0.37;
        let (mut inner, mut ends) = (String::new(), Vec::new());
        for shape in library.primaries().iter().flat_map(|e| &e.shapes) {
            let Some(line) = &shape.line else { continue };
            let mut parts: Vec<Vec<Point>> = Vec::new();
            let mut last: Option<Point> = None;
            flatten(line.path.path(), |element| match (element, last) {
                (PathEl::LineTo(b), Some(a)) => {
                    let t = (border - a.x) / (b.x - a.x);
                    let cut = Point::new(border, a.y + t * (b.y - a.y));
                    match (a.x <= border, b.x <= border, parts.last_mut()) {
                        (true, true, Some(part)) => part.push(b),
                        (true, false, Some(part)) if a.x < border => {
                            part.push(cut);
                            ends.push(cut);
                        }
                        (false, true, _) if b.x < border => {
                            parts.push(vec![cut, b]);
                            ends.push(cut);
                        }
                        _ => {}
                    }
                    last = Some(b);
                }
                (PathEl::MoveTo(a), _) => {
                    parts.push(vec![a]);
                    last = Some(a);
                }
                _ => last = None,
            });
            for part in parts.iter().filter(|p| p.len() > 1) {
                let points: Vec<String> = part.iter().map(|p| format!("{:.4} {:.4}", p.x, p.y)).collect();
                let (colour, width) = (shape.colour, line.width);
                inner += &format!(
                    r#"<path fill="none" stroke="{colour}" stroke-width="{width}" d="M{}"/>"#,
                    points.join("L")
                );
            }
        }
        folder.write("half.svg", svg_of(size, &inner));
        folder.write("region.svg", svg_of(size, &format!(r#"<path d="M{border} 0H{w}V{h}H{border}z"/>"#)));
        ends.retain(|p| p.y > 1.0 && p.y < h - 1.0);
        Self { ends }
    }
}

fn group<'a>(document: &'a Document<'_>, id: &str) -> Node<'a, 'a> {
    document.descendants().find(|n| n.attribute("id") == Some(id)).unwrap_or_else(|| panic!("no group {id}"))
}

/// Paths within a group: data, colour and width.
fn paths(group: Node<'_, '_>) -> Vec<[String; 3]> {
    let of = |n: Node<'_, '_>| ["d", "stroke", "stroke-width"].map(|a| n.attribute(a).unwrap_or("").into());
    group.descendants().filter(|n| n.has_tag_name("path")).map(of).collect()
}

/// The first and last points of paths.
fn ends_of(paths: &[[String; 3]]) -> Vec<Point> {
    let of = |path: &[String; 3]| {
        let path = parse_path(&path[0]).unwrap();
        let points: Vec<Point> = path.elements().iter().filter_map(PathEl::end_point).collect();
        [points[0], points[points.len() - 1]]
    };
    paths.iter().flat_map(of).collect()
}

#[test]
fn lines_go_on_and_the_drawing_stays() {
    let example = |name: &str| {
        std::fs::read_to_string(format!("{}/examples/drawings/{name}.svg", env!("CARGO_MANIFEST_DIR")))
            .unwrap()
    };
    // Ends that lead into the region and those that go on; ends at the border and those that are met.
    let (mut all_leading, mut all_continued, mut all_ends, mut all_joined) = (0, 0, 0, 0);
    for (name, drawing) in
        [("coloured", COLOURED.into()), ("cells", example("cells")), ("bricks", example("bricks"))]
    {
        let folder = Folder::new();
        let Halved { ends } = Halved::new(&folder, &drawing);
        let run = folder
            .run("synth whole.lib.json --context half.svg --region region.svg -o out.svg --expand --seed 1 --json")
            .succeeds();
        let [leading, continued] = [0, 1].map(|k| run.json()["curves"]["continued"][k].as_u64().unwrap());
        assert!(ends.len() >= 4 && leading as usize >= ends.len() - 1, "{name}: {leading} of {}", ends.len());
        (all_leading, all_continued) = (all_leading + leading, all_continued + continued);
        let text = String::from_utf8(folder.read("out.svg")).unwrap();
        let document = Document::parse(&text).unwrap();
        let predicted = paths(group(&document, "layer-predicted"));
        let found = ends_of(&predicted);
        // Numbers have one decimal in both drawings.
        let joined = ends.iter().filter(|e| found.iter().any(|f| f.distance(**e) < 0.15)).count();
        (all_ends, all_joined) = (all_ends + ends.len(), all_joined + joined);
        // The paths of the drawing are those that it has when it is written alone.
        let half = as_drawn(&folder.read("half.svg"), "half.svg", &()).unwrap();
        let (mut alone, options) = (Vec::new(), svg::SvgOptions { expand: true, ..Default::default() });
        svg::write(&reconstruct(&half), &options, &mut alone).unwrap();
        let alone = String::from_utf8(alone).unwrap();
        let alone = paths(group(&Document::parse(&alone).unwrap(), "primary"));
        assert!(alone.len() >= 4 && alone == paths(group(&document, "layer-drawn")), "{name}");
        // Every path that was made is told from them, by class and number.
        let groups: Vec<Node<'_, '_>> =
            group(&document, "layer-predicted").children().filter(Node::is_element).collect();
        assert_eq!(groups.len(), predicted.len());
        for made in groups {
            assert!(made.attribute("class").unwrap().split(' ').any(|class| class == "predicted"));
            let id = made.attribute("data-vtex-id").unwrap();
            assert_eq!(made.attribute("id"), Some(format!("p{id}").as_str()));
        }
    }
    assert!(all_continued as f64 >= 0.9 * all_leading as f64, "{all_continued} of {all_leading}");
    assert!(all_joined as f64 >= 0.9 * all_ends as f64, "{all_joined} of {all_ends}");
}

#[test]
fn other_seeds_change_only_what_is_made_and_threads_nothing() {
    let folder = Folder::new();
    Halved::new(&folder, COLOURED);
    let make = |name: &str, options: &str| {
        let arguments =
            format!("synth whole.lib.json --context half.svg --region region.svg -o {name} {options}");
        folder.run(&arguments).succeeds();
        String::from_utf8(folder.read(name)).unwrap()
    };
    let one = make("one.svg", "--seed 1 --threads 1");
    assert!(one == make("again.svg", "--seed 1 --threads 2"));
    let other = make("other.svg", "--seed 2");
    let part = |text: &str, id: &str| {
        let document = Document::parse(text).unwrap();
        text[group(&document, id).range()].to_owned()
    };
    assert_eq!(part(&one, "layer-drawn"), part(&other, "layer-drawn"));
    assert_ne!(part(&one, "layer-predicted"), part(&other, "layer-predicted"));
}

/// The least and greatest x of the paths in a layer.
fn reach(text: &str, layer: &str) -> [f64; 2] {
    let document = Document::parse(text).unwrap();
    let xs = paths(group(&document, layer)).into_iter().flat_map(|p| {
        let path = parse_path(&p[0]).unwrap();
        path.elements().iter().filter_map(PathEl::end_point).map(|p| p.x).collect::<Vec<f64>>()
    });
    xs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

#[test]
fn a_region_is_made_anew_between_the_lines_around_it() {
    let folder = Folder::new();
    let Halved { ends } = Halved::new(&folder, COLOURED);
    let arguments = "synth whole.lib.json --context whole.svg --region region.svg --anew -o out.svg";
    let run = folder.run(&format!("{arguments} --expand --json")).succeeds();
    let [leading, continued] = [0, 1].map(|k| run.json()["curves"]["continued"][k].as_u64().unwrap());
    assert!(leading as usize >= ends.len() && continued as f64 >= 0.9 * leading as f64);
    let text = String::from_utf8(folder.read("out.svg")).unwrap();
    let border = ends[0].x;
    // Numbers have one decimal.
    assert!((reach(&text, "layer-drawn")[1] - border).abs() < 0.06);
    let [first, last] = reach(&text, "layer-predicted");
    assert!((first - border).abs() < 0.06 && last >= 480.0, "{first} to {last}");
}

#[test]
fn a_part_of_the_library_is_copied_to_the_region() {
    let folder = Folder::new();
    let cells = format!("{}/examples/drawings/cells.svg", env!("CARGO_MANIFEST_DIR"));
    let cells = std::fs::read_to_string(cells).unwrap();
    folder.write("whole.svg", &cells);
    folder.run("analyze whole.svg -o whole.lib.json").succeeds();
    let disc = |x: u32, y: u32| svg_of([300, 300], &format!(r#"<circle cx="{x}" cy="{y}" r="60"/>"#));
    folder.write("here.svg", disc(110, 110));
    folder.write("there.svg", disc(190, 180));
    folder.write("corner.svg", svg_of([300, 300], r##"<path stroke="#533" stroke-width="3" d="M1 1v2"/>"##));
    let mut points: Vec<Point> = Vec::new();
    for shape in
        as_drawn(cells.as_bytes(), "cells.svg", &()).unwrap().primaries().iter().flat_map(|e| &e.shapes)
    {
        let mut last = Point::ORIGIN;
        flatten(shape.line.as_ref().unwrap().path.path(), |element| {
            let at = element.end_point().unwrap();
            if matches!(element, PathEl::LineTo(_)) {
                points.extend((0..100).map(|k| last.lerp(at, f64::from(k) / 100.0)));
            }
            last = at;
        });
    }
    // Share of the points of what is made that lie on lines of the drawing, as far away as the two discs.
    let alike = |options: &str| {
        let files = "synth whole.lib.json --context corner.svg --region there.svg -o out.svg";
        folder.run(&format!("{files} --expand --force --seed 2 {options}")).succeeds();
        let text = String::from_utf8(folder.read("out.svg")).unwrap();
        let document = Document::parse(&text).unwrap();
        let (mut on, mut all) = (0.0, 0.0);
        for [d, ..] in paths(group(&document, "layer-predicted")) {
            flatten(&parse_path(&d).unwrap(), |element| {
                let at = element.end_point().unwrap() - Vec2::new(80.0, 70.0);
                let near = points.iter().any(|p| p.distance(at) < 3.0);
                (on, all) = (on + f64::from(u8::from(near)), all + 1.0);
            });
        }
        assert!(all > 20.0);
        on / all
    };
    let (copied, by_chance) = (alike("--source here.svg"), alike(""));
    assert!(copied > 0.9 && by_chance < 0.6, "{copied} and {by_chance}");
    folder.write("beyond.svg", svg_of([300, 300], r#"<path d="M500 0h40v40h-40z"/>"#));
    let beyond = "synth whole.lib.json --context corner.svg --region there.svg --source beyond.svg -o x.svg";
    folder.run(beyond).fails(1, "outside the canvas");
    folder.run("synth whole.lib.json --anew -o x.svg").fails(2, "--context");
    folder.run("synth whole.lib.json --source here.svg -o x.svg").fails(2, "--context");
}

#[test]
fn predicted_lines_are_taken_away_by_their_numbers() {
    let folder = Folder::new();
    Halved::new(&folder, COLOURED);
    folder.run("synth whole.lib.json --context half.svg --region region.svg -o a.scene.json").succeeds();
    folder.run("render a.scene.json -o a.svg").succeeds();
    let numbers = |name: &str| -> BTreeSet<String> {
        let text = String::from_utf8(folder.read(name)).unwrap();
        let document = Document::parse(&text).unwrap();
        let of = |n: Node<'_, '_>| n.attribute("data-vtex-id").map(Into::into);
        document.descendants().filter_map(of).collect()
    };
    let made = numbers("a.svg");
    let rejected: Vec<&str> = made.iter().take(2).map(String::as_str).collect();
    assert!(made.len() > 2);
    let operation = format!("delete --where id={}", rejected.join("|"));
    folder.run(&format!("edit a.scene.json -o b.svg --op '{operation}'")).succeeds();
    let kept: BTreeSet<String> = made.iter().skip(2).cloned().collect();
    assert_eq!(numbers("b.svg"), kept);
    let drawn = |name: &str| {
        let text = String::from_utf8(folder.read(name)).unwrap();
        paths(group(&Document::parse(&text).unwrap(), "layer-drawn"))
    };
    assert_eq!(drawn("a.svg"), drawn("b.svg"));
    folder.run("edit a.scene.json -o c.svg --op 'delete --layer predicted'").succeeds();
    assert!(numbers("c.svg").is_empty() && drawn("c.svg") == drawn("a.svg"));
}

#[test]
fn the_canvas_is_the_page_unless_a_size_is_given() {
    let folder = Folder::new();
    Halved::new(&folder, COLOURED);
    let size = |options: &str| {
        let arguments =
            format!("synth whole.lib.json --context half.svg --region region.svg -o a.svg --json {options}");
        folder.run(&arguments).succeeds().json()["size"].clone()
    };
    assert_eq!(size(""), serde_json::json!([480, 320]));
    assert_eq!(size("--size 600x400"), serde_json::json!([600, 400]));
}

#[test]
fn what_cannot_be_filled_is_refused() {
    let folder = Folder::with_library();
    Halved::new(&folder, COLOURED);
    let size = [480, 320];
    folder.write("outside.svg", svg_of(size, r#"<path d="M500 0h40v40h-40z"/>"#));
    folder.write("nothing.svg", svg_of(size, ""));
    folder.write("hair.svg", svg_of(size, r#"<path d="M300 100h.1v.1h-.1z"/>"#));
    folder.write("gap.svg", svg_of(size, r#"<path d="M300 10h4v4h-4z"/>"#));
    folder.write("blank.svg", svg_of(size, r##"<rect x="9" y="9" width="90" height="80" fill="#123"/>"##));
    folder.write(
        "picture.svg",
        svg_of(size, r#"<filter id="f"><feGaussianBlur/></filter><path filter="url(#f)" d="M0 0h9v9z"/>"#),
    );
    let fails = |options: &str, code: i32, message: &str| {
        let run = folder.run(&format!("synth -o x.svg {options}")).fails(code, message);
        assert!(run.stderr.contains("hint: ") || run.stderr.contains("Usage"), "{}", run.stderr);
        assert!(!folder.path("x.svg").exists());
    };
    let beside = "whole.lib.json --context half.svg";
    fails(beside, 2, "--region");
    fails("whole.lib.json --region region.svg", 2, "--context");
    fails(&format!("{beside} --region outside.svg"), 1, "outside the canvas");
    fails(&format!("{beside} --region nothing.svg"), 1, "no visible shape");
    fails(&format!("{beside} --region hair.svg"), 1, "encloses no area");
    fails(&format!("{beside} --region gap.svg"), 2, "region = 4 x 4");
    fails(
        "whole.lib.json --context blank.svg --region region.svg",
        1,
        "'blank.svg' cannot be used as a context",
    );
    fails("whole.lib.json --context picture.svg --region region.svg", 1, "has a filter");
    fails("whole.lib.json --context photo.png --region region.svg", 1, "contains an image");
    let both = format!("{beside} --region region.svg");
    fails(&format!("{both} --method clustered"), 2, "whose elements end");
    fails(&format!("{both} --method period"), 2, "--context is for --method curves and clustered");
    fails(&format!("{both} --tile"), 2, "--context does not go with --tile");
    fails(&format!("{both} --domain region.svg"), 2, "--domain");
    fails("whole.lib.json photo.lib.json --map photo.png --context half.svg --region region.svg", 2, "--map");
    fails("whole.lib.json photo.lib.json --context half.svg --region region.svg", 2, "a single library");
    let photograph = folder.run("synth photo.lib.json -o x.svg --context half.svg --region region.svg");
    photograph.fails(2, "method = curves cannot be used here: it works for a drawing");
}

/// Twelve leaves and discs with a dot each, on a page that repeats.
fn leaves() -> String {
    let mut inner = String::from(r##"<rect width="100%" height="100%" fill="#fff8ee"/>"##);
    for k in 0..12u32 {
        let (x, y) = (30 + 60 * (k % 4) + 7 * (k * k % 5), 30 + 60 * (k / 4) + 5 * (k * 3 % 7));
        inner += &match k % 3 {
            0 => format!(
                r##"<g><circle cx="{x}" cy="{y}" r="15" fill="#c1440e"/><circle cx="{}" cy="{y}" r="5" fill="#222"/></g>"##,
                x + 4
            ),
            _ => format!(r##"<path d="M{x} {y}m-18 0q18-20 36 0q-18 20-36 0z" fill="#2a7f4f"/>"##),
        };
    }
    svg_of([240, 180], &inner)
}

#[cfg(feature = "clustered")]
#[test]
fn elements_fit_to_those_that_stand() {
    let folder = Folder::new();
    folder.write("leaves.svg", leaves());
    folder.run("analyze leaves.svg -o leaves.lib.json --seed 1").succeeds();
    folder.run("texture leaves.svg -o whole.svg --size 720x540 --variation 0 --seed 1").succeeds();
    folder.write("hole.svg", svg_of([720, 540], r#"<circle cx="350" cy="270" r="150"/>"#));
    let arguments = "synth leaves.lib.json --context whole.svg --region hole.svg --anew --seed 2 --expand";
    let run = folder.run(&format!("{arguments} -o a.svg --json --threads 1")).succeeds();
    assert_eq!(run.json()["method"], "clustered");
    // What stands around the hole is known, elements of two shapes, too, but where the page ends within them.
    let [known, all] = [0, 1].map(|k| run.json()["clusters"]["recognised"][k].as_u64().unwrap());
    assert!(known > 60 && known as f64 >= 0.9 * all as f64, "{known} of {all}");
    folder.run(&format!("{arguments} -o b.svg --threads 2")).succeeds();
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    let text = String::from_utf8(folder.read("a.svg")).unwrap();
    let document = Document::parse(&text).unwrap();
    let places = |layer: &str| -> Vec<(String, Point)> {
        let of = |n: Node<'_, '_>| {
            let path = parse_path(n.attribute("d")?).ok()?;
            Some((n.attribute("fill")?.to_owned(), Outline::new(&path)?.bounds().center()))
        };
        group(&document, layer).descendants().filter(|n| n.has_tag_name("path")).filter_map(of).collect()
    };
    let (drawn, made) = (places("layer-drawn"), places("layer-predicted"));
    let middle = Point::new(350.0, 270.0);
    // Discs and their dots go and stay together.
    let of = |all: &[(String, Point)], colour: &str| -> Vec<Point> {
        all.iter().filter(|p| p.0 == colour).map(|p| p.1).collect()
    };
    for (layer, least) in [(&drawn, 10), (&made, 1)] {
        let (discs, dots) = (of(layer, "#c1440e"), of(layer, "#222"));
        // Dots beyond the page are not part of it.
        let on_page = |p: &&Point| (20.0..700.0).contains(&p.x) && (20.0..520.0).contains(&p.y);
        let discs: Vec<&Point> = discs.iter().filter(on_page).collect();
        assert!(discs.len() > least, "{} discs", discs.len());
        assert!(discs.iter().all(|disc| dots.iter().any(|dot| dot.distance(**disc) < 6.0)));
    }
    assert!(drawn.iter().filter(|p| p.0 != "#222").all(|p| p.1.distance(middle) > 145.0));
    assert!(made.iter().all(|p| p.1.distance(middle) < 160.0));
    let count = made.len() as f64 / (std::f64::consts::PI * 150.0 * 150.0);
    let wanted = 16.0 / (240.0 * 180.0);
    assert!((0.75..1.25).contains(&(count / wanted)), "{count} {wanted}");
    folder.write("speck.svg", svg_of([720, 540], r#"<circle cx="350" cy="270" r="2"/>"#));
    let speck = "synth leaves.lib.json --context whole.svg --region speck.svg -o x.svg --seed 1";
    folder.run(speck).fails(2, "large enough for elements");
}
