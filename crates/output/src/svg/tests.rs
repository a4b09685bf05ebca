//! Properties of every SVG of vtex.

use super::*;
use crate::raster_svg::render_svg;
use crate::testing;
use resvg::usvg;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use vtex_scene::scene::{Domain, Edge, ElementId, Tile};

fn text(scene: &Scene, options: &SvgOptions) -> (String, SvgSummary) {
    let mut bytes = Vec::new();
    let summary = write(scene, options, &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), summary)
}

const EXPANDED: SvgOptions = SvgOptions { precision: 2, expand: true, css: false, names: true, fills: false };

fn named<'a>(document: &'a Document<'_>, name: &str) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", name))).collect()
}

/// One element for each id, every reference leads somewhere, and there is no picture.
fn check_document(text: &str, summary: &SvgSummary) {
    usvg::Tree::from_str(text, &usvg::Options::default()).unwrap();
    let document = Document::parse(text).unwrap();
    let ids: Vec<&str> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len());
    assert!(named(&document, "image").is_empty());
    assert_eq!(summary.bytes, text.len() as u64);
    assert_eq!(summary.elements, document.descendants().filter(Node::is_element).count() as u64);
    assert_eq!(summary.drawn, crate::raster_svg::weight(text));
    assert_eq!(summary.warnings, Vec::<String>::new());
    // Inkscape ignores coordinates that come from elsewhere.
    let gradients = named(&document, "linearGradient");
    assert!(gradients.iter().all(|n| n.attributes().all(|a| a.name() != "href")), "gradients are complete");
    let known: BTreeSet<&str> = ids.into_iter().collect();
    let links = document.descendants().filter_map(|n| n.attribute(("http://www.w3.org/1999/xlink", "href")));
    let paints = document.descendants().flat_map(|n| ["fill", "mask", "clip-path"].map(|a| n.attribute(a)));
    let paints = paints.flatten().filter_map(|p| p.strip_prefix("url(")).map(|p| p.trim_end_matches(')'));
    for link in links.chain(paints) {
        assert!(link.strip_prefix('#').is_some_and(|id| known.contains(id)), "{link}");
    }
}

#[test]
fn well_formed_with_unique_ids_and_no_picture() {
    let tiled = testing::tiled(400, 300, 1, Tile { x: true, y: true });
    let mut shaped = tiled.clone();
    let outline = shaped.elements[0].outline().clone();
    shaped.domain = Some(Domain { outline, edge: Edge::Clip });
    for options in [SvgOptions::default(), EXPANDED] {
        for scene in [&testing::scene(400, 300, 1), &tiled, &shaped] {
            let (text, summary) = text(scene, &options);
            check_document(&text, &summary);
        }
        let printed = testing::printed(testing::drawn(tiled.clone()));
        let (tile, summary) = text(&printed, &SvgOptions { fills: true, ..options });
        check_document(&tile, &summary);
        for scene in [&tiled, &shaped] {
            let mut bytes = Vec::new();
            let summary = write_pattern(scene, &options, &mut bytes).unwrap();
            check_document(&String::from_utf8(bytes).unwrap(), &summary);
        }
    }
}

#[test]
fn copies_follow_their_original() {
    let scene = testing::tiled(400, 300, 2, Tile { x: true, y: true });
    let copies = |i: &Instance| {
        let bounds = scene.element(i).bounds();
        scene.copies(i.affine().transform_rect_bbox(bounds).inflate(0.01, 0.01)).skip(1).count()
    };
    for (options, name) in [(SvgOptions::default(), "use"), (EXPANDED, "g")] {
        let (text, _) = text(&scene, &options);
        let document = Document::parse(&text).unwrap();
        let layer = document.descendants().find(|n| n.attribute("id") == Some("primary")).unwrap();
        let mut found = layer.children().filter(Node::is_element);
        let mut all = 0;
        for instance in scene.primary() {
            let id = format!("p{}", instance.id);
            assert_eq!(found.next().unwrap().attribute("id"), Some(&id[..]));
            for _ in 0..copies(instance) {
                let copy = found.next().unwrap();
                assert!(copy.has_tag_name(("http://www.w3.org/2000/svg", name)));
                let link = copy.attribute(("http://www.w3.org/1999/xlink", "href"));
                let of = copy.attribute("data-copy-of").or(link.and_then(|l| l.strip_prefix('#')));
                assert_eq!(of, Some(&id[..]));
                all += 1;
            }
        }
        assert!(found.next().is_none() && all > 10);
    }
}

#[test]
fn a_domain_clips_what_belongs_inside() {
    for (edge, inside) in [
        (Edge::Clip, &["background", "secondary", "primary"][..]),
        (Edge::Avoid, &["background", "secondary", "primary"]),
        (Edge::Keep, &["background", "secondary"]),
    ] {
        let mut scene = testing::scene(200, 200, 3);
        scene.domain = Some(Domain { outline: scene.elements[1].outline().clone(), edge });
        let (text, _) = text(&scene, &SvgOptions::default());
        let document = Document::parse(&text).unwrap();
        let group = document.descendants().find(|n| n.attribute("id") == Some("inside")).unwrap();
        assert!(group.has_attribute("clip-path"));
        let layers: Vec<_> = group.children().filter_map(|n| n.attribute("id")).collect();
        assert_eq!(layers, inside);
    }
}

#[test]
fn layers_in_order_with_a_group_for_each_primary() {
    let scene = testing::scene(400, 300, 2);
    let (text, _) = text(&scene, &SvgOptions::default());
    let document = Document::parse(&text).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("viewBox"), Some("0 0 400 300"));
    assert_eq!((root.attribute("width"), root.attribute("height")), (Some("400"), Some("300")));
    let children: Vec<Node<'_, '_>> = root.children().filter(Node::is_element).collect();
    let names: Vec<&str> =
        children.iter().map(|n| n.attribute("id").unwrap_or(n.tag_name().name())).collect();
    assert_eq!(names, ["title", "metadata", "defs", "background", "secondary", "primary"]);
    let groups: Vec<Node<'_, '_>> = children[5].children().filter(Node::is_element).collect();
    assert_eq!(groups.len(), scene.primary().len());
    for (group, instance) in groups.iter().zip(scene.primary()) {
        assert!(group.has_tag_name(("http://www.w3.org/2000/svg", "g")));
        assert_eq!(group.attribute("id"), Some(&format!("p{}", instance.id)[..]));
        let class = scene.element(instance).category.map(|c| format!("category-{c}"));
        assert_eq!(group.attribute("class"), class.as_deref());
    }
}

#[test]
fn motifs_are_groups_of_what_is_painted_one_after_another() {
    let mut scene = testing::scene(400, 300, 1);
    for (k, motif) in [(1, 7), (2, 7), (3, 8), (5, 7)] {
        scene.primary_mut()[k].motif = Some(motif);
    }
    let (text, summary) = text(&scene, &SvgOptions::default());
    check_document(&text, &summary);
    let document = Document::parse(&text).unwrap();
    let groups: Vec<Node<'_, '_>> =
        document.descendants().filter(|n| n.attribute("class") == Some("motif")).collect();
    assert_eq!(groups.len(), 1);
    let ids: Vec<&str> = groups[0].children().filter_map(|n| n.attribute("id")).collect();
    let wanted = [1, 2].map(|k| format!("p{}", scene.primary()[k].id));
    assert_eq!(ids, wanted);
}

#[test]
fn categories_have_names_colours_and_rules() {
    let scene = testing::scene(400, 300, 2);
    let (plain, _) = text(&scene, &SvgOptions::default());
    let (styled, _) = text(&scene, &SvgOptions { css: true, ..SvgOptions::default() });
    let document = Document::parse(&styled).unwrap();
    let style = named(&document, "style")[0].text().unwrap();
    let metadata = named(&document, "metadata")[0].text().unwrap();
    let metadata: serde_json::Value = serde_json::from_str(metadata).unwrap();
    let listed = metadata["categories"].as_array().unwrap();
    assert!(listed.len() > 1);
    for entry in listed {
        let class = format!("category-{}", entry["category"]);
        let shown: Vec<_> = document.descendants().filter(|n| n.attribute("class") == Some(&class)).collect();
        assert_eq!(entry["elements"].as_u64(), Some(shown.len() as u64));
        let (name, colour) = (entry["name"].as_str().unwrap(), entry["colour"].as_str().unwrap());
        let twins = listed.iter().filter(|other| other["name"] == entry["name"]).count();
        assert_eq!(twins, 1, "{name}");
        let label = |n: &Node<'_, '_>| {
            n.attribute(("http://www.inkscape.org/namespaces/inkscape", "label")).unwrap_or("").to_owned()
        };
        assert!(shown.iter().all(|n| label(n).starts_with(name)), "{name}");
        assert!(style.contains(&format!(".{class}{{filter:")) && style.contains(&format!("{name} {colour}")));
    }
    // Everything but the rules is the same, and nothing is filtered before a hue is set.
    let (before, rest) = styled.split_once("<style>").unwrap();
    let after = rest.split_once("</style>\n").unwrap().1;
    assert_eq!(format!("{before}{after}"), plain);
    assert!(style.lines().all(|line| !line.starts_with('.') || line.contains("hue-rotate(var(--hue-")));
}

#[test]
fn each_texton_used_twice_is_defined_once() {
    let scene = testing::scene(400, 300, 3);
    let (text, summary) = text(&scene, &SvgOptions::default());
    let document = Document::parse(&text).unwrap();
    let instances: Vec<usize> = scene.instances().map(|i| i.element.index()).collect();
    let uses = |t: usize| instances.iter().filter(|i| **i == t).count();
    let defined: Vec<usize> = named(&document, "defs")[0]
        .children()
        .filter_map(|n| n.attribute("id")?.strip_prefix(['t', 's'])?.parse().ok())
        .collect();
    let expected: Vec<usize> = (0..scene.elements.len()).filter(|t| uses(*t) > 1).collect();
    assert_eq!(defined, expected);
    assert_eq!(summary.shared_textons, expected.len() as u64);
    assert!(
        (0..scene.elements.len()).any(|t| uses(t) == 1) && (0..scene.elements.len()).any(|t| uses(t) == 0)
    );

    let (text, summary) = self::text(&scene, &EXPANDED);
    let document = Document::parse(&text).unwrap();
    assert!(["use", "symbol"].iter().all(|name| named(&document, name).is_empty()));
    let moved: Vec<_> = document.descendants().filter(|n| n.has_attribute("transform")).collect();
    assert!(!moved.is_empty() && moved.iter().all(|n| n.tag_name().name() == "circle"));
    assert_eq!(summary.shared_textons, 0);
}

#[test]
fn limits_of_viewers_are_told_with_what_helps() {
    let warned = |elements, references| too_much(ViewerLoad { elements, references }).unwrap_or_default();
    assert_eq!(warned(99_999, 90_000), "");
    let slow = warned(330_000, 90_000);
    assert!(slow.contains("330000 shapes") && slow.contains("some 37 s and 6.3 GB"), "{slow}");
    assert!(slow.contains("a limit of bytes, fewer elements") && !slow.contains("stops"), "{slow}");
    assert!(
        warned(1_000_000, 0).contains("resvg stops at 1000000") && !warned(1_000_000, 0).contains("librsvg")
    );
    assert!(
        warned(900_000, 500_000).contains("librsvg stops at 500000")
            && warned(900_000, 500_000).contains("written in full")
    );
    let both = warned(2_000_000, 600_000);
    assert!(
        both.contains("2000000 shapes") && both.contains("librsvg") && !both.contains("written in full"),
        "{both}"
    );
}

#[test]
fn ids_stay_unique_where_sources_do_not() {
    let mut scene = testing::scene(400, 300, 3);
    scene.elements.iter_mut().for_each(|t| t.source = Some(ElementId(5)));
    let (text, summary) = text(&scene, &SvgOptions::default());
    check_document(&text, &summary);
    scene.libraries.push(scene.libraries[0].clone());
    let (text, summary) = self::text(&scene, &SvgOptions::default());
    check_document(&text, &summary);
}

#[test]
fn shared_and_expanded_look_alike() {
    let scene = testing::scene(400, 300, 4);
    let fine = SvgOptions { precision: 2, ..SvgOptions::default() };
    let [shared, expanded] = [fine, SvgOptions { expand: true, ..fine }]
        .map(|options| render_svg(text(&scene, &options).0.as_bytes(), 1.0, "test", &()).unwrap());
    let pairs = shared.data().iter().zip(expanded.data());
    let sum: u64 = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    let mean = sum as f64 / shared.data().len() as f64;
    assert!(mean < 0.02, "{mean}");
}

#[test]
fn metadata_come_back() {
    let mut scene = testing::scene(60, 50, 5);
    scene.libraries[0].exemplar = "]]> \u{1}\u{7f}<b> \"ü\" \u{ffff} &amp;.jpg".into();
    let (text, _) = text(&scene, &SvgOptions::default());
    let document = Document::parse(&text).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(named(&document, "metadata")[0].text().unwrap()).unwrap();
    assert_eq!(json["format"], "vtex-svg");
    assert_eq!(json["seed"], 5);
    assert_eq!(json["program"], "vtex test");
    let parameters: vtex_scene::scene::SynthParams =
        serde_json::from_value(json["parameters"].clone()).unwrap();
    assert_eq!(Some(parameters), scene.parameters);
    // XML cannot hold the last character of the plane.
    let exemplar = scene.libraries[0].exemplar.replace('\u{ffff}', "\u{fffd}");
    assert_eq!(json["libraries"][0]["exemplar"], exemplar);
    assert!(named(&document, "title")[0].text().unwrap().starts_with("Texture from ]]>"));
}

#[test]
fn more_digits_more_bytes_and_nothing_lost_at_two() {
    let scene = testing::scene(300, 300, 6);
    let bytes: Vec<u64> = (0..=4)
        .map(|precision| text(&scene, &SvgOptions { precision, ..SvgOptions::default() }).1.bytes)
        .collect();
    assert!(bytes.is_sorted() && bytes[0] < bytes[1] && bytes[1] < bytes[2], "{bytes:?}");
    let (text, _) = text(&scene, &SvgOptions { precision: 2, ..SvgOptions::default() });
    let document = Document::parse(&text).unwrap();
    for (i, element) in scene.elements.iter().enumerate() {
        let id = format!("{}{i}", if element.category.is_some() { 't' } else { 's' });
        let Some(node) = named(&document, "defs")[0].children().find(|n| n.attribute("id") == Some(&id))
        else {
            continue;
        };
        let path = node.descendants().find_map(|n| n.attribute("d")).unwrap();
        assert_eq!(serde_json::to_value(element.outline()).unwrap(), path);
    }
    let wrong = write(&scene, &SvgOptions { precision: 7, ..SvgOptions::default() }, std::io::sink());
    assert!(matches!(wrong.unwrap_err().downcast(), Ok(Error::Parameter { name: "precision", .. })));
}

#[test]
fn failing_writers_are_reported() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let result = write(&testing::scene(50, 50, 8), &SvgOptions::default(), Full);
    assert_eq!(result.unwrap_err().kind(), io::ErrorKind::StorageFull);
}
