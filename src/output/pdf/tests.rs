//! What every PDF of vtex holds to; how it looks is compared in `tests/formats.rs`.

use super::*;
use crate::output::testing;
use crate::scene::{Domain, Tile};

fn bytes(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    assert_eq!(write(scene, &mut bytes).unwrap(), bytes.len() as u64);
    bytes
}

fn count(bytes: &[u8], needle: &str) -> usize {
    bytes.windows(needle.len()).filter(|w| *w == needle.as_bytes()).count()
}

#[test]
fn vectors_only_with_title_and_producer() {
    let mut scene = testing::scene(400, 300, 1);
    let file = bytes(&scene);
    assert_eq!(file, bytes(&scene));
    assert_eq!(count(&file, "/Subtype /Image"), 0);
    assert!(count(&file, "/ShadingType 2") > 0);
    assert_eq!(count(&file, "/MediaBox [0 0 400 300]"), 1);
    assert_eq!(count(&file, "/Title (Texture from stones & <chips>.jpg)"), 1);
    assert_eq!(count(&file, &format!("/Producer ({})", crate::PROGRAM)), 1);
    assert_eq!(count(&file, "/CreationDate") + count(&file, "/ModDate"), 0);
    scene.width = 100_000;
    scene.height = 1;
    scene.background.points.clear();
    assert_eq!(count(&bytes(&scene), "/MediaBox [0 0 14400 "), 1);
}

#[test]
fn textons_that_stand_often_are_written_once() {
    let mut scene = testing::scene(400, 300, 2);
    let once = bytes(&scene).len();
    let copies = scene.primary.clone();
    for k in 1..=4 {
        let shifted = copies.iter().map(|i| {
            let mut copy = i.clone();
            copy.id += 100_000 * k;
            copy.transform[4] = 400.0 - copy.transform[4];
            copy
        });
        scene.primary.extend(shifted);
    }
    // Five times the primaries: a few lines for each instance, not its paths.
    let grown = bytes(&scene).len() - once;
    assert!(grown < 60 * 4 * copies.len(), "{grown} bytes for {} instances", 4 * copies.len());
}

#[test]
fn any_domain_tile_and_size_is_written() {
    let mut scene = testing::tiled(300, 200, 3, Tile { x: true, y: false });
    let plain = bytes(&scene);
    let outline = scene.textons[1].outline.clone();
    for edge in [Edge::Keep, Edge::Clip, Edge::Avoid] {
        scene.domain = Some(Domain { outline: outline.clone(), edge });
        assert_ne!(bytes(&scene), plain);
    }
    bytes(&testing::scene(1, 1, 4));
    scene.primary[0].texton = 1000;
    assert!(matches!(write(&scene, io::sink()), Err(Error::Format { .. })));
}
