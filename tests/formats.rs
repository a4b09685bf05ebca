//! All files of one scene show the same picture, and the elements of the scene can be identified in the SVG.

use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use std::process::Command;
use std::sync::OnceLock;
use tiny_skia::Pixmap;
use vtex::output::svg::SvgOptions;
use vtex::output::{file, pdf, png, raster_svg, reduce, svg};
use vtex::raster::colour::Colour;
use vtex::scene::{Domain, Edge, Element, Instance, Role, Scene, Shadow, Shape, Stroke, SynthParams, Tile};
use vtex::synth::synthesize;

const EXPANDED: SvgOptions = SvgOptions { precision: 2, expand: true, css: false, names: true, fills: false };
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// A texture from the middle of a self-made exemplar; it tiles, so copies are drawn too.
fn scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let tile = Tile { x: true, y: true };
        let params = SynthParams { width: 260, height: 200, seed: 4, tile, ..SynthParams::default() };
        synthesize(&crate::support::library("pebbles"), &params, &()).unwrap()
    })
}

/// The scene inside the outline of one of its textons, enlarged.
fn shaped(edge: Edge) -> Scene {
    use vtex::geometry::{Affine, Outline};
    let mut scene = scene().clone();
    scene.tile = Tile::default();
    let first = scene.individuals().next().unwrap();
    let outline = scene.element(first).outline().clone();
    let bounds = outline.bounds();
    let size = 180.0 / bounds.height().max(bounds.width());
    let path = Affine::translate((130.0, 100.0))
        * Affine::scale(size)
        * Affine::translate(-bounds.center().to_vec2())
        * outline.path();
    scene.domain = Some(Domain { outline: Outline::new(&path).unwrap(), edge });
    scene
}

fn svg_of(scene: &Scene, options: &SvgOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    svg::write(scene, options, &mut bytes).unwrap();
    bytes
}

/// A picture as red, green and blue on white, as paper shows it.
struct Rgb {
    width: usize,
    data: Vec<u8>,
}

fn on_white(picture: &Pixmap) -> Rgb {
    let white = |v: u8, alpha: u8| v.saturating_add(255 - alpha);
    let pixels = picture.pixels().iter();
    let data = pixels.flat_map(|p| [p.red(), p.green(), p.blue()].map(|v| white(v, p.alpha()))).collect();
    Rgb { width: picture.width() as usize, data }
}

/// Mean difference, in 8-bit steps.
fn mean(a: &Rgb, b: &Rgb) -> f64 {
    assert_eq!((a.width, a.data.len()), (b.width, b.data.len()));
    let sum: u64 = a.data.iter().zip(&b.data).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.data.len() as f64
}

/// The page as poppler draws it at `resolution` pixels per inch; `None` without poppler.
fn by_poppler(scene: &Scene, resolution: u32) -> Option<Rgb> {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.pdf");
    let mut bytes = Vec::new();
    let length = pdf::write(scene, &mut bytes).unwrap();
    assert_eq!(length, bytes.len() as u64);
    std::fs::write(&page, bytes).unwrap();
    let root = folder.path().join("page");
    let run = Command::new("pdftoppm")
        .args(["-png", "-singlefile", "-r", &resolution.to_string()])
        .args([&page, &root])
        .output();
    let Ok(output) = run else {
        eprintln!("skipped: pdftoppm is not installed, so nothing here draws a PDF");
        return None;
    };
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.is_empty(), "{said}");
    let picture = image::open(root.with_extension("png")).unwrap().into_rgb8();
    Some(Rgb { width: picture.width() as usize, data: picture.into_raw() })
}

/// The scene with soft shadows and lines.
fn styled() -> Scene {
    let mut scene = scene().clone();
    let shadow = Shadow { offset: [3.0, 4.5], opacity: 0.5, blur: 4.0 };
    let mut layers = scene.layers.iter_mut().rev();
    let primary = &mut layers.next().unwrap().instances;
    primary.iter_mut().for_each(|i| i.shadow = Some(shadow));
    let stroke = Stroke { width: 1.5, colour: Colour([250, 240, 200]) };
    primary.iter_mut().step_by(3).for_each(|i| i.stroke = Some(stroke));
    let secondary = &mut layers.next().unwrap().instances;
    secondary.iter_mut().step_by(4).for_each(|i| i.shadow = Some(Shadow { blur: 1.5, ..shadow }));
    scene
}

/// The scene without soft ellipses.
fn unshaded() -> Scene {
    let mut scene = scene().clone();
    let elements = scene.elements.clone();
    for layer in &mut scene.layers {
        layer.instances.retain(|i| !elements[i.element.index()].base().is_soft());
    }
    for element in &mut scene.elements {
        let base = element.shapes.remove(0);
        element.shapes.retain(|shape| !shape.is_soft());
        element.shapes.insert(0, base);
    }
    scene
}

#[test]
fn all_formats_agree() {
    for scene in [scene(), &unshaded(), &shaped(Edge::Clip), &shaped(Edge::Keep), &styled()] {
        let picture = on_white(&png::render(scene, 1.0).unwrap());
        let drawn = |bytes: &[u8]| on_white(&raster_svg::render_svg(bytes, 1.0, "test", &()).unwrap());
        let plain = svg_of(scene, &SvgOptions::default());
        let mut packed = file::gzip(Vec::new());
        std::io::Write::write_all(&mut packed, &plain).unwrap();
        let packed = packed.finish().unwrap();
        assert_eq!(drawn(&packed).data, drawn(&plain).data);
        for (name, bytes) in [("svg", plain), ("expanded", svg_of(scene, &EXPANDED))] {
            let found = mean(&picture, &drawn(&bytes));
            assert!(found <= 1.0, "{name}: {found}");
        }
        // Pictures are enlarged, because poppler draws edges differently: it fills every sixteenth of a pixel
        // that a shape touches, and then thins partly filled pixels.
        if let Some(page) = by_poppler(scene, 96 * 4) {
            let found = mean(&on_white(&png::render(scene, 4.0).unwrap()), &page);
            // Poppler and MuPDF round down what they blend by each soft mask: they are darker by two to
            // three steps where many ellipses lie on one another.
            let is_soft = scene.instances().any(|i| scene.element(i).shapes.iter().any(Shape::is_soft));
            let most = if is_soft { 3.0 } else { 1.5 };
            assert!(found <= most, "pdf: {found}");
        }
    }
}

#[test]
fn pictures_agree_at_twice_the_size() {
    let picture = on_white(&png::render(scene(), 2.0).unwrap());
    let drawn = raster_svg::render_svg(&svg_of(scene(), &SvgOptions::default()), 2.0, "test", &()).unwrap();
    let found = mean(&picture, &on_white(&drawn));
    assert!(found <= 1.0, "{found}");
}

#[test]
fn a_reduced_scene_still_looks_the_same() {
    let picture = on_white(&png::render(scene(), 1.0).unwrap());
    let measure = |scene: &Scene, options: &SvgOptions| {
        svg::write(scene, options, std::io::sink()).map(|summary| summary.bytes)
    };
    let whole = measure(scene(), &SvgOptions::default()).unwrap();
    let mut last = 0.0;
    for (share, limit) in [(0.9, 1.2), (0.75, 2.3), (0.5, 5.2)] {
        let most = (whole as f64 * share) as u64;
        let reduced = reduce::to_fit(scene(), &SvgOptions::default(), most, measure).unwrap();
        let bytes = svg_of(&reduced.scene, &reduced.options);
        assert!(bytes.len() as u64 <= most);
        let drawn = raster_svg::render_svg(&bytes, 1.0, "test", &()).unwrap();
        let found = mean(&picture, &on_white(&drawn));
        assert!(found <= limit && found >= last, "{share}: {found}");
        last = found;
    }
}

/// Every reference leads to the one element of its id, and nothing is a bitmap.
fn check_references(document: &Document<'_>) {
    let ids: Vec<&str> = document.descendants().filter_map(|n| n.attribute("id")).collect();
    let known: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(known.len(), ids.len(), "ids are unique");
    for node in document.descendants().filter(Node::is_element) {
        assert_ne!(node.tag_name().name(), "image");
        for attribute in node.attributes() {
            let value = attribute.value();
            let link = match attribute.name() {
                "href" => Some(value),
                _ => value.strip_prefix("url(").map(|v| v.trim_end_matches(')')),
            };
            let found = link.is_none_or(|l| l.strip_prefix('#').is_some_and(|id| known.contains(id)));
            assert!(found, "{attribute:?}");
        }
    }
}

/// Source and index of the library of the texton drawn by an element, as itself or the id that it refers to says.
fn origin(node: Node<'_, '_>) -> (u32, u32) {
    let number = |text: &str| text.parse().unwrap();
    let said = |name| node.descendants().find_map(|n| n.attribute(name)).map(number);
    let link = node.descendants().find_map(|n| n.attribute((XLINK, "href")));
    let path = node.descendants().find(|n| n.tag_name().name() == "path");
    let name = link.map(|l| l.strip_prefix('#').unwrap()).or(path.and_then(|n| n.attribute("id")));
    match (said("data-source"), name) {
        (Some(source), _) => (source, said("data-library").unwrap_or(1) - 1),
        (None, Some(name)) => {
            // Later parts of a texton have a number after a point.
            let name = name.split('.').next().unwrap();
            let (source, library) = name[1..].split_once('-').unwrap_or((&name[1..], "1"));
            (number(source), number(library) - 1)
        }
        (None, None) => panic!("nothing says where it comes from: {node:?}"),
    }
}

/// The colour of the brush that fills a circle.
fn brush<'a>(circle: Node<'a, '_>) -> &'a str {
    let id = circle.attribute("fill").unwrap().strip_prefix("url(#").unwrap().trim_end_matches(')');
    let brush = circle.document().descendants().find(|n| n.attribute("id") == Some(id)).unwrap();
    brush.first_element_child().unwrap().attribute("stop-color").unwrap()
}

#[test]
fn a_reader_finds_category_source_and_order_of_every_texton() {
    let mut mixed = shaped(Edge::Clip);
    mixed.libraries.push(mixed.libraries[0].clone());
    mixed.elements.iter_mut().step_by(2).for_each(|t| t.library.0 = 1);
    for (scene, options) in
        [scene(), &mixed].into_iter().flat_map(|s| [(s, SvgOptions::default()), (s, EXPANDED)])
    {
        let bytes = svg_of(scene, &options);
        let document = Document::parse(std::str::from_utf8(&bytes).unwrap()).unwrap();
        check_references(&document);
        let layer = |id: &str| {
            let layer = document.descendants().find(|n| n.attribute("id") == Some(id)).unwrap();
            assert_eq!(layer.attribute((INKSCAPE, "groupmode")), Some("layer"));
            assert!(layer.attribute((INKSCAPE, "label")).is_some());
            layer
        };
        assert!(layer("background").children().any(|n| n.is_element()));
        let check = |node: Node<'_, '_>, element: &Element| {
            assert_eq!(origin(node), (element.source.unwrap().0, element.library.0));
        };
        let textons = |i: &Instance| scene.element(i);

        // Elements without an id are copies.
        let primaries = layer("primary").children().filter(|n| n.has_attribute("id"));
        let primaries: Vec<Node<'_, '_>> = primaries.collect();
        assert_eq!(primaries.len(), scene.individuals().count());
        for (node, instance) in primaries.into_iter().zip(scene.individuals()) {
            assert_eq!(node.attribute("id"), Some(&format!("p{}", instance.id)[..]));
            let category = textons(instance).category.unwrap();
            let several = if scene.libraries.len() > 1 {
                format!("-{}", textons(instance).library)
            } else {
                String::new()
            };
            assert_eq!(node.attribute("class"), Some(&format!("category-{category}{several}")[..]));
            check(node, textons(instance));
        }
        // Each secondary is one element; the element of a copy follows that of the original.
        let layer = layer("secondary");
        let mut elements =
            layer.descendants().filter(|n| ["use", "path", "circle"].contains(&n.tag_name().name()));
        for instance in scene.of_role(Role::Secondary) {
            let bounds = instance.affine().transform_rect_bbox(textons(instance).bounds());
            // Rounding may move it by as much as the last digit.
            let reach = if options.precision == 1 { 0.1 } else { 0.01 };
            for _ in scene.copies(bounds.inflate(reach, reach)) {
                let node = elements.next().unwrap();
                let spot = textons(instance).spot(instance.colour);
                assert_eq!(node.tag_name().name() == "circle", spot.is_some());
                match spot {
                    // A spot is identified by its brush.
                    Some((_, colour)) => assert_eq!(brush(node), colour.to_string()),
                    None => check(node, textons(instance)),
                }
            }
        }
        assert!(elements.next().is_none());
    }
}

#[test]
fn symbols_have_titles() {
    let bytes = svg_of(scene(), &SvgOptions::default());
    let document = Document::parse(std::str::from_utf8(&bytes).unwrap()).unwrap();
    let symbols = document.descendants().filter(|n| n.tag_name().name() == "symbol");
    let titles: Vec<&str> = symbols
        .map(|s| s.first_element_child().filter(|t| t.tag_name().name() == "title").unwrap().text().unwrap())
        .collect();
    assert!(!titles.is_empty());
    assert_eq!(titles.iter().collect::<BTreeSet<_>>().len(), titles.len());
    assert!(titles.iter().all(|t| t.starts_with("Element ") && t.contains(", category ")), "{titles:?}");
}

#[test]
fn versions_that_are_not_known_are_named() {
    for version in [0, 1, 3] {
        let text = format!(r#"{{"format":"vtex-scene","version":{version}}}"#);
        let error = Scene::from_bytes(text.into_bytes(), "new").unwrap_err();
        assert!(matches!(error, vtex::Error::Version { known: 2, .. }), "{error}");
        assert!(!error.hint().unwrap().is_empty());
    }
}
