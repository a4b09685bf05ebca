//! The content of the page.

use super::subject::{NAME, made, page};
use base64::Engine;
use serde_json::Value;
use std::io::Read;
use vtex::element::ElementId;
use vtex::library::Library;
use vtex::report::{Named, Photo, Subject};
use vtex::scene::{Domain, Edge, Tile};

/// A page taken apart: its data, and its files by id.
struct Parts {
    data: Value,
    files: Vec<(String, Vec<u8>)>,
}

/// Takes a page apart as XML, which fails if anything is not closed or not escaped.
fn parts(page: &str) -> Parts {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(page, options).unwrap();
    let scripts: Vec<_> = document.descendants().filter(|n| n.has_tag_name("script")).collect();
    let data = scripts.iter().find(|n| n.attribute("id") == Some("data")).unwrap();
    let files = scripts.iter().filter(|n| n.attribute("type") == Some("text/plain")).map(|n| {
        let bytes = base64::engine::general_purpose::STANDARD.decode(n.text().unwrap()).unwrap();
        let mut unpacked = Vec::new();
        match n.attribute("data-gzip") {
            Some("true") => _ = flate2::read::GzDecoder::new(&bytes[..]).read_to_end(&mut unpacked).unwrap(),
            _ => unpacked = bytes,
        }
        (n.attribute("id").unwrap().to_owned(), unpacked)
    });
    // There is a single script, although the data contain markup of another.
    assert_eq!(scripts.iter().filter(|n| n.attribute("type").is_none()).count(), 1);
    Parts { data: serde_json::from_str(data.text().unwrap()).unwrap(), files: files.collect() }
}

impl Parts {
    fn ids(&self) -> Vec<&str> {
        self.files.iter().map(|(id, _)| id.as_str()).collect()
    }

    fn file(&self, id: &str) -> &[u8] {
        &self.files.iter().find(|(known, _)| known == id).unwrap_or_else(|| panic!("no {id}")).1
    }

    /// The text of an SVG, which is checked to be well-formed.
    fn picture(&self, id: &str) -> &str {
        let text = std::str::from_utf8(self.file(id)).unwrap();
        roxmltree::Document::parse(text).unwrap();
        text
    }
}

fn sum(values: &Value, key: &str) -> f64 {
    values.as_array().unwrap().iter().map(|v| v[key].as_f64().unwrap()).sum()
}

/// Checks that every texton can be cut out of its picture, as the page's script does.
fn check_textons(parts: &Parts, group: &Value) {
    let picture = parts.picture(group["picture"].as_str().unwrap());
    for texton in group["textons"].as_array().unwrap() {
        let begin = format!("<g id=\"p{}\" class=\"category-{}\"", texton["id"], texton["category"]);
        let found = picture.split_once(&begin).unwrap_or_else(|| panic!("no {begin}")).1;
        let inside = found.split_once('>').unwrap().1;
        // A base with a soft rim, soft ellipses and the rim are in groups of their own.
        let mut ends = inside.match_indices("</g>").map(|(at, _)| at);
        let of_texton =
            |end: &usize| inside[..*end].matches("<g ").count() == inside[..*end].matches("</g>").count();
        let inside = &inside[..ends.find(of_texton).unwrap()];
        assert!(inside.contains("<path ") && inside.matches("<g ").count() <= 3, "{inside}");
        // References lead to parts of the texton, or to a brush on its own line.
        for link in inside.split("xlink:href=\"#").skip(1).map(|rest| rest.split_once('"').unwrap().0) {
            let brush = format!("\n<radialGradient id=\"{link}g\" ");
            assert!(
                inside.contains(&format!("id=\"{link}\"")) || picture.contains(&brush),
                "{link}: {inside}"
            );
        }
        assert!(texton["bounds"][2].as_f64().unwrap() > 0.0);
    }
}

/// Checks that the page's script can split a picture into its layers, each with its definitions.
fn check_layers(picture: &str) {
    let (_, rest) = picture.split_once("<defs>").unwrap();
    let (definitions, rest) = rest.split_once("</defs>").unwrap();
    let whole = |part: &str| {
        let text = format!("<svg xmlns:xlink='x' xmlns:inkscape='i'>{part}</svg>");
        roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{e}: {part}"));
    };
    definitions.lines().for_each(whole);
    let starts = ["background", "secondary", "primary"].map(|layer| {
        let mark = format!("<g id=\"{layer}\"");
        assert_eq!(picture.matches(&mark).count(), 1);
        rest.find(&mark).unwrap()
    });
    let ends = [starts[1], starts[2], rest.rfind("</svg>").unwrap()];
    for (start, end) in starts.into_iter().zip(ends) {
        let mut layer = &rest[start..end];
        while layer.matches("</g>").count() > layer.matches("<g ").count() + layer.matches("<g>").count() {
            layer = &layer[..layer.rfind("</g>").unwrap()];
        }
        whole(layer);
    }
}

#[test]
fn pictures_come_apart_into_layers() {
    let made = made();
    let mut scene = made.scene.clone();
    let path = vtex::geometry::Rect::new(30.0, 20.0, 200.0, 150.0);
    let outline = vtex::geometry::Outline::new(&rectangle(path)).unwrap();
    for edge in [None, Some(Edge::Keep), Some(Edge::Clip), Some(Edge::Avoid)] {
        scene.content.domain = edge.map(|edge| Domain { outline: outline.clone(), edge });
        for tile in [false, true] {
            scene.content.tile = Tile { x: tile, y: tile };
            let (text, _) = page(&made.libraries, Some(&scene), &[]);
            let parts = parts(&text);
            check_layers(parts.picture("result"));
            check_layers(parts.picture("textons-0"));
        }
    }
}

fn rectangle(r: vtex::geometry::Rect) -> vtex::geometry::BezPath {
    let mut path = vtex::geometry::BezPath::new();
    path.move_to((r.x0, r.y0));
    [(r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)].into_iter().for_each(|corner| path.line_to(corner));
    path.close_path();
    path
}

#[test]
fn a_library_and_a_scene_make_a_whole_page() {
    let made = made();
    let (text, warnings) = page(&made.libraries, Some(&made.scene), &made.photos());
    assert_eq!(warnings, Vec::<String>::new());
    let parts = parts(&text);
    assert_eq!(parts.ids(), ["photo-0", "textons-0", "result"]);
    assert_eq!(parts.file("photo-0"), made.photo);
    parts.picture("result");
    let (group, scene) = (&parts.data["groups"][0], &parts.data["scene"]);
    assert_eq!((&group["file"], &group["photo_missing"]), (&Value::from(NAME), &Value::Null));
    assert_eq!((&group["in_scene"], &scene["seed"]), (&true.into(), &"7".into()));
    assert_eq!(parts.data["program"], vtex::PROGRAM);
    check_textons(&parts, group);

    let (library, placed) = (&made.libraries[0].content, made.scene.content.individuals().count() as f64);
    assert_eq!(group["textons"].as_array().unwrap().len(), library.primaries().len());
    assert_eq!(sum(&group["textons"], "placed"), placed);
    assert_eq!(sum(&group["categories"], "placed"), placed);
    assert_eq!(sum(&group["categories"], "members"), library.primaries().len() as f64);
    assert!((sum(&group["categories"], "wanted") - library.coverage).abs() < 1e-9);
    assert!((sum(&group["categories"], "got") - scene["coverage"].as_f64().unwrap()).abs() < 1e-9);

    let distributions = group["distributions"].as_array().unwrap();
    assert!(distributions.len() > 4, "{}", distributions.len());
    for d in distributions {
        let bins = d["edges"].as_array().unwrap().len() - 1;
        for whose in ["exemplar", "result"] {
            assert_eq!(d[whose].as_array().unwrap().len(), bins, "{} {whose}", d["title"]);
        }
    }
}

#[test]
fn each_alone_makes_a_page_of_what_is_known() {
    let made = made();
    let (text, _) = page(&made.libraries, None, &[]);
    let alone = parts(&text);
    assert_eq!(alone.ids(), ["textons-0"]);
    let group = &alone.data["groups"][0];
    assert_eq!((&alone.data["scene"], &group["in_scene"]), (&Value::Null, &false.into()));
    assert!(group["photo_missing"].as_str().unwrap().ends_with("Ask the owner."));
    assert!(group["distributions"][0].get("result").is_none());
    assert!(group["categories"][0]["got"].is_null());
    check_textons(&alone, group);

    let (text, _) = page(&[], Some(&made.scene), &made.photos());
    let alone = parts(&text);
    assert_eq!(alone.ids(), ["photo-0", "textons-0", "result"]);
    let group = &alone.data["groups"][0];
    assert!(group["library"].is_null() && group["distributions"][0].get("exemplar").is_none());
    assert_eq!(sum(&group["textons"], "placed"), made.scene.content.individuals().count() as f64);
    assert!(group["categories"][0]["wanted"].is_null());
    check_textons(&alone, group);
}

#[test]
fn the_page_asks_nobody_for_anything() {
    let made = made();
    let (text, _) = page(&made.libraries, Some(&made.scene), &made.photos());
    for (at, _) in text.match_indices("://") {
        let from = text[..at].rfind(|c: char| !c.is_ascii_alphabetic()).unwrap() + 1;
        assert!(text[from..].starts_with("http://www.w3.org/"), "{}", &text[from..(at + 40).min(text.len())]);
    }
    for word in ["fetch(", "XMLHttpRequest", "WebSocket", "import(", "innerHTML", "eval(", "@import"] {
        assert!(!text.contains(word), "{word}");
    }
    assert!(text.contains("default-src 'none'"), "the policy forbids all requests");
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&text, options).unwrap();
    for attribute in document.descendants().flat_map(|n| n.attributes()) {
        assert!(!["src", "href", "srcset", "action"].contains(&attribute.name()), "{attribute:?}");
    }
}

#[test]
fn names_are_escaped_and_come_back() {
    let made = made();
    let (text, _) = page(&made.libraries, Some(&made.scene), &made.photos());
    assert!(!text.contains("<script>alert"), "the name became markup");
    let title = text.split_once("<title>").unwrap().1.split_once("</title>").unwrap().0;
    assert!(title.starts_with("Texture from &lt;/script&gt;&lt;script&gt;"), "{title}");
    assert_eq!(parts(&text).data["scene"]["exemplars"][0], NAME);
}

#[test]
fn the_same_page_comes_out_every_time() {
    let made = made();
    let write = || page(&made.libraries, Some(&made.scene), &made.photos()).0;
    assert_eq!(write(), write());
}

#[test]
fn a_photograph_is_told_by_its_sum() {
    let made = made();
    let mut other = made.photo.clone();
    other.push(0);
    for given in [false, true] {
        let (text, warnings) = page(&made.libraries, None, &[Photo::new(NAME, other.clone(), given)]);
        let parts = parts(&text);
        assert_eq!(parts.ids(), ["textons-0"]);
        let reason = parts.data["groups"][0]["photo_missing"].as_str().unwrap();
        assert!(reason.contains("SHA-256"), "{reason}");
        assert_eq!(warnings.len(), usize::from(given));
    }
    // A photograph with another name is recognised.
    let (text, warnings) = page(&made.libraries, None, &[Photo::new("moved.png", made.photo.clone(), true)]);
    assert_eq!((parts(&text).ids(), warnings.len()), (vec!["photo-0", "textons-0"], 0));
}

#[test]
fn what_browsers_cannot_show_becomes_a_png() {
    let made = made();
    let mut tiff = std::io::Cursor::new(Vec::new());
    let picture = image::load_from_memory(&made.photo).unwrap();
    picture.write_to(&mut tiff, image::ImageFormat::Tiff).unwrap();
    let tiff = tiff.into_inner();
    let exemplar = vtex::analyze::Exemplar::from_bytes(&tiff, "a.tif", &Default::default()).unwrap();
    let mut library = made.libraries[0].content.clone();
    library.source.sha256 = exemplar.sha256;
    let named = [Named { name: "a.lib.json".into(), content: library }];
    let (text, _) = page(&named, None, &[Photo::new("a.tif", tiff, false)]);
    let shown = image::load_from_memory(parts(&text).file("photo-0")).unwrap();
    assert_eq!(shown.into_rgb8(), picture.into_rgb8());
}

#[test]
fn a_scene_is_compared_only_with_what_it_was_made_from() {
    let made = made();
    let mut stranger = made.libraries[0].clone();
    stranger.content.source.sha256 = "f".repeat(64);
    // The element is changed as if it came from another library of the same photograph.
    let mut other = made.scene.clone();
    let primaries = &made.libraries[0].content.primaries();
    let element = other.content.elements.iter_mut().find(|e| e.category.is_some()).unwrap();
    let elsewhere = primaries.iter().position(|p| p.category != element.category).unwrap();
    element.source = Some(ElementId(elsewhere as u32));
    for (library, scene) in [(&stranger, &made.scene), (&made.libraries[0], &other)] {
        let (text, _) = page(std::slice::from_ref(library), Some(scene), &[]);
        let data = parts(&text).data;
        let groups = data["groups"].as_array().unwrap();
        let known: Vec<_> = groups.iter().map(|g| (g["library"].is_null(), &g["in_scene"])).collect();
        assert_eq!(known, [(false, &false.into()), (true, &true.into())]);
    }
}

#[test]
fn several_libraries_are_kept_apart() {
    let made = made();
    let mut second = made.libraries[0].content.clone();
    second.source.sha256 = "e".repeat(64);
    let mut scene = made.scene.clone();
    let mut reference = scene.content.libraries[0].clone();
    reference.sha256 = second.source.sha256.clone();
    scene.content.libraries.push(reference);
    scene.content.elements.iter_mut().for_each(|e| e.library.0 = e.source.unwrap().0 % 2);
    let libraries = [made.libraries[0].clone(), Named { name: "second.lib.json".into(), content: second }];
    let (text, _) = page(&libraries, Some(&scene), &made.photos());
    let data = parts(&text).data;
    let placed: Vec<f64> = (0..2).map(|g| sum(&data["groups"][g]["categories"], "placed")).collect();
    assert_eq!(placed[0] + placed[1], scene.content.individuals().count() as f64);
    assert!(placed.iter().all(|p| *p > 0.0), "{placed:?}");
    let listed = |g: usize| -> usize {
        let instances = data["groups"][g]["instances"].as_object().unwrap();
        instances.values().map(|ids| ids.as_array().unwrap().len()).sum()
    };
    assert_eq!([listed(0) as f64, listed(1) as f64], placed[..]);
}

#[test]
fn what_is_unsound_is_refused() {
    let made = made();
    let mut scene = made.scene.clone();
    scene.content.instances_mut().next().unwrap().element = ElementId(1_000_000);
    let subject = Subject { libraries: &[], scene: Some(&scene), photos: &[], ask: "" };
    let fault = vtex::report::write(&subject, std::io::sink()).unwrap_err();
    assert!(matches!(fault.downcast(), Ok(vtex::Error::Format { .. })));
    let mut library = made.libraries[0].clone();
    library.content.arrangement.runs.clear();
    let subject = Subject { libraries: &[library], scene: None, photos: &[], ask: "" };
    let fault = vtex::report::write(&subject, std::io::sink()).unwrap_err();
    assert!(matches!(fault.downcast(), Ok(vtex::Error::Format { .. })));
}

#[test]
fn next_to_nothing_makes_a_page_too() {
    let made = made();
    let mut library: Library = made.libraries[0].content.clone();
    library.elements.clear();
    library.categories.clear();
    for layer in &mut library.layers {
        layer.instances.clear();
        layer.field.iter_mut().for_each(|field| field.points.clear());
    }
    library.arrangement.runs = vec![0, 160 * 160];
    library.coverage = 0.0;
    let mut scene = made.scene.clone();
    scene.content.elements.clear();
    for layer in &mut scene.content.layers {
        layer.instances.clear();
        layer.field.iter_mut().for_each(|field| field.points.clear());
    }
    scene.content.libraries.clear();
    scene.content.parameters = None;
    scene.content.tile = Tile { x: true, y: true };
    let named = [Named { name: "empty.lib.json".into(), content: library }];
    for (libraries, scene) in [(&named[..], None), (&[], Some(&scene)), (&named, Some(&scene))] {
        let (text, _) = page(libraries, scene, &[]);
        assert_eq!(parts(&text).data["groups"].as_array().unwrap().len(), libraries.len());
    }
}
