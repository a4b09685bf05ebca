//! Properties of every PDF of vtex; its look is compared in `tests/formats.rs`.

use super::*;
use crate::testing;
use std::io::Read;
use vtex_base::error::Error;
use vtex_scene::scene::{Domain, Edge, ElementId, Tile};

fn bytes(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    assert_eq!(write(scene, &mut bytes).unwrap(), bytes.len() as u64);
    bytes
}

/// The objects of a file, those that are packed unpacked.
pub(crate) fn objects(file: &[u8]) -> Vec<u8> {
    let mut all = file.to_vec();
    let mark = b"/FlateDecode/Type/ObjStm";
    for at in (0..file.len()).filter(|at| file[*at..].starts_with(mark)) {
        let begin = at + file[at..].windows(7).position(|w| w == b"stream\n").unwrap() + 7;
        flate2::read::ZlibDecoder::new(&file[begin..]).read_to_end(&mut all).unwrap();
    }
    all
}

pub(crate) fn count(bytes: &[u8], needle: &str) -> usize {
    bytes.windows(needle.len()).filter(|w| *w == needle.as_bytes()).count()
}

#[test]
fn vectors_only_with_title_and_producer() {
    let mut scene = testing::scene(400, 300, 1);
    let file = bytes(&scene);
    assert_eq!(file, bytes(&scene));
    assert_eq!(count(&file, "/Subtype/Image"), 0);
    assert!(count(&objects(&file), "/ShadingType 2") > 0);
    assert_eq!(count(&file, "/MediaBox[0 0 300 225]"), 1);
    assert_eq!(count(&file, "/Title(Texture from stones & <chips>.jpg)"), 1);
    assert_eq!(count(&file, &format!("/Producer({})", vtex_base::PROGRAM)), 1);
    assert_eq!(count(&file, "/CreationDate") + count(&file, "/ModDate"), 0);
    scene.width = 100_000;
    scene.height = 1;
    scene.field_mut().points.clear();
    assert_eq!(count(&bytes(&scene), "/MediaBox[0 0 12500 0.125]/UserUnit 6"), 1);
}

/// The content of the object of a number, unpacked.
fn object(file: &[u8], number: usize) -> String {
    let mark = format!("\n{number} 0 obj\n");
    let at = file.windows(mark.len()).position(|w| w == mark.as_bytes()).unwrap();
    let object = &file[at..];
    let end = object.windows(6).position(|w| w == b"endobj").unwrap();
    String::from_utf8_lossy(&object[..end]).into_owned()
}

/// The number of the object after a key.
fn number(text: &str, key: &str) -> usize {
    text.split_once(key)
        .unwrap_or_else(|| panic!("{key} in {text}"))
        .1
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap()
}

#[test]
fn layers_are_optional_content() {
    let mut scene = testing::scene(400, 300, 1);
    let mut found = Vec::new();
    let outline = scene.elements[1].outline().clone();
    for edge in [None, Some(Edge::Keep), Some(Edge::Clip)] {
        scene.domain = edge.map(|edge| Domain { outline: outline.clone(), edge });
        let file = bytes(&scene);
        let text = String::from_utf8_lossy(&file);
        let catalog = object(&file, number(&text, "/Root "));
        let page = object(&file, number(&object(&file, number(&catalog, "/Pages ")), "/Kids["));
        let content = object(&file, number(&page, "/Contents "));
        let names: Vec<String> = (0..3)
            .map(|k| {
                assert!(content.contains(&format!("/OC/l{k} BDC/x{k} Do\nEMC")), "{content}");
                let group = number(&page, &format!("/l{k} "));
                assert_eq!(catalog.matches(&format!("{group} 0 R")).count(), 2, "{catalog}");
                object(&file, group).split(['(', ')']).nth(1).unwrap().to_owned()
            })
            .collect();
        found.push(names);
        // One change of coordinates, outside of all `q` and `Q`.
        let plain = content.split_once("stream\n").unwrap().1;
        assert!(plain.starts_with(" 0.75 0 0 -0.75 0 225 cm\nq"), "{content}");
        assert_eq!(plain.matches(" cm").count(), 1, "{content}");
    }
    assert!(found.iter().all(|names| names == &["Background", "Secondary", "Primary"]), "{found:?}");
}

#[test]
fn textons_that_stand_often_are_written_once() {
    let mut scene = testing::scene(400, 300, 2);
    let once = bytes(&scene).len();
    let copies = scene.primary().to_vec();
    for k in 1..=4 {
        let shifted = copies.iter().map(|i| {
            let mut copy = i.clone();
            copy.id.0 += 100_000 * k;
            copy.transform[4] = 400.0 - copy.transform[4];
            copy
        });
        scene.primary_mut().extend(shifted);
    }
    // Five times the primaries: a few lines for each instance, not its paths.
    let grown = bytes(&scene).len() - once;
    assert!(grown < 60 * 4 * copies.len(), "{grown} bytes for {} instances", 4 * copies.len());
}

#[test]
fn any_domain_tile_and_size_is_written() {
    let mut scene = testing::tiled(300, 200, 3, Tile { x: true, y: false });
    let plain = bytes(&scene);
    let outline = scene.elements[1].outline().clone();
    for edge in [Edge::Keep, Edge::Clip, Edge::Avoid] {
        scene.domain = Some(Domain { outline: outline.clone(), edge });
        assert_ne!(bytes(&scene), plain);
    }
    bytes(&testing::scene(1, 1, 4));
    scene.primary_mut()[0].element = ElementId(1000);
    assert!(matches!(write(&scene, io::sink()).unwrap_err().downcast(), Ok(Error::Format { .. })));
}
